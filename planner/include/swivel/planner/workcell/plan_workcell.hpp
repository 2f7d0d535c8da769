// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"

namespace swivel {

struct ProblemView;

/// Plans two arms that work at one time: the two paths without conflict whose costs together are
/// least. Where the arms' own answers have no conflict, they are the answer, bit for bit. The
/// result is the same at any thread count, unless it times out. Where the motion of one arm is
/// given, the answer is the other arm's cheapest path that keeps clear of it. Throws
/// InvalidArgument for options that workcells do not have (an eager planner, hooks), InputError as
/// plan() does of either arm and for a given motion that does not pass check_trajectory() by
/// itself,
/// std::logic_error if options.check finds an answer invalid.
[[nodiscard]] Answer plan_workcell(const Problem& cell, const PlanOptions& options = {});
/// Plans a workcell that was prepared before. `view`: filled with what was found out, or null.
[[nodiscard]] Answer plan_workcell(const PreparedWorkcell& prepared,
                                   const PlanOptions& options = {}, ProblemView* view = nullptr);

/// Returns a certificate that a workcell has no plan, which verify_certificate() verifies. It comes
/// from a search of its own, by regions of conflict alone: where plan_workcell() was decided by
/// pairs of nodes, this may take much longer. Throws InvalidArgument if the workcell has a plan,
/// InputError as plan_workcell() does, and Stopped.
[[nodiscard]] WorkcellCertificate prove_infeasible(const PreparedWorkcell& prepared,
                                                   const Budget& budget = {});

}  // namespace swivel
