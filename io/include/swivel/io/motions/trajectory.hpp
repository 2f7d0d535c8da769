// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "swivel/core/answer/plan.hpp"

namespace swivel::io {

/// TRAJ.csv: header s, phi, branch and the seven joint names, 17 significant digits.
[[nodiscard]] std::string to_csv(const PlanResult& result);
/// The same as a file, written beside and renamed.
void write_trajectory(const std::filesystem::path& csv, const PlanResult& result);

}  // namespace swivel::io
