// SPDX-License-Identifier: BSD-3-Clause
#include "plan/answer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

void append(const std::vector<std::string>& lines, std::vector<std::string>& all) {
  all.insert(all.end(), lines.begin(), lines.end());
}

}  // namespace

PlanStatus stopped_status(const Budget& budget) {
  return budget.cancelled() ? PlanStatus::kCancelled : PlanStatus::kTimeout;
}

void withdraw(PlanResult& result) {
  result.partial = std::exchange(result.trajectory, {});
}

void withdraw(Answer& answer) {
  for (ArmAnswer& arm : answer.arms) arm.partial = std::exchange(arm.parts, {});
}

Diagnosis diagnosis_alone(PlanResult plan) {
  if (plan.diagnosis) return *std::move(plan.diagnosis);
  Diagnosis unknown;
  unknown.complete = false;
  return unknown;
}

LatticeInfo info_of(const Lattice& lattice, const ArmClass& arm) {
  LatticeInfo info = lattice.describe();
  info.method = arm.method();
  info.complete = arm.complete();
  return info;
}

double cost_of_rows(const Lattice& lattice, const std::vector<int>& path,
                    const std::vector<TrajectoryRow>& rows, double cost) {
  if (!lattice.is_approximate() && !lattice.has_layers_between()) return cost;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const int layer = static_cast<int>(i);
    cost -= lattice.edge_cost(
        lattice.delta(*lattice.node(layer - 1, path[i - 1]), *lattice.node(layer, path[i])));
  }
  // Edges cost what the roll turns against the path's frames; rows count it from the waypoints.
  std::vector<TrajectoryRow> counted = rows;
  count_from_path(lattice.chain(), lattice.path_of_rows(), counted);
  for (std::size_t i = 1; i < counted.size(); ++i)
    cost += lattice.edge_cost(lattice.delta(counted[i - 1].q, counted[i].q));
  if (!lattice.has_node_costs()) return cost;
  for (std::size_t i = 0; i < path.size(); ++i)
    cost -= lattice.node_cost(static_cast<int>(i), path[i]);
  const std::vector<double> shares = lattice.path_of_rows().shares();
  for (std::size_t i = 0; i < rows.size(); ++i)
    cost += lattice.rounded_cost(lattice.cost().roll * shares[i] *
                                 std::abs(wrap_angle(roll_of(lattice.chain(), rows[i]))));
  return cost;
}

void SpecialPairs::add(const World& world) {
  for (const RobotPair& p : world.robot_pairs()) {
    if (!p.dropped && !p.reduced) continue;
    const SpecialPair pair{world.names(p.pair), p.median, p.required.node, p.required.motion};
    std::vector<SpecialPair>& pairs = p.dropped ? dropped : reduced;
    if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
  }
}

std::vector<std::string> robot_warnings(const PreparedRobot& robot, const Robot& problem) {
  const Chain& chain = robot.arm().chain;
  std::vector<std::string> all = limit_warnings(chain);
  append(held_warnings(robot.arm().held), all);
  append(file_warnings(*problem.model, chain), all);
  append(scale_warnings(chain, problem), all);
  return all;
}

std::vector<std::string> path_warnings(const PreparedRobot& robot, const PathProblem& problem,
                                       const ToolPath& path, const World& world) {
  const Chain& chain = robot.arm().chain;
  std::vector<std::string> all = limit_scale_warnings(chain, problem);
  append(scale_warnings(chain, path, problem.scene), all);
  append(world.warnings(), all);
  return all;
}

void add_lines(const std::vector<std::string>& lines, std::vector<std::string>& all) {
  for (const std::string& line : lines)
    if (std::find(all.begin(), all.end(), line) == all.end()) all.push_back(line);
}

void require_joints_that_move(const PreparedRobot& robot, const Robot& problem) {
  if (const std::string rest = joints_at_rest(*problem.model, robot.arm().chain); !rest.empty())
    throw InputError(rest);
}

}  // namespace swivel
