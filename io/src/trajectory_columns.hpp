// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "csv.hpp"
#include "schema.hpp"
#include "swivel/core/plan.hpp"

namespace swivel::io {

/// The columns that the schema of a row names: "JOINT" and "JOINT_v" stand for as many as there are joints. `roll`: that column,
/// too.
[[nodiscard]] std::vector<std::string> csv_header(const Schema& row, const std::array<std::string, kDof>& joint_names, bool roll);
/// What stands in the columns of a trajectory.
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row, bool roll);
/// Columns `first` ... of row k; how many there are.
struct ReadRow {
  TrajectoryRow row;
  std::size_t columns = 0;
};
[[nodiscard]] ReadRow read_trajectory_row(const CsvTable& table, std::size_t k, std::size_t first, bool roll);

}  // namespace swivel::io
