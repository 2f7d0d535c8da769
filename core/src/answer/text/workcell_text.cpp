// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "answer/text/answer_words.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

bool has_path_alone(const Answer& result, std::size_t arm) {
  return std::isfinite(result.arms[arm].run().least_cost);
}

/// Returns "the given motion of 'left'".
std::string given_words(const Answer& result) {
  return "the given motion of '" + result.arms[*result.given_arm()].name + "'";
}

/// Returns what a plan says of the costs of the arms alone.
std::string alone_text(const Answer& result) {
  const auto given = result.given_arm();
  const std::size_t planned = given ? 1 - *given : 0;
  // What the search found: refined paths may cost less than the arms' cheapest nodes alone.
  const auto found = [&](std::size_t arm) { return result.arms[arm].run().lattice.cost; };
  const double least = given ? result.arms[planned].run().least_cost
                             : result.arms[0].run().least_cost + result.arms[1].run().least_cost,
               cost = given ? found(planned) : found(0) + found(1);
  const std::string colon = result.refined ? ": before refining " : ": ";
  const std::string who =
      given ? "'" + result.arms[planned].name + "' alone, which " : "both arms alone, which ";
  if (result.pair.decided_by == PairSearch::kArmsAlone)
    return colon + "that of " + who + (given ? "keeps clear of it" : "do not meet");
  if (least <= 0) return "";
  return colon + formatted("%.2g %% more than ", 100 * (cost / least - 1)) + who +
         (given ? "would not keep clear of it" : "would meet");
}

/// Returns why two arms, each of which has a path by itself, have none together.
std::string conflict_text(const Answer& result) {
  std::string text = "no plan: each arm has a path by itself, and no two of them keep clear";
  if (const auto given = result.given_arm())
    text = "no plan: '" + result.arms[1 - *given].name +
           "' has a path by itself, and none keeps clear of " + given_words(result);
  if (result.pair.decided_by == PairSearch::kRegions)
    text += formatted(" (%lld region%s of conflict)",
                      static_cast<long long>(result.pair.counters.rounds),
                      result.pair.counters.rounds == 1 ? "" : "s");
  text += "\n";
  if (const auto& conflict = result.pair.conflict)
    text += formatted("  the cheapest paths meet at s = %.4f m of '%s' and %.4f m of '%s'%s: ",
                      conflict->s[0], result.arms[0].name.c_str(), conflict->s[1],
                      result.arms[1].name.c_str(), conflict->of_motion ? ", on the way on" : "") +
            conflict->bodies[0] + " and " + conflict->bodies[1] + "\n";
  return text;
}

std::string solved_text(const Answer& result) {
  std::string text =
      formatted("two arms, %zu layers, cost %.6g", result.arms[0].rows().size(), result.cost);
  if (const auto given = result.given_arm())
    text = formatted("'%s' beside %s, %zu layers, cost %.6g", result.arms[1 - *given].name.c_str(),
                     given_words(result).c_str(), result.arms[0].rows().size(),
                     result.arms[1 - *given].cost());
  text += alone_text(result);
  if (const auto& nearest = result.pair.nearest)
    text += formatted("; nearest to each other %.3g mm: ", 1e3 * nearest->clearance) +
            nearest->bodies[0] + " and " + nearest->bodies[1];
  if (result.arms[0].run().asked.postures && !result.pair.measured)
    text += "; clearance between them not measured, for time ran out";
  return text + "\n";
}

std::string indented(const std::string& text) {
  std::string all;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    all += "  " + text.substr(begin, end - begin);
    begin = end;
  }
  return all;
}

}  // namespace

std::string text_of_two_arms(const Answer& result) {
  const bool solved = result.has_rows();
  std::string text;
  if (solved)
    text = solved_text(result);
  else if (result.status != PlanStatus::kInfeasible)
    return std::string(result.arms[0].partial.empty() ? "stopped before there was a plan: "
                                                      : "stopped before a plan was proved: ") +
           to_string(result.status) + "\n";
  else if (has_path_alone(result, 0) && has_path_alone(result, 1))
    return conflict_text(result);
  else
    text = "no plan: an arm has no path by itself\n";
  for (std::size_t k = 0; k < 2; ++k) {
    if (!solved && has_path_alone(result, k)) continue;
    const ArmAnswer& arm = result.arms[k];
    const Part* const part = solved ? &arm.parts.front() : nullptr;
    text += "  " + arm.name + (arm.given ? " (given):\n" : ":\n") +
            indented(indented(run_text(arm.run(), arm.held, part)));
  }
  return text;
}

}  // namespace swivel
