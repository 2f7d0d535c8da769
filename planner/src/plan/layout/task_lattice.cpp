// SPDX-License-Identifier: BSD-3-Clause
#include "plan/layout/task_lattice.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "plan/layout/told_turns.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

bool same_task(const Task& a, const Task& b) {
  const auto same_signs = [](const std::optional<Config>& p, const std::optional<Config>& q) {
    for (Eigen::Index j = 0; p && q && j < kDof; ++j)
      if (std::signbit((*p)[j]) != std::signbit((*q)[j])) return false;
    return true;
  };
  return a == b && same_signs(a.start, b.start) && same_signs(a.end, b.end);
}

TaskLattice::TaskLattice(const PreparedRobot& robot, const PathProblem& problem, const Hooks& hooks,
                         const Budget& budget)
    : path_(path_within_scale(problem, robot.arm().chain, budget)),
      turns_told_apart_(may_tell_turns_apart(hooks)),
      states_cost_(hooks.cost != nullptr) {
  first_ = make_coaxial_lattice(robot.arm().chain, robot.arm_class(), path_, problem, budget);
  coaxial_ = first_ != nullptr;
  if (!coaxial_)
    first_ = free_lattice(robot, problem, budget);
  else if (turns_told_apart_)
    first_ = with_all_windings(first_);
}

bool TaskLattice::serves(const Hooks& hooks) const {
  return turns_told_apart_ == may_tell_turns_apart(hooks) &&
         states_cost_ == (hooks.cost != nullptr);
}

std::shared_ptr<Lattice> TaskLattice::free_lattice(const PreparedRobot& robot,
                                                   const PathProblem& problem,
                                                   const Budget& budget) const {
  const auto make = [&](const PathProblem& of) {
    return make_lattice(robot.arm().chain, robot.arm_class(), path_, of, budget);
  };
  std::shared_ptr<Lattice> lattice =
      states_cost_ ? make(on_all_layers(problem, robot.arm_class())) : make(problem);
  return turns_told_apart_ && robot.arm_class().srs ? with_all_windings(lattice) : lattice;
}

bool TaskLattice::has_second(const PreparedRobot& robot, const PathProblem& problem,
                             const Budget& budget) const {
  // Arcs treat as circles what a caller's hook may tell apart.
  return coaxial_ ||
         (!turns_told_apart_ &&
          leads_past_singularity(robot.arm().chain, robot.arm_class(), path_, problem, budget));
}

std::shared_ptr<Lattice> TaskLattice::second(const PreparedRobot& robot, const PathProblem& problem,
                                             const Budget& budget) const {
  if (coaxial_) return free_lattice(robot, problem, budget);
  return make_srs_arcs(robot.arm().chain, robot.arm_class(), path_,
                       states_cost_ ? on_all_layers(problem, robot.arm_class()) : problem, budget);
}

CarriedStart TaskLattice::carried_start(const PreparedRobot& robot, const PathProblem& problem,
                                        const Budget& budget) const {
  if (coaxial_ || turns_told_apart_ || states_cost_) return {};
  return carried_past_singularity(*first_, robot.arm_class(), problem, budget);
}

}  // namespace swivel
