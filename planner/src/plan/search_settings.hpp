// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/collision/world/world.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// Returns whether the planner asks about all nodes and edges before it searches.
[[nodiscard]] inline bool is_eager(const PlanOptions& options) {
  return options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp;
}

/// Returns whether distance proofs answer before FCL does. The eager planners are the baseline, FCL
/// used well, so that they do without. The verdicts are the same.
[[nodiscard]] inline DistanceProofs distance_proofs_of(const PlanOptions& options) {
  return is_eager(options) || options.fcl_alone ? DistanceProofs::kOff : DistanceProofs::kOn;
}

/// Returns the number of threads of a search over several lattices, 0 for all cores. One plan calls
/// hooks from one thread alone.
[[nodiscard]] inline int threads_for(const PlanOptions& options) {
  const bool alone =
      options.planner == PlannerKind::kLazy || options.hooks.check || options.hooks.cost;
  return alone ? 1 : options.threads;
}

}  // namespace swivel
