// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "schema/schema.hpp"
#include "swivel/core/answer/plan.hpp"

namespace swivel::io {

/// Returns the columns that the schema of a row names, with "JOINT" and "JOINT_v" replaced by one
/// column for each joint; the column "roll" only if `roll` is true.
[[nodiscard]] std::vector<std::string> csv_header(const Schema& row,
                                                  const std::array<std::string, kDof>& joint_names,
                                                  bool roll);
/// Returns the fields of a trajectory row, separated by commas; the roll only if `roll` is true.
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row, bool roll);

}  // namespace swivel::io
