// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the trajectories of a workcell. docs/formats.md "Workcells".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns a timed motion of both arms as CSV, one row for each sample: the column t, those of
/// to_csv(), then the joints of both with _v (rad/s) and _a (rad/s^2).
[[nodiscard]] std::string to_workcell_motion_csv(const Motion& motion,
                                                 const std::array<JointNames, 2>& joint_names);
/// Returns a timed motion of both arms in the format of the file name's ending: .csv as above,
/// .json, .yaml or .mcap as motion_text() has it, with the joints of both arms, those of arm 0
/// first. Throws InputError for any other.
[[nodiscard]] std::string workcell_motion_text(const Motion& motion,
                                               const std::array<JointNames, 2>& joint_names,
                                               const std::string& frame_id,
                                               const std::filesystem::path& file);

/// The rows of a workcell as read from a file, by arm. Values that the file does not state are 0.
struct WorkcellRows {
  std::array<std::vector<TrajectoryRow>, 2> rows;
  std::array<std::vector<TimedRow>, 2> timed;  ///< these rows with times, if the file has times
  std::array<Stated, 2> stated;                ///< complete_rows() works out the rest
};
/// Loads trajectories or a motion of both arms: all that is written of workcells, and files of
/// other programs. As load_trajectory_file() does of one arm, it takes CSV with columns by name,
/// those of an arm (s, phi, branch, a roll) with "_" and its name, JSON or YAML (JointTrajectory)
/// and MCAP (JointState). `names` and `joint_names` are those of both arms. Throws InputError.
[[nodiscard]] WorkcellRows load_workcell_rows(const std::filesystem::path& file,
                                              const std::array<std::string, 2>& names,
                                              const std::array<JointNames, 2>& joint_names);

}  // namespace swivel::io
