// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/planner/plan/planner.hpp"

namespace swivel::test {

/// All planners; tests expect the same answer of each.
inline constexpr PlannerKind kPlanners[] = {PlannerKind::kEager, PlannerKind::kEagerDp,
                                            PlannerKind::kLazy, PlannerKind::kParallel};

/// Returns options for a planner on two threads, with all evidence.
inline PlanOptions with_all_evidence(PlannerKind planner) {
  PlanOptions options;
  options.planner = planner;
  options.threads = 2;
  options.evidence = Evidence::all();
  return options;
}

}  // namespace swivel::test
