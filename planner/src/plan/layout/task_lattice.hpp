// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/kinds/past_singularity.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

class PreparedRobot;

/// Returns whether two tasks are equal, the signs of zeros in the joints of their starts and ends
/// included: these become those of rows.
[[nodiscard]] bool same_task(const Task& a, const Task& b);

/// What a plan computes from the task and the pose of the path's frame alone: the tool path and the
/// lattice that is searched first. Obstacles do not matter. Threads may share it as long as none
/// of them changes the clearances of the lattice.
class TaskLattice {
 public:
  /// `hooks`: may tell the turns of joints apart, and say what the states of all layers cost.
  /// `robot` must outlive it. Throws InputError and Stopped.
  TaskLattice(const PreparedRobot& robot, const PathProblem& problem, const Hooks& hooks,
              const Budget& budget);
  TaskLattice(const TaskLattice&) = delete;
  TaskLattice& operator=(const TaskLattice&) = delete;

  [[nodiscard]] const ToolPath& path() const { return path_; }
  /// Returns the lattice that every plan searches first.
  [[nodiscard]] const std::shared_ptr<Lattice>& first() const { return first_; }
  /// Returns whether joint 7 rests in first() (make_coaxial_lattice()).
  [[nodiscard]] bool coaxial() const { return coaxial_; }
  /// Returns whether the caller's hook says what states cost: those of all layers, so that there
  /// are no knots.
  [[nodiscard]] bool states_cost() const { return states_cost_; }
  /// Returns whether plans with these hooks search the same lattices.
  [[nodiscard]] bool serves(const Hooks& hooks) const;
  /// Returns whether second() may have a path where first() has none: where a joint rests in
  /// first(), or if leads_past_singularity(). Robot and problem must be those that this was made
  /// for. Throws InputError and Stopped.
  [[nodiscard]] bool has_second(const PreparedRobot& robot, const PathProblem& problem,
                                const Budget& budget) const;
  /// Makes the lattice that is searched second: that in which no joint rests, where one rests in
  /// first(), or else arcs of self-motion of an S-R-S arm (make_srs_arcs()). Parameters as of
  /// has_second().
  [[nodiscard]] std::shared_ptr<Lattice> second(const PreparedRobot& robot,
                                                const PathProblem& problem,
                                                const Budget& budget) const;
  /// Returns the start carried past a singular pose (carried_past_singularity()), about what a path
  /// of second() may be; none where first() is what serves. Parameters as of has_second().
  [[nodiscard]] CarriedStart carried_start(const PreparedRobot& robot, const PathProblem& problem,
                                           const Budget& budget) const;

 private:
  /// Makes the lattice of the task in which no joint rests.
  [[nodiscard]] std::shared_ptr<Lattice> free_lattice(const PreparedRobot& robot,
                                                      const PathProblem& problem,
                                                      const Budget& budget) const;

  ToolPath path_;
  // Whether the lattices of S-R-S arms tell the turns of all joints apart, because the caller's
  // hooks may.
  bool turns_told_apart_, states_cost_;
  bool coaxial_ = false;
  std::shared_ptr<Lattice> first_;
};

}  // namespace swivel
