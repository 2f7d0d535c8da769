// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "jobs/job_rows.hpp"
#include "motions/joint_rows.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"

namespace swivel::io {

namespace {

std::vector<std::string> header_of(const JointNames& joint_names, bool roll) {
  std::vector<std::string> header = csv_header(motion_schema(), joint_names, roll);
  header.insert(header.end(), {"stroke", "process"});
  return header;
}

/// Returns for each row of a motion whether the process is on from it to the next row.
std::vector<bool> process_of_motion(const ArmMotion& motion) {
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

std::string to_job_motion_csv(const ArmMotion& motion, const Problem& job,
                              const JointNames& joint_names) {
  const std::vector<std::optional<std::size_t>> strokes = strokes_of_parts(motion, job);
  require_samples_of_strokes(motion, job);
  const std::vector<bool> process = process_of_motion(motion);
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
  const std::size_t joints = named_joints(joint_names);
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    const TimedRow& row = motion.rows[k];
    text += format_double(row.t) + ',';
    TrajectoryRow place = row.row;
    if (placed(k))
      place.s += s_of_piece(job.arm().strokes[stroke(k) ? *stroke(k) : *stroke(k + 1)]);
    text +=
        placed(k) ? trajectory_fields(place, roll, joints) : placeless_fields(place, roll, joints);
    text += joint_fields(row.v, joints) + joint_fields(row.a, joints);
    text += ',' + (stroke(k) ? csv_line_field(job.arm().strokes[*stroke(k)].name) : "");
    text += process[k] ? ",1\n" : ",0\n";
  }
  return text;
}

namespace {

/// Makes a motion of the rows of a job.
class JobMotionRows {
 public:
  JobMotionRows(const FileRows& read, const Problem& job, const JointNames& joint_names)
      : file_(read),
        of_job_(read.job),
        rows_(read.arms.front().timed),
        job_(job),
        roll_(may_lack_last(joint_names)) {
    for (std::size_t k = 0; k < job.arm().strokes.size(); ++k)
      strokes_.emplace(csv_line_field(job.arm().strokes[k].name), k);
  }

  GivenArm motion() {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (k == 0 || of_job_[k].stroke != of_job_[k - 1].stroke) begin_part(k);
      part_.push_back(part_now_);
    }
    const std::string& last_stroke = of_job_.back().stroke;
    if (order_.empty())
      bad_input(file_.file, "has no row of a stroke", "rows of the job's strokes");
    if (job_.arm().home && !last_stroke.empty())
      bad_input(file_.file, "ends with stroke '" + last_stroke + "', though the job has a home",
                "rows of the way home behind it");
    if (!job_.arm().home && last_stroke.empty())
      bad_input(file_.file, "ends with a transition, though the job has no home",
                "a stroke at the end");
    GivenArm arm;
    arm.stated = file_.arms.front().stated;
    require_places(states_places(arm.stated));
    ArmMotion& motion = arm.motion.emplace();
    find_events(motion.events);
    motion.duration = rows_.back().t - rows_.front().t;
    motion.rate = static_cast<double>(rows_.size() - 1) / motion.duration;
    if (std::abs(std::round(motion.rate) - motion.rate) < 1e-9 * motion.rate)
      motion.rate = std::round(motion.rate);
    motion.roll = roll_;
    motion.rows = rows_;
    motion.part = std::move(part_);
    for (const std::size_t stroke : order_) arm.order.push_back({stroke, false});
    return arm;
  }

 private:
  /// Returns whether a table has columns that say where a row is on its stroke.
  [[nodiscard]] bool states_places(const Stated& stated) const {
    return !file_.lines.empty() && (stated.s || stated.phi || stated.branch || stated.roll);
  }

  void begin_part(std::size_t k) {
    const std::string at = file_.where(k) + ": stroke", &stroke = of_job_[k].stroke;
    if (stroke.empty()) {
      if (k == 0 && !job_.arm().home)
        bad_input(at, "is empty, though the job has no home", "the name of the first stroke");
    } else {
      const auto known = strokes_.find(stroke);
      if (known == strokes_.end())
        bad_input(at, "'" + stroke + "' is no stroke of the job", "the names of its strokes");
      if (std::find(order_.begin(), order_.end(), known->second) != order_.end())
        bad_input(at, "'" + stroke + "' comes twice", "the rows of a stroke together");
      if (k == 0 && job_.arm().home)
        bad_input(at, "is '" + stroke + "' in the first row, though the job has a home",
                  "an empty one: rows of the way from home");
      if (k > 0 && !of_job_[k - 1].stroke.empty())
        bad_input(at, "'" + stroke + "' follows '" + of_job_[k - 1].stroke + "' at once",
                  "rows of a transition between them");
      order_.push_back(known->second);
    }
    part_now_ = k == 0 ? 0 : part_now_ + 1;
  }

  [[nodiscard]] bool of_stroke(std::size_t k) const { return !of_job_[k].stroke.empty(); }
  /// Throws InputError unless the rows of transitions at which strokes begin, and they alone, have
  /// places on these, where the file states places.
  void require_places(bool stated) const {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (of_stroke(k)) continue;
      const bool begins = k + 1 < rows_.size() && of_stroke(k + 1);
      if (stated && begins && !of_job_[k].placed)
        bad_input(file_.where(k) + ": s", "is empty where a stroke begins",
                  "s, phi and branch at which it begins");
      if (stated && !begins && of_job_[k].placed)
        bad_input(file_.where(k) + ": s", "is given in a transition, whose stroke is empty",
                  "empty fields s, phi and branch, or the name of a stroke");
      if (!begins && of_job_[k].process)
        bad_input(file_.where(k) + ": process", "is 1 in a transition",
                  "0, or the name of a stroke");
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
    const std::string name = "stroke '" + job_.arm().strokes[stroke].name + "'";
    const auto process = [&](std::size_t k) { return of_job_[k].process; };
    std::size_t on = first;
    while (on < end && !process(on)) ++on;
    if (on == end)
      bad_input(file_.where(end - 1) + ": process", "is 1 in no row of " + name,
                "1 from the first row on the stroke itself to the one before its end");
    std::size_t off = on;
    while (off < end && process(off)) ++off;
    if (off == end)
      bad_input(file_.where(end - 1) + ": process", "is 1 in the last row of " + name,
                "0 from the stroke's end on");
    for (std::size_t k = off; k < end; ++k)
      if (process(k))
        bad_input(file_.where(k) + ": process", "is 1 again in " + name + ", after rows with 0",
                  "one stretch of rows with 1 in a stroke");
    const bool known = file_.lines.empty() || file_.arms.front().stated.s;
    for (const std::size_t k : {on, off})
      events.push_back({rows_[k].t, stroke, known ? rows_[k].row.s : std::nan(""), k == on});
  }

  const FileRows& file_;
  const std::vector<RowOfJob>& of_job_;
  const std::vector<TimedRow>& rows_;
  const Problem& job_;
  bool roll_;
  std::map<std::string, std::size_t> strokes_;  // by name
  std::vector<std::size_t> part_, order_;
  std::size_t part_now_ = 0;
};

}  // namespace

GivenArm motion_of(const FileRows& read, const Problem& job, const JointNames& joint_names) {
  return JobMotionRows(read, job, joint_names).motion();
}

}  // namespace swivel::io
