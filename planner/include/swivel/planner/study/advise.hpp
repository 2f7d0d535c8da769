// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel {

/// Returns changes that would help a problem that has no path, each planned alone: a free start, a
/// free end, a tool that may turn freely about its axis, one limit relaxed (by bisection, the
/// strictest value of those tried that solves), deeper allowed contact, half the lattice's steps,
/// an object moved by up to 80 mm along an axis of the base frame or of its own, an object removed,
/// two objects where one is not enough, or the tool turned over. What the verdict's cause suggests
/// comes first.
///
/// The order is by outcome: changes that solve the problem; those whose path comes further, the
/// furthest first; those that do not help; those that were not tried or not decided. Equal outcomes
/// stay in the order in which they were suggested. `planner` holds the problem, `result` is its
/// verdict; planner kind, hooks and threads are those of `options`, whose time-out covers all
/// trials together (one second if unset). Empty unless the verdict is infeasible. Throws as
/// Planner::plan() does. The number of threads changes the result only through the time.
[[nodiscard]] std::vector<Advice> advise(const Planner& planner, const RunAnswer& result,
                                         PlanOptions options = {});

/// Returns changes that would help a job that cannot be planned, each planned alone. Where strokes
/// have no path by themselves: these left out or, where approach and retract differ, run backwards,
/// and what advise() finds for each of them. Where a transition has no way: a longer retract or
/// approach (20, 50 or 100 mm, the shortest that helps), these at all strokes, another home, the
/// best order, a stroke beside it run backwards or left out. A home that is tried is where the
/// cheapest job without one begins, to 1e-4 rad.
///
/// `result` is the verdict on the job. Planner kind and threads are those of `options`, whose
/// time-out covers all trials together (one second if unset). Changes that help come first. Empty
/// unless the verdict is infeasible. Throws as plan_job() does.
[[nodiscard]] AdviceList advise_job(const PreparedRobot& robot, const Problem& job,
                                    const Answer& result, PlanOptions options = {});

/// Returns changes that would help a workcell that has no plan, each planned alone, with both arms.
/// Where one arm has no path by itself: what advise() finds for it. Where both have one: a free
/// start, end or roll of either arm, a smaller joint margin of it, its path moved by 10, 20 or 40
/// mm along an axis of the base frame (unless the other arm leads it or both paths are on one
/// object), a smaller clearance of both. Further half the steps of both lattices, an object of the
/// scene removed or moved, the follower as leader, and both paths moved alike. Paths are not moved
/// where a start, an end or a motion is given. Where both arms have no path by themselves, no
/// change of a single arm is planned with both, but a smaller clearance and joint margin of both.
/// For arms without a path AdviceList::alone says what helps them by themselves.
///
/// `result` is the verdict on the workcell. Planner kind and threads are those of `options`, whose
/// time-out covers all trials together (one second if unset). Changes that help come first. Empty
/// unless the verdict is infeasible. Throws as plan_workcell() does. The number of threads changes
/// the result only through the time.
[[nodiscard]] AdviceList advise_workcell(const Problem& cell, const Answer& result,
                                         PlanOptions options = {});

}  // namespace swivel
