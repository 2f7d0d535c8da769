// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Reads ROS 2's trajectory_msgs/msg/JointTrajectory in JSON, as Swivel writes it. Throws
/// InputError, one line with `file` and the key.
[[nodiscard]] TrajectoryFile read_joint_trajectory_json(const std::string& file,
                                                        std::string_view text,
                                                        const JointNames& joint_names);
/// Reads ROS 2's trajectory_msgs/msg/JointTrajectory in YAML, as `ros2 topic echo` and Swivel write
/// it. Throws InputError, one line with `file` and the key.
[[nodiscard]] TrajectoryFile read_joint_trajectory_yaml(const std::string& file,
                                                        const std::string& text,
                                                        const JointNames& joint_names);

/// Reads an MCAP log with one topic of ROS 2's sensor_msgs/msg/JointState in CDR, in uncompressed
/// chunks or in none. Rows are its messages, their times those of `header.stamp` since the first.
/// Throws InputError, one line with `file` and the message.
[[nodiscard]] TrajectoryFile read_mcap(const std::string& file, std::string_view text,
                                       const JointNames& joint_names);

}  // namespace swivel::io
