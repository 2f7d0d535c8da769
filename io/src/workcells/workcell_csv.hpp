// SPDX-License-Identifier: BSD-3-Clause
// Writes motions of two arms, and reads their rows. docs/formats.md "Workcells".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/given_answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns a timed motion of both arms in the format of the file name's ending: .csv with one row
/// for each sample, the column t, those of to_csv(), then the joints of both with _v (rad/s) and _a
/// (rad/s^2); .json, .yaml or .mcap as motion_text() has it, with the joints of both arms, those of
/// arm 0 first. Throws InputError for any other.
[[nodiscard]] std::string workcell_motion_text(const Motion& motion,
                                               const std::array<JointNames, 2>& joint_names,
                                               const std::string& frame_id,
                                               const std::filesystem::path& file);

/// Loads trajectories or a motion of both arms: all that is written of them, and files of other
/// programs. As load_trajectory_file() does of one arm, it takes CSV with columns by name, those of
/// an arm (s, phi, branch, a roll) with "_" and its name, JSON or YAML (JointTrajectory) and MCAP
/// (JointState). `joint_names` are those of both arms. Throws InputError.
[[nodiscard]] GivenAnswer load_two_arms(const std::filesystem::path& file, const Problem& problem,
                                        const std::array<JointNames, 2>& joint_names);

}  // namespace swivel::io
