// SPDX-License-Identifier: BSD-3-Clause
#include "output/pairs_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

void print_pairs(const std::string& file) {
  if (std::filesystem::path(file).extension() == ".urdf")
    throw InputError(
        "--pairs: " + file +
        " is a URDF file: allowed is a problem file, whose limits say what pairs keep");
  const Problem problem = io::load_problem(file);
  const PreparedRobot robot(problem);
  const World& world = robot.world();
  std::vector<RobotPair> pairs = world.robot_pairs_with_medians();
  const auto dropped =
      std::count_if(pairs.begin(), pairs.end(), [](const RobotPair& p) { return p.dropped; });
  const auto reduced =
      std::count_if(pairs.begin(), pairs.end(), [](const RobotPair& p) { return p.reduced; });
  say("%s, %zu robot pairs: %zu count, %zu of these reduced, %zu dropped\n",
      problem.model->has_srdf ? "with an SRDF" : "without an SRDF", pairs.size(),
      pairs.size() - static_cast<std::size_t>(dropped), static_cast<std::size_t>(reduced),
      static_cast<std::size_t>(dropped));
  std::size_t width = 9;
  for (const RobotPair& p : pairs)
    for (const std::string& name : world.names(p.pair)) width = std::max(width, name.size());
  say("%-*s %-*s %-8s %9s %12s %13s %12s\n", static_cast<int>(width), "body",
      static_cast<int>(width), "body", "", "median mm", "on layers mm", "on motions mm",
      "tolerance mm");
  // Dropped and reduced pairs come first, as people look for these.
  std::stable_sort(pairs.begin(), pairs.end(), [](const RobotPair& x, const RobotPair& y) {
    return std::pair(!x.dropped, !x.reduced) < std::pair(!y.dropped, !y.reduced);
  });
  for (const RobotPair& p : pairs) {
    const auto names = world.names(p.pair);
    say("%-*s %-*s %-8s ", static_cast<int>(width), names[0].c_str(), static_cast<int>(width),
        names[1].c_str(),
        p.dropped   ? "dropped"
        : p.reduced ? "reduced"
                    : "counts");
    if (p.dropped)
      say("%9s\n", "touching");
    else if (std::isinf(p.median))
      say("%9s %12.3f %13.3f %12.3f\n", "-", 1e3 * p.required.node, 1e3 * p.required.motion,
          1e3 * p.required.tolerance);
    else
      say("%9.3f %12.3f %13.3f %12.3f\n", 1e3 * p.median, 1e3 * p.required.node,
          1e3 * p.required.motion, 1e3 * p.required.tolerance);
  }
}

}  // namespace swivel::cli
