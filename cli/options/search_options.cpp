// SPDX-License-Identifier: BSD-3-Clause
#include "options/search_options.hpp"

#include <unistd.h>

#include <array>
#include <charconv>
#include <cmath>
#include <csignal>

#include "options/commands.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/report/page.hpp"

namespace swivel::cli {

void SearchOptions::add_to(CLI::App& command) {
  command.add_option("--planner", planner, "eager | eager_dp | lazy | parallel")
      ->capture_default_str();
  command.add_option("--threads", threads, "0: all cores")->capture_default_str();
  command.add_flag("--no-check", no_check, "do not prove answers before they are told");
  LatticeOptions::add_to(command);
}

void LatticeOptions::add_to(CLI::App& command) {
  command.add_option("--ds", ds, "resolution along the path, m");
  command.add_option("--dphi", dphi, "resolution of the arm angle, rad");
  command.add_option("--knot", knot, "path between the layers that have nodes, m; 0: all have");
  // A flag bound to an optional would be false, not unset, if it is not given.
  CLI::Option* const with = command.add_flag_callback(
      "--arcs", [this] { arcs = true; }, "nodes on arcs of arm angles that the grid misses, too");
  command
      .add_flag_callback(
          "--no-arcs", [this] { arcs = false; }, "no such nodes, whatever the problem file says")
      ->excludes(with);
  command.add_option("--edges", edges, "continuous | nodes");
}

PlanOptions SearchOptions::plan_options() const {
  PlanOptions options;
  options.planner = in_the_name_of("--planner", [&] { return planner_from_string(planner); });
  constexpr int kMostThreads = 1024;
  if (threads < 0 || threads > kMostThreads)
    throw InputError("--threads: " + std::to_string(threads) + ": allowed are 0 (all cores) to " +
                     std::to_string(kMostThreads));
  options.threads = threads;
  options.check = !no_check;
  options.cancel = &interrupted;
  return options;
}

void LatticeOptions::apply(Task& task) const {
  if (ds) task.resolution.ds = positive(*ds, "--ds");
  if (dphi) {
    task.resolution.dphi = positive(*dphi, "--dphi");
    if (task.resolution.dphi > kTwoPi)
      throw InputError("--dphi: more than a turn: allowed are values up to 6.2831853");
  }
  if (knot) {
    if (!(*knot >= 0) || !std::isfinite(*knot))
      throw InputError("--knot: " + shortest(*knot) + ": allowed are finite numbers from 0 on");
    task.resolution.knot = knot;
  }
  if (arcs) task.resolution.arcs = *arcs;
  if (!edges.empty()) {
    if (edges != "continuous" && edges != "nodes")
      throw InputError("--edges: unknown mode '" + edges + "': allowed are continuous, nodes");
    task.limits.edges = edges == "nodes" ? EdgeMode::kNodes : EdgeMode::kContinuous;
  }
}

void LatticeOptions::require_used(const std::vector<UnusedKey>& unused) const {
  for (const UnusedKey& key : unused) {
    const std::string option = key.key == "dphi" && dphi   ? "--dphi"
                               : key.key == "arcs" && arcs ? "--arcs"
                                                           : "";
    if (!option.empty() && (key.key != "arcs" || *arcs))
      throw InputError(option + ": is given, but " + key.why +
                       ": allowed is no such option for this arm");
  }
}

std::vector<UnusedKey> unused_keys_of(const Robot& robot, const std::string& source) {
  const Chain chain =
      build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll)
          .chain;
  return unused_keys(chain, classify(chain, source));
}

std::string shortest(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-") ==
                           std::string::npos)
    return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

std::string SearchOptions::words() const {
  std::string words = " --planner " + planner;
  const auto add = [&](const char* option, const std::optional<double>& value) {
    if (value) words += option + shortest(*value);
  };
  add(" --ds ", ds);
  add(" --dphi ", dphi);
  add(" --knot ", knot);
  if (arcs) words += *arcs ? " --arcs" : " --no-arcs";
  if (!edges.empty()) words += " --edges " + edges;
  return words;
}

void require_pages() {
  if (!page_available())
    throw InputError(
        "--report: this program was built without reports: allowed is a build with "
        "SWIVEL_REPORT=ON");
}

double positive(double value, const char* option) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(std::string(option) + ": " + shortest(value) +
                     ": allowed are finite numbers above 0");
  return value;
}

std::atomic<bool> interrupted{false};

void catch_interrupts() {
  for (const int caught : {SIGINT, SIGTERM})
    std::signal(caught, [](int signal) {
      if (interrupted.exchange(true)) _exit(128 + signal);
    });
}

}  // namespace swivel::cli
