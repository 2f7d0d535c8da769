// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// Where two arms bar each other: a layer, or the motion from it to the next, and two bodies.
struct ArmConflict {
  int layer = 0;
  bool of_motion = false;
  std::array<double, 2> s{};          ///< of either arm at the layer, m
  std::array<std::string, 2> bodies;  ///< of arm 0 and of arm 1
};

/// How a workcell was decided.
enum class WorkcellSearch { kNone, kArmsAlone, kRegions, kProduct };
/// Returns "none", "arms alone", "regions" or "pairs of nodes".
[[nodiscard]] const char* to_string(WorkcellSearch search);

/// What the search of two arms asked and did.
struct WorkcellCounters {
  std::int64_t rounds = 0;  ///< regions of conflict by which pairs of paths were divided
  std::int64_t pops = 0;    ///< pairs of nodes taken by A*
  std::int64_t node_pairs = 0, move_pairs = 0;  ///< questions about both arms
};

/// The plan of two arms that work at one time.
struct WorkcellResult {
  PlanStatus status = PlanStatus::kInfeasible;
  double cost = 0;   ///< of both paths together
  double bound = 0;  ///< no two paths without conflict cost less
  /// What each arm's path costs at least by itself; infinite where it has none.
  std::array<double, 2> least_costs{};
  std::array<std::string, 2> names;
  /// The arm whose motion was given, if one was. Its rows are those of Problem::arms, bit for bit.
  std::optional<std::size_t> given_arm;
  /// The plans of both arms: solved with trajectories whose rows are simultaneous, row by row.
  /// Where there is no plan, an arm that has no path by itself says why in its diagnosis. Where
  /// time was up before a pair was proved, `partial` of both has the cheapest pair known, if any.
  std::array<PlanResult, 2> arms;
  WorkcellSearch decided_by = WorkcellSearch::kNone;
  /// Where each arm has a path by itself and both together have none: the first conflict that was
  /// met.
  std::optional<ArmConflict> conflict;
  /// The row of the trajectories and the bodies of both arms with the least margin. None where no
  /// pair is near, and unless measured.
  std::optional<LeastMargin> between_arms;
  bool between_arms_measured = false;  ///< asked for by Evidence::postures, and known
  /// Returns whether between_arms is known.
  [[nodiscard]] Known between_arms_status() const {
    return known(between_arms_measured, between_arms.has_value());
  }
  WorkcellCounters counters;
  std::string planner;
  int threads = 1;
  std::map<std::string, double> time_ms;  ///< by stage
  bool checked = false;                   ///< the trajectories were verified by check_workcell()
  bool refined = false;                   ///< the trajectories are refined ones
  std::vector<std::string> warnings;
};

}  // namespace swivel
