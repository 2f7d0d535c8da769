// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/job_advice.hpp"
#include "swivel/core/answer/job_result.hpp"
#include "swivel/core/problem/job.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class PreparedRobot;

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
[[nodiscard]] AdviceOnJob advise_job(const PreparedRobot& robot, const Job& job,
                                     const JobResult& result, PlanOptions options = {});

}  // namespace swivel
