// SPDX-License-Identifier: BSD-3-Clause
#include "workcells/workcell_csv.hpp"

#include <utility>

#include "files/csv.hpp"
#include "motions/given_rows.hpp"
#include "motions/messages.hpp"
#include "motions/trajectory_columns.hpp"
#include "motions/trajectory_formats.hpp"

namespace swivel::io {

namespace {

std::vector<std::string> workcell_motion_header(const std::vector<ArmColumns>& arms) {
  std::vector<std::string> columns = workcell_columns(arms);
  columns.insert(columns.begin(), "t");
  for (const char* const what : {"_v", "_a"})
    for (const ArmColumns& arm : arms)
      for (std::size_t j = 0; j < named_joints(arm.joints); ++j)
        columns.push_back(arm.name(j) + what);
  return columns;
}

std::string header_line(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& name : columns) text += (text.empty() ? "" : ",") + csv_field(name);
  return text + '\n';
}

/// Returns the number of joints of each arm that have a name.
std::array<std::size_t, 2> joints_of_arms(const std::array<JointNames, 2>& names) {
  return {named_joints(names[0]), named_joints(names[1])};
}

/// Returns a field for each of the first `joints` values by joint, each after a comma.
std::string joint_numbers(const Config& values, std::size_t joints) {
  std::string text;
  for (std::size_t j = 0; j < joints; ++j)
    text += ',' + csv_number(values[static_cast<Eigen::Index>(j)]);
  return text;
}

/// Returns the fields of both arms' rows at one moment.
std::string fields_of(const std::array<const TrajectoryRow*, 2>& rows,
                      const std::array<std::size_t, 2>& joints) {
  std::string text = csv_number(rows[0]->s) + ',' + csv_number(rows[1]->s);
  for (const TrajectoryRow* row : rows) text += ',' + csv_number(row->phi);
  for (const TrajectoryRow* row : rows) text += ',' + std::to_string(row->branch);
  for (std::size_t k = 0; k < 2; ++k) text += joint_numbers(rows[k]->q, joints[k]);
  return text;
}

std::string to_workcell_motion_csv(const Motion& motion,
                                   const std::array<JointNames, 2>& joint_names) {
  std::string text = header_line(workcell_motion_header(
      arms_of_workcell({motion.arms[0].name, motion.arms[1].name}, joint_names)));
  const auto joints = joints_of_arms(joint_names);
  const auto &first = motion.arms[0].rows, &second = motion.arms[1].rows;
  for (std::size_t k = 0; k < first.size(); ++k) {
    text += csv_number(first[k].t) + ',' + fields_of({&first[k].row, &second[k].row}, joints) +
            joint_numbers(first[k].v, joints[0]) + joint_numbers(second[k].v, joints[1]) +
            joint_numbers(first[k].a, joints[0]) + joint_numbers(second[k].a, joints[1]) + '\n';
  }
  return text;
}

}  // namespace

std::string two_arms_csv(const Answer& result) {
  std::string text = header_line(
      workcell_columns(arms_of_workcell(names_of_arms(result), joint_names_of_arms(result))));
  const auto joints = joints_of_arms(joint_names_of_arms(result));
  const auto &first = result.arms[0].rows(), &second = result.arms[1].rows();
  for (std::size_t k = 0; k < first.size(); ++k)
    text += fields_of({&first[k], &second[k]}, joints) + '\n';
  return text;
}

std::string workcell_motion_text(const Motion& motion, const std::array<JointNames, 2>& joint_names,
                                 const std::string& frame_id, const std::filesystem::path& file) {
  require_motion_format(file);
  const std::string format = file.extension().string();
  if (format == ".csv") return to_workcell_motion_csv(motion, joint_names);
  const auto &first = motion.arms[0], &second = motion.arms[1];
  const MotionMessages other{second.rows, second.roll, joint_names[1], frame_id};
  const MotionMessages both{first.rows, first.roll, joint_names[0], frame_id, nullptr, &other};
  if (format == ".json") return trajectory_json(both);
  if (format == ".yaml") return trajectory_yaml(both);
  return mcap_log(both);
}

GivenAnswer load_two_arms(const std::filesystem::path& file, const Problem& problem,
                          const std::array<JointNames, 2>& joint_names) {
  FileRows read = read_rows(
      file, {.arms = arms_of_workcell({problem.arms[0].name, problem.arms[1].name}, joint_names)});
  GivenAnswer given{problem, {}};
  for (TrajectoryFile& arm : read.arms) given.arms.push_back(given_arm(std::move(arm)));
  return given;
}

}  // namespace swivel::io
