// SPDX-License-Identifier: BSD-3-Clause
// Limits per metre of path are per metre: verdicts do not depend on how many waypoints a line is
// written with, and where such a limit ends every path it is named, with its figures, and tried as
// advice.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "diagnosis_of.hpp"
#include "motion_problem.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

TestRobot robot_of_data(const std::string& name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Returns the problem with each segment of its polyline cut into `parts` parts.
PathProblem in_parts(PathProblem problem, int parts) {
  std::vector<Waypoint> waypoints{problem.waypoints[0]};
  for (std::size_t k = 0; k + 1 < problem.waypoints.size(); ++k)
    for (int part = 1; part <= parts; ++part) {
      const Waypoint &from = problem.waypoints[k], &to = problem.waypoints[k + 1];
      const double t = static_cast<double>(part) / parts;
      if (part == parts)
        waypoints.push_back(to);
      else
        waypoints.push_back({from.position + t * (to.position - from.position),
                             from.orientation.slerp(t, to.orientation)});
    }
  problem.waypoints = waypoints;
  return problem;
}

/// A line of one or two segments from a posture within the limits, that turns sometimes; coarse, so
/// that it is planned at once.
PathProblem random_line(const TestRobot& robot, const std::optional<Roll>& roll, Random& random) {
  PathProblem problem = motion_problem(robot, random, roll);
  problem.scene.clear();
  problem.smooth.reset();
  problem.cost.metric = CostMetric::kL2;
  problem.start.reset();
  problem.waypoints.resize(1);
  const int segments = 1 + random.below(2);
  for (int k = 0; k < segments; ++k) {
    Waypoint to = problem.waypoints.back();
    to.position += random_vector(random, random.uniform(0.04, 0.15));
    if (random.coin()) {
      const Vector3d turn = random_vector(random, random.uniform(0.1, 0.8));
      to.orientation =
          to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    }
    problem.waypoints.push_back(to);
  }
  problem.resolution = {.ds = 0.02, .dphi = 0.3, .dalpha = 0.2, .arc = 0.5};
  problem.limits.clearance = 0;
  problem.limits.edges = EdgeMode::kNodes;
  problem.limits.tool_path_error = 0.02;
  return problem;
}

struct Tally {
  int lines = 0, solved = 0, infeasible = 0, by_slope = 0, advised = 0;
};

/// Plans a line with 1, 10 and 100 waypoints a segment, and compares.
void plan_in_parts(const PathProblem& line, const std::string& what, Tally& tally,
                   PlanResult& first) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  first = plan(line, options);
  ++tally.lines;
  ++(first.status == PlanStatus::kSolved ? tally.solved : tally.infeasible);
  for (const int parts : {10, 100}) {
    const PathProblem same = in_parts(line, parts);
    const PlanResult result = plan(same, options);
    ASSERT_EQ(result.status, first.status) << what << " parts " << parts;
    ASSERT_EQ(result.lattice.layers, first.lattice.layers) << what << " parts " << parts;
    if (first.status != PlanStatus::kSolved) {
      // Frames that are carried over more waypoints are rounded otherwise.
      ASSERT_EQ(words(diagnosis_of(result).cause), words(diagnosis_of(first).cause))
          << what << " parts " << parts;
      ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(first).reached_layer)
          << what << " parts " << parts;
      // The rows about the end of the paths are those of the longer list.
      ASSERT_GE(diagnosis_of(result).waypoints[1], parts * (diagnosis_of(first).waypoints[1] - 1))
          << what;
      ASSERT_LE(diagnosis_of(result).waypoints[1], parts * diagnosis_of(first).waypoints[1])
          << what;
      continue;
    }
    ASSERT_NEAR(result.cost, first.cost, 1e-9) << what << " parts " << parts;
    ASSERT_TRUE(check_trajectory(same, result.trajectory).passed) << what << " parts " << parts;
  }
}

/// 200 lines of arms of six joints whose tool may turn: one verdict each; where the slope of the
/// roll ends every path it is named.
TEST(Slopes, OneVerdictForALineOfSixJointsHoweverManyWaypoints) {
  const std::uint64_t base = seed("Slopes");
  const TestRobot robots[] = {robot_of_data("kr6_like"), robot_of_data("ur5e_like")};
  Tally tally;
  const int count = trials(200);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem line =
        random_line(robots[trial % 2], random.coin(0.7) ? Roll{} : Roll{-1, 1}, random);
    line.limits.roll_slope = std::exp(random.uniform(std::log(0.5), std::log(20)));
    line.limits.joint_step = random.uniform(0.2, 1);
    // Where the roll is free the axis moves on its least turn, and so must the waypoints between.
    line.waypoints = waypoints_in_base(line);
    line.path_frame = line.base_link;
    PlanResult result;
    plan_in_parts(line, what, tally, result);
    if (HasFatalFailure()) return;
    if (result.status == PlanStatus::kSolved) continue;
    const Cause& cause = diagnosis_of(result).cause;
    EXPECT_NE(cause.kind, Cause::Kind::kSpeed) << what << ": no speed of the tool is asked for";
    if (cause.kind != Cause::Kind::kRollSlope) continue;
    ++tally.by_slope;
    if (!diagnosis_of(result).without_it) continue;
    ASSERT_TRUE(cause.value && cause.limit && cause.over) << what;
    EXPECT_EQ(cause.joint, "roll") << what;
    EXPECT_GT(*cause.value, *cause.limit) << what;
    EXPECT_NEAR(*cause.limit, line.limits.roll_slope * *cause.over, 1e-12) << what;
    EXPECT_LE(*cause.over, line.resolution.ds * (1 + 1e-9)) << what;
    EXPECT_NE(figures(cause).find("roll_slope"), std::string::npos) << figures(cause);
    if (tally.advised >= 3) continue;
    Planner planner(line);
    PlanOptions options;
    options.timeout_s = 20;
    const auto advice = advise(planner, planner.plan(), options);
    const auto slope = std::find_if(advice.begin(), advice.end(), [](const Advice& a) {
      return a.change == Advice::Change::kRollSlope;
    });
    ASSERT_NE(slope, advice.end()) << what;
    EXPECT_GT(*slope->to, *slope->from) << what;
    tally.advised += slope->outcome == Advice::Outcome::kSolved;
  }
  std::printf(
      "%d lines, %d solved, %d without a path, %d of these by the roll's slope, %d advised\n",
      tally.lines, tally.solved, tally.infeasible, tally.by_slope, tally.advised);
  EXPECT_GE(tally.lines, at_least(200));
  EXPECT_GE(tally.solved, at_least(60));
  EXPECT_GE(tally.infeasible, at_least(20));
  EXPECT_GE(tally.by_slope, at_least(5));
  EXPECT_GE(tally.advised, at_least(1));
}

/// Seven joints along a line have one verdict however many waypoints it has, by the slope of the
/// arm angle and, with a roll, by both slopes.
TEST(Slopes, OneVerdictForALineOfSevenJointsHoweverManyWaypoints) {
  const std::uint64_t base = seed("SlopesOfSeven");
  const TestRobot robots[] = {data_robot("iiwa14"), continuous_robot(),
                              robot_of_data("panda_like")};
  Tally tally;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const bool srs = trial % 3 < 2;
    PathProblem line = random_line(
        robots[trial % 3], srs && random.coin(0.3) ? std::optional(Roll{-0.3, 0.3}) : std::nullopt,
        random);
    if (srs) line.limits.arm_slope = random.uniform(2, 40);
    line.limits.joint_step = random.uniform(0.05, 0.4);
    line.resolution.knot = 0.04;
    PlanResult result;
    plan_in_parts(line, what, tally, result);
    if (HasFatalFailure()) return;
  }
  std::printf("%d lines, %d solved, %d without a path\n", tally.lines, tally.solved,
              tally.infeasible);
  EXPECT_GE(tally.solved, at_least(20));
  EXPECT_GE(tally.infeasible, at_least(5));
}

/// A tool that turns about the axis of the last joint until that joint's range is used up: what
/// ends every path is the end of the range, not the turn that the joint would have to unwind by in
/// one step. A tool that may turn helps at once.
TEST(Slopes, AJointThatHasRunOutOfTurnsIsAtItsLimit) {
  const TestRobot robot = data_robot("iiwa14");
  const Chain chain =
      build_arm(*robot.model, robot.base_link, robot.tip_link, {}, Pose::Identity()).chain;
  int unwound = 0, helped = 0;
  const std::uint64_t base = seed("Unwinds");
  for (int trial = 0; trial < 4; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = problem_for(robot);
    problem.waypoints.assign(1, waypoint_of(chain.tool(inner_posture(chain, random))));
    const double way = trial % 2 == 0 ? 1 : -1;
    for (int k = 1; k <= 8; ++k) {
      Waypoint to = problem.waypoints.back();
      to.position.z() -= 0.002;
      to.orientation = to.orientation * Quaterniond(Eigen::AngleAxisd(way * 2, Vector3d::UnitZ()));
      problem.waypoints.push_back(to);
    }
    problem.resolution = {.ds = 0.005, .dphi = 0.2, .dalpha = 0.2};
    problem.limits.clearance = 0;
    problem.limits.roll_slope =
        100;  // of the advice: joint 7 may stand still while the waypoints turn
    Planner planner(problem);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult result = planner.plan(options);
    if (result.status == PlanStatus::kSolved) continue;
    ASSERT_EQ(result.status, PlanStatus::kInfeasible) << what;
    const Cause& cause = diagnosis_of(result).cause;
    if (!cause.unwinds) {
      std::printf("%s: %s %s\n", what.c_str(), words(cause).c_str(), figures(cause).c_str());
      continue;
    }
    ++unwound;
    EXPECT_EQ(cause.kind, Cause::Kind::kLimit) << what;
    EXPECT_EQ(cause.joint, chain.joint_names.back()) << what;
    ASSERT_TRUE(cause.value && cause.limit) << what;
    EXPECT_GT(cause.side == Cause::Side::kUpper ? *cause.value - *cause.limit
                                                : *cause.limit - *cause.value,
              0)
        << what;
    EXPECT_LE(*cause.by(), problem.limits.joint_step) << what;
    EXPECT_NE(figures(cause).find("unwind"), std::string::npos) << figures(cause);
    options.timeout_s = 6;
    const auto begin = std::chrono::steady_clock::now();
    const auto advice = advise(planner, result, options);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 7)
        << what;
    for (const Advice& one : advice) {
      EXPECT_NE(one.change, Advice::Change::kJointStep) << what;
      helped += one.change == Advice::Change::kFreeRoll && one.outcome == Advice::Outcome::kSolved;
    }
  }
  EXPECT_GE(unwound, 3);
  EXPECT_EQ(helped, unwound);
}

}  // namespace
}  // namespace swivel
