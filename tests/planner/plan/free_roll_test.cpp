// SPDX-License-Identifier: BSD-3-Clause
// A tool that is free to turn about its own z axis: its path is position and axis alone, whichever
// way the x axes of the waypoints point.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "joint_cost.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/problem/axis_frames.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Ways to write the same positions and z axes: x axes that are carried along, that point along the
/// path, all one way in the plane, and to and fro from line to line.
constexpr std::array<const char*, 4> kWays{"normals", "tangents", "one way", "zigzag"};

/// A raster on a curved surface, as waypoints with frames of each of kWays.
struct Raster {
  explicit Raster(Random& random, const Vector3d& middle) {
    const double bend = random.uniform(-1.5, 1.5), tilt = random.uniform(-0.3, 0.3);
    const int lines = 2 + random.below(2), points = 4;
    const double pitch = random.uniform(0.01, 0.03), length = random.uniform(0.05, 0.12);
    for (int line = 0; line < lines; ++line)
      for (int k = 0; k < points; ++k) {
        const double along = length * (k / (points - 1.0) - 0.5),
                     y = line % 2 == 0 ? along : -along, x = pitch * line;
        position.push_back(middle + Vector3d(x, y, bend * y * y / 2 + tilt * x));
        axis.push_back(-Vector3d(-tilt, -bend * y, 1).normalized());
        line_of.push_back(line);
      }
  }
  [[nodiscard]] std::vector<Waypoint> written(std::size_t way) const {
    std::vector<Waypoint> waypoints;
    for (std::size_t k = 0; k < position.size(); ++k) {
      const std::size_t to = k + 1 < position.size() ? k + 1 : k;
      Vector3d x = way == 1   ? Vector3d(position[to] - position[to - 1])
                   : way == 2 ? Vector3d(Vector3d::UnitY())
                              : Vector3d((line_of[k] % 2 == 0 ? 1 : -1) * Vector3d::UnitY());
      x = (x - x.dot(axis[k]) * axis[k]).normalized();
      Matrix3d frame;
      frame << x, axis[k].cross(x), axis[k];
      waypoints.push_back({position[k], Quaterniond(frame).normalized()});
    }
    if (way == 0) carry_frames(waypoints);
    return waypoints;
  }
  std::vector<Vector3d> position, axis;
  std::vector<int> line_of;
};

/// A problem without a path: an S-R-S arm or one of six joints with a torch at an angle.
PathProblem free_problem(bool srs) {
  PathProblem problem;
  problem.source = srs ? "iiwa14" : "kr6_like";
  problem.model = io::load_robot(data_dir() / "robots" / (problem.source + ".urdf"),
                                 data_dir() / "robots" / (problem.source + ".srdf"));
  problem.base_link = "base_link";
  problem.tip_link = srs ? "tool0" : "flange";
  problem.tool = Eigen::Translation3d(0.05, 0, 0.15) * Eigen::AngleAxisd(0.5, Vector3d::UnitY());
  problem.roll = Roll{};
  problem.resolution.ds = 0.01;
  problem.resolution.dphi = 0.2;
  problem.resolution.droll = 0.3;
  return problem;
}

Vector3d middle_of(bool srs) {
  return srs ? Vector3d(0.5, 0, 0.3) : Vector3d(0.5, 0, 0.2);
}

PlanOptions lazily() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  return options;
}

/// Holds the roll that rows state against their joints: the tool stands turned by it from the
/// waypoint's own orientation.
void expect_stated_rolls(const PathProblem& problem, const PreparedRobot& robot,
                         const std::vector<TrajectoryRow>& rows, const std::string& what) {
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain);
  ASSERT_EQ(static_cast<int>(rows.size()), path.size()) << what;
  for (int i = 0; i < path.size(); ++i) {
    const int waypoint = path.layer(i).waypoint;
    if (waypoint < 0) continue;
    const TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
    const Waypoint& own = problem.waypoints[static_cast<std::size_t>(waypoint)];
    const Matrix3d wanted = own.orientation.normalized().toRotationMatrix(),
                   tool = chain.tool(row.q).linear();
    const Matrix3d stated =
        chain.roll ? wanted : Matrix3d(wanted * Eigen::AngleAxisd(row.roll, Vector3d::UnitZ()));
    ASSERT_LE((stated - tool).norm(), 1e-6) << what << " row " << i;
  }
}

TEST(FreeRoll, CountsPositionsAndAxesAlone) {
  const std::uint64_t base = seed("FreeRoll");
  int solved = 0, wide = 0;
  const int rasters = trials(12);
  for (int trial = 0; trial < rasters; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const bool srs = trial % 2 == 0;
    const Raster raster(random, middle_of(srs));
    std::vector<double> costs;
    for (std::size_t way = 0; way < kWays.size(); ++way) {
      const std::string what = "trial " + std::to_string(trial) + ' ' + kWays[way];
      PathProblem problem = free_problem(srs);
      problem.waypoints = raster.written(way);
      const PreparedRobot robot(problem);
      const PlanResult result = plan(robot, problem, lazily());
      costs.push_back(result.status == PlanStatus::kSolved ? result.cost : -1);
      if (result.status != PlanStatus::kSolved) continue;
      ++solved;
      expect_stated_rolls(problem, robot, result.trajectory, what);
      const CheckResult check = check_trajectory(robot, problem, result.trajectory);
      ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
      ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
      ASSERT_NEAR(cost_of_joints(result.trajectory, !srs), result.cost, 1e-9) << what;
      if (trial >= 4) continue;
      TimingOptions timing;
      timing.speed = 0.05;
      const MotionResult motion = time_trajectory(robot, problem, result.trajectory, timing);
      if (!motion.motion) continue;
      ++wide;
      const CheckResult timed = check_motion(robot, problem, motion.motion->rows);
      ASSERT_TRUE(timed.passed) << what << ": " << timed.failures.front();
    }
    for (const double cost : costs) ASSERT_NEAR(cost, costs.front(), 1e-9) << "trial " << trial;
  }
  std::printf("%d rasters, %d solved, %d motions\n", rasters, solved, wide);
  EXPECT_GE(solved, at_least_among(24));
}

TEST(FreeRoll, CountsAxesAloneInStrokes) {
  const std::uint64_t base = seed("FreeRollStrokes");
  int solved = 0;
  for (int trial = 0; trial < trials(4); ++trial) {
    Random random(base + 1000 + static_cast<std::uint64_t>(trial));
    const bool srs = trial % 2 == 0;
    const Raster first(random, middle_of(srs)),
        second(random, middle_of(srs) + Vector3d(0.08, 0.05, 0));
    std::vector<double> costs;
    for (std::size_t way = 0; way < kWays.size(); ++way) {
      const PathProblem problem = free_problem(srs);
      Problem job;
      static_cast<Robot&>(job.arm()) = problem;
      job.source = problem.source;
      for (const Raster* raster : {&first, &second}) {
        Stroke stroke;
        static_cast<Task&>(stroke) = problem;
        stroke.name = raster == &first ? "first" : "second";
        stroke.waypoints = raster->written(way);
        stroke.approach = stroke.retract = Vector3d(0, 0, -0.02);
        job.arm().strokes.push_back(stroke);
      }
      const PreparedRobot robot(problem_of_run(job, {0, false}));
      const Answer result = plan_job(robot, job, lazily());
      costs.push_back(result.status == PlanStatus::kSolved ? result.cost : -1);
      if (result.status != PlanStatus::kSolved) continue;
      ++solved;
      const AnswerCheck check = check_job(robot, job, result.arm().parts);
      ASSERT_TRUE(check.passed) << "trial " << trial << ' ' << kWays[way];
    }
    for (const double cost : costs) ASSERT_NEAR(cost, costs.front(), 1e-9) << "trial " << trial;
  }
  EXPECT_GE(solved, at_least_among(8));
}

}  // namespace
}  // namespace swivel
