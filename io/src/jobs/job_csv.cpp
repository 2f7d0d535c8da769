// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "jobs/job_rows.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::io {

const Schema& job_trajectory_schema() {
  static const Schema schema = [] {
    std::vector<Schema::Key> keys = trajectory_schema().keys;
    for (Schema::Key& key : keys) key.group = "trajectory";
    keys.push_back({"stroke", text(), "", required(), "name of the stroke; empty in transitions"});
    keys.push_back({"process", integer(), "", required(),
                    "1 on the stroke itself, 0 on the lines of approach and retract and in "
                    "transitions"});
    return section("job_trajectory", std::move(keys));
  }();
  return schema;
}

bool any_rolls(const ArmAnswer& arm) {
  const auto any = [](const std::vector<Part>& parts) {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part& part) { return part.run && swivel::any_rolls(part.rows); });
  };
  return any(arm.parts) || any(arm.partial);
}

std::string placeless_fields(const TrajectoryRow& row, bool roll, std::size_t joints) {
  return (roll ? ",,," : ",,") + joint_fields(row.q, joints);
}

namespace {

std::vector<std::string> job_header(const JointNames& joint_names, bool roll) {
  return csv_header(job_trajectory_schema(), joint_names, roll);
}

}  // namespace

std::string strokes_csv(const ArmAnswer& arm, const Problem& job) {
  std::string text;
  const bool roll = any_rolls(arm);
  for (const std::string& name : job_header(arm.joint_names, roll))
    text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  const std::size_t joints = named_joints(arm.joint_names);
  for (const Part& part : arm.parts) {
    const std::string stroke =
        part.run ? csv_line_field(job.arm().strokes[part.run->stroke].name) : "";
    const std::vector<bool> process = process_of_rows(part, job);
    for (std::size_t k = 0; k < part.rows.size(); ++k) {
      TrajectoryRow row = part.rows[k];
      if (part.run) row.s += s_of_piece(job.arm().strokes[part.run->stroke]);
      text += part.run ? trajectory_fields(row, roll, joints) : placeless_fields(row, roll, joints);
      text += ',' + stroke + (process[k] ? ",1\n" : ",0\n");
    }
  }
  return text;
}

namespace {

/// Divides rows of strokes without times into their parts.
class StrokeRows {
 public:
  StrokeRows(const FileRows& read, const Problem& problem) : file_(read), problem_(problem) {}

  GivenArm parts() {
    arm_.stated = file_.arms.front().stated;
    for (std::size_t k = 0; k < file_.job.size(); ++k) add(k);
    end_part(file_.file);
    return std::move(arm_);
  }

 private:
  void add(std::size_t k) {
    const RowOfJob& of = file_.job[k];
    if (k == 0 || file_.job[k - 1].stroke != of.stroke) begin_part(k);
    std::vector<bool>& process = arm_.process.back();
    if (of.process && of.stroke.empty())
      bad_input(file_.where(k) + ": process", "is 1 in a transition", "0, or the name of a stroke");
    if (of.process && processed_ > 0 && !process.back())
      bad_input(file_.where(k) + ": process",
                "is 1 again in stroke '" + of.stroke + "', after rows with 0",
                "one stretch of rows with 1 in a stroke");
    if (of.process) ++processed_;
    process.push_back(of.process);
    arm_.parts.back().rows.push_back(file_.arms.front().rows[k]);
  }

  void begin_part(std::size_t k) {
    if (k > 0) end_part(file_.where(k));
    const std::string& name = file_.job[k].stroke;
    if (!name.empty() && !known_.insert(name).second)
      bad_input(file_.where(k) + ": stroke", "'" + name + "' comes twice",
                "the rows of a stroke together");
    arm_.parts.emplace_back();
    arm_.process.emplace_back();
    processed_ = 0;
    name_ = name;
    if (name.empty()) return;
    const auto stroke = find_stroke(problem_, name);
    if (!stroke)
      bad_input(file_.where(k) + ": stroke", "'" + name + "' is no stroke of the job",
                "the names of its strokes");
    arm_.parts.back().run = StrokeRun{*stroke, false};
  }

  /// Throws InputError, prefixed by `where`, if the last part cannot end there.
  void end_part(const std::string& where) const {
    const std::string name = name_.empty() ? "the transition" : "stroke '" + name_ + "'";
    if (arm_.parts.back().rows.size() < 2)
      bad_input(where, name + " before it has one row", "at least two rows in each part");
    if (!name_.empty() && processed_ < 2)
      bad_input(where, name + " before it has fewer than two rows whose process is 1",
                "two or more: those on the stroke itself");
  }

  const FileRows& file_;
  const Problem& problem_;
  GivenArm arm_;
  std::set<std::string> known_;  // strokes that have come
  std::string name_;             // of the stroke of the last part
  std::size_t processed_ = 0;    // rows of the last part whose process is 1
};

}  // namespace

GivenArm parts_of(const FileRows& read, const Problem& problem) {
  return StrokeRows(read, problem).parts();
}

}  // namespace swivel::io
