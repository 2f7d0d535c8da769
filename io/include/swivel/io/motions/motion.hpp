// SPDX-License-Identifier: BSD-3-Clause
// Motions in time, out and in. docs/formats.md "Motion".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/motion/timed_path.hpp"

namespace swivel::io {

using JointNames = std::array<std::string, kDof>;

/// Header t,s,phi,branch, joints, joints with _v (rad/s), joints with _a (rad/s^2); 17 significant digits.
[[nodiscard]] std::string to_timed_csv(const TimedPath& motion, const JointNames& joint_names);
/// ROS 2's trajectory_msgs/msg/JointTrajectory, of the joints alone: without the roll of the tool. frame_id: the arm's base link.
[[nodiscard]] std::string to_trajectory_json(const TimedPath& motion, const JointNames& joint_names, const std::string& frame_id);
[[nodiscard]] std::string to_trajectory_yaml(const TimedPath& motion, const JointNames& joint_names, const std::string& frame_id);
/// A log of ROS 2's sensor_msgs/msg/JointState on the topic /joint_states, log time = t: MCAP, profile ros2, CDR, one uncompressed
/// chunk, with index and summary, without the roll of the tool. https://mcap.dev/spec
[[nodiscard]] std::string to_mcap(const TimedPath& motion, const JointNames& joint_names, const std::string& frame_id);

/// The motion in the format that the file name's ending names: .csv, .json, .yaml or .mcap. Throws InputError for another.
[[nodiscard]] std::string motion_text(const TimedPath& motion, const JointNames& joint_names, const std::string& frame_id,
                                      const std::filesystem::path& file);
void require_motion_format(const std::filesystem::path& file);

/// A trajectory as a file has it. What is not stated is 0.
struct TrajectoryFile {
  std::vector<TrajectoryRow> rows;
  std::vector<TimedRow> timed;  ///< the same rows where the file has times, else empty
  Stated stated;
};
/// What it reads, in a line for the help of commands.
inline constexpr const char* kTrajectoryFile =
    "any trajectory or motion of the arm: CSV with columns by name (the joints are enough; t, s, phi, roll, branch, and joints "
    "with "
    "_v and _a may be there), JSON or YAML (JointTrajectory), MCAP (JointState); the contents tell which";
/// Any trajectory of the arm, docs/formats.md "Trajectories that are read": all that Swivel writes, and CSV files, JointTrajectory
/// messages and JointState logs of other programs. The file's contents tell the format. Every joint must be there and no other;
/// times must ascend.
[[nodiscard]] TrajectoryFile load_trajectory_file(const std::filesystem::path& file, const JointNames& joint_names);

}  // namespace swivel::io
