// SPDX-License-Identifier: BSD-3-Clause
// Which of several answers of one cost is given: the one that begins nearest to the middle of the
// joints' ranges.
#include <gtest/gtest.h>

#include <cmath>

#include "answer_order.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

/// The other limits are as in the file.
TestRobot with_odd_joints_between(const std::string& name, const std::string& tip, double limit) {
  TestRobot robot = data_robot(name);
  robot.tip_link = tip;
  return with_limits(robot, [&](int number, Joint& joint) {
    if (number % 2 == 0) joint.lower = -limit, joint.upper = limit;
  });
}

/// A straight line of 5 cm from a random pose.
std::vector<Waypoint> random_line(const Chain& chain, Random& random) {
  Pose pose = chain.tool(random_config(chain, random));
  const Waypoint first = waypoint_of(pose);
  const Vector3d way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  pose.translation() += 0.05 * way.normalized();
  return {first, waypoint_of(pose)};
}

/// Joints of two turns begin within half a turn of the middle, at the cost that they have where
/// they have one turn.
TEST(Order, JointsOfTwoTurnsBeginInTheTurnNearestToTheMiddle) {
  const std::uint64_t base = seed("Order.Turns");
  int solved = 0, same_cost = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto [name, tip] =
        trial % 2 == 0 ? std::pair{"iiwa14", "tool0"} : std::pair{"xarm7_like", "flange"};
    const TestRobot one = with_odd_joints_between(name, tip, kPi),
                    two = with_odd_joints_between(name, tip, kTwoPi);
    PathProblem problem = problem_for(one);
    problem.waypoints = random_line(arm_of(one).chain, random);
    problem.resolution = {.ds = 0.01, .dphi = 0.15, .arc = 0.3};
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) + " " + name;
    problem.cost.metric =
        random.one_of({CostMetric::kL2, CostMetric::kL2, CostMetric::kL1, CostMetric::kMax});
    if (random.coin(0.3)) {
      problem.cost.weights = {1, 1, 1, 1, 1, 1, 1};
      (*problem.cost.weights)[static_cast<std::size_t>(random.below(kDof))] = 0;
    }
    const PlanResult of_one = plan(problem);
    problem.model = two.model;
    const PlanResult of_two = plan(problem);
    if (of_two.status != PlanStatus::kSolved) continue;
    ++solved;
    for (int j = 0; j < kDof; j += 2)
      ASSERT_LE(std::abs(of_two.trajectory[0].q[j]), kPi + 1e-6) << what << " joint " << j + 1;
    same_cost += of_one.status == PlanStatus::kSolved && std::abs(of_one.cost - of_two.cost) < 1e-9;
  }
  std::printf("%d solved, %d at the same cost with one turn\n", solved, same_cost);
  EXPECT_GE(solved, at_least_among(count / 3));
  EXPECT_GE(same_cost, at_least_among(count / 4));
}

/// Two branches that mirror each other have equal costs up to rounding. The order of answers, not
/// rounding, decides between them.
TEST(Order, MirroredBranchesAreTiesHoweverCostsAreRounded) {
  const std::uint64_t base = seed("Order.Mirrored");
  int solved = 0, rivals = 0, dearer = 0;
  double furthest = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto [name, tip] =
        trial % 2 == 0 ? std::pair{"iiwa14", "tool0"} : std::pair{"xarm7_like", "flange"};
    PathProblem problem = problem_for(with_odd_joints_between(name, tip, kPi));
    const PreparedRobot robot(problem);
    const Chain& chain = robot.arm().chain;
    problem.waypoints = random_line(chain, random);
    problem.resolution = {.ds = 2e-4, .dphi = 0.15, .arc = 0.3};  // many costs to add up
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) + " " + name;
    const ToolPath path = problem_path(problem, chain);
    const std::unique_ptr<Lattice> made = make_lattice(chain, robot.arm_class(), path, problem);
    const Lattice& lattice = *made;
    const auto cost_to_go = make_cost_to_go(lattice);
    cost_to_go->sweep(lattice.layers() - 1);
    std::int64_t expansions = 0;
    const SlotPath best = best_path(*cost_to_go, expansions);
    if (best.empty()) continue;
    ++solved;
    const double least = cost_to_go->best(), off = off_middle(lattice, *lattice.node(0, best[0]));
    dearer += cost_to_go->at(0, best[0]) > least;
    for (int slot = 0; slot < lattice.slots(0); ++slot) {
      const double cost = cost_to_go->at(0, slot);
      if (slot == best[0] || cost > least + 1e-9) continue;
      ++rivals;
      furthest = std::max(furthest, std::abs(cost - cost_to_go->at(0, best[0])));
      ASSERT_GE(off_middle(lattice, *lattice.node(0, slot)), off) << what << " slot " << slot;
    }
  }
  std::printf(
      "%d solved, %d other starts of the same cost, up to %g apart; %d of those taken were dearer "
      "by rounding\n",
      solved, rivals, furthest, dearer);
  EXPECT_GE(rivals, at_least_among(count / 2));
  EXPECT_GE(dearer, at_least(1));
}

TEST(Order, ShippedArmsBeginInTheTurnNearestToTheMiddle) {
  for (const char* const name : {"ur5e_deburr_edge", "xarm7_polish_raster"}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    problem.resolution.ds = 0.02;
    const PreparedRobot robot(problem);
    const PlanResult result = plan(robot, problem);
    ASSERT_EQ(result.status, PlanStatus::kSolved) << name;
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = robot.arm().chain.limit[j];
      if (limit.continuous || limit.upper - limit.lower <= kTwoPi) continue;
      const double off =
          result.trajectory[0].q[static_cast<Eigen::Index>(j)] - (limit.lower + limit.upper) / 2;
      EXPECT_LE(std::abs(off), kPi) << name << " joint " << j + 1;
    }
  }
}

}  // namespace
}  // namespace swivel
