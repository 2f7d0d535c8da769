// SPDX-License-Identifier: BSD-3-Clause
#include "output/workcell_output.hpp"

#include <algorithm>
#include <cmath>

#include "options/search_options.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::cli {

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
  const bool refined = result.arms[0].cost != found(0) || result.arms[1].cost != found(1);
  const double least = given ? result.least_costs[planned]
                             : result.least_costs[0] + result.least_costs[1],
               cost = given ? found(planned) : found(0) + found(1);
  const std::string colon = refined ? ": before refining " : ": ";
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
  if (result.status != PlanStatus::kSolved && result.bound > 0)
    text += formatted("; stopped, at most %.2g %% from the best",
                      100 * (result.cost / result.bound - 1));
  if (const auto& nearest = result.between_arms)
    text += formatted("; nearest to each other %.3g mm: ", 1e3 * nearest->clearance) +
            nearest->bodies[0] + " and " + nearest->bodies[1];
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

std::string plural(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Returns a line for each rate: the joint of an arm that comes nearest to its limit.
std::string peaks_text(const TimedPath& motion, const io::JointNames& names) {
  std::string text;
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    const auto& peaks = motion.peaks[static_cast<std::size_t>(rate)];
    const TimedPath::Peak* most = &peaks[0];
    for (const TimedPath::Peak& peak : peaks)
      if (peak.ratio > most->ratio) most = &peak;
    text += std::string("    ") + to_string(rate) + " at most " + percent(most->ratio) +
            " of the limit: '" + names[static_cast<std::size_t>(most->joint)] +
            formatted("' at s = %.4f m, t = %.3f s\n", most->s, most->t);
  }
  for (const TimedPath::Slow& slow : motion.slow)
    text += formatted("    slower from t = %.3f to %.3f s: ", slow.from_t, slow.to_t) +
            percent(slow.share) + " of the speed at least, for the " + to_string(slow.reason) +
            " of '" + names[static_cast<std::size_t>(slow.joint)] + "'\n";
  return text;
}

}  // namespace

std::string refined_workcell_text(const RefinedWorkcell& refined,
                                  const std::array<std::string, 2>& names) {
  std::string text =
      formatted("refined: cost %.6g before, %.6g now, in ", refined.cost_before, refined.cost) +
      plural(static_cast<std::size_t>(refined.turns), "turn") + "\n";
  if (!refined.arms[0].refined && !refined.arms[1].refined) text = "";
  for (std::size_t k = 0; k < 2; ++k) {
    const Refined& arm = refined.arms[k];
    text += "  " + names[k] + ": ";
    text += arm.refined ? formatted("joints bend by at most %.3g rad/m^2 before, %.3g now",
                                    arm.bend_before, arm.bend)
                        : "not refined: " + arm.reason;
    text += "\n";
  }
  return text;
}

std::string workcell_motion_text(const WorkcellTiming& timing,
                                 const std::array<io::JointNames, 2>& joint_names,
                                 const std::array<std::string, 2>& names) {
  if (const auto& failure = timing.failure)
    return formatted("not executable: s = %.4f m of '", failure->s) + names[timing.failed_arm] +
           "': " + failure->reason + "\n";
  const WorkcellMotion& motion = *timing.motion;
  std::string text = formatted(
      "motion: %.3f s at %g mm/s (%.3f s with the faster tool at that speed throughout), %zu "
      "samples at %g Hz",
      motion.duration, 1e3 * std::max(motion.arms[0].speed, motion.arms[1].speed), motion.ideal,
      motion.arms[0].rows.size(), motion.rate);
  if (motion.blended > 0)
    text += "; the ratio of the tools' speeds changes in passing at " +
            plural(static_cast<std::size_t>(motion.blended), "waypoint");
  const auto& stops = motion.arms[0].stops;
  if (!stops.empty()) text += "; " + plural(stops.size(), "stop");
  if (motion.follower)
    text += "; '" + names[*motion.follower] +
            formatted(
                "' within %.3f mm and %.3f mrad of its path "
                "on '",
                1e3 * motion.follower_position, 1e3 * motion.follower_angle) +
            names[1 - *motion.follower] + "'";
  text += "\n";
  for (const TimedPath::Stop& stop : stops)
    text += formatted("  both stop at waypoint %d, t = %.3f s\n", stop.waypoint, stop.t);
  for (std::size_t k = 0; k < 2; ++k) {
    const TimedPath& arm = motion.arms[k];
    text += "  " + names[k] +
            formatted(": the tool is within %.2g um of its path between samples\n",
                      1e6 * arm.between_position) +
            peaks_text(arm, joint_names[k]);
  }
  return text;
}

std::string workcell_text(const WorkcellResult& result) {
  const bool solved = !result.arms[0].trajectory.empty();
  std::string text;
  if (solved)
    text = solved_text(result);
  else if (result.status != PlanStatus::kInfeasible)
    return std::string("stopped before there was a plan: ") + to_string(result.status) + "\n";
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

}  // namespace swivel::cli
