// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class PreparedRobot;
struct ProblemView;

/// Plans a job: the cheapest path through every stroke, joined by transitions in joint space, from
/// home and back. The result is the same at any thread count, unless it times out; then its parts
/// are those of the cheapest job known, if any, and `bound` says how much cheaper another may be.
/// Throws InputError for a job that makes no sense, InvalidArgument for what validate(Problem)
/// refuses or options that jobs do not have (an eager planner, hooks), std::logic_error if
/// options.check finds an answer invalid.
[[nodiscard]] Answer plan_job(const Problem& job, const PlanOptions& options = {});
/// Plans a job with a robot that was prepared before. Throws InvalidArgument also if it was not
/// prepared for this job (PreparedRobot::require_prepared_for). `view`, if given, gets what was
/// found out about the runs.
[[nodiscard]] Answer plan_job(const PreparedRobot& robot, const Problem& job,
                              const PlanOptions& options = {}, ProblemView* view = nullptr);

}  // namespace swivel
