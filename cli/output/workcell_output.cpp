// SPDX-License-Identifier: BSD-3-Clause
#include "output/workcell_output.hpp"

#include <algorithm>

#include "options/search_options.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::cli {

namespace {

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

std::string refined_workcell_text(const RefinedArms& refined,
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

std::string workcell_motion_text(const MotionTiming& timing,
                                 const std::array<io::JointNames, 2>& joint_names,
                                 const std::array<std::string, 2>& names) {
  if (const auto& failure = timing.failure)
    return formatted("not executable: s = %.4f m of '", failure->s) + names[timing.failed_arm] +
           "': " + failure->reason + "\n";
  const Motion& motion = *timing.motion;
  std::string text = formatted(
      "motion: %.3f s at %g mm/s (%.3f s with the faster tool at that speed throughout), %zu "
      "samples at %g Hz",
      motion.arms[0].rows.back().t, 1e3 * std::max(motion.arms[0].speed, motion.arms[1].speed),
      motion.ideal, motion.arms[0].rows.size(), motion.rate);
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

}  // namespace swivel::cli
