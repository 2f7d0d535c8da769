// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// What would help a problem that has no path, found by planning it: a free start, one limit less strict (by bisection, the
/// strictest value of those tried that solves), half the lattice's steps, an object that stands in the way up to 20 mm elsewhere,
/// or gone. What the verdict's cause suggests is tried first. Each is tried alone.
///
/// In the order of trust: what solves, in the order in which it was tried; what comes further, the furthest first; what does not
/// help; what was not tried or not decided. `planner` holds the problem, `result` is its verdict; planners, hooks and threads are
/// those of `options`, whose time-out is that of all trials together (none: a second). Empty unless infeasible. Throws as
/// Planner::plan(). The same at any number of threads but for what the time allows.
[[nodiscard]] std::vector<Advice> advise(const Planner& planner, const PlanResult& result, PlanOptions options = {});

}  // namespace swivel
