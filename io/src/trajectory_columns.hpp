// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "csv.hpp"
#include "schema.hpp"
#include "swivel/core/plan.hpp"

namespace swivel::io {

/// The columns that the schema of a row names: "JOINT" and "JOINT_v" stand for as many as there are joints.
[[nodiscard]] std::vector<std::string> csv_header(const Schema& row, const std::array<std::string, kDof>& joint_names);
/// What stands in the columns of a trajectory.
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row);
/// Columns `first` ... of row k.
[[nodiscard]] TrajectoryRow read_trajectory_row(const CsvTable& table, std::size_t k, std::size_t first);

}  // namespace swivel::io
