// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the trajectories of a workcell. docs/formats.md "Workcells".
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/workcell_result.hpp"
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

}  // namespace swivel::io
