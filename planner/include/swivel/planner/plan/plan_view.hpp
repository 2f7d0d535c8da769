// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

class Lattice;
class PreparedRobot;
class Verdicts;
class World;

/// What the last plan of a planner found out, for those who draw or measure it. Valid until the
/// planner plans again, changes or is destroyed.
struct PlanView {
  const PreparedRobot& robot;
  const PathProblem& problem;
  const Lattice& lattice;
  const World& world;
  const Verdicts* verdicts;  ///< null after an eager planner, which asks about every node
  /// One slot for each layer from layer 0 on: the answer. If there is none, a valid path to the
  /// deepest layer that was found to be reachable; after a search that was stopped, the part that
  /// was proved.
  const std::vector<int>& path;
  Resolution resolution;  ///< that the lattice was made with
};

}  // namespace swivel
