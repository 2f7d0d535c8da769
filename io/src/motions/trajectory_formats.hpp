// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// ROS 2's trajectory_msgs/msg/JointTrajectory, as `ros2 topic echo` and Swivel write it. Each throws InputError, one line with
/// `file` and the key.
[[nodiscard]] TrajectoryFile read_joint_trajectory_json(const std::string& file, std::string_view text,
                                                        const JointNames& joint_names);
[[nodiscard]] TrajectoryFile read_joint_trajectory_yaml(const std::string& file, const std::string& text,
                                                        const JointNames& joint_names);

/// An MCAP log with one topic of ROS 2's sensor_msgs/msg/JointState in CDR, in chunks that are not compressed or in none. Rows are
/// its messages, their times those of `header.stamp` since the first. Throws InputError, one line with `file` and the message.
[[nodiscard]] TrajectoryFile read_mcap(const std::string& file, std::string_view text, const JointNames& joint_names);

}  // namespace swivel::io
