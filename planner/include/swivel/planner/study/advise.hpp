// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// Returns changes that would help a problem that has no path, each planned alone: a free start, a
/// tool that may turn freely about its axis, one limit relaxed (by bisection, the strictest value
/// of those tried that solves), deeper allowed contact, half the lattice's steps, an object moved
/// by up to 20 mm, or an object removed. What the verdict's cause suggests comes first.
///
/// The order is by outcome: changes that solve the problem; those whose path comes further, the
/// furthest first; those that do not help; those that were not tried or not decided. Equal outcomes
/// stay in the order in which they were suggested. `planner` holds the problem, `result` is its
/// verdict; planner kind, hooks and threads are those of `options`, whose time-out covers all
/// trials together (one second if unset). Empty unless the verdict is infeasible. Throws as
/// Planner::plan() does. The number of threads changes the result only through the time.
[[nodiscard]] std::vector<Advice> advise(const Planner& planner, const PlanResult& result,
                                         PlanOptions options = {});

}  // namespace swivel
