// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/problem_path.hpp"

#include <algorithm>
#include <string>

#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel {

ToolPath problem_path(const Problem& problem, const Chain& chain, const Budget& budget,
                      const std::optional<PathSmoothing>& otherwise) {
  ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source, budget,
                problem.smooth ? problem.smooth : otherwise, problem.roll && problem.roll->circle(),
                problem.steps);
  if (problem.closed) path.close();
  if (problem.start) {
    Pose tool = chain.tool(*problem.start);
    if (chain.free_roll) {  // the roll is free: compare poses without it
      const double s = problem.start_at.value_or(0);
      int i = 0;
      while (i + 2 < path.size() && path.layer(i + 1).s < s) ++i;
      const double length = path.layer(i).step_length,
                   t = length > 0 ? std::clamp((s - path.layer(i).s) / length, 0.0, 1.0) : 0;
      const Pose there = path.at(i, t);
      tool = rolled(tool, -roll_between(there, tool));
    }
    path.begin_at(problem.start_at, tool, problem.start_tolerance, problem.source);
  }
  if (!problem.rolls.empty()) {
    if (problem.rolls.size() != static_cast<std::size_t>(path.size()))
      throw InvalidArgument("Task: " + std::to_string(problem.rolls.size()) +
                            " rolls: allowed is one for each layer, " +
                            std::to_string(path.size()));
    return path.with_rolls(problem.rolls);
  }
  return path;
}

}  // namespace swivel
