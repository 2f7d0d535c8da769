// SPDX-License-Identifier: BSD-3-Clause
#include "output/motion_output.hpp"

#include <algorithm>

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

TimingOptions MotionOptions::timing_of_strokes() const {
  TimingOptions options;
  if (speed) options.speed = positive(*speed, "--speed");
  if (turn_speed) options.turn_speed = positive(*turn_speed, "--turn-speed");
  if (chord) options.chord = positive(*chord, "--chord");
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

Limits limits_of_speeds(const Problem& problem) {
  if (is_path(problem)) return problem.arm().path().limits;
  Limits limits;
  for (const ArmTask& arm : problem.arms)
    if (const auto& speed = arm.path().limits.tool_speed)
      limits.tool_speed = std::min(*speed, limits.tool_speed.value_or(*speed));
  return limits;
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

void warn_of(const Motion& motion) {
  for (const std::string& warning : motion.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
  for (const ArmMotion& arm : motion.arms)
    for (const std::string& warning : arm.warnings)
      complain("swivel: warning: %s%s\n",
               arm.name.empty() ? "" : ("arm '" + arm.name + "': ").c_str(), warning.c_str());
}

}  // namespace swivel::cli
