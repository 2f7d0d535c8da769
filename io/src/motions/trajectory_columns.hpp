// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "schema/schema.hpp"
#include "swivel/core/answer/answer.hpp"

namespace swivel::io {

/// Returns the columns that the schema of a row names, with "JOINT" and "JOINT_v" replaced by one
/// column for each joint; the column "roll" only if `roll` is true.
[[nodiscard]] std::vector<std::string> csv_header(const Schema& row,
                                                  const std::array<std::string, kDof>& joint_names,
                                                  bool roll);
/// Returns the fields of a trajectory row, separated by commas: the roll only if `roll` is true,
/// and the first `joints` of the joints.
[[nodiscard]] std::string trajectory_fields(const TrajectoryRow& row, bool roll,
                                            std::size_t joints);
/// Returns a field for each of the first `joints` values by joint, each after a comma.
[[nodiscard]] std::string joint_fields(const Config& values, std::size_t joints);

/// Returns the trajectory of an arm that runs strokes as CSV, with `stroke` and `process`.
[[nodiscard]] std::string strokes_csv(const ArmAnswer& arm, const Problem& problem);
/// Returns the trajectories of two arms as CSV.
[[nodiscard]] std::string two_arms_csv(const Answer& answer);

}  // namespace swivel::io
