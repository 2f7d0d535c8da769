// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/plan.hpp"
#include "swivel/core/problem.hpp"

namespace swivel {

/// What an independent look at a trajectory found. Knows the problem, the exact chain and FCL; nothing of lattices or planners.
struct CheckResult {
  bool passed = false;
  std::vector<std::string> failures;  ///< one line each, with the row; at most 20
  double worst_position = 0;          ///< m, tool against path at the rows
  double worst_angle = 0;             ///< rad
  double worst_path_error = 0;        ///< m, between rows
  double cost = 0;                    ///< of the rows as given, by the problem's metric
  std::optional<double> min_clearance;
};
/// Tolerances: pose 1e-6 m and rad, limits 1e-9, clearance - 0.05 mm; between rows the tool-path error and, in continuous mode,
/// d_edge. Rows may have any spacing in s but must begin and end with the path. Throws InvalidArgument as plan() does.
[[nodiscard]] CheckResult check_trajectory(const Problem& problem, const std::vector<TrajectoryRow>& rows);

}  // namespace swivel
