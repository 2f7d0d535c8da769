// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "schema/schema.hpp"
#include "swivel/core/answer/plan.hpp"

namespace swivel::io {

/// The columns that the schema of a row names: "JOINT" and "JOINT_v" stand for as many as there are joints. `roll`: that column,
/// too.
[[nodiscard]] std::vector<std::string> csv_header(const Schema& row, const std::array<std::string, kDof>& joint_names, bool roll);
/// What stands in the columns of a trajectory.
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row, bool roll);

}  // namespace swivel::io
