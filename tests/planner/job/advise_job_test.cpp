// SPDX-License-Identifier: BSD-3-Clause
// Jobs that cannot be planned: what is said of them, and advice that holds.
#include <gtest/gtest.h>

#include <algorithm>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"

namespace swivel {
namespace {

using Change = Advice::Change;

/// The first strokes of the car door's job, on coarse lattices.
Problem door_of(std::size_t strokes) {
  Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/door_job.yaml");
  job.arm().strokes.resize(strokes);
  for (Stroke& stroke : job.arm().strokes) {
    stroke.resolution.ds = 0.02;
    stroke.resolution.dphi = 0.1;
  }
  return job;
}

/// A job, its verdict and what is advised.
struct Advised {
  explicit Advised(const Problem& job)
      : robot(problem_of_run(job, {0, false})),
        result(plan_job(robot, job)),
        advice(advise_job(robot, job, result, thirty_seconds())) {}
  static PlanOptions thirty_seconds() {
    PlanOptions options;
    options.timeout_s = 30;
    return options;
  }
  [[nodiscard]] const Advice* find(Change change) const {
    for (const Advice& one : advice.changes)
      if (one.change == change) return &one;
    return nullptr;
  }
  PreparedRobot robot;
  Answer result;
  AdviceList advice;
};

void expect_solved(const Advice* advice, const PreparedRobot& robot, const Problem& changed) {
  ASSERT_NE(advice, nullptr);
  ASSERT_EQ(advice->outcome, Advice::Outcome::kSolved) << words(*advice);
  const Answer found = plan_job(robot, changed);
  ASSERT_EQ(found.status, PlanStatus::kSolved) << words(*advice);
  EXPECT_EQ(found.cost, *advice->cost) << words(*advice);
}

TEST(AdviseJob, LeavesOutStrokesThatHaveNoPath) {
  Problem job = door_of(3);
  for (Waypoint& waypoint : job.arm().strokes[1].waypoints) waypoint.position.x() += 3;
  const Advised advised(job);
  ASSERT_EQ(advised.result.status, PlanStatus::kInfeasible);
  EXPECT_FALSE(advised.result.arm().no_transition);
  const Advice* without = advised.find(Change::kWithoutStrokes);
  ASSERT_NE(without, nullptr);
  EXPECT_EQ(without->strokes, std::vector<std::string>{job.arm().strokes[1].name});
  Problem changed = job;
  changed.arm().strokes.erase(changed.arm().strokes.begin() + 1);
  expect_solved(without, advised.robot, changed);
  EXPECT_EQ(advised.find(Change::kReversed), nullptr);  // it has no path either way
  ASSERT_EQ(advised.advice.alone.size(), 1u);
  EXPECT_EQ(advised.advice.alone.front().name, job.arm().strokes[1].name);
  EXPECT_FALSE(advised.advice.alone.front().advice.empty());
}

TEST(AdviseJob, MovesAHomeThatIsBarred) {
  Problem job = door_of(1);
  (*job.arm().home)[0] -= 0.6;  // away from the door, so that the stroke is free
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  SceneObject ball;
  ball.name = "ball";
  ball.shape = Sphere{0.03};
  ball.pose = robot.arm().chain.tool(*job.arm().home);
  job.scene.push_back(ball);
  const Advised advised(job);
  ASSERT_TRUE(advised.result.arm().no_transition);
  EXPECT_EQ(advised.result.arm().no_transition->where, NoTransition::Where::kHome);
  EXPECT_EQ((*advised.result.arm().no_transition->bodies)[1], "ball")
      << (*advised.result.arm().no_transition->bodies)[0];
  const Advice* home = advised.find(Change::kHome);
  ASSERT_NE(home, nullptr);
  ASSERT_TRUE(home->home);
  Problem changed = job;
  changed.arm().home = home->home;
  expect_solved(home, advised.robot, changed);
}

/// Strokes may come nearer to the door than transitions: their ends are told once, not pair by
/// pair, and longer lines help.
TEST(AdviseJob, LengthensLinesWhereEndsAreTooNear) {
  Problem job = door_of(2);
  job.arm().transition_limits.clearance = 0.06;
  job.arm().transition_limits.self_clearance = 0.005;
  for (Stroke& stroke : job.arm().strokes) stroke.approach = stroke.retract = Vector3d::Zero();
  const Advised advised(job);
  ASSERT_EQ(advised.result.status, PlanStatus::kInfeasible);
  ASSERT_TRUE(advised.result.arm().no_transition);
  const auto where = advised.result.arm().no_transition->where;
  EXPECT_TRUE(where == NoTransition::Where::kEndBefore || where == NoTransition::Where::kBegin);
  ASSERT_TRUE(advised.result.arm().no_transition->bodies);
  EXPECT_EQ((*advised.result.arm().no_transition->bodies)[1], "door");
  EXPECT_EQ(advised.result.arm().transitions.searches, 0);
  const Advice* lines = advised.find(Change::kLines);
  ASSERT_NE(lines, nullptr);
  ASSERT_TRUE(lines->length);
  EXPECT_EQ(&advised.advice.changes.front(), lines);  // what helps comes first
  Problem changed = job;
  for (Stroke& stroke : changed.arm().strokes)
    stroke.approach = stroke.retract = Vector3d(0, 0, -*lines->length);
  expect_solved(lines, advised.robot, changed);
  EXPECT_NE(advice_text(advised.advice).find("would help: approach and retract of "),
            std::string::npos);
}

TEST(AdviseJob, NothingWhereThereIsAJob) {
  const Problem job = door_of(1);
  const Advised advised(job);
  EXPECT_EQ(advised.result.status, PlanStatus::kSolved);
  EXPECT_TRUE(advised.advice.changes.empty());
  EXPECT_TRUE(advised.advice.alone.empty());
}

}  // namespace
}  // namespace swivel
