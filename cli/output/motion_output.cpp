// SPDX-License-Identifier: BSD-3-Clause
#include "output/motion_output.hpp"

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

void MotionOptions::add_to(CLI::App& command) {
  command.add_option("--speed", speed, "speed of the tool along its path, m/s");
  command.add_option("--turn-speed", turn_speed, "its speed of rotation, rad/s");
  command.add_option("--rate", rate, "samples a second, default 250");
  command.add_option("--chord", chord,
                     "slow down where the tool would leave its path by more between samples, m");
}

std::optional<TimingOptions> MotionOptions::asked_timing(const Limits& limits) const {
  if (speed) return timing(limits);
  for (const auto& [given, option] : {std::pair(turn_speed, "--turn-speed"),
                                      std::pair(rate, "--rate"), std::pair(chord, "--chord")})
    if (given) throw InputError(std::string(option) + ": is of motions: allowed with --speed");
  return std::nullopt;
}

TimingOptions MotionOptions::timing(const Limits& limits) const {
  TimingOptions options;
  if (!speed && !limits.tool_speed)
    throw InputError(
        "--speed: is not given, nor limits.tool_speed: allowed is the speed of the tool in m/s");
  options.speed = speed ? positive(*speed, "--speed") : *limits.tool_speed;
  options.turn_speed = limits.tool_turn_speed;
  if (turn_speed) options.turn_speed = positive(*turn_speed, "--turn-speed");
  if (chord) options.chord = positive(*chord, "--chord");
  options.rate = checked_rate();
  return options;
}

JobTimingOptions MotionOptions::job_timing() const {
  if (chord)
    throw InputError("--chord: is not supported yet for jobs: allowed are problems with one path");
  JobTimingOptions options;
  if (speed) options.speed = positive(*speed, "--speed");
  if (turn_speed) options.turn_speed = positive(*turn_speed, "--turn-speed");
  options.rate = checked_rate();
  return options;
}

double MotionOptions::checked_rate() const {
  constexpr double kMostRate = 1e5;
  const double asked = rate.value_or(TimingOptions{}.rate);
  if (!(asked > 0 && asked <= kMostRate))
    throw InputError("--rate: " + shortest(asked) + ": allowed are numbers > 0, at most 100000");
  return asked;
}

void add_out_option(CLI::App& command, std::vector<std::string>& files, const std::string& help) {
  command.add_option("--out", files, help + "; may be given several times")
      ->allow_extra_args(false);
}

void require_motion_formats(const std::vector<std::string>& files) {
  in_the_name_of("--out", [&] {
    for (const std::string& file : files) io::require_motion_format(file);
  });
}

void require_table_names(const std::vector<std::string>& files, const std::string& what,
                         const std::string& instead) {
  for (const std::string& file : files) require_table_name("--out", file, what, instead);
}

void print_refined(const Refined& refined) {
  if (refined.refined)
    say("refined: cost %.6g before, %.6g now; joints bend by at most %.3g rad/m^2 before, %.3g "
        "now\n",
        refined.cost_before, refined.cost, refined.bend_before, refined.bend);
  else
    say("not refined: %s\n", refined.reason.c_str());
}

void print_refined_and_timed(const Answer& answer) {
  if (answer.refinement) print_refined(answer.refinement->arms.front());
  if (!answer.motion) return;
  if (const auto& failure = answer.motion->failure) {
    say("not executable: s = %.4f m: %s\n", failure->s, failure->reason.c_str());
    return;
  }
  const io::JointNames& joint_names = answer.arm().joint_names;
  const TimedPath& motion = answer.timed()->arms.front();
  const TimedPath::Peak* most = &motion.peaks[0][0];
  JointRate rate = JointRate::kSpeed;
  for (const JointRate one : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk})
    for (const TimedPath::Peak& peak : motion.peaks[static_cast<std::size_t>(one)])
      if (peak.ratio > most->ratio) most = &peak, rate = one;
  say("motion: %.3f s at %g mm/s (%.3f s at that speed throughout), %zu samples at %g Hz, tool "
      "within %.2g um of its path "
      "between; %s of '%s' at %s of its limit, s = %.4f m",
      motion.rows.back().t, 1e3 * motion.speed, motion.ideal, motion.rows.size(), motion.rate,
      1e6 * motion.between_position, to_string(rate),
      joint_names[static_cast<std::size_t>(most->joint)].c_str(), percent(most->ratio).c_str(),
      most->s);
  if (!motion.slow.empty())
    say("; slower on %zu stretch%s", motion.slow.size(), motion.slow.size() == 1 ? "" : "es");
  if (!motion.stops.empty())
    say("; %zu stop%s", motion.stops.size(), motion.stops.size() == 1 ? "" : "s");
  say("\n");
}

void warn_of(const Motion& motion) {
  for (const std::string& warning : motion.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
  for (const ArmMotion& arm : motion.arms)
    for (const std::string& warning : arm.warnings)
      complain("swivel: warning: %s%s\n",
               arm.name.empty() ? "" : ("arm '" + arm.name + "': ").c_str(), warning.c_str());
}

void print_motion(const TimedPath& motion, const io::JointNames& joint_names) {
  const auto name = [&](int joint) { return joint_names[static_cast<std::size_t>(joint)].c_str(); };
  say("motion: %.3f s at %g mm/s (%.3f s at that speed throughout), %zu samples at %g Hz\n",
      motion.rows.back().t, 1e3 * motion.speed, motion.ideal, motion.rows.size(), motion.rate);
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    const auto& peaks = motion.peaks[static_cast<std::size_t>(rate)];
    const TimedPath::Peak* most = &peaks[0];
    for (const TimedPath::Peak& peak : peaks)
      if (peak.ratio > most->ratio) most = &peak;
    say("  %s at most %s of the limit: '%s' at s = %.4f m, t = %.3f s\n", to_string(rate),
        percent(most->ratio).c_str(), name(most->joint), most->s, most->t);
  }
  for (const TimedPath::Slow& slow : motion.slow) {
    say("  slower from s = %.4f to %.4f m (t = %.3f to %.3f s): %s of the speed at least, for the "
        "%s of '%s'",
        slow.from_s, slow.to_s, slow.from_t, slow.to_t, percent(slow.share).c_str(),
        to_string(slow.reason), name(slow.joint));
    if (!slow.singular.empty())
      say("; the %s is %.1f deg from singular", slow.singular.c_str(),
          slow.singular_angle * 180 / kPi);
    say("\n");
  }
  if (motion.rounded > 0)
    say("  %d corner%s rounded, within %.3g mm and %.3g mrad\n", motion.rounded,
        motion.rounded == 1 ? "" : "s", 1e3 * motion.rounded_position, 1e3 * motion.rounded_angle);
  for (const TimedPath::Stop& stop : motion.stops)
    say("  stops at waypoint %d, s = %.4f m, t = %.3f s: the corner may not be rounded\n",
        stop.waypoint, stop.s, stop.t);
  say("  between samples the tool is within %.3g um and %.3g urad of its path\n",
      1e6 * motion.between_position, 1e6 * motion.between_angle);
  for (const std::string& warning : motion.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
}

}  // namespace swivel::cli
