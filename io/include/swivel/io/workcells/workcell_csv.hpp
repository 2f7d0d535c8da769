// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the trajectories of a workcell. docs/formats.md "Workcells".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/workcell_result.hpp"
#include "swivel/core/motion/workcell_motion.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns the trajectories of both arms as CSV, one row for each layer: for each arm s, phi and
/// branch, named after it, then the joints of both by name. Rolls are not in it.
[[nodiscard]] std::string to_workcell_csv(const WorkcellResult& result);
/// Loads what to_workcell_csv() writes. `names` and `joint_names` are those of both arms. Throws
/// InputError, by row, for other columns, numbers that are not finite and branches other than 0 to
/// 7.
[[nodiscard]] std::array<std::vector<TrajectoryRow>, 2> load_workcell_csv(
    const std::filesystem::path& csv, const std::array<std::string, 2>& names,
    const std::array<JointNames, 2>& joint_names);

/// Returns a timed motion of both arms as CSV, one row for each sample: the column t, those of
/// to_workcell_csv(), then the joints of both with _v (rad/s) and _a (rad/s^2).
[[nodiscard]] std::string to_workcell_motion_csv(const WorkcellMotion& motion,
                                                 const std::array<JointNames, 2>& joint_names);
/// Returns a timed motion of both arms in the format of the file name's ending: .csv as above,
/// .json, .yaml or .mcap as motion_text() has it, with the joints of both arms, those of arm 0
/// first. Throws InputError for any other.
[[nodiscard]] std::string workcell_motion_text(const WorkcellMotion& motion,
                                               const std::array<JointNames, 2>& joint_names,
                                               const std::string& frame_id,
                                               const std::filesystem::path& file);

/// The rows of a workcell as read from a file.
struct WorkcellRows {
  std::array<std::vector<TrajectoryRow>, 2> rows;
  std::array<std::vector<TimedRow>, 2> timed;  ///< these rows with times, if the file has times
};
/// Loads what to_workcell_csv() or to_workcell_motion_csv() writes. Throws InputError as
/// load_workcell_csv() does, and for times that do not ascend.
[[nodiscard]] WorkcellRows load_workcell_rows(const std::filesystem::path& csv,
                                              const std::array<std::string, 2>& names,
                                              const std::array<JointNames, 2>& joint_names);

}  // namespace swivel::io
