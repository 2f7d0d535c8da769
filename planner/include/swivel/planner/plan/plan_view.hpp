// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

namespace swivel {

class Lattice;
class PreparedRobot;
class Verdicts;
class World;
struct Problem;

/// What the last plan of a planner came to know, for those who draw or measure it. Valid until the
/// planner plans again, changes or ends.
struct PlanView {
  const PreparedRobot& robot;
  const Problem& problem;
  const Lattice& lattice;
  const World& world;
  const Verdicts* verdicts;  ///< null where the planner was eager: it asked about every node
  /// One slot in each layer: the answer; where there is none, a valid path to the furthest layer,
  /// where one was found.
  const std::vector<int>& path;
};

}  // namespace swivel
