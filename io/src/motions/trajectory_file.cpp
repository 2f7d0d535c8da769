// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "motions/joint_rows.hpp"
#include "motions/trajectory_formats.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

namespace {

using Place = std::optional<std::size_t>;

/// The columns of a table that hold the values of an arm's row.
struct ArmPlaces {
  Place s, phi, roll, branch;
  std::array<Place, kDof> q, v, a;
};

/// The columns of a table.
struct Columns {
  Place t, stroke, process;
  std::vector<ArmPlaces> arms;
};

/// A name that a column may have, and where its number is kept.
struct Known {
  std::string name;
  Place* place;
  bool listed = true;  ///< whether messages name it among what is allowed
};

/// Finds the columns of a table.
class Header {
 public:
  Header(const std::vector<std::string>& names, const Sought& sought, const std::string& where)
      : names_(names), sought_(sought), where_(where) {}

  /// Returns the columns. Names are tried in the order in which Swivel writes them, so that a joint
  /// may have the name of another column. Throws InputError.
  Columns columns() {
    columns_.arms.resize(sought_.arms.size());
    list_known();
    refuse_rows_of_jobs();
    for (std::size_t k = 0; k < names_.size(); ++k) take(k);
    for (std::size_t arm = 0; arm < sought_.arms.size(); ++arm) require_joints(arm);
    if (sought_.job)
      for (const auto& [place, name] :
           {std::pair(&columns_.stroke, "stroke"), std::pair(&columns_.process, "process")})
        if (!*place)
          bad(std::string("column '") + name +
              "' is missing, which tells the parts of a job's trajectory");
    return std::move(columns_);
  }

 private:
  [[noreturn]] void bad(const std::string& what) const {
    std::string names;
    for (const Known& known : known_)
      if (known.listed) names += (names.empty() ? "" : ", ") + csv_field(known.name);
    bad_input(where_, what, names + ", and joints with _v and _a, each once");
  }

  void list_known() {
    known_.push_back({"t", &columns_.t});
    for (const char* const what : {"s", "phi", "roll", "branch"})
      for (std::size_t arm = 0; arm < sought_.arms.size(); ++arm) {
        const ArmColumns& of = sought_.arms[arm];
        ArmPlaces& places = columns_.arms[arm];
        const std::string name = what;
        // The roll is a joint of an arm of six, and is not chosen where two arms work together.
        if (name == "roll" && (may_lack_last(of.joints) || sought_.arms.size() > 1)) continue;
        known_.push_back({name + of.suffix, name == "s"      ? &places.s
                                            : name == "phi"  ? &places.phi
                                            : name == "roll" ? &places.roll
                                                             : &places.branch});
      }
    for (const auto& [ending, places] :
         {std::pair("", &ArmPlaces::q), std::pair("_v", &ArmPlaces::v),
          std::pair("_a", &ArmPlaces::a)})
      for (std::size_t arm = 0; arm < sought_.arms.size(); ++arm)
        for (std::size_t j = 0; j < named_joints(sought_.arms[arm].joints); ++j) {
          Place* const place = &(columns_.arms[arm].*places)[j];
          known_.push_back({sought_.arms[arm].name(j) + ending, place, *ending == '\0'});
          // Earlier versions gave the rolls of two arms one name.
          if (sought_.arms[arm].name(j) != sought_.arms[arm].joints[j])
            known_.push_back({sought_.arms[arm].joints[j] + ending, place, false});
        }
    if (!sought_.job) return;
    known_.push_back({"stroke", &columns_.stroke});
    known_.push_back({"process", &columns_.process});
  }

  void refuse_rows_of_jobs() const {
    const auto is_there = [&](const char* name) {
      return std::find(names_.begin(), names_.end(), name) != names_.end() &&
             std::none_of(known_.begin(), known_.end(),
                          [&](const Known& known) { return known.name == name; });
    };
    if (!sought_.job && is_there("stroke") && is_there("process"))
      bad_input(where_, "columns 'stroke' and 'process' are those of a job's rows",
                sought_.arms.size() == 1
                    ? "the rows of one path; those of a job are read with the job's problem file"
                    : "the rows of two arms");
  }

  void take(std::size_t column) {
    bool there = false;
    for (const Known& known : known_) {
      if (known.name != names_[column]) continue;
      there = true;
      if (*known.place) continue;
      *known.place = column;
      return;
    }
    bad("column '" + names_[column] + "' " +
        (there                      ? "is there twice"
         : sought_.arms.size() == 1 ? "is unknown, or no joint of the arm"
                                    : "is unknown, or no joint of the two arms"));
  }

  /// Throws InputError unless all joints of an arm are there, and their rates where one is.
  void require_joints(std::size_t arm) const {
    const ArmColumns& of = sought_.arms[arm];
    const ArmPlaces& places = columns_.arms[arm];
    const std::size_t count = may_lack_last(of.joints) && !places.q.back() ? kDof - 1 : kDof;
    const auto require_all = [&](const std::array<Place, kDof>& found, const char* ending) {
      for (std::size_t j = 0; j < kDof; ++j)
        if (found[j].has_value() != (j < count))
          bad("column '" + of.name(j) + ending + "' is " +
              (found[j] ? "there, but not its joint" : "missing"));
    };
    require_all(places.q, "");
    for (const auto& [ending, found] :
         {std::pair("_v", &ArmPlaces::v), std::pair("_a", &ArmPlaces::a)}) {
      const auto there = [](const Place& place) { return place.has_value(); };
      if (std::none_of(columns_.arms.begin(), columns_.arms.end(), [&](const ArmPlaces& one) {
            return std::any_of((one.*found).begin(), (one.*found).end(), there);
          }))
        continue;
      if (!columns_.t) bad(std::string("joints have ") + ending + ", but column 't' is missing");
      require_all(places.*found, ending);
    }
  }

  const std::vector<std::string>& names_;
  const Sought& sought_;
  const std::string& where_;
  Columns columns_;
  std::vector<Known> known_;
};

/// Reads the rows of a table.
class TableRows {
 public:
  TableRows(const std::string& file, const Sought& sought) : sought_(sought) {
    read_.file = file;
    read_.arms.resize(sought.arms.size());
  }

  void header(const std::vector<std::string>& names, const std::string& where) {
    names_ = names;
    columns_ = Header(names, sought_, where).columns();
    for (std::size_t arm = 0; arm < sought_.arms.size(); ++arm) {
      const ArmPlaces& places = columns_.arms[arm];
      Stated& stated = read_.arms[arm].stated;
      stated.s = places.s.has_value();
      stated.phi = places.phi.has_value();
      stated.branch = places.branch.has_value();
      // Swivel leaves the column out where all are 0
      stated.roll = places.roll || (stated.s && stated.phi && stated.branch);
      stated.last_joint =
          places.q.back().has_value() || named_joints(sought_.arms[arm].joints) < kDof;
      stated.v = places.v.front().has_value();
      stated.a = places.a.front().has_value();
    }
  }

  void add(const CsvPlace& place, const std::vector<std::string>& fields) {
    read_.lines.push_back(place.line);
    const bool placed = !sought_.job || add_row_of_job(place, fields);
    for (std::size_t arm = 0; arm < sought_.arms.size(); ++arm) {
      const ArmPlaces& places = columns_.arms[arm];
      TrajectoryFile& of = read_.arms[arm];
      TimedRow timed;
      TrajectoryRow& row = timed.row;
      if (columns_.t) timed.t = number(place, fields, *columns_.t);
      const auto take = [&](const Place& column) {
        return column ? number(place, fields, *column) : 0.0;
      };
      if (placed) {
        row.s = take(places.s);
        row.phi = take(places.phi);
        row.roll = take(places.roll);
        row.branch = branch(place, fields, places.branch);
      }
      for (std::size_t j = 0; j < kDof; ++j) {
        const auto joint = static_cast<Eigen::Index>(j);
        row.q[joint] = take(places.q[j]);
        timed.v[joint] = take(places.v[j]);
        timed.a[joint] = take(places.a[j]);
      }
      of.rows.push_back(row);
      if (!columns_.t) continue;
      if (!of.timed.empty() && !(timed.t > of.timed.back().t))
        bad_input(place.where() + ": t", "is " + format_double(timed.t),
                  "times that ascend from row to row");
      of.timed.push_back(timed);
    }
  }

  FileRows finish() { return std::move(read_); }

 private:
  /// Adds what the row says of the job. Returns whether it has a place on a stroke: a row of a
  /// stroke must have one, others may.
  bool add_row_of_job(const CsvPlace& place, const std::vector<std::string>& fields) {
    RowOfJob& row = read_.job.emplace_back();
    row.stroke = fields[*columns_.stroke];
    const std::string& process = fields[*columns_.process];
    if (process != "0" && process != "1")
      bad_input(place.where() + ": process", "is '" + process + "'", "0 or 1");
    row.process = process == "1";
    const ArmPlaces& places = columns_.arms.front();
    for (const Place& column : {places.s, places.phi, places.roll, places.branch}) {
      if (!column || fields[*column].empty()) continue;
      row.placed = true;
      // In a motion it may be the row at which the next stroke begins.
      if (row.stroke.empty() && !columns_.t)
        bad_input(place.where() + ": " + names_[*column],
                  "is '" + fields[*column] + "' in a transition, whose stroke is empty",
                  "an empty field, or the name of a stroke");
    }
    return row.placed || !row.stroke.empty();
  }
  [[nodiscard]] double number(const CsvPlace& place, const std::vector<std::string>& fields,
                              std::size_t column) const {
    const auto value = to_number<double>(fields[column]);
    if (!value || !std::isfinite(*value))
      bad_input(place.where() + ": " + names_[column], "'" + fields[column] + "' is not a number",
                "a finite number");
    return *value;
  }
  [[nodiscard]] int branch(const CsvPlace& place, const std::vector<std::string>& fields,
                           const Place& column) const {
    if (!column) return 0;
    const double value = number(place, fields, *column);
    if (!(value >= 0 && value <= 7) || value != static_cast<int>(value))
      bad_input(place.where() + ": " + names_[*column], "is " + format_double(value),
                "a whole number from 0 to 7");
    return static_cast<int>(value);
  }

  const Sought& sought_;
  std::vector<std::string> names_;
  Columns columns_;
  FileRows read_;
};

FileRows read_table(const std::string& file, std::string_view text, const Sought& sought) {
  TableRows rows(file, sought);
  const std::string header = sought.arms.size() == 1
                                 ? "a header with the names of the arm's joints"
                                 : "a header with the names of both arms' joints";
  read_csv_rows(file, text,
                {sought.job ? header + ", stroke and process" : header,
                 [&](const std::vector<std::string>& names, const std::string& where) {
                   rows.header(names, where);
                 }},
                [&](const CsvPlace& place, const std::vector<std::string>& fields) {
                  rows.add(place, fields);
                });
  return rows.finish();
}

enum class Format { kCsv, kJson, kYaml, kMcap };

/// Returns the format of a file by its contents, docs/formats.md "Trajectories that are read".
Format format_of(std::string_view text) {
  if (text.starts_with("\x89MCAP")) return Format::kMcap;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#' || line.starts_with("---")) continue;
    if (line[first] == '{' || line[first] == '[') return Format::kJson;
    const auto end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", first);
    const bool is_key = end != std::string_view::npos && end > first && line[end] == ':' &&
                        (end + 1 == line.size() || line[end + 1] == ' ' || line[end + 1] == '\r');
    return is_key ? Format::kYaml : Format::kCsv;
  }
  return Format::kCsv;
}

}  // namespace

std::string FileRows::where(std::size_t row) const {
  if (!lines.empty()) return CsvPlace{file, row, lines.at(row)}.where();
  return file + ": row " + std::to_string(row) + " (counted from 0)";
}

FileRows read_rows(const std::filesystem::path& file, const Sought& sought) {
  return read_rows(file.string(), read_file(file, "trajectory file", kMostTableBytes), sought);
}

FileRows read_rows(const std::string& file, const std::string& text, const Sought& sought) {
  switch (format_of(text)) {
    case Format::kJson:
      return read_joint_trajectory_json(file, text, sought);
    case Format::kYaml:
      return read_joint_trajectory_yaml(file, text, sought);
    case Format::kMcap:
      return read_mcap(file, text, sought);
    case Format::kCsv:
      break;
  }
  return read_table(file, text, sought);
}

TrajectoryFile load_trajectory_file(const std::filesystem::path& path,
                                    const JointNames& joint_names) {
  return std::move(read_rows(path, {.arms = {{.joints = joint_names}}}).arms.front());
}

GivenArm given_arm(TrajectoryFile read) {
  const StrokeRun run{0, false};
  GivenArm arm{.stated = read.stated};
  if (read.timed.empty()) {
    arm.parts.push_back({.run = run, .rows = std::move(read.rows)});
    return arm;
  }
  arm.motion.emplace().rows = std::move(read.timed);
  arm.order = {run};
  return arm;
}

}  // namespace swivel::io
