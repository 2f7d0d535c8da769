// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/refine/refine.hpp"

namespace swivel {

class PreparedRobot;

/// Refines the runs among the parts of a job, each as refine() does. Rows at which a transition
/// begins or ends stay as they are, bit for bit, so that transitions stay too. Replaces rows and
/// costs of the runs that became cheaper or smoother; returns what refining made of each. Costs of
/// the result are those of all runs, without transitions.
///
/// The parts must pass check_job(), with rows of runs at the layers of problem_of_run(). Throws
/// InputError and InvalidArgument as plan_job() does, and Stopped, which leaves runs as they are
/// that were not reached.
RefinedRuns refine_job(const PreparedRobot& robot, const Problem& job, std::vector<Part>& parts,
                       const RefineOptions& options = {}, const Budget& budget = {});

}  // namespace swivel
