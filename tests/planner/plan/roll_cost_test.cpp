// SPDX-License-Identifier: BSD-3-Clause
// What moves cost where a tool may turn about its own axis: all seven joints of an S-R-S arm weigh
// 1, the roll of an arm of six joints 0, whether the problem comes from a file or from memory.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "joint_cost.hpp"
#include "robots.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

PlanOptions lazily() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  return options;
}

TEST(RollCost, IsThatOfTheRowsFromFilesAndFromMemory) {
  for (const char* name :
       {"torch_door", "iiwa14_deburr_in_hand", "kr6_weld_pipe", "ur5e_deburr_edge"}) {
    const PathProblem of_file =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    PathProblem of_memory = of_file;
    of_memory.cost = Cost();
    const PreparedRobot robot(of_file);
    const bool six = robot.arm().chain.roll;
    const PlanResult one = plan(robot, of_file, lazily()), other = plan(robot, of_memory, lazily());
    ASSERT_EQ(one.status, PlanStatus::kSolved) << name;
    EXPECT_EQ(one.cost, other.cost) << name;
    EXPECT_NEAR(one.cost, cost_of_joints(one.trajectory, six), 1e-9) << name;
    EXPECT_NEAR(one.cost, check_trajectory(robot, of_file, one.trajectory).cost, 1e-9) << name;
  }
}

TEST(RollCost, IsTheSameForWeightsThatAreGiven) {
  for (const bool six : {false, true}) {
    PathProblem problem;
    problem.source = six ? "kr6_like" : "iiwa14";
    problem.model = io::load_robot(data_dir() / "robots" / (problem.source + ".urdf"),
                                   data_dir() / "robots" / (problem.source + ".srdf"));
    problem.base_link = "base_link";
    problem.tip_link = six ? "flange" : "tool0";
    problem.tool = Eigen::Translation3d(0.05, 0, 0.15) * Eigen::AngleAxisd(0.5, Vector3d::UnitY());
    problem.roll = Roll{};
    problem.resolution.droll = 0.3;
    problem.waypoints = {{{0.5, -0.1, 0.3}, Quaterniond(0, 0, 1, 0)},
                         {{0.5, 0.1, 0.3}, Quaterniond(0, 0, 1, 0)}};
    const PreparedRobot robot(problem);
    const PlanResult result = plan(robot, problem, lazily());
    ASSERT_EQ(result.status, PlanStatus::kSolved) << six;
    EXPECT_NEAR(result.cost, cost_of_joints(result.trajectory, six), 1e-9) << six;
    problem.cost.weights = {1, 1, 1, 1, 1, 1, six ? 0.0 : 1.0};
    EXPECT_EQ(plan(robot, problem, lazily()).cost, result.cost) << six;
  }
}

}  // namespace
}  // namespace swivel
