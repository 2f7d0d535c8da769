// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/workcell_result.hpp"

namespace swivel {

/// Returns the answer of a plan for people, in one line: whether there is a path, and what it comes
/// near to, as far as that was asked for. Where there is no path, it says what ends every path,
/// with further lines for every run of layers that are empty for one cause.
[[nodiscard]] std::string answer_text(const PlanResult& result);

/// Returns the answer of a workcell for people: what both arms do together, then a line about each
/// arm; where there is no plan, why.
[[nodiscard]] std::string answer_text(const WorkcellResult& result);

/// Returns a line for each change that was tried, and one for those that were not, in the order
/// given.
[[nodiscard]] std::string advice_text(const std::vector<Advice>& advice);

/// Returns what an infeasibility certificate of a size in bytes holds: its layers, and which causes
/// remove how many nodes and edges.
[[nodiscard]] std::string certificate_text(const InfeasibilityCertificate& certificate,
                                           std::size_t bytes);
/// Returns what an infeasibility certificate holds, without its size: its layers, and which causes
/// remove how many nodes and edges.
[[nodiscard]] std::string removed_text(const InfeasibilityCertificate& certificate);

}  // namespace swivel
