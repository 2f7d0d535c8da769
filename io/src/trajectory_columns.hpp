// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "csv.hpp"
#include "swivel/core/plan.hpp"

namespace swivel::io {

/// s,phi,branch and the joints: the columns of a trajectory, and what stands in them.
[[nodiscard]] std::vector<std::string> trajectory_header(const std::array<std::string, kDof>& joint_names);
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row);
/// Columns `first` ... of row k.
[[nodiscard]] TrajectoryRow read_trajectory_row(const CsvTable& table, std::size_t k, std::size_t first);

}  // namespace swivel::io
