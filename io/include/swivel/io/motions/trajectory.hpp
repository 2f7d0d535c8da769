// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "swivel/core/answer/plan.hpp"

namespace swivel::io {

/// Returns the text of TRAJ.csv: the columns s, phi, branch and the seven joints, and roll if a row
/// has one, with 17 significant digits. docs/formats.md "Trajectory".
[[nodiscard]] std::string to_csv(const PlanResult& result);
/// Writes the trajectory of a result as TRAJ.csv: to a file beside the target, which is then
/// renamed. Throws InputError if it cannot be written.
void write_trajectory(const std::filesystem::path& csv, const PlanResult& result);

}  // namespace swivel::io
