// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

bool has_path_alone(const WorkcellResult& result, std::size_t arm) {
  return std::isfinite(result.least_costs[arm]);
}

/// Returns "the given motion of 'left'".
std::string given_words(const WorkcellResult& result) {
  return "the given motion of '" + result.names[*result.given_arm] + "'";
}

/// Returns what a plan says of the costs of the arms alone.
std::string alone_text(const WorkcellResult& result) {
  const auto given = result.given_arm;
  const std::size_t planned = given ? 1 - *given : 0;
  // What the search found: refined paths may cost less than the arms' cheapest nodes alone.
  const auto found = [&](std::size_t arm) { return result.arms[arm].lattice.cost; };
  const double least = given ? result.least_costs[planned]
                             : result.least_costs[0] + result.least_costs[1],
               cost = given ? found(planned) : found(0) + found(1);
  const std::string colon = result.refined ? ": before refining " : ": ";
  const std::string who =
      given ? "'" + result.names[planned] + "' alone, which " : "both arms alone, which ";
  if (result.decided_by == WorkcellSearch::kArmsAlone)
    return colon + "that of " + who + (given ? "keeps clear of it" : "do not meet");
  if (least <= 0) return "";
  return colon + formatted("%.2g %% more than ", 100 * (cost / least - 1)) + who +
         (given ? "would not keep clear of it" : "would meet");
}

/// Returns why two arms, each of which has a path by itself, have none together.
std::string conflict_text(const WorkcellResult& result) {
  std::string text = "no plan: each arm has a path by itself, and no two of them keep clear";
  if (result.given_arm)
    text = "no plan: '" + result.names[1 - *result.given_arm] +
           "' has a path by itself, and none keeps clear of " + given_words(result);
  if (result.decided_by == WorkcellSearch::kRegions)
    text +=
        formatted(" (%lld region%s of conflict)", static_cast<long long>(result.counters.rounds),
                  result.counters.rounds == 1 ? "" : "s");
  text += "\n";
  if (const auto& conflict = result.conflict)
    text += formatted("  the cheapest paths meet at s = %.4f m of '%s' and %.4f m of '%s'%s: ",
                      conflict->s[0], result.names[0].c_str(), conflict->s[1],
                      result.names[1].c_str(), conflict->of_motion ? ", on the way on" : "") +
            conflict->bodies[0] + " and " + conflict->bodies[1] + "\n";
  return text;
}

std::string solved_text(const WorkcellResult& result) {
  std::string text =
      formatted("two arms, %zu layers, cost %.6g", result.arms[0].trajectory.size(), result.cost);
  if (const auto given = result.given_arm)
    text = formatted("'%s' beside %s, %zu layers, cost %.6g", result.names[1 - *given].c_str(),
                     given_words(result).c_str(), result.arms[0].trajectory.size(),
                     result.arms[1 - *given].cost);
  text += alone_text(result);
  if (const auto& nearest = result.between_arms)
    text += formatted("; nearest to each other %.3g mm: ", 1e3 * nearest->clearance) +
            nearest->bodies[0] + " and " + nearest->bodies[1];
  if (result.arms[0].asked.postures && !result.between_arms_measured)
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

std::string answer_text(const WorkcellResult& result) {
  const bool solved = !result.arms[0].trajectory.empty();
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
    const PlanResult& arm = result.arms[k];
    text += "  " + result.names[k] + (result.given_arm == k ? " (given):\n" : ":\n") +
            indented(indented(answer_text(arm)));
  }
  return text;
}

}  // namespace swivel
