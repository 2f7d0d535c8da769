// SPDX-License-Identifier: BSD-3-Clause
// Paths that are beside a singular pose, at a start or between their ends: where the joints of an
// arm of seven can follow by small moves, a path is found.
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

/// Returns the joints that reach a tool pose from q by moves of least norm; none where they leave
/// their limits or the tool does not follow.
std::optional<Config> moved(const Chain& chain, Config q, const Pose& tool) {
  bool there = false;
  for (int step = 0; step < 30 && !there; ++step) {
    const Pose here = chain.tool(q);
    const Eigen::AngleAxisd turn(tool.linear() * here.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << tool.translation() - here.translation(), turn.angle() * turn.axis();
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
  return there ? std::optional(q) : std::nullopt;
}

/// Returns joints that follow the path forwards and backwards from those of a layer; none where
/// they cannot.
std::optional<std::vector<Config>> followed(const Chain& chain, const ToolPath& path, int layer,
                                            const Config& there) {
  std::vector<Config> rows(static_cast<std::size_t>(path.size()), there);
  for (const int way : {1, -1})
    for (int i = layer + way; i >= 0 && i < path.size(); i += way) {
      const auto q = moved(chain, rows[static_cast<std::size_t>(i - way)], path.layer(i).tool);
      if (!q) return std::nullopt;
      rows[static_cast<std::size_t>(i)] = *q;
    }
  return rows;
}

/// Where a path is beside a singular pose.
enum class Beside { kStart, kMiddle };

/// A path that is beside a singular pose somewhere, with a start, and what it costs to follow it.
struct Case {
  PathProblem problem;
  double cost = 0;
};

/// Returns a random path that joints follow from a posture beside a singular pose, by moves of a
/// quarter of what a step may be; none where they do not. The robot has no shapes.
std::optional<Case> random_case(const TestRobot& robot, const PreparedRobot& prepared,
                                Beside beside, Random& random) {
  const Chain& chain = prepared.arm().chain;
  const std::vector<Alignment> alignments = alignments_of(chain);
  Config singular, towards;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    singular[j] = limit.continuous ? random.uniform(-kPi, kPi)
                                   : random.uniform(limit.lower + 0.2, limit.upper - 0.2);
    towards[j] = random.uniform(-0.3, 0.3);
  }
  const Alignment& near =
      alignments[static_cast<std::size_t>(random.below(static_cast<int>(alignments.size())))];
  singular[near.joint] = near.angle + random.uniform(-0.06, 0.06);
  Case made;
  PathProblem& problem = made.problem;
  problem.model = robot.model;
  problem.source = robot.name;
  problem.base_link = robot.base_link, problem.tip_link = robot.tip_link;
  problem.limits.tool_path_error = 1e-3;
  const double before = beside == Beside::kStart ? 0 : random.uniform(0.2, 0.8);
  if (before > 0) problem.waypoints.push_back(waypoint_of(chain.tool(singular - before * towards)));
  for (const double t : {0.0, 1 - before})
    problem.waypoints.push_back(waypoint_of(chain.tool(singular + t * towards)));
  const ToolPath path = problem_path(problem, chain);
  const Vector3d corner = chain.tool(singular).translation();
  int layer = 0;
  while (layer < path.size() && (path.layer(layer).tool.translation() - corner).norm() > 1e-9)
    ++layer;
  if (layer == path.size()) return std::nullopt;
  const auto witness = followed(chain, path, layer, singular);
  if (!witness) return std::nullopt;
  problem.start = witness->front();
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
  int plans = 0, missed = 0, by_arcs = 0;
  std::vector<double> ratios;
  const int count = trials(80);
  for (int trial = 0; plans < count; ++trial) {
    const TestRobot robot = without_shapes(data_robot(trial % 2 ? "iiwa14" : "sda5f"));
    PathProblem bare;
    bare.model = robot.model, bare.base_link = robot.base_link, bare.tip_link = robot.tip_link;
    const PreparedRobot prepared(bare);
    const auto one = random_case(robot, prepared, Beside::kStart, random);
    if (!one) continue;
    const std::string what = "trial " + std::to_string(trial) + ", " + robot.name;
    const auto plan_by = [&](PlannerKind planner) {
      PlanOptions options;
      options.planner = planner;
      options.check = true;
      return plan(prepared, one->problem, options);
    };
    const PlanResult result = plan_by(PlannerKind::kLazy);
    ++plans;
    if (result.status != PlanStatus::kSolved) {
      std::printf("%s: %s, followed at %.3f\n", what.c_str(),
                  words(diagnosis_of(result).cause).c_str(), one->cost);
      ++missed;
      continue;
    }
    ASSERT_TRUE(check_trajectory(prepared, one->problem, result.trajectory).passed) << what;
    if (plans % 16 == 0) {  // it takes seconds
      ASSERT_EQ(plan_by(PlannerKind::kEager).cost, result.cost) << what;
    }
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
  EXPECT_LE(missed, std::max(1, plans / 100));
  EXPECT_GE(by_arcs, at_least(4));
  EXPECT_LE(std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio > 1.1; }),
            std::max(1, plans / 100));
}

/// A planner that plans again among moving bodies answers as a fresh one, and so do two threads;
/// one that is stopped has a path that passes the check, or none.
TEST(SingularStart, PlansAgainAndStopsAsOtherPathsDo) {
  Random random(seed("SingularStart.PlansAgainAndStopsAsOtherPathsDo"));
  const TestRobot robot = data_robot("iiwa14");
  int plans = 0, by_arcs = 0, stopped = 0, dearer = 0, none = 0;
  const int count = trials(24);
  for (int trial = 0; trial < count;) {
    PathProblem bare;
    bare.model = robot.model, bare.base_link = robot.base_link, bare.tip_link = robot.tip_link;
    auto one = random_case(robot, PreparedRobot(bare), Beside::kStart, random);
    if (!one) continue;
    const std::string what = "trial " + std::to_string(trial++);
    PathProblem& problem = one->problem;
    problem.limits.clearance = 1e-3;
    const Vector3d near = problem.waypoints.back().position;
    const auto anywhere = [&] {
      Pose pose = Pose::Identity();
      for (int k = 0; k < 3; ++k) pose.translation()[k] = near[k] + random.uniform(-0.5, 0.5);
      return pose;
    };
    problem.scene.push_back({"ball", Sphere{0.1}, anywhere(), {}});
    Planner planner(problem);
    for (int move = 0; move < 4; ++move) {
      if (move > 0) planner.move("ball", anywhere());
      PlanOptions options;
      options.planner = PlannerKind::kLazy;
      const PlanResult again = planner.plan(options), fresh = plan(planner.problem(), options);
      options.planner = PlannerKind::kParallel;
      options.threads = 2;
      const PlanResult parallel = plan(planner.problem(), options);
      for (const PlanResult& other : {fresh, parallel}) {
        ASSERT_EQ(again.status, other.status) << what;
        ASSERT_EQ(again.cost, other.cost) << what;
        ASSERT_EQ(again.lattice.nodes, other.lattice.nodes) << what;
        ASSERT_EQ(again.trajectory.size(), other.trajectory.size()) << what;
        for (std::size_t k = 0; k < again.trajectory.size(); ++k)
          ASSERT_EQ(again.trajectory[k].q, other.trajectory[k].q) << what;
      }
      ++plans;
      by_arcs += again.status == PlanStatus::kSolved && !again.lattice.grid;
      none += again.status == PlanStatus::kInfeasible;
      options.timeout_s = random.uniform(0, 0.02);
      const PlanResult hurried = plan(planner.problem(), options);
      stopped += hurried.status == PlanStatus::kTimeout;
      dearer += hurried.status == PlanStatus::kSolved && hurried.cost > again.cost;
      if (hurried.status != PlanStatus::kSolved) continue;
      ASSERT_GE(hurried.cost, again.cost) << what;
      ASSERT_TRUE(check_trajectory(planner.problem(), hurried.trajectory).passed) << what;
    }
  }
  std::printf("%d plans, %d by arcs, %d without a path, %d stopped, %d with a dearer path then\n",
              plans, by_arcs, none, stopped, dearer);
  EXPECT_GE(by_arcs, at_least(count / 4));
  EXPECT_GE(stopped + dearer, at_least(count / 12));
}

/// Paths cost hardly more than to follow by the joints' own moves. A few of S-R-S arms without a
/// given start do: beside a singular pose nodes of a grid of arm angles are far apart.
TEST(SingularPose, IsPassedByArmsWithSevenJoints) {
  Random random(seed("SingularPose.IsPassedByArmsWithSevenJoints"));
  std::vector<TestRobot> robots = {data_robot("iiwa14"), data_robot("sda5f")};
  for (const char* const name : {"panda_like", "xarm7_like", "fetch_like"}) {
    const auto file = [&](const char* end) {
      return data_dir() / "robots" / (std::string(name) + end);
    };
    robots.push_back({name, io::load_robot(file(".urdf"), file(".srdf")), "base_link", "flange"});
  }
  int all = 0, missed = 0, started = 0;
  int dear_started = 0, dear_on_grids = 0, dear_on_arcs = 0;
  for (TestRobot& robot : robots) {
    robot = without_shapes(robot);
    PathProblem bare;
    bare.model = robot.model, bare.base_link = robot.base_link, bare.tip_link = robot.tip_link;
    const PreparedRobot prepared(bare);
    const int count = trials(40);
    int plans = 0, dear = 0;
    const bool on_grid = prepared.arm_class().srs.has_value();
    std::vector<double> ratios;
    for (int trial = 0; plans < count; ++trial) {
      auto one = random_case(robot, prepared, trial % 3 ? Beside::kMiddle : Beside::kStart, random);
      if (!one) continue;
      ++plans;
      if (random.below(2) == 0) one->problem.start.reset();
      PlanOptions options;
      options.check = true;
      const PlanResult result = plan(prepared, one->problem, options);
      if (result.status != PlanStatus::kSolved) {
        std::printf("%s, trial %d: %s, followed at %.3f\n", robot.name.c_str(), trial,
                    words(diagnosis_of(result).cause).c_str(), one->cost);
        ++missed;
        continue;
      }
      ratios.push_back(result.cost / one->cost);
      if (one->problem.start) ++started;
      if (ratios.back() <= 1.1) continue;
      ++dear;
      if (one->problem.start) ++dear_started;
    }
    all += plans;
    (on_grid ? dear_on_grids : dear_on_arcs) += dear;
    std::sort(ratios.begin(), ratios.end());
    std::printf(
        "%s: %d plans, %d dearer than 1.1; cost over that of following: %.3f in the "
        "median, %.3f at most\n",
        robot.name.c_str(), plans, dear, ratios.empty() ? 0 : ratios[ratios.size() / 2],
        ratios.empty() ? 0 : ratios.back());
  }
  EXPECT_EQ(all, 5 * trials(40));
  EXPECT_LE(missed, 1 + all / 200);
  std::printf("%d with a start, %d of them dearer\n", started, dear_started);
  EXPECT_LE(dear_started, 1 + started / 50);
  EXPECT_LE(dear_on_grids, 2 + 2 * trials(40) / 20);
  EXPECT_LE(dear_on_arcs, 1 + 3 * trials(40) / 50);
}

}  // namespace
}  // namespace swivel
