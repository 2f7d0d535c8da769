// SPDX-License-Identifier: BSD-3-Clause
// No answer leaves a planner unproved, of one path, of a job and of two arms alike: where time ends
// before the proof, what was found is `partial`.
#include <gtest/gtest.h>

#include <chrono>
#include <stop_token>
#include <string>
#include <thread>

#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel {
namespace {

using namespace test;

PathProblem short_path() {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_a.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  return problem;
}
Problem short_job() {
  Problem job = io::load_job(data_dir() / "problems/door_job.yaml");
  for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.02, .dphi = 0.1};
  return job;
}
/// Returns two arms that have a plan.
Problem short_workcell() {
  Random random(seed("Unproved.Workcell"));
  const auto robot = data_robot("sda10f");
  for (;;) {
    Problem cell = random_workcell(robot, random);
    if (plan_workcell(cell).status == PlanStatus::kSolved) return cell;
  }
}

/// What became of an answer.
struct Outcome {
  PlanStatus status;
  bool checked;
  std::size_t rows, partial;  ///< numbers of rows, or of parts
};
Outcome outcome(const PlanResult& result) {
  return {result.status, result.checked, result.trajectory.size(), result.partial.size()};
}
Outcome outcome(const Answer& answer) {
  Outcome found{answer.status, answer.checked, 0, 0};
  for (const ArmAnswer& arm : answer.arms) {
    found.rows += arm.parts.size();
    found.partial += arm.partial.size();
  }
  return found;
}

/// Plans with options that stop the plan when its proof begins: by a request, or, `late`, by its
/// time-out.
template <class Plan>
Outcome stopped_at_proof(const Plan& plan, bool late) {
  constexpr double kTimeout = 2;  // s
  const auto begun = std::chrono::steady_clock::now();
  std::stop_source source;
  int proofs = 0;
  PlanOptions options;
  options.threads = 1;
  options.stop = source.get_token();
  if (late) options.timeout_s = kTimeout;
  options.progress = [&](const Progress& now) {
    if (now.stage != Stage::kProving || proofs++ > 0) return;
    if (late)
      std::this_thread::sleep_until(begun + std::chrono::duration<double>(kTimeout));
    else
      source.request_stop();
  };
  const Outcome found = outcome(plan(options));
  EXPECT_EQ(proofs, 1);
  return found;
}

template <class Plan>
void expect_none_unproved(const Plan& plan, const std::string& what) {
  SCOPED_TRACE(what);
  for (const bool late : {false, true}) {
    const Outcome stopped = stopped_at_proof(plan, late);
    EXPECT_EQ(stopped.status, late ? PlanStatus::kTimeout : PlanStatus::kCancelled);
    EXPECT_FALSE(stopped.checked);
    EXPECT_EQ(stopped.rows, 0U);
    EXPECT_GT(stopped.partial, 0U);
  }
  const Outcome proved = outcome(plan(PlanOptions()));
  EXPECT_EQ(proved.status, PlanStatus::kSolved);
  EXPECT_TRUE(proved.checked);
  EXPECT_GT(proved.rows, 0U);
  EXPECT_EQ(proved.partial, 0U);
  PlanOptions without_proof;
  without_proof.check = false;
  const Outcome unproved = outcome(plan(without_proof));
  EXPECT_EQ(unproved.status, PlanStatus::kSolved);
  EXPECT_FALSE(unproved.checked);
  EXPECT_EQ(unproved.rows, proved.rows);
}

TEST(Unproved, OfEveryKindIsPartial) {
  const PathProblem problem = short_path();
  expect_none_unproved([&](const PlanOptions& options) { return plan(problem, options); }, "path");
  Problem job = short_job();
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  expect_none_unproved([&](const PlanOptions& options) { return plan_job(robot, job, options); },
                       "job");
  const PreparedWorkcell cell(short_workcell());
  expect_none_unproved([&](const PlanOptions& options) { return plan_workcell(cell, options); },
                       "two arms");
}

/// An order that was proved stays the answer where time ends while others are tried.
TEST(Unproved, TheBestOrderThatWasProvedStays) {
  Problem job = short_job();
  job.arm().order = StrokeOrder::kBest;
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  std::stop_source source;
  PlanOptions options;
  options.threads = 1;
  options.stop = source.get_token();
  bool proved = false;
  options.progress = [&](const Progress& now) {
    if (proved) source.request_stop();  // the first stage of the next order
    proved = now.stage == Stage::kProving;
  };
  const Answer found = plan_job(robot, job, options);
  EXPECT_EQ(found.status, PlanStatus::kSolved);
  EXPECT_TRUE(found.checked);
  EXPECT_GT(found.arm().parts.size(), 0U);
}

/// A job that has none without lift-offs is not said to have none where time ended before lift-offs
/// were tried.
TEST(Unproved, LiftOffsThatWereNotTriedAreNoVerdict) {
  Problem job = io::load_job(data_dir() / "problems/iiwa14_ring_job.yaml");
  ASSERT_TRUE(job.arm().lift);
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  std::stop_source source;
  PlanOptions options;
  options.threads = 1;
  options.stop = source.get_token();
  int proofs = 0;
  options.progress = [&](const Progress& now) {
    if (now.stage == Stage::kProving && proofs++ == 0) source.request_stop();
  };
  const Answer found = plan_job(robot, job, options);
  EXPECT_GT(proofs, 0);
  EXPECT_EQ(found.status, PlanStatus::kCancelled);
  EXPECT_TRUE(found.arm().parts.empty());
}

}  // namespace
}  // namespace swivel
