// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// Returns the answer to a problem for people. Of one path, in one line: whether there is a path,
/// and what it comes near to, as far as that was asked for; where there is none, what ends every
/// path, with further lines for every run of layers that are empty for one cause. Of strokes, the
/// verdict, then a table with a line for each stroke in the order in which they are run, and a line
/// about the transitions; where there is no answer, which stroke has no path and why, or between
/// which two there is no way. Of two arms, what both do together, then a line about each arm; where
/// there is no answer, why. `problem` is executed_problem() of the answer.
[[nodiscard]] std::string answer_text(const Answer& answer, const Problem& problem);
/// Returns the answer of the plan of one path, as answer_text() has that of its problem.
[[nodiscard]] std::string answer_text(const PlanResult& result);
/// Returns an answer in full for people: verdict, advice (null: none), refinement and motion, but
/// of one path the verdict and the advice alone. `problem` is executed_problem() of the answer.
[[nodiscard]] std::string whole_text(const Answer& answer, const Problem& problem,
                                     const AdviceList* advice = nullptr);
/// Returns what was found about a run, in the words of the answer of one path. `part`: its rows;
/// null where there are none.
[[nodiscard]] std::string run_text(const RunAnswer& run, const std::vector<HeldJoint>& held,
                                   const Part* part = nullptr);

/// Returns a line for each change that was tried, and one for those that were not, in the order
/// given.
[[nodiscard]] std::string advice_text(const std::vector<Advice>& advice);

/// Returns the advice on a problem for the terminal, a line for each change.
[[nodiscard]] std::string advice_text(const AdviceList& advice);

/// Returns what an infeasibility certificate of a size in bytes holds: its layers, and which causes
/// remove how many nodes and edges.
[[nodiscard]] std::string certificate_text(const InfeasibilityCertificate& certificate,
                                           std::size_t bytes);
/// Returns what an infeasibility certificate holds, without its size: its layers, and which causes
/// remove how many nodes and edges.
[[nodiscard]] std::string removed_text(const InfeasibilityCertificate& certificate);

}  // namespace swivel
