// SPDX-License-Identifier: BSD-3-Clause
// The tool's error on steps that are hardly longer than the noise of waypoints: turns on the spot
// and ends of short paths, against plain forward kinematics and the distance from a segment.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "inner_posture.hpp"
#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/planning_arm.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"
#include "verify/path_following.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNoise = 5e-6;  // m, the most of a waypoint's

/// Returns the distance of a point from the segment between two others.
double from_segment(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d way = b - a;
  if (way.norm() == 0 || (p - a).dot(way) <= 0) return (p - a).norm();
  if ((p - b).dot(way) >= 0) return (p - b).norm();
  return (p - a).cross(way).norm() / way.norm();
}

/// Returns the largest distance of the tool from its step, m, over all moves of rows at the layers
/// of a path, at `parts` - 1 moments of each. `parts` may depend on the move.
template <class Parts>
double largest_error(const Chain& chain, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, const Parts& parts) {
  double most = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Config &from = rows[k - 1].q, move = rows[k].q - from;
    const Vector3d &a = path.layer(static_cast<int>(k) - 1).tool.translation(),
                   &b = path.layer(static_cast<int>(k)).tool.translation();
    const int count = parts(k);
    for (int m = 1; m < count; ++m)
      most = std::max(most, from_segment(a, b, chain.tool(from + m * move / count).translation()));
  }
  return most;
}

/// Returns a turn on the spot, of up to three parts, or a short path that turns. Its waypoints are
/// those of `exact` with up to 5 um of noise.
std::array<std::vector<Waypoint>, 2> short_waypoints(const Pose& begin, Random& random) {
  std::array<std::vector<Waypoint>, 2> paths;  // exact and with noise
  paths[0] = {waypoint_of(begin)};
  const bool on_the_spot = random.coin(0.7);
  const int turns = 1 + random.below(3);
  for (int k = 0; k < turns; ++k) {
    Waypoint to = paths[0].back();
    if (!on_the_spot) to.position += random_vector(random, random.uniform(0.2e-3, 5e-3));
    const Vector3d turn = random_vector(random, random.uniform(0.1, 1.0));
    to.orientation =
        to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    paths[0].push_back(to);
  }
  paths[1] = paths[0];
  for (Waypoint& waypoint : paths[1])
    waypoint.position += random_vector(random, random.uniform(0.5e-6, kNoise / 2));
  return paths;
}

Resolution coarse(Random& random) {
  return {.ds = 0.02, .dphi = random.uniform(0.1, 0.3), .dalpha = random.uniform(0.1, 0.5)};
}

/// Draws limits with which about half of the paths are solved.
void draw_limits(Limits& limits, Random& random) {
  limits.clearance = 0;
  limits.edges = EdgeMode::kNodes;
  limits.joint_step = random.uniform(0.5, 1.5);
  limits.tool_path_error = std::pow(10, random.uniform(-4, -1.5));
  if (random.coin(0.3)) limits.tool_angle_error = std::pow(10, random.uniform(-3, -0.7));
}

struct Tally {
  int cases = 0, solved = 0, differ = 0;  // `differ`: with noise and without
  double ratio = 0;
};

/// Compares what the plan and the check of a path say of the tool's error with what it is.
void expect_errors_as_outside(const PreparedRobot& robot, const PathProblem& problem,
                              const std::vector<TrajectoryRow>& rows, const Measures& measures,
                              const CheckResult& check, const std::string& what, Tally& tally) {
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain);
  ASSERT_EQ(static_cast<int>(rows.size()), path.size()) << what;
  const double quarters = largest_error(chain, path, rows, [](std::size_t) { return 4; });
  EXPECT_NEAR(1e-3 * measures.tool_path_error_mm.max, quarters, 1e-9) << what;
  EXPECT_LE(quarters, *problem.limits.tool_path_error + 1e-12) << what;
  ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
  const PoseDistance at_waypoints{*problem.limits.tool_path_error,
                                  problem.limits.tool_angle_error.value_or(0.02)};
  const double as_checked = largest_error(chain, path, rows, [&](std::size_t k) {
    const Config &from = rows[k - 1].q, &to = rows[k].q;
    return static_cast<int>(
               tool_motion(chain, from, to, {chain.tool(from), chain.tool(to)}, at_waypoints)
                   .poses.size()) -
           1;
  });
  EXPECT_NEAR(check.worst_path_error, as_checked, 1e-6) << what;
  const double most = largest_error(chain, path, rows, [](std::size_t) { return 1000; });
  EXPECT_LE(most, 1.1 * quarters + 1e-6) << what;
  if (most > 1e-5) tally.ratio = std::max(tally.ratio, most / quarters);
}

/// Makes the tolerances of the tool looser by what the noise of waypoints changes at most.
template <class Limited>
void loosen(Limited& of) {
  of.limits.tool_path_error = *of.limits.tool_path_error + 2 * kNoise;
  if (of.limits.tool_angle_error) of.limits.tool_angle_error = *of.limits.tool_angle_error + 1e-4;
}

PlanOptions with_errors() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.evidence.tool_path_error = true;
  return options;
}

/// Arms of all kinds of lattices: grids of arm angles, arcs, rolls, and both.
TEST(StepSegment, ErrorsOfTurnsOnTheSpotAreFromTheSegmentAndNoiseChangesNoVerdict) {
  const std::uint64_t base = seed("StepSegment");
  TestRobot panda = data_robot("panda_like"), kr6 = data_robot("kr6_like");
  panda.tip_link = kr6.tip_link = "flange";
  const std::vector<TestRobot> robots = {data_robot("iiwa14"),
                                         data_robot("sda10f"),
                                         continuous_robot(),
                                         windings_robot(),
                                         data_robot("iiwa14"),
                                         panda,
                                         kr6};
  Tally tally;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::size_t kind = static_cast<std::size_t>(trial) % robots.size();
    PathProblem problem = problem_for(robots[kind]);
    problem.tool.translation() = Vector3d(random.uniform(0, 0.06), 0, random.uniform(0.05, 0.2));
    if (kind == 4 || kind == 6) problem.roll = Roll{-0.5, 0.5};
    problem.resolution = coarse(random);
    draw_limits(problem.limits, random);
    if (random.coin(0.2) && kind != 2 && kind != 3) problem.limits.tool_speed = 0.1;
    const Chain chain = planning_arm(problem).model.chain;
    const auto paths = short_waypoints(chain.tool(inner_posture(chain, random)), random);
    std::array<PlanStatus, 2> status{};
    for (const std::size_t noisy : {0, 1}) {
      problem.waypoints = paths[noisy];
      const PreparedRobot robot(problem);
      const PlanResult found = plan(robot, problem, with_errors());
      status[noisy] = found.status;
      ++tally.cases;
      if (found.status != PlanStatus::kSolved) continue;
      ++tally.solved;
      expect_errors_as_outside(robot, problem, found.trajectory, found,
                               check_trajectory(robot, problem, found.trajectory), what, tally);
      PathProblem other = problem;
      other.waypoints = paths[1 - noisy];
      loosen(other);
      EXPECT_EQ(plan(other, with_errors()).status, PlanStatus::kSolved) << what << " " << noisy;
    }
    tally.differ += status[0] != status[1];
  }
  std::printf(
      "%d turns and short paths, %d solved, %d verdicts differ; the largest error of a path is up "
      "to %.3f times that at quarters\n",
      tally.cases, tally.solved, tally.differ, tally.ratio);
  EXPECT_GE(tally.solved, at_least(30));
  EXPECT_LE(tally.solved, tally.cases - at_least(10));
  EXPECT_LE(tally.differ, 1 + tally.cases / 100);
}

TEST(StepSegment, StrokesOfJobsHaveTheErrorsOfPaths) {
  const std::uint64_t base = seed("StepSegment.Strokes");
  const TestRobot robot = data_robot("iiwa14");
  Tally tally;
  const int count = trials(12);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem = problem_for(robot);
    const Chain chain = planning_arm(problem).model.chain;
    const Config q = inner_posture(chain, random);
    std::array<Problem, 2> jobs;
    for (Problem& job : jobs) {
      static_cast<swivel::Robot&>(job.arm()) = problem;
      job.source = robot.name;
      job.arm().strokes.resize(2);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      Stroke stroke;
      stroke.name = "stroke " + std::to_string(k);
      stroke.path_frame = robot.base_link;
      stroke.resolution = coarse(random);
      draw_limits(stroke.limits, random);
      Pose begin = chain.tool(q);
      begin.translation() += random_vector(random, 0.05);
      const auto paths = short_waypoints(begin, random);
      for (std::size_t noisy : {0, 1})
        stroke.waypoints = paths[noisy], jobs[noisy].arm().strokes[k] = stroke;
    }
    std::array<PlanStatus, 2> status{};
    for (const std::size_t noisy : {0, 1}) {
      const Problem& job = jobs[noisy];
      const PreparedRobot prepared(problem_of_run(job, {0, false}));
      const Answer found = plan_job(prepared, job, with_errors());
      status[noisy] = found.status;
      ++tally.cases;
      if (found.status != PlanStatus::kSolved) continue;
      ++tally.solved;
      const AnswerCheck check = check_job(prepared, job, found.arm().parts);
      ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
      std::size_t run = 0;
      for (const Part& part : found.arm().parts) {
        if (!part.run) continue;
        expect_errors_as_outside(prepared, problem_of_run(job, *part.run), part.rows,
                                 found.arm().runs[run], check.runs[run], what, tally);
        ++run;
      }
      Problem other = jobs[1 - noisy];
      for (Stroke& stroke : other.arm().strokes) loosen(stroke);
      EXPECT_EQ(plan_job(prepared, other, with_errors()).status, PlanStatus::kSolved)
          << what << " " << noisy;
    }
    tally.differ += status[0] != status[1];
  }
  std::printf("%d jobs, %d solved, %d verdicts differ; largest errors up to %.3f times\n",
              tally.cases, tally.solved, tally.differ, tally.ratio);
  EXPECT_GE(tally.solved, at_least(4));
  EXPECT_LE(tally.differ, 1);
}

/// One arm turns on the spot while the other one follows its line.
TEST(StepSegment, TwoArmsHaveTheErrorsOfPaths) {
  const std::uint64_t base = seed("StepSegment.TwoArms");
  TestRobot robot = data_robot("sda10f");
  Tally tally;
  const int count = trials(12);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    std::array<Problem, 2> cells;
    cells[0] = random_workcell(robot, random);
    Pose begin;
    begin.translation() = cells[0].arms[0].path().waypoints[0].position;
    begin.linear() = cells[0].arms[0].path().waypoints[0].orientation.toRotationMatrix();
    draw_limits(cells[0].arms[0].path().limits, random);
    auto paths = short_waypoints(begin, random);
    cells[1] = cells[0];
    for (const std::size_t noisy : {0, 1}) {
      paths[noisy].resize(2);  // waypoints of both arms belong together
      cells[noisy].arms[0].path().waypoints = paths[noisy];
      cells[noisy].arms[0].path().resolution.dalpha = 0.2;
    }
    std::array<PlanStatus, 2> status{};
    for (const std::size_t noisy : {0, 1}) {
      const PreparedWorkcell prepared(cells[noisy]);
      const Answer found = plan_workcell(prepared, with_errors());
      status[noisy] = found.status;
      ++tally.cases;
      if (found.status != PlanStatus::kSolved) continue;
      ++tally.solved;
      const AnswerCheck check = check_workcell(prepared, rows_of_arms(found));
      ASSERT_TRUE(check.passed) << what;
      for (std::size_t k = 0; k < 2; ++k)
        expect_errors_as_outside(prepared.robot(k), prepared.problem(k), found.arms[k].rows(),
                                 found.arms[k].run(), check.runs[k], what, tally);
      Problem other = cells[1 - noisy];
      for (ArmTask& arm : other.arms) loosen(arm.path());
      EXPECT_EQ(plan_workcell(PreparedWorkcell(other), with_errors()).status, PlanStatus::kSolved)
          << what << " " << noisy;
    }
    tally.differ += status[0] != status[1];
  }
  std::printf("%d workcells, %d solved, %d verdicts differ; largest errors up to %.3f times\n",
              tally.cases, tally.solved, tally.differ, tally.ratio);
  EXPECT_GE(tally.solved, at_least(4));
  EXPECT_LE(tally.differ, 1);
}

}  // namespace
}  // namespace swivel
