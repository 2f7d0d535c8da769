// SPDX-License-Identifier: BSD-3-Clause
// Limits of joints beside those of the URDF: of the problem file, and of MoveIt's files.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "swivel/core/problem/robot_model.hpp"
#include "swivel/io/robots/robot.hpp"

namespace swivel::io {

/// What is wrong with a limit of a joint, and what is allowed instead.
struct LimitFault {
  std::string what, allowed;
};

/// Narrows the range of a joint, rad or m. A continuous joint becomes a revolute one of that range.
/// Returns what is wrong where the robot has no such joint, or none that moves, or where the range
/// is empty or reaches beyond the joint's own (by 1e-6 at most is none); the joint is as it was
/// then.
[[nodiscard]] std::optional<LimitFault> narrow_range(RobotModel& robot, const std::string& joint,
                                                     const Joint::Range& range);
/// Narrows the range of a joint by a distance from both of its limits, rad or m. Returns what is
/// wrong, as narrow_range() does; a joint without limits has none to keep off.
[[nodiscard]] std::optional<LimitFault> keep_off_limits(RobotModel& robot, const std::string& joint,
                                                        double margin);

/// Reads the limits of joints from a file as MoveIt has it, joint_limits.yaml. Positions narrow the
/// joints' ranges; speeds, accelerations and jerks stand in place of the URDF's. What the file says
/// and the model does not keep is added to its warnings: joints that the robot does not have,
/// ranges beyond the URDF's, speeds that are said to be unlimited, scaling factors, unknown words.
/// Throws InputError.
void read_joint_limits(const std::filesystem::path& yaml, RobotModel& robot);

/// Narrows the limits of a robot's joints as the options say. Throws InputError.
void keep_limits(const RobotOptions& options, RobotModel& robot);

}  // namespace swivel::io
