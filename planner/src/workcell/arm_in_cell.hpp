// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <memory>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"
#include "workcell/given_motion.hpp"

namespace swivel {

/// One arm of a workcell with its world, its path and its lattice, as its problem by itself has
/// them.
struct ArmInCell {
  /// Throws InputError as make_lattice() does, and Stopped. `prepared` must outlive the object.
  ArmInCell(const PreparedWorkcell& prepared, std::size_t arm, const Budget& budget)
      : problem(prepared.problem(arm)),
        robot(prepared.robot(arm)),
        world(robot.world(), problem, budget),
        rule(world.edge_rule(robot.radii())),
        path(path_within_scale(problem, robot.arm().chain, budget)),
        of_lattice(on_all_layers(problem, robot.arm_class())),
        is_given(prepared.given_arm() == arm) {
    const Chain& chain = robot.arm().chain;
    if (is_given)
      lattice = std::make_unique<GivenLattice>(chain, path, problem, prepared.given_rows());
    else
      lattice = make_lattice(chain, robot.arm_class(), path, of_lattice, budget);
  }
  ArmInCell(const ArmInCell&) = delete;
  ArmInCell& operator=(const ArmInCell&) = delete;

  const PathProblem& problem;
  const PreparedRobot& robot;
  World world;
  EdgeRule rule;
  ToolPath path;
  PathProblem of_lattice;  // `problem` as the lattice takes it: with nodes at every layer
  bool is_given;
  std::shared_ptr<Lattice> lattice;
};

}  // namespace swivel
