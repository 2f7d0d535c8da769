// SPDX-License-Identifier: BSD-3-Clause
// What the answers of one path, of jobs and of two arms have in common.
#pragma once
#include <string>
#include <vector>

#include "plan/stopwatch.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// Returns the status of a plan that this budget ended: cancelled, or timed out.
[[nodiscard]] PlanStatus stopped_status(const Budget& budget);

/// Moves what is not proved to `partial`: the trajectory of a path, the parts of all arms.
void withdraw(PlanResult& result);
void withdraw(Answer& answer);

/// Proves an answer: the only way by which one leaves a planner whose options ask for proofs.
/// `prove` proves all of it within the budget, or throws std::logic_error. Where the budget ends
/// first, withdraws the answer, sets its status to stopped_status() and throws Stopped.
template <class Result, class Prove>
void prove_answer(const PlanOptions& options, const Budget& budget, Result& result,
                  const Prove& prove) {
  if (!options.check) return;
  Stopwatch watch;
  budget.tell(Stage::kProving);
  try {
    prove();
  } catch (const Stopped&) {
    withdraw(result);
    result.status = stopped_status(budget);
    throw;
  }
  result.checked = true;
  result.time_ms["check"] += watch.lap();
}

/// Returns why a run has no path from the plan of the run by itself. Where time was up before that
/// had its verdict, the diagnosis knows nothing and is not complete.
[[nodiscard]] Diagnosis diagnosis_alone(PlanResult plan);

/// Returns what a lattice is like, with how the solutions of its arm are found.
[[nodiscard]] LatticeInfo info_of(const Lattice& lattice, const ArmClass& arm);

/// Returns the cost of the rows of a path whose nodes and edges cost `cost` in the lattice. It is
/// `cost` itself, bit for bit, unless rows may differ from nodes: those of arms that are not
/// exactly S-R-S, and those between nodes.
[[nodiscard]] double cost_of_rows(const Lattice& lattice, const std::vector<int>& path,
                                  const std::vector<TrajectoryRow>& rows, double cost);

/// The robot's own pairs of bodies that are not kept apart as others are.
struct SpecialPairs {
  std::vector<SpecialPair> dropped, reduced;
  /// Adds the pairs of a world, each once.
  void add(const World& world);
};

/// Returns the warnings about the robot of a problem: limits that are missing or assumed, joints
/// that are held, its files, and bodies as large as if their lengths were millimetres.
[[nodiscard]] std::vector<std::string> robot_warnings(const PreparedRobot& robot,
                                                      const Robot& problem);
/// Returns the warnings about what a path asks of the robot: limits, waypoints and objects of the
/// scene as large as if their lengths were millimetres, and those of the world.
[[nodiscard]] std::vector<std::string> path_warnings(const PreparedRobot& robot,
                                                     const PathProblem& problem,
                                                     const ToolPath& path, const World& world);
/// Adds those lines that are not there yet.
void add_lines(const std::vector<std::string>& lines, std::vector<std::string>& all);

/// Throws InputError if a joint between base and tip rests where a URDF has none of its limits.
void require_joints_that_move(const PreparedRobot& robot, const Robot& problem);

}  // namespace swivel
