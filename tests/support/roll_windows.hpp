// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <vector>

#include "seed.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel::test {

/// Gives every waypoint a part of the roll's range, which is less than a turn, within which the
/// tool has to stand; `has`, where given, is in all of them.
inline void draw_windows(PathProblem& problem, Random& random,
                         const std::optional<double>& has = {}) {
  const Roll range = *problem.roll;
  for (Waypoint& waypoint : problem.waypoints) {
    double a = random.uniform(range.lower, range.upper),
           b = random.uniform(range.lower, range.upper);
    if (has) a = std::min(a, *has), b = std::max(b, *has);
    waypoint.roll = Roll{std::min(a, b), std::max(a, b)};
  }
}

/// Returns by how much a roll at a layer is outside what the waypoints before and after it allow,
/// rad; negative inside. The path must not be rounded, must begin at the first waypoint, and its
/// layers must be spread evenly between waypoints.
inline double outside_windows(const PathProblem& problem, const ToolPath& path, int layer,
                              double roll) {
  int before = layer, after = layer;
  while (path.layer(before).waypoint < 0) --before;
  while (path.layer(after).waypoint < 0) ++after;
  const Roll& from = *problem.waypoints[static_cast<std::size_t>(path.layer(before).waypoint)].roll;
  const Roll& to = *problem.waypoints[static_cast<std::size_t>(path.layer(after).waypoint)].roll;
  const double t = after > before ? static_cast<double>(layer - before) / (after - before) : 0;
  return std::max((1 - t) * from.lower + t * to.lower - roll,
                  roll - ((1 - t) * from.upper + t * to.upper));
}

}  // namespace swivel::test
