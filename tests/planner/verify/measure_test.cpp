// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/measure/measure.hpp"
#include "swivel/collision/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "axes_robots.hpp"
#include "random_problem.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

/// Counts the trajectories that were measured.
struct Counts {
  int solved = 0;   ///< problems that have a trajectory
  int near = 0;     ///< trajectories with a clearance
  int bounded = 0;  ///< trajectories with a nearest limit of a joint
  int slides = 0;   ///< trajectories of arms with a joint that slides
};

/// Checks that the measures are what plan() says of its trajectory.
void expect_what_plan_says(const Measures& measures, const PlanResult& result,
                           const PathProblem& problem, const std::string& what) {
  EXPECT_EQ(measures.min_clearance, result.min_clearance) << what;
  EXPECT_EQ(measures.min_manipulability, result.min_manipulability) << what;
  EXPECT_EQ(measures.arm_angle, result.arm_angle) << what;
  EXPECT_EQ(measures.tool_path_error_mm.max, result.tool_path_error_mm.max) << what;
  EXPECT_EQ(measures.tool_path_error_mm.mean, result.tool_path_error_mm.mean) << what;
  EXPECT_EQ(measures.tool_path_error_mm.allowed, problem.limits.tool_path_error) << what;
  EXPECT_TRUE(measures.evidence.postures && measures.evidence.tool_path_error) << what;
}

/// Checks that the measures are what rows say one by one.
void expect_what_rows_say(const Measures& measures, const PreparedRobot& robot,
                          const PathProblem& problem, const std::vector<TrajectoryRow>& trajectory,
                          const std::string& what, Counts& counts) {
  const Chain& chain = robot.arm().chain;
  const World world(robot.world(), problem);
  World::Query query(world);
  std::optional<double> least;
  double manipulability = 1e9, margin = 1e9, slide_margin = 1e9;
  for (const TrajectoryRow& row : trajectory) {
    if (const auto clearance = query.clearance(row.q))
      least = std::min(least.value_or(1e9), clearance->least);
    manipulability = std::min(manipulability, chain.manipulability(row.q));
    for (std::size_t k = 0; k < kDof; ++k) {
      if (chain.limit[k].continuous || chain.limit[k].wide()) continue;
      const double q = row.q[static_cast<Eigen::Index>(k)];
      double& least_of_kind = chain.limit[k].slides ? slide_margin : margin;
      least_of_kind = std::min({least_of_kind, q - chain.limit[k].lower, chain.limit[k].upper - q});
    }
  }
  EXPECT_EQ(measures.min_clearance, least) << what;
  EXPECT_EQ(measures.min_manipulability, manipulability) << what;
  counts.near += least.has_value();
  ASSERT_EQ(measures.nearest_limit.has_value(), margin < 1e9) << what;
  if (measures.nearest_limit) {
    EXPECT_EQ(measures.nearest_limit->margin, margin) << what;
  }
  counts.bounded += measures.nearest_limit.has_value();
  ASSERT_EQ(measures.nearest_slide_limit.has_value(), chain.slide() >= 0) << what;
  if (const auto& slide = measures.nearest_slide_limit) {
    EXPECT_EQ(slide->margin, slide_margin) << what;
    EXPECT_TRUE(slide->slides) << what;
    EXPECT_EQ(slide->joint, chain.joint_names[static_cast<std::size_t>(chain.slide())]) << what;
    const double q = trajectory[static_cast<std::size_t>(slide->row)].q[chain.slide()];
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(chain.slide())];
    EXPECT_EQ(slide->side == Cause::Side::kLower ? q - limit.lower : limit.upper - q, slide_margin)
        << what;
    ++counts.slides;
  }
}

/// Checks what measuring gives without evidence, and that it refuses a trajectory without its last
/// row.
void expect_less_without_evidence(const Measures& measures, const PreparedRobot& robot,
                                  const PathProblem& problem,
                                  const std::vector<TrajectoryRow>& trajectory,
                                  const std::string& what) {
  const Measures little = measure(robot, problem, trajectory, {});
  EXPECT_FALSE(little.evidence.postures || little.evidence.tool_path_error || little.min_clearance)
      << what;
  EXPECT_EQ(little.nearest_limit.has_value(), measures.nearest_limit.has_value()) << what;
  std::vector<TrajectoryRow> fewer = trajectory;
  fewer.pop_back();
  EXPECT_THROW((void)measure(robot, problem, fewer), InvalidArgument) << what;
}

/// Measuring a trajectory gives what plan() says of it, and what asking row by row gives.
TEST(Measure, IsWhatPlanSaysAndWhatRowsSay) {
  const std::uint64_t base = seed("Measure");
  auto robots = all_robots();
  for (TestRobot& robot : slide_robots()) robots.push_back(std::move(robot));
  Counts counts;
  const int count = trials(80);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (arm_of({"", problem.model, problem.base_link, problem.tip_link}).chain.slide() >= 0) {
      problem.limits.arm_slope = Limits().arm_slope;  // these arms have no arm angle
      problem.limits.step_error.reset();
      problem.resolution.arc = random.uniform(0.3, 0.6);
    }
    const PreparedRobot robot(problem);
    PlanOptions options;
    options.evidence = Evidence::all();
    const PlanResult result = plan(robot, problem, options);
    if (result.status != PlanStatus::kSolved) continue;
    ++counts.solved;
    const Measures measures = measure(robot, problem, result.trajectory);
    expect_what_plan_says(measures, result, problem, what);
    expect_what_rows_say(measures, robot, problem, result.trajectory, what, counts);
    if (::testing::Test::HasFatalFailure()) return;
    expect_less_without_evidence(measures, robot, problem, result.trajectory, what);
  }
  std::printf("%d trajectories, %d near something, %d with limits, %d of slides\n", counts.solved,
              counts.near, counts.bounded, counts.slides);
  EXPECT_GE(counts.slides, at_least_among(count / 8));
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.near, at_least_among(count / 8));
  EXPECT_GE(counts.bounded, at_least_among(count / 8));
}

}  // namespace
}  // namespace swivel
