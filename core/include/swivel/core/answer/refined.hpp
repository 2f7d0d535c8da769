// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// A lattice's path, refined or not, and how it changed.
struct Refined {
  std::vector<TrajectoryRow> rows;         ///< the refined rows, or those given
  std::vector<TrajectoryRow> rows_before;  ///< those given
  bool refined = false;
  std::string reason;                ///< why the rows are those given
  double cost_before = 0, cost = 0;  ///< by the problem's cost metric
  /// The largest second divided difference of the joints over the tool's travel, rad/m^2.
  double bend_before = 0, bend = 0;
  int rounds = 0;  ///< rounds of optimising and asking
  std::int64_t nodes_asked = 0, edges_asked = 0;
  bool from_second_seed = false;
};

/// What refining made of the runs of an answer.
struct RefinedRuns {
  /// The rows of each run, refined or not, with the cost before and now, and the work of all turns:
  /// of one arm in the order in which its runs are executed, of two arms the run of either.
  std::vector<Refined> runs;
  int turns = 0;                     ///< times that each run was refined
  double cost_before = 0, cost = 0;  ///< of the answer: runs, transitions and lift-offs
  /// Returns whether the rows of any run are refined ones.
  [[nodiscard]] bool any() const {
    return std::any_of(runs.begin(), runs.end(), [](const Refined& run) { return run.refined; });
  }
};

}  // namespace swivel
