// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// How near the bodies of a problem come at single states of the arm.
struct StateClearances {
  struct State {
    /// Distance of the pair that comes nearest to what it must keep at layers, or falls furthest
    /// below it, m; 0 if its bodies touch. Infinite where there are no pairs.
    double distance = std::numeric_limits<double>::infinity();
    double required = 0;  ///< what this pair must keep, m
    /// Least distance of all pairs, m.
    double least = std::numeric_limits<double>::infinity();
    std::array<int, 2> pair{-1, -1};  ///< indices into `bodies`
  };
  std::vector<std::string> bodies;  ///< links and attached bodies, then scene objects
  std::vector<State> states;
};

/// Measures states, rad, one by one, as exactly as FCL tells. Pairs that may touch are left out.
/// Throws InvalidArgument for a robot that is not prepared for the problem, InputError for an empty
/// mesh, and Stopped.
[[nodiscard]] StateClearances state_clearances(const PreparedRobot& robot,
                                               const PathProblem& problem,
                                               std::span<const Config> states,
                                               const Budget& budget = {});

}  // namespace swivel
