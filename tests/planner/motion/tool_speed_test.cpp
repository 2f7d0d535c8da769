// SPDX-License-Identifier: BSD-3-Clause
// How fast the tool of a motion is, by the forward kinematics of its rows: never faster than asked.
#include <gtest/gtest.h>

#include <cmath>

#include "motion_problem.hpp"
#include "robots.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

struct Fastest {
  double along = 0, turning = 0;  ///< m/s and rad/s, over the move from a row to the next
};
Fastest fastest(const Chain& chain, const TimedPath& motion) {
  Fastest most;
  Pose before = chain.tool(motion.rows[0].row.q);
  for (std::size_t k = 1; k < motion.rows.size(); ++k) {
    const Pose tool = chain.tool(motion.rows[k].row.q);
    most.along =
        std::max(most.along, (tool.translation() - before.translation()).norm() * motion.rate);
    most.turning = std::max(
        most.turning,
        Eigen::AngleAxisd(before.linear().transpose() * tool.linear()).angle() * motion.rate);
    before = tool;
  }
  return most;
}

struct Case {
  TestRobot robot;
  std::optional<Roll> roll;
};
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const TestRobot& robot : all_robots()) all.push_back({robot, {}});
  for (const char* name : {"panda_like", "xarm7_like", "gen3_like", "fetch_like", "kr6_like"}) {
    TestRobot robot = data_robot(name);
    robot.tip_link = "flange";
    all.push_back(
        {robot, std::string(name) == "kr6_like" ? std::optional(Roll{-1.5, 1.5}) : std::nullopt});
  }
  return all;
}

/// A random problem of an arm and how its motion is timed.
struct SpeedTask {
  PathProblem problem;
  double speed = 0;            ///< of the tool, m/s
  std::optional<double> turn;  ///< speed of the tool's rotation, rad/s
  double rate = 0;             ///< rows per second
  bool limit = false;          ///< whether the speeds are limits of the problem
  bool spot = false;           ///< whether the tool turns on the spot
};

/// Draws a problem, a speed of the tool and a rate at which the motion has few rows.
SpeedTask random_speed_task(const Case& which, Random& random) {
  constexpr double kRows = 6000;  // that a motion has at most, about
  SpeedTask task;
  PathProblem& problem = task.problem;
  problem = with_motion_defaults(motion_problem(which.robot, random, which.roll));
  task.speed = 0.0005 * std::pow(1000, random.uniform(0, 1));  // 0.5 mm/s to 0.5 m/s
  double length = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k) {
    const double way = (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
    length += way;
    task.spot = task.spot || way == 0;
  }
  const double rates[] = {20, 125, 250, 1000};
  task.rate =
      std::min(rates[random.below(4)], std::max(5.0, std::floor(kRows * task.speed / length)));
  task.turn = random.coin() ? std::optional(random.uniform(0.05, 1)) : std::nullopt;
  task.limit = random.coin();
  if (task.limit)
    problem.limits.tool_speed = task.speed, problem.limits.tool_turn_speed = task.turn;
  return task;
}

/// Counts the motions, and which of them are fast, slow or limited.
struct SpeedCounts {
  int timed = 0, as_fast = 0, slowest = 0, with_turn = 0, limited = 0, on_the_spot = 0;
};

/// Plans and times one problem and expects the tool to be no faster than asked.
void check_speed(const SpeedTask& task, const std::string& trace, Random& random,
                 SpeedCounts& counts) {
  const auto& [problem, speed, turn, rate, limit, spot] = task;
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Planner planner(problem);
  // A limit of the problem is kept by motions that are asked to be faster as well.
  const MotionPlan plan =
      plan_motion(planner, options, random.coin(),
                  TimingOptions{.speed = limit ? 1.5 * speed : speed,
                                .turn_speed = limit || !turn ? std::nullopt : turn,
                                .rate = rate});
  if (!plan.motion || !plan.motion->motion) return;
  SCOPED_TRACE(trace + ", " + std::to_string(speed) + " m/s, " + std::to_string(rate));
  const TimedPath& motion = *plan.motion->motion;
  const PreparedRobot robot(problem);
  const Fastest most = fastest(robot.arm().chain, motion);
  const double rounding = 1e-9 * rate;  // m/s and rad/s, of joints by Newton steps
  EXPECT_LE(most.along, speed * (1 + 1e-6) + rounding);
  if (turn) {
    EXPECT_LE(most.turning, *turn * (1 + 1e-6) + rounding);
  }
  EXPECT_EQ(motion.speed, speed);
  const CheckResult check = check_motion(robot, problem, motion.rows);
  EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
  ++counts.timed;
  counts.as_fast += most.along > 0.99 * speed;
  counts.slowest += speed < 0.002;
  counts.with_turn += turn.has_value();
  counts.limited += limit;
  counts.on_the_spot += spot;
}

TEST(ToolSpeed, IsAtMostTheOneAskedFor) {
  const std::uint64_t base = seed("ToolSpeed");
  const std::vector<Case> all = cases();
  SpeedCounts counts;
  for (int trial = 0; trial < trials(90); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Case& which = all[static_cast<std::size_t>(trial) % all.size()];
    const SpeedTask task = random_speed_task(which, random);
    check_speed(task, which.robot.name + " " + std::to_string(trial), random, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d motions, %d as fast as asked, %d below 2 mm/s, %d with a turn speed, %d with limits, %d "
      "that turn on the spot\n",
      counts.timed, counts.as_fast, counts.slowest, counts.with_turn, counts.limited,
      counts.on_the_spot);
  EXPECT_GE(counts.timed, at_least(25));
  EXPECT_GE(counts.as_fast, at_least(15));
  EXPECT_GE(counts.slowest, at_least(3));
  EXPECT_GE(counts.with_turn, at_least(8));
  EXPECT_GE(counts.limited, at_least(8));
  EXPECT_GE(counts.on_the_spot, at_least(5));
}

/// The tool comes out of a turn on the spot into a straight line: travel that was nearly all
/// rotation becomes all way within the rounded corner.
TEST(ToolSpeed, IsKeptWhereATurnOnTheSpotBecomesALine) {
  TestRobot fetch = data_robot("fetch_like");
  fetch.tip_link = "flange";
  PathProblem problem = problem_for(fetch);
  problem.tool.translation() = Vector3d(0.012961861183245462, 0, 0.1384121636511872);
  problem.tool.linear() = Eigen::AngleAxisd(0.785, Vector3d::UnitY()).toRotationMatrix();
  const auto add = [&](const Vector3d& xyz, double w, double x, double y, double z) {
    Waypoint waypoint;
    waypoint.position = xyz;
    waypoint.orientation = Quaterniond(w, x, y, z);
    problem.waypoints.push_back(waypoint);
  };
  add({0.7171862732968365, -0.7070783629853588, 0.6728291633388533}, 0.1099952610863626,
      0.17063477276616174, -0.11008714696812683, 0.9729674387840537);
  add({0.7210132803836177, -0.6936896365754414, 0.6652827534388923}, 0.24944277930097308,
      0.20502158160852255, -0.12296494622040632, 0.9384157250016427);
  add({0.7210132803836177, -0.6936896365754414, 0.6652827534388923}, 0.2920107249735096,
      0.22874116913106193, -0.1450290390788861, 0.9172642977184141);
  add({0.7414693602202809, -0.6692054138603837, 0.6272145042887389}, 0.20961693482963642,
      0.25478450124420293, -0.22455965490641526, 0.9168825895105774);
  problem.resolution.ds = 0.01;
  problem.limits.clearance = 0.005;
  problem.limits.tool_path_error = 0.002;
  problem.limits.joint_acceleration.emplace().fill(10);
  problem.limits.joint_jerk.emplace().fill(100);
  problem.limits.tool_speed = 0.001;
  problem = with_motion_defaults(problem);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Planner planner(problem);
  const MotionPlan plan = plan_motion(planner, options, false,
                                      TimingOptions{.speed = 0.001, .turn_speed = {}, .rate = 250});
  ASSERT_TRUE(plan.motion && plan.motion->motion);
  const TimedPath& motion = *plan.motion->motion;
  std::printf("%.3f s, %.3f s at the speed asked for throughout\n", motion.duration, motion.ideal);
  EXPECT_LE(fastest(PreparedRobot(problem).arm().chain, motion).along, 0.001 * (1 + 2e-6));
  EXPECT_LE(motion.duration, 1.01 * motion.ideal);
}

TEST(ToolSpeed, LimitsAreKeptAndSaid) {
  Random random(seed("ToolSpeedSaid"));
  PathProblem problem = with_motion_defaults(motion_problem(data_robot("iiwa14"), random));
  problem.limits.tool_speed = 0.02;
  problem.limits.tool_turn_speed = 0.1;
  Planner planner(problem);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const auto warnings = [&](const TimingOptions& timing) {
    const MotionPlan plan = plan_motion(planner, options, false, timing);
    EXPECT_TRUE(plan.motion && plan.motion->motion);
    std::string lines;
    if (plan.motion && plan.motion->motion)
      for (const std::string& line : plan.motion->motion->warnings) lines += line + '\n';
    return lines;
  };
  const std::string both = warnings({.speed = 0.05, .turn_speed = 0.5, .rate = 100});
  EXPECT_NE(both.find("limits.tool_speed allows 0.02 m/s"), std::string::npos) << both;
  EXPECT_NE(both.find("limits.tool_turn_speed allows 0.1 rad/s"), std::string::npos) << both;
  problem.limits.tool_speed = problem.limits.tool_turn_speed = std::nullopt;
  planner.set_task(problem);
  const char* const decides =
      "joint jerks are stated neither by the URDF nor as limits.joint_jerk: 100 rad/s^3 is "
      "assumed, and this decides";
  EXPECT_NE(warnings({.speed = 0.5, .turn_speed = {}, .rate = 250}).find(decides),
            std::string::npos);
  const std::string slow = warnings({.speed = 0.001, .turn_speed = 0.01, .rate = 20});
  EXPECT_NE(slow.find("100 rad/s^3 is assumed\n"), std::string::npos) << slow;  // nothing more
  const std::string none = warnings({.speed = 0.02, .turn_speed = {}, .rate = 100});
  EXPECT_EQ(none.find("limits.tool"), std::string::npos) << none;
}

}  // namespace
}  // namespace swivel
