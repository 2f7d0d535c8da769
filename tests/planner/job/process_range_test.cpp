// SPDX-License-Identifier: BSD-3-Clause
// Where the process of a stroke begins and ends, and how fast the tool may be there: strokes that
// go straight on from their approach, and motions that are faster than the job asks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

Problem load(const char* name) {
  return io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/" + name);
}

/// Returns a job of one stroke, a hole of 33 mm above a casting: the tool goes along its own axis,
/// as it does on the approach.
Problem drilling(bool reversible) {
  Problem job = load("iiwa14_bench_job.yaml");
  job.arm().strokes.resize(1);
  Stroke& stroke = job.arm().strokes.front();
  stroke.reversible = reversible;
  stroke.approach = stroke.retract = Vector3d(0, 0, -0.02);
  stroke.resolution.ds = 0.02;
  stroke.waypoints = {stroke.waypoints.front(), stroke.waypoints.front()};
  stroke.waypoints[0].position.z() += 0.053;
  stroke.waypoints[1].position.z() += 0.02;
  return job;
}

TEST(ProcessRange, BeginsAtTheFirstWaypointWhereTheApproachGoesOnIntoTheStroke) {
  const Problem job = drilling(false);
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  const Answer plan = plan_job_motion(robot, job, {}, false, TimingOptions{});
  ASSERT_EQ(plan.status, PlanStatus::kSolved);
  for (const Part& part : plan.arm().parts) {
    if (!part.run) continue;
    const std::vector<bool> process = process_of_rows(part, job);
    const auto on = std::find(process.begin(), process.end(), true);
    ASSERT_NE(on, process.end());
    const auto first = static_cast<std::size_t>(on - process.begin());
    EXPECT_NEAR(part.rows[first].s, 0.02, 1e-9);
    const auto last = static_cast<std::size_t>(process.rend() -
                                               std::find(process.rbegin(), process.rend(), true)) -
                      1;
    EXPECT_NEAR(part.rows[last].s, 0.053, 1e-9);
  }
  ASSERT_TRUE(plan.timed());
  const std::vector<ProcessEvent>& events = plan.timed()->arms.front().events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_NEAR(events[0].s, 0.02, 1e-3);
  EXPECT_NEAR(events[1].s, 0.053, 1e-3);
  const AnswerCheck check = check_job_motion(robot, job, {{0, false}}, plan.timed()->arms.front());
  EXPECT_TRUE(check.passed) << check.failures.front();
}

/// Both directions of both ends, and strokes that bend or whose waypoints are one line.
TEST(ProcessRange, EndsOfStrokesAreLayers) {
  Problem job = drilling(true);
  Stroke& stroke = job.arm().strokes.front();
  const auto layers = [&](bool reversed) {
    const PathProblem problem = problem_of_run(job, {0, reversed});
    const ToolPath path(problem.waypoints, problem.resolution, "", {}, {}, false, problem.steps);
    std::vector<int> waypoints;
    for (int i = 0; i < path.size(); ++i)
      if (path.layer(i).waypoint >= 0) waypoints.push_back(path.layer(i).waypoint);
    return waypoints;
  };
  EXPECT_EQ(layers(false), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(layers(true), (std::vector<int>{0, 1, 2, 3}));  // the retract goes on
  stroke.waypoints.insert(stroke.waypoints.begin() + 1, stroke.waypoints.front());
  stroke.waypoints[1].position.z() -= 0.01;
  EXPECT_EQ(layers(false), (std::vector<int>{0, 1, 2, 3, 4}));
  stroke.approach.setZero();
  EXPECT_EQ(layers(false), (std::vector<int>{0, 2, 3}));  // on the line from end to end
  stroke.approach = Vector3d(0, 0.02, 0);
  EXPECT_EQ(layers(false), (std::vector<int>{0, 1, 3, 4}));
}

/// Executes a motion faster.
void speed_up(ArmMotion& motion, double factor) {
  for (TimedRow& row : motion.rows) {
    row.t /= factor;
    row.v *= factor;
    row.a *= factor * factor;
  }
  for (ProcessEvent& event : motion.events) event.t /= factor;
  motion.rate *= factor;
  motion.duration /= factor;
}

/// A job of one slow stroke.
struct SlowJob {
  SlowJob() : job(load("iiwa14_bench_job.yaml")), robot(problem_of_run(job, {0, false})) {
    job.arm().strokes.resize(1);
    job.arm().strokes.front().reversible = false;
    job.arm().rapid = 0.1;
    job.arm().process_speed = 0.02;
    job.arm().approach_speed = 0.03;
  }
  [[nodiscard]] AnswerCheck check(const ArmMotion& motion, std::optional<double> speed = {}) const {
    return check_job_motion(robot, job, {{0, false}}, motion, {.margins = false, .speed = speed});
  }
  Problem job;
  PreparedRobot robot;
};

TEST(ToolSpeed, FasterThanTheJobAsksIsRefused) {
  SlowJob slow;
  const Answer plan = plan_job_motion(slow.robot, slow.job, {}, false, TimingOptions{});
  ASSERT_TRUE(plan.timed());
  ArmMotion motion = plan.timed()->arms.front();
  const AnswerCheck as_asked = slow.check(motion);
  EXPECT_TRUE(as_asked.passed) << as_asked.failures.front();
  speed_up(motion, 1.05);
  const AnswerCheck faster = slow.check(motion);
  ASSERT_FALSE(faster.passed);
  const auto names_speed = [](const std::string& line) {
    return line.find("stroke 'bead_0': rows ") == 0 &&
           line.find("the tool moves at 0.0") != std::string::npos &&
           line.find("the speed asked for there") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(faster.failures.begin(), faster.failures.end(), names_speed))
      << faster.failures.front();
}

TEST(ToolSpeed, IsThatOfThePlaceOrTheOneGivenForAll) {
  SlowJob slow;
  const Answer fast =
      plan_job_motion(slow.robot, slow.job, {}, false, TimingOptions{.speed = 0.04});
  ASSERT_TRUE(fast.timed());
  EXPECT_FALSE(slow.check(fast.timed()->arms.front()).passed);
  EXPECT_TRUE(slow.check(fast.timed()->arms.front(), 0.04).passed);
  // A feed stands in place of the job's speed, along the stroke alone.
  slow.job.arm().strokes.front().feed = {0.05, 0.05};
  EXPECT_TRUE(slow.check(fast.timed()->arms.front()).passed);
  slow.job.arm().approach_speed = 0.01;
  EXPECT_FALSE(slow.check(fast.timed()->arms.front()).passed);
}

}  // namespace
}  // namespace swivel
