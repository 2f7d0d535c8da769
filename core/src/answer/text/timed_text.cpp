// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/timed_text.hpp"

#include <algorithm>
#include <array>

#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

constexpr std::array kRates{JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk};

std::string plural(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string name_of(int joint, const JointNames& names) {
  return "'" + names[static_cast<std::size_t>(joint)] + "'";
}

/// Returns a line for each rate, behind `indent`: the joint of an arm that comes nearest to its
/// limit.
std::string peaks_text(const TimedPath& motion, const JointNames& names, const char* indent) {
  std::string text;
  for (const JointRate rate : kRates) {
    const auto& peaks = motion.peaks[static_cast<std::size_t>(rate)];
    const TimedPath::Peak* most = &peaks[0];
    for (const TimedPath::Peak& peak : peaks)
      if (peak.ratio > most->ratio) most = &peak;
    text += std::string(indent) + to_string(rate) + " at most " + percent(most->ratio) +
            " of the limit: " + name_of(most->joint, names) +
            formatted(" at s = %.4f m, t = %.3f s\n", most->s, most->t);
  }
  return text;
}

/// Returns by how much a motion is slower on a stretch, and for which rate of which joint.
std::string cause_text(const TimedPath::Slow& slow, const JointNames& names) {
  return percent(slow.share) + " of the speed at least, for the " + to_string(slow.reason) +
         " of " + name_of(slow.joint, names);
}

std::string line_of_path(const TimedPath& motion, const JointNames& names) {
  const TimedPath::Peak* most = &motion.peaks[0][0];
  JointRate rate = JointRate::kSpeed;
  for (const JointRate one : kRates)
    for (const TimedPath::Peak& peak : motion.peaks[static_cast<std::size_t>(one)])
      if (peak.ratio > most->ratio) most = &peak, rate = one;
  std::string text = formatted(
      "motion: %.3f s at %g mm/s (%.3f s at that speed throughout), %zu samples at %g Hz, tool "
      "within %.2g um of its path between; %s of ",
      motion.rows.back().t, 1e3 * motion.speed, motion.ideal, motion.rows.size(), motion.rate,
      1e6 * motion.between_position, to_string(rate));
  text += name_of(most->joint, names) + " at " + percent(most->ratio) +
          formatted(" of its limit, s = %.4f m", most->s);
  if (const std::size_t count = motion.slow.size(); count > 0)
    text += formatted("; slower on %zu stretch%s", count, count == 1 ? "" : "es");
  if (!motion.stops.empty()) text += "; " + plural(motion.stops.size(), "stop");
  return text + "\n";
}

std::string lines_of_path(const TimedPath& motion, const JointNames& names) {
  std::string text = formatted(
      "motion: %.3f s at %g mm/s (%.3f s at that speed throughout), %zu samples at %g Hz\n",
      motion.rows.back().t, 1e3 * motion.speed, motion.ideal, motion.rows.size(), motion.rate);
  text += peaks_text(motion, names, "  ");
  for (const TimedPath::Slow& slow : motion.slow) {
    text += formatted("  slower from s = %.4f to %.4f m (t = %.3f to %.3f s): ", slow.from_s,
                      slow.to_s, slow.from_t, slow.to_t) +
            cause_text(slow, names);
    if (!slow.singular.empty())
      text += "; the " + slow.singular +
              formatted(" is %.1f deg from singular", slow.singular_angle * 180 / kPi);
    text += "\n";
  }
  if (motion.rounded > 0)
    text += "  " + plural(static_cast<std::size_t>(motion.rounded), "corner") +
            formatted(" rounded, within %.3g mm and %.3g mrad\n", 1e3 * motion.rounded_position,
                      1e3 * motion.rounded_angle);
  for (const TimedPath::Stop& stop : motion.stops)
    text +=
        formatted("  stops at waypoint %d, s = %.4f m, t = %.3f s: the corner may not be rounded\n",
                  stop.waypoint, stop.s, stop.t);
  return text +
         formatted("  between samples the tool is within %.3g um and %.3g urad of its path\n",
                   1e6 * motion.between_position, 1e6 * motion.between_angle);
}

/// Returns the speed that a motion was asked for along its strokes, in words.
std::string speed_words(const ArmMotion& motion, const Problem& problem) {
  if (motion.runs.empty()) return "";
  double least = motion.runs.front().speed, most = least;
  for (const TimedPath& run : motion.runs)
    least = std::min(least, run.speed), most = std::max(most, run.speed);
  const bool feeds = std::any_of(problem.arm().strokes.begin(), problem.arm().strokes.end(),
                                 [](const Stroke& stroke) { return !stroke.feed.empty(); });
  return formatted(least < most || feeds ? " at up to %g mm/s" : " at %g mm/s", 1e3 * most);
}

std::string line_of_strokes(const ArmMotion& motion, const std::vector<Part>& parts,
                            const Problem& problem) {
  double on_strokes = 0;
  for (std::size_t k = 1; k < motion.rows.size(); ++k)
    if (parts.at(motion.part[k]).run) on_strokes += motion.rows[k].t - motion.rows[k - 1].t;
  return formatted(
      "motion: %.3f s, %.3f s of it on strokes%s and %.3f s in transitions, %zu samples at %g Hz, "
      "%zu events\n",
      motion.duration, on_strokes, speed_words(motion, problem).c_str(),
      motion.duration - on_strokes, motion.rows.size(), motion.rate, motion.events.size());
}

std::string lines_of_two_arms(const Motion& motion, const Answer& answer) {
  const std::vector<ArmMotion>& arms = motion.arms;
  std::string text = formatted(
      "motion: %.3f s at %g mm/s (%.3f s with the faster tool at that speed throughout), %zu "
      "samples at %g Hz",
      arms[0].rows.back().t, 1e3 * std::max(arms[0].speed, arms[1].speed), motion.ideal,
      arms[0].rows.size(), motion.rate);
  if (motion.blended > 0)
    text += "; the ratio of the tools' speeds changes in passing at " +
            plural(static_cast<std::size_t>(motion.blended), "waypoint");
  const auto& stops = arms[0].stops;
  if (!stops.empty()) text += "; " + plural(stops.size(), "stop");
  if (motion.follower)
    text += "; '" + answer.arms[*motion.follower].name +
            formatted("' within %.3f mm and %.3f mrad of its path on '",
                      1e3 * motion.follower_position, 1e3 * motion.follower_angle) +
            answer.arms[1 - *motion.follower].name + "'";
  text += "\n";
  for (const TimedPath::Stop& stop : stops)
    text += formatted("  both stop at waypoint %d, t = %.3f s\n", stop.waypoint, stop.t);
  for (std::size_t k = 0; k < 2; ++k) {
    const JointNames& names = answer.arms[k].joint_names;
    text += "  " + answer.arms[k].name +
            formatted(": the tool is within %.2g um of its path between samples\n",
                      1e6 * arms[k].between_position) +
            peaks_text(arms[k], names, "    ");
    for (const TimedPath::Slow& slow : arms[k].slow)
      text += formatted("    slower from t = %.3f to %.3f s: ", slow.from_t, slow.to_t) +
              cause_text(slow, names) + "\n";
  }
  return text;
}

/// Returns the place at which an answer has no motion: "s = 0.1000 m", with the part of strokes or
/// the arm of two.
std::string place_text(const MotionTiming& timing, const Answer& answer, const Problem& problem) {
  const std::string s = formatted("s = %.4f m", timing.failure->s);
  if (answer.arms.size() == 2) return s + " of '" + answer.arms[timing.failed_arm].name + "'";
  if (is_path(problem)) return s;
  const std::vector<Part>& parts = answer.arm().parts;
  const std::size_t k = timing.failed_part;
  std::string part = "transition home";
  if (parts.at(k).run)
    part = "stroke " + words(*parts[k].run, problem);
  else if (k + 1 < parts.size())
    part = "transition to " + words(*parts[k + 1].run, problem);
  return part + ": " + s;
}

}  // namespace

std::string refined_text(const Answer& answer, const Problem& problem) {
  if (!answer.refinement) return "";
  const RefinedRuns& all = *answer.refinement;
  const auto bend = [](const Refined& one) {
    return one.refined ? formatted("joints bend by at most %.3g rad/m^2 before, %.3g now\n",
                                   one.bend_before, one.bend)
                       : "not refined: " + one.reason + "\n";
  };
  std::string text;
  if (all.any()) text = formatted("refined: cost %.6g before, %.6g now", all.cost_before, all.cost);
  if (is_path(problem)) return text + (all.any() ? "; " : "") + bend(all.runs.front());
  const bool two_arms = answer.arms.size() == 2;
  if (all.any())
    text += (two_arms ? ", in " + plural(static_cast<std::size_t>(all.turns), "turn")
                      : std::string(", without transitions")) +
            "\n";
  std::vector<std::string> names;
  for (const ArmAnswer& arm : answer.arms)
    if (two_arms) names.push_back(arm.name);
  if (!two_arms)
    for (const Part& part : answer.arm().parts)
      if (part.run) names.push_back("stroke " + words(*part.run, problem));
  for (std::size_t k = 0; k < all.runs.size(); ++k)
    text += "  " + names[k] + ": " + bend(all.runs[k]);
  return text;
}

std::string timed_text(const Answer& answer, const Problem& problem, bool in_full) {
  if (!answer.motion) return "";
  const MotionTiming& timing = *answer.motion;
  if (timing.failure)
    return "not executable: " + place_text(timing, answer, problem) + ": " +
           timing.failure->reason + "\n";
  const ArmMotion& motion = timing.motion->arms.front();
  if (answer.arms.size() == 2) return lines_of_two_arms(*timing.motion, answer);
  if (!is_path(problem)) return line_of_strokes(motion, answer.arm().parts, problem);
  const JointNames& names = answer.arm().joint_names;
  return in_full ? lines_of_path(motion, names) : line_of_path(motion, names);
}

}  // namespace swivel
