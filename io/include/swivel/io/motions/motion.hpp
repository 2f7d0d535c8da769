// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes timed motions. docs/formats.md "Motion".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/answer/timed_path.hpp"

namespace swivel::io {

using swivel::JointNames;

/// Returns a timed motion as CSV: the columns t, s, phi, branch, the joints, and the joints with _v
/// (rad/s) and _a (rad/s^2), and roll if a row has one, with 17 significant digits.
[[nodiscard]] std::string to_timed_csv(const TimedPath& motion, const JointNames& joint_names);
/// Returns a timed motion as ROS 2's trajectory_msgs/msg/JointTrajectory in JSON. It holds the
/// joints alone, without the roll of the tool. `frame_id` is the arm's base link.
[[nodiscard]] std::string to_trajectory_json(const TimedPath& motion, const JointNames& joint_names,
                                             const std::string& frame_id);
/// Returns a timed motion as ROS 2's trajectory_msgs/msg/JointTrajectory in YAML. It holds the
/// joints alone, without the roll of the tool. `frame_id` is the arm's base link.
[[nodiscard]] std::string to_trajectory_yaml(const TimedPath& motion, const JointNames& joint_names,
                                             const std::string& frame_id);
/// Returns a timed motion as a log of ROS 2's sensor_msgs/msg/JointState on the topic
/// /joint_states, without the roll of the tool, with log time = t: MCAP, profile ros2, CDR, one
/// uncompressed chunk, with index and summary. `frame_id` is the arm's base link.
/// https://mcap.dev/spec
[[nodiscard]] std::string to_mcap(const TimedPath& motion, const JointNames& joint_names,
                                  const std::string& frame_id);

/// Returns the motion in the format of the file name's ending: .csv, .json, .yaml or .mcap. Throws
/// InputError for any other.
[[nodiscard]] std::string motion_text(const TimedPath& motion, const JointNames& joint_names,
                                      const std::string& frame_id,
                                      const std::filesystem::path& file);
/// Throws InputError unless the file name ends in .csv, .json, .yaml or .mcap.
void require_motion_format(const std::filesystem::path& file);

/// A trajectory as read from a file. Values that the file does not state are 0.
struct TrajectoryFile {
  std::vector<TrajectoryRow> rows;
  std::vector<TimedRow> timed;  ///< these rows with times, if the file has times; else empty
  Stated stated;
};
/// Describes the files that load_trajectory_file() reads, for the help of commands.
inline constexpr const char* kTrajectoryFile =
    "any trajectory or motion of the arm or of both: CSV with columns by name (the joints are "
    "enough, of jobs with stroke and process; t, s, phi, roll, branch, and joints with _v and _a "
    "may be there), JSON or YAML (JointTrajectory), MCAP (JointState); the contents tell which";
/// Loads a trajectory of the arm, docs/formats.md "Trajectories that are read": all that Swivel
/// writes, and CSV files, JointTrajectory messages and JointState logs of other programs. The
/// file's contents tell the format. Throws InputError unless every joint of the arm is there and no
/// other (a joint named "roll" may be missing), and times ascend.
[[nodiscard]] TrajectoryFile load_trajectory_file(const std::filesystem::path& file,
                                                  const JointNames& joint_names);

}  // namespace swivel::io
