// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

std::string words(const WorkcellAdvice& advice) {
  std::string what = words(static_cast<const Advice&>(advice));
  if (advice.change == Advice::Change::kMovePaths)
    what = advice.arm.empty() ? "both " + what : "path" + what.substr(5);
  if (advice.arm.empty()) return what;
  const bool leads = advice.change == Advice::Change::kLeads;
  return "'" + advice.arm + (leads ? "' " : "': ") + what;
}

std::string advice_text(const AdviceOnWorkcell& advice) {
  std::string lines, unknown;
  for (const WorkcellAdvice& one : advice.cell) {
    if (one.outcome == Advice::Outcome::kSolved)
      lines += "  would help: " + words(one) + formatted(" (solved, cost %.6g)\n", *one.cost);
    else if (one.outcome == Advice::Outcome::kUnknown)
      unknown += (unknown.empty() ? "" : ", ") + words(one);
    else
      lines += "  no help: " + words(one) + '\n';
  }
  if (!unknown.empty()) lines += "  not tried in the time: " + unknown + '\n';
  for (const ArmAdvice& one : advice.arms)
    if (!one.advice.empty())
      lines += "  for arm '" + one.arm + "' by itself:\n" + advice_text(one.advice);
  return lines;
}

}  // namespace swivel
