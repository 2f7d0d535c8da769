// SPDX-License-Identifier: BSD-3-Clause
// Starts of S-R-S arms beside a singular pose: where the joints can follow the path by small moves,
// a path is found.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis_of.hpp"
#include "planners.hpp"
#include "robots.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/equations/alignment.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns joints that follow the path from a start by moves of least norm; none where they leave
/// their limits or the tool does not follow.
std::optional<std::vector<Config>> followed(const Chain& chain, const ToolPath& path,
                                            const Config& start) {
  std::vector<Config> rows{start};
  for (int i = 1; i < path.size(); ++i) {
    Config q = rows.back();
    bool there = false;
    for (int step = 0; step < 30 && !there; ++step) {
      const Pose here = chain.tool(q);
      const Eigen::AngleAxisd turn(path.layer(i).tool.linear() * here.linear().transpose());
      Eigen::Matrix<double, 6, 1> error;
      error << path.layer(i).tool.translation() - here.translation(), turn.angle() * turn.axis();
      there = error.norm() < 1e-10;
      const auto J = chain.jacobian(q);
      const Eigen::Matrix<double, 6, 6> JJt = J * J.transpose();
      q += Config(J.transpose() * JJt.ldlt().solve(error));
      if (!q.allFinite()) return std::nullopt;
    }
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      const double x = q[static_cast<Eigen::Index>(j)];
      there = there && (limit.continuous || (x > limit.lower && x < limit.upper));
    }
    if (!there) return std::nullopt;
    rows.push_back(q);
  }
  return rows;
}

/// A path from a start beside a singular pose, and what it costs to follow it.
struct Case {
  PathProblem problem;
  double cost = 0;
};

/// Returns a random path that joints follow from a start beside a singular pose, by moves of a
/// quarter of what a step may be; none where they do not. The robot has no shapes.
std::optional<Case> random_case(const TestRobot& robot, const PreparedRobot& prepared,
                                Random& random) {
  const Chain& chain = prepared.arm().chain;
  const std::vector<Alignment> alignments = alignments_of(chain);
  Config start, towards;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    start[j] = random.uniform(limit.lower + 0.2, limit.upper - 0.2);
    towards[j] = random.uniform(-0.3, 0.3);
  }
  const Alignment& near =
      alignments[static_cast<std::size_t>(random.below(static_cast<int>(alignments.size())))];
  start[near.joint] = near.angle + random.uniform(-0.06, 0.06);
  Case made;
  PathProblem& problem = made.problem;
  problem.model = robot.model;
  problem.source = robot.name;
  problem.base_link = robot.base_link, problem.tip_link = robot.tip_link;
  problem.limits.tool_path_error = 1e-3;
  for (const double t : {0.0, 1.0})
    problem.waypoints.push_back(waypoint_of(chain.tool(start + t * towards)));
  problem.start = start;
  const ToolPath path = problem_path(problem, chain);
  const auto witness = followed(chain, path, start);
  if (!witness) return std::nullopt;
  std::vector<TrajectoryRow> rows;
  for (std::size_t i = 0; i < witness->size(); ++i) {
    rows.push_back({path.layer(static_cast<int>(i)).s, 0, 0, (*witness)[i]});
    if (i > 0) made.cost += joint_norm((*witness)[i] - (*witness)[i - 1]);
  }
  PathProblem strict = problem;
  strict.limits.joint_step /= 4, *strict.limits.tool_path_error /= 2;
  const CheckResult checked = check_trajectory(prepared, strict, rows);
  // Branch and arm angle are not stated: nothing else may be wrong.
  const bool follows =
      std::all_of(checked.failures.begin(), checked.failures.end(), [](const std::string& failure) {
        return failure.find("branch") != std::string::npos ||
               failure.find("phi") != std::string::npos;
      });
  return follows ? std::optional(made) : std::nullopt;
}

TestRobot without_shapes(TestRobot robot) {
  auto model = std::make_shared<RobotModel>(*robot.model);
  for (Link& link : model->links) link.collision.clear();
  robot.model = std::move(model);
  return robot;
}

TEST(SingularStart, HasAPathWhereTheJointsCanFollow) {
  Random random(seed("SingularStart.HasAPathWhereTheJointsCanFollow"));
  int plans = 0, by_arcs = 0;
  std::vector<double> ratios;
  const int count = trials(80);
  for (int trial = 0; plans < count; ++trial) {
    const TestRobot robot = without_shapes(data_robot(trial % 2 ? "iiwa14" : "sda5f"));
    PathProblem bare;
    bare.model = robot.model, bare.base_link = robot.base_link, bare.tip_link = robot.tip_link;
    const PreparedRobot prepared(bare);
    const auto one = random_case(robot, prepared, random);
    if (!one) continue;
    const std::string what = "trial " + std::to_string(trial) + ", " + robot.name;
    const auto plan_by = [&](PlannerKind planner) {
      PlanOptions options;
      options.planner = planner;
      options.check = true;
      return plan(prepared, one->problem, options);
    };
    const PlanResult result = plan_by(PlannerKind::kLazy);
    ASSERT_EQ(result.status, PlanStatus::kSolved)
        << what << ": " << words(diagnosis_of(result).cause) << ", followed at " << one->cost;
    ASSERT_TRUE(check_trajectory(prepared, one->problem, result.trajectory).passed) << what;
    if (++plans % 16 == 0)  // it takes seconds
      ASSERT_EQ(plan_by(PlannerKind::kEager).cost, result.cost) << what;
    if (result.lattice.grid) continue;
    ++by_arcs;
    ratios.push_back(result.cost / one->cost);
  }
  std::sort(ratios.begin(), ratios.end());
  std::printf(
      "%d starts beside singular poses: %d by arcs, cost over that of following: %.3f in "
      "the median, %.3f at most\n",
      plans, by_arcs, ratios.empty() ? 0 : ratios[ratios.size() / 2],
      ratios.empty() ? 0 : ratios.back());
  EXPECT_GE(by_arcs, at_least(4));
  EXPECT_LE(ratios.empty() ? 0 : ratios.back(), 1.1);
}

}  // namespace
}  // namespace swivel
