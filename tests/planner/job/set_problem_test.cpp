// SPDX-License-Identifier: BSD-3-Clause
// A planner whose problem is replaced, over and over: its answers are those of a new planner, bit
// for bit, of one path, of jobs and of two arms; also where the kind, the robot or the tool change.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "random_jobs.hpp"
#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "two_arms.hpp"

namespace swivel {
namespace {

using namespace test;

/// Expects the same answers of all arms, bit for bit.
void expect_same_answers(const Answer& a, const Answer& b, const std::string& what) {
  ASSERT_EQ(a.status, b.status) << what;
  ASSERT_EQ(a.cost, b.cost) << what;
  ASSERT_EQ(a.bound, b.bound) << what;
  ASSERT_EQ(a.arms.size(), b.arms.size()) << what;
  ASSERT_EQ(a.warnings, b.warnings) << what;
  for (std::size_t arm = 0; arm < a.arms.size(); ++arm) {
    const std::vector<Part>&own = a.arms[arm].parts, &other = b.arms[arm].parts;
    ASSERT_EQ(own.size(), other.size()) << what;
    for (std::size_t k = 0; k < own.size(); ++k) {
      ASSERT_EQ(own[k].run, other[k].run) << what;
      ASSERT_EQ(own[k].cost, other[k].cost) << what;
      ASSERT_EQ(own[k].rows.size(), other[k].rows.size()) << what;
      for (std::size_t i = 0; i < own[k].rows.size(); ++i)
        ASSERT_EQ(own[k].rows[i].q, other[k].rows[i].q) << what;
    }
  }
  ASSERT_EQ(a.timed() != nullptr, b.timed() != nullptr) << what;
  if (a.timed() == nullptr) return;
  for (std::size_t arm = 0; arm < a.arms.size(); ++arm) {
    const std::vector<TimedRow>&own = a.timed()->arms[arm].rows, &other = b.timed()->arms[arm].rows;
    ASSERT_EQ(own.size(), other.size()) << what;
    for (std::size_t i = 0; i < own.size(); ++i) ASSERT_EQ(own[i].row.q, other[i].row.q) << what;
  }
}

void move_something(std::vector<SceneObject>& scene, Random& random) {
  if (scene.empty() || random.coin(0.2)) {
    SceneObject& post = scene.emplace_back();
    post.name = "post " + std::to_string(scene.size()) + " " + std::to_string(random.below(10000));
    post.shape = Cylinder{0.02, 0.4};
    post.pose.translation() =
        Vector3d(random.uniform(0.3, 0.8), random.uniform(-0.5, 0.5), random.uniform(0, 1));
    return;
  }
  SceneObject& object =
      scene[static_cast<std::size_t>(random.below(static_cast<int>(scene.size())))];
  for (int axis = 0; axis < 3; ++axis)
    object.pose.translation()[axis] += random.uniform(-0.01, 0.01);
}

/// Changes a job as a user would between plans.
void change_job(const Problem& whole, Problem& job, Random& random) {
  switch (random.below(6)) {
    case 0:
      job.arm().home = random.coin() ? whole.arm().home : std::nullopt;
      break;
    case 1:
      job.arm().strokes = whole.arm().strokes;
      job.arm().strokes.resize(static_cast<std::size_t>(2 + random.below(2)));
      for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.04, .dphi = 0.25};
      break;
    case 2:
      for (Stroke& stroke : job.arm().strokes)
        stroke.limits.clearance = random.uniform(0.001, 0.006);
      break;
    case 3:
      for (Waypoint& waypoint : job.arm().strokes.front().waypoints)
        waypoint.position.x() += random.uniform(-0.005, 0.005);
      break;
    default:
      move_something(job.scene, random);
  }
}

void change_two_arms(Problem& cell, Random& random) {
  ArmTask& arm = cell.arms[static_cast<std::size_t>(random.below(2))];
  switch (random.below(4)) {
    case 0:
      for (Waypoint& waypoint : arm.path().waypoints)
        waypoint.position.y() += random.uniform(-0.02, 0.02);
      break;
    case 1:
      arm.attached.front().pose.translation().x() += 0.001;
      break;
    default:
      move_something(cell.scene, random);
  }
}

struct Met {
  int plans = 0, solved = 0;
};

/// Plans a problem anew and by a planner that planned others before, and expects the same.
void expect_as_new(ProblemPlanner& kept, const Problem& problem, const MotionRequest& asked,
                   const std::string& what, Met& met) {
  kept.set_problem(problem);
  const Answer found = kept.plan({.threads = 2});
  expect_same_answers(found, ProblemPlanner(problem, asked).plan({.threads = 1}), what);
  ++met.plans;
  met.solved += found.has_rows();
}

TEST(SetProblem, JobsAreThoseOfANewPlanner) {
  Random random(seed("SetProblem.Jobs"));
  const JobCase door("door_job.yaml");
  Met met;
  const int count = trials(150);
  for (int series = 0; series * 10 < count; ++series) {
    MotionRequest asked;
    if (series % 3 == 1) asked.refine = true;
    if (series % 3 == 2) asked.timing = TimingOptions{.rate = 20};
    Problem job = door.job;
    job.arm().strokes.resize(2);
    for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.04, .dphi = 0.25};
    ProblemPlanner kept(job, asked);
    for (int k = 0; k < 10; ++k) {
      change_job(door.job, job, random);
      expect_as_new(kept, job, asked, "job " + std::to_string(10 * series + k), met);
      if (HasFatalFailure()) return;
    }
  }
  std::printf("%d plans, %d solved\n", met.plans, met.solved);
  EXPECT_GE(met.solved, at_least(60));
}

TEST(SetProblem, TwoArmsAreThoseOfANewPlanner) {
  Random random(seed("SetProblem.TwoArms"));
  const TestRobot robot = data_robot("sda10f");
  Met met;
  const int count = trials(150);
  for (int series = 0; series * 10 < count; ++series) {
    MotionRequest asked;
    if (series % 3 == 1) asked.refine = true;
    if (series % 3 == 2) asked.timing = TimingOptions{.speed = 0.05, .rate = 20};
    Problem cell = random_workcell(robot, random);
    ProblemPlanner kept(cell, asked);
    for (int k = 0; k < 10; ++k) {
      change_two_arms(cell, random);
      expect_as_new(kept, cell, asked, "cell " + std::to_string(10 * series + k), met);
      if (HasFatalFailure()) return;
    }
  }
  std::printf("%d plans, %d solved\n", met.plans, met.solved);
  EXPECT_GE(met.solved, at_least(30));
}

TEST(SetProblem, TheKindAndTheRobotMayChange) {
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().strokes.resize(2);
  for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.04, .dphi = 0.25};
  const PathProblem path = problem_of_run(job, {0, false});
  Random random(seed("SetProblem.Kinds"));
  const Problem cell = random_workcell(data_robot("sda10f"), random);
  Problem longer = job;
  longer.arm().tool.translation().z() += 0.01;
  Met met;
  ProblemPlanner kept(job);
  for (const Problem& next : {one_path(path), job, longer, cell, one_path(path), cell, longer, job})
    expect_as_new(kept, next, {}, "kind " + std::to_string(met.plans), met);
  EXPECT_EQ(met.plans, 8);
  EXPECT_GE(met.solved, 5);
}

TEST(SetProblem, WhatMakesNoSenseChangesNothing) {
  const JobCase door("door_job.yaml");
  ProblemPlanner kept(door.job);
  const Answer before = kept.plan({});
  Problem none = door.job;
  none.arm().strokes.back().name = none.arm().strokes.front().name;
  EXPECT_THROW(kept.set_problem(none), InvalidArgument);
  expect_same_answers(kept.plan({}), before, "after an error");
}

}  // namespace
}  // namespace swivel
