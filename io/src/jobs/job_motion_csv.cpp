// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "jobs/job_rows.hpp"
#include "motions/joint_rows.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel::io {

namespace {

std::vector<std::string> header_of(const JointNames& joint_names, bool roll) {
  std::vector<std::string> header = csv_header(motion_schema(), joint_names, roll);
  header.insert(header.end(), {"stroke", "process"});
  return header;
}

/// Returns for each part of a job's motion the index of its stroke; none for transitions.
std::vector<std::optional<std::size_t>> strokes_of_parts(const JobMotion& motion, const Job& job) {
  std::vector<std::optional<std::size_t>> strokes;
  if (!motion.part.empty()) strokes.resize(motion.part.back() + 1);
  std::size_t part = job.home ? 1 : 0;
  for (const ProcessEvent& event : motion.events) {
    if (!event.on) continue;
    if (part < strokes.size()) strokes[part] = event.stroke;
    part += 2;
  }
  return strokes;
}

/// Returns for each row of a motion whether the process is on from it to the next row. Throws
/// InputError if a stroke has no such row.
std::vector<bool> process_of_motion(const JobMotion& motion, const Job& job) {
  for (std::size_t k = 1; k < motion.events.size(); ++k)
    if (motion.events[k].t <= motion.events[k - 1].t)
      throw InputError(job.source, "stroke '" + job.strokes[motion.events[k].stroke].name +
                                       "' begins and ends between two samples: allowed are more "
                                       "samples a second");
  std::vector<bool> process(motion.rows.size());
  std::size_t event = 0;
  bool on = false;
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    while (event < motion.events.size() && motion.events[event].t <= motion.rows[k].t)
      on = motion.events[event++].on;
    process[k] = on;
  }
  return process;
}

}  // namespace

std::string to_job_motion_csv(const JobMotion& motion, const Job& job,
                              const JointNames& joint_names) {
  const std::vector<std::optional<std::size_t>> strokes = strokes_of_parts(motion, job);
  const std::vector<bool> process = process_of_motion(motion, job);
  const auto stroke = [&](std::size_t k) { return strokes[motion.part[k]]; };
  const auto placed = [&](std::size_t k) {
    return stroke(k) || (k + 1 < motion.rows.size() && stroke(k + 1));
  };
  bool roll = false;
  for (std::size_t k = 0; k < motion.rows.size(); ++k)
    roll = roll || (placed(k) && motion.rows[k].row.roll != 0);
  std::string text;
  for (const std::string& name : header_of(joint_names, roll))
    text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    const TimedRow& row = motion.rows[k];
    text += format_double(row.t) + ',';
    TrajectoryRow place = row.row;
    if (placed(k)) place.s += s_of_piece(job.strokes[stroke(k) ? *stroke(k) : *stroke(k + 1)]);
    text += placed(k) ? trajectory_fields(place, roll) : placeless_fields(place, roll);
    for (const Config* values : {&row.v, &row.a})
      for (const double value : *values) text += ',' + format_double(value);
    text += ',' + (stroke(k) ? csv_line_field(job.strokes[*stroke(k)].name) : "");
    text += process[k] ? ",1\n" : ",0\n";
  }
  return text;
}

namespace {

/// Reads the rows of a job's motion one after the other.
class JobMotionRows {
 public:
  JobMotionRows(const std::string& file, const Job& job, const JointNames& joint_names)
      : file_(file), job_(job), joint_names_(joint_names) {
    for (std::size_t k = 0; k < job.strokes.size(); ++k)
      strokes_.emplace(csv_line_field(job.strokes[k].name), k);
  }

  /// Sets the columns. Throws InputError for any but those of to_job_motion_csv().
  void header(const std::vector<std::string>& columns, const std::string& where) {
    for (const bool roll : {false, true})
      if (columns == header_of(joint_names_, roll)) {
        columns_ = columns;
        rolls_ = roll;
        return;
      }
    bad_header(where, "a job's motion", header_of(joint_names_, false));
  }

  void add(const CsvPlace& place, const std::vector<std::string>& fields) {
    const std::string& stroke = fields[columns_.size() - 2];
    if (rows_.empty() || stroke != last_stroke_) begin_part(place, stroke);
    TimedRow row;
    row.t = number(place, fields, 0);
    if (rows_.empty() ? row.t != 0 : !(row.t > rows_.back().t))
      bad_input(place.where() + ": t", "is " + fields[0],
                rows_.empty() ? "0 in the first row" : "times that ascend from row to row");
    const std::size_t joints = rolls_ ? 5 : 4;
    const bool placed = std::any_of(fields.begin() + 1, fields.begin() + static_cast<long>(joints),
                                    [](const std::string& field) { return !field.empty(); });
    if (!stroke.empty() || placed) {
      row.row.s = number(place, fields, 1);
      row.row.phi = number(place, fields, 2);
      if (rolls_) row.row.roll = number(place, fields, 3);
      row.row.branch = branch_field(place, fields[joints - 1]);
    }
    std::size_t column = joints;
    for (Config* values : {&row.row.q, &row.v, &row.a})
      for (double& value : *values) value = number(place, fields, column++);
    rows_.push_back(row);
    places_.push_back({place.row, place.line});
    placed_.push_back(placed);
    process_.push_back(process_field(place, fields.back()));
    part_.push_back(part_now_);
  }

  JobMotionFile finish() {
    if (order_.empty()) bad_input(file_, "has no row of a stroke", "rows of the job's strokes");
    if (job_.home && !last_stroke_.empty())
      bad_input(file_, "ends with stroke '" + last_stroke_ + "', though the job has a home",
                "rows of the way home behind it");
    if (!job_.home && last_stroke_.empty())
      bad_input(file_, "ends with a transition, though the job has no home", "a stroke at the end");
    require_places();
    JobMotionFile read;
    JobMotion& motion = read.motion;
    find_events(motion.events);
    const double last = rows_.back().t, count = static_cast<double>(rows_.size() - 1);
    motion.rate = count / last;
    if (std::abs(std::round(motion.rate) - motion.rate) < 1e-9 * motion.rate)
      motion.rate = std::round(motion.rate);
    motion.duration = last;
    motion.roll = may_lack_last(joint_names_);
    motion.rows = std::move(rows_);
    motion.part = std::move(part_);
    read.strokes = std::move(order_);
    return read;
  }

 private:
  struct Line {
    std::size_t row = 0;
    int line = 0;
  };
  [[nodiscard]] std::string where(std::size_t k) const {
    return CsvPlace{file_, places_[k].row, places_[k].line}.where();
  }
  [[nodiscard]] double number(const CsvPlace& place, const std::vector<std::string>& fields,
                              std::size_t column) const {
    return number_field(place, columns_[column], fields[column]);
  }

  void begin_part(const CsvPlace& place, const std::string& stroke) {
    const std::string at = place.where() + ": stroke";
    if (stroke.empty()) {
      if (rows_.empty() && !job_.home)
        bad_input(at, "is empty, though the job has no home", "the name of the first stroke");
      part_now_ = rows_.empty() ? 0 : part_now_ + 1;
    } else {
      const auto known = strokes_.find(stroke);
      if (known == strokes_.end())
        bad_input(at, "'" + stroke + "' is no stroke of the job", "the names of its strokes");
      if (std::find(order_.begin(), order_.end(), known->second) != order_.end())
        bad_input(at, "'" + stroke + "' comes twice", "the rows of a stroke together");
      if (rows_.empty() && job_.home)
        bad_input(at, "is '" + stroke + "' in the first row, though the job has a home",
                  "an empty one: rows of the way from home");
      if (!rows_.empty() && !last_stroke_.empty())
        bad_input(at, "'" + stroke + "' follows '" + last_stroke_ + "' at once",
                  "rows of a transition between them");
      order_.push_back(known->second);
      part_now_ = rows_.empty() ? 0 : part_now_ + 1;
    }
    last_stroke_ = stroke;
  }

  [[nodiscard]] bool of_stroke(std::size_t k) const {
    return (part_[k] % 2 == 1) == job_.home.has_value();
  }
  /// Throws InputError unless the rows of transitions at which strokes begin, and they alone, have
  /// places on these.
  void require_places() const {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (of_stroke(k)) continue;
      const bool begins = k + 1 < rows_.size() && of_stroke(k + 1);
      if (begins && !placed_[k])
        bad_input(where(k) + ": s", "is empty where a stroke begins",
                  "s, phi and branch at which it begins");
      if (!begins && placed_[k])
        bad_input(where(k) + ": s", "is given in a transition, whose stroke is empty",
                  "empty fields s, phi and branch, or the name of a stroke");
      if (!begins && process_[k])
        bad_input(where(k) + ": process", "is 1 in a transition", "0, or the name of a stroke");
    }
  }

  /// Finds the events of each run: a run's rows begin with the one before its first, where there
  /// is one. Throws InputError unless its process is 1 in one stretch that ends before its last.
  void find_events(std::vector<ProcessEvent>& events) const {
    std::size_t run = 0;
    for (std::size_t first = 0; first < rows_.size();) {
      std::size_t end = first + 1;
      while (end < rows_.size() && part_[end] == part_[first]) ++end;
      if (of_stroke(first)) add_events(order_[run++], first > 0 ? first - 1 : 0, end, events);
      first = end;
    }
  }
  void add_events(std::size_t stroke, std::size_t first, std::size_t end,
                  std::vector<ProcessEvent>& events) const {
    const std::string name = "stroke '" + job_.strokes[stroke].name + "'";
    std::size_t on = first;
    while (on < end && !process_[on]) ++on;
    if (on == end)
      bad_input(where(end - 1) + ": process", "is 1 in no row of " + name,
                "1 from the first row on the stroke itself to the one before its end");
    std::size_t off = on;
    while (off < end && process_[off]) ++off;
    if (off == end)
      bad_input(where(end - 1) + ": process", "is 1 in the last row of " + name,
                "0 from the stroke's end on");
    for (std::size_t k = off; k < end; ++k)
      if (process_[k])
        bad_input(where(k) + ": process", "is 1 again in " + name + ", after rows with 0",
                  "one stretch of rows with 1 in a stroke");
    events.push_back({rows_[on].t, stroke, rows_[on].row.s, true});
    events.push_back({rows_[off].t, stroke, rows_[off].row.s, false});
  }

  const std::string& file_;
  const Job& job_;
  const JointNames& joint_names_;
  std::map<std::string, std::size_t> strokes_;  // by name
  std::vector<std::string> columns_;
  bool rolls_ = false;
  std::vector<TimedRow> rows_;
  std::vector<Line> places_;
  std::vector<bool> placed_, process_;
  std::vector<std::size_t> part_, order_;
  std::size_t part_now_ = 0;
  std::string last_stroke_;
};

}  // namespace

JobMotionFile read_job_motion(const std::string& file, std::string_view text, const Job& job,
                              const JointNames& joint_names) {
  JobMotionRows rows(file, job, joint_names);
  read_csv_rows(file, text,
                {"the header of a job's motion",
                 [&](const std::vector<std::string>& columns, const std::string& where) {
                   rows.header(columns, where);
                 }},
                [&](const CsvPlace& place, const std::vector<std::string>& fields) {
                  rows.add(place, fields);
                });
  return rows.finish();
}

JobMotionFile load_job_motion(const std::filesystem::path& csv, const Job& job,
                              const JointNames& joint_names) {
  return read_job_motion(csv.string(), read_file(csv, "motion file", kMostTableBytes), job,
                         joint_names);
}

namespace {

/// Reads the text of a file by its first column.
std::variant<JobTrajectory, JobMotionFile> read_job_rows(const std::string& file,
                                                         std::string_view text, const Job& job,
                                                         const JointNames& joint_names) {
  std::string_view first = text;
  if (first.starts_with("\xef\xbb\xbf")) first.remove_prefix(3);
  first.remove_prefix(std::min(first.size(), first.find_first_not_of(" \t\r\n")));
  first = first.substr(0, first.find('\n'));
  const std::vector<std::string> fields = csv_fields(first, 1);
  if (!fields.empty() && fields.front() == "t")
    return read_job_motion(file, text, job, joint_names);
  return read_job_trajectory(file, text, joint_names);
}

/// Reads where the tool lifts off from the rows of a file.
class LiftOffRows {
 public:
  explicit LiftOffRows(const Job& job) : job_(job) {}

  void header(const std::vector<std::string>& columns) {
    const auto s = std::find(columns.begin(), columns.end(), "s");
    s_ = static_cast<std::size_t>(s - columns.begin());
    known_ = s != columns.end() && columns.size() > 2;
  }
  void add(const CsvPlace& place, const std::vector<std::string>& fields) {
    if (!known_) return;
    const std::string& name = fields[fields.size() - 2];
    const std::optional<double> s =
        fields[s_].empty() ? std::nullopt : std::optional(number_field(place, "s", fields[s_]));
    const std::size_t slash = name.rfind('/');
    if (slash != std::string::npos && s) {
      // a run of a motion begins with the last row of the transition before it
      if (name != name_) begin(place, name, slash, name_.empty() && before_ ? *before_ : *s);
      end_ = *s;
    }
    name_ = name;
    before_ = s;
  }
  [[nodiscard]] std::vector<LiftOff> lift_offs() const { return lift_offs_; }

 private:
  void begin(const CsvPlace& place, const std::string& name, std::size_t slash, double s) {
    const auto stroke = find_stroke(job_, name.substr(0, slash));
    if (!stroke) return;  // refused by who reads the rows
    const std::size_t number = stroke == stroke_ ? number_ + 1 : 1;
    if (name.substr(slash + 1) != std::to_string(number))
      bad_input(place.where() + ": stroke", "is '" + name + "'",
                "'" + name.substr(0, slash + 1) + std::to_string(number) +
                    "': runs of a stroke in their order");
    if (number > 1) {
      const Stroke& of = job_.strokes[*stroke];
      const double end = end_ - of.approach.norm() - of.retract.norm(),
                   most = std::max(0.0, end - job_.lift->overlap);
      if (s > most + kSamePlace)
        bad_input(
            place.where() + ": s",
            formatted("is %.9g where the run begins, and the one before it ends at %.9g", s, end),
            formatted("at most %.9g, so that nothing of the stroke is left out and runs "
                      "overlap as lift.overlap says",
                      most));
      lift_offs_.push_back({*stroke, end, s});
    }
    stroke_ = stroke;
    number_ = number;
  }

  static constexpr double kSamePlace = 1e-9;  // m
  const Job& job_;
  bool known_ = false;
  std::size_t s_ = 0, number_ = 0;
  std::optional<std::size_t> stroke_;
  std::string name_;
  std::optional<double> before_;
  double end_ = 0;
  std::vector<LiftOff> lift_offs_;
};

/// Returns the job whose strokes the rows of a file are: with its lift-offs, where it has any.
Job job_of_rows(const std::string& file, std::string_view text, const Job& job) {
  if (!job.lift) return job;
  LiftOffRows rows(job);
  read_csv_rows(file, text,
                {"the header of a job's rows", [&](const std::vector<std::string>& columns,
                                                   const std::string&) { rows.header(columns); }},
                [&](const CsvPlace& place, const std::vector<std::string>& fields) {
                  rows.add(place, fields);
                });
  try {
    return with_lift_offs(job, rows.lift_offs());
  } catch (const InvalidArgument& error) {
    throw InputError(file, error.what());
  }
}

/// Lets s of rows begin at 0 in each run, as it does in the problem of the run.
void begin_at_runs(JobTrajectory& read, const Job& job) {
  for (JobTrajectoryPart& part : read.parts)
    if (const auto stroke = find_stroke(job, part.stroke))
      for (TrajectoryRow& row : part.rows) row.s -= s_of_piece(job.strokes[*stroke]);
}
void begin_at_runs(JobMotionFile& read, const Job& job) {
  JobMotion& motion = read.motion;
  const auto begin_of = [&](std::size_t part) -> double {
    if ((part % 2 == 1) != job.home.has_value()) return 0;
    return s_of_piece(job.strokes[read.strokes.at(part / 2)]);
  };
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    const bool begins = k + 1 < motion.rows.size() && motion.part[k + 1] != motion.part[k];
    const double own = begin_of(motion.part[k]);
    motion.rows[k].row.s -= own != 0 || !begins ? own : begin_of(motion.part[k + 1]);
  }
  for (ProcessEvent& event : motion.events) event.s -= s_of_piece(job.strokes[event.stroke]);
}

}  // namespace

ExecutedJobRows load_executed_rows(const std::filesystem::path& csv, const Job& job,
                                   const JointNames& joint_names) {
  const std::string text = read_file(csv, "trajectory file", kMostTableBytes);
  ExecutedJobRows read{job_of_rows(csv.string(), text, job), {}};
  read.rows = read_job_rows(csv.string(), text, read.job, joint_names);
  std::visit([&](auto& rows) { begin_at_runs(rows, read.job); }, read.rows);
  return read;
}

std::variant<JobTrajectory, JobMotionFile> load_job_rows(const std::filesystem::path& csv,
                                                         const Job& job,
                                                         const JointNames& joint_names) {
  return load_executed_rows(csv, job, joint_names).rows;
}

}  // namespace swivel::io
