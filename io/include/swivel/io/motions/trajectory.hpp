// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "swivel/core/answer/answer.hpp"

namespace swivel::io {

/// Returns the text of TRAJ.csv, with 17 significant digits. docs/formats.md "Trajectory".
/// - One path: the columns s, phi, branch and the joints, and roll if a row has one.
/// - Strokes: these columns, then `stroke` and `process`. Rows of the parts follow each other, ends
///   of transitions included, which are the rows beside them once more. `problem` is
///   executed_problem() of the answer.
/// - Two arms: one row for each layer; of each arm s, phi and branch, named after it, then the
///   joints of both by name. Rolls are not in it.
[[nodiscard]] std::string to_csv(const Answer& answer, const Problem& problem);
/// Returns the text of TRAJ.csv of the plan of one path.
[[nodiscard]] std::string to_csv(const PlanResult& result);
/// Writes the trajectory of a result as TRAJ.csv: to a file beside the target, which is then
/// renamed. Throws InputError if it cannot be written.
void write_trajectory(const std::filesystem::path& csv, const PlanResult& result);

}  // namespace swivel::io
