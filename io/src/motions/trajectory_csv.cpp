// SPDX-License-Identifier: BSD-3-Clause
#include <span>

#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"
#include "swivel/io/motions/trajectory.hpp"

namespace swivel::io {

const Schema& trajectory_schema() {
  static const Schema schema = section(
      "trajectory", {
                        {"s", number(), "m", required(),
                         "along the path; equal in rows of a segment that only turns"},
                        {"phi", number(), "rad", required(),
                         "carried arm angle; `check` takes it modulo 2π. Of arms that are not "
                         "S-R-S a generalised arm angle, for plots, "
                         "which `check` "
                         "does not look at; with `path.roll` the roll, which it does"},
                        {"roll", number(), "rad", in_words("no such column: 0"),
                         "of seven joints with `path.roll`: by how much the tool stands turned "
                         "about its own z axis"},
                        {"branch", integer(), "", required(),
                         "0 to 7, the sum of 1 (shoulder), 2 (wrist), 4 (elbow), each where the "
                         "sine of that angle, measured from its "
                         "singular pose, "
                         "is negative; `check` proves it. Of arms that are not S-R-S 0 to 3, [for "
                         "plots](#branch), which `check` does "
                         "not look at"},
                        {"JOINT", number(), "rad or m", required(),
                         "a column for each joint, with its name; continuous joints without jumps"},
                    });
  return schema;
}

std::vector<std::string> csv_header(const Schema& row,
                                    const std::array<std::string, kDof>& joint_names, bool roll) {
  constexpr std::string_view kJoint = "JOINT";
  std::vector<std::string> header;
  for (const std::string& name : row.key_names()) {
    if (name == "roll" && !roll) continue;
    if (!name.starts_with(kJoint)) {
      header.push_back(name);
      continue;
    }
    for (const std::string& joint : std::span(joint_names).first(named_joints(joint_names)))
      header.push_back(joint + name.substr(kJoint.size()));
  }
  return header;
}

std::string joint_fields(const Config& values, std::size_t joints) {
  std::string text;
  for (std::size_t j = 0; j < joints; ++j)
    text += ',' + format_double(values[static_cast<Eigen::Index>(j)]);
  return text;
}

std::string trajectory_fields(const TrajectoryRow& row, bool roll, std::size_t joints) {
  std::string text = format_double(row.s) + ',' + format_double(row.phi) + ',';
  if (roll) text += format_double(row.roll) + ',';
  return text + std::to_string(row.branch) + joint_fields(row.q, joints);
}

namespace {

std::string path_csv(const std::vector<TrajectoryRow>& rows,
                     const std::array<std::string, kDof>& joint_names) {
  std::string text;
  const bool roll = any_rolls(rows);
  const std::size_t joints = named_joints(joint_names);
  for (const std::string& name : csv_header(trajectory_schema(), joint_names, roll))
    text.append(text.empty() ? "" : ",").append(csv_field(name));
  text += '\n';
  for (const TrajectoryRow& row : rows) text += trajectory_fields(row, roll, joints) + '\n';
  return text;
}

}  // namespace

std::string to_csv(const Answer& answer, const Problem& problem) {
  if (answer.arms.size() == 2) return two_arms_csv(answer);
  if (!is_path(problem)) return strokes_csv(answer.arm(), problem);
  return path_csv(answer.arm().rows(), answer.arm().joint_names);
}

std::string to_csv(const PlanResult& result) {
  return path_csv(result.trajectory, result.joint_names);
}

void write_trajectory(const std::filesystem::path& csv, const PlanResult& result) {
  write_file(csv, to_csv(result));
}

}  // namespace swivel::io
