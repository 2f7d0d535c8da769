// SPDX-License-Identifier: BSD-3-Clause
// Refined jobs: proved by their own check and against the refinement of each stroke by itself;
// transitions stay as they are; timed, stopped, with lift-offs and with rolls.
#include <gtest/gtest.h>

#include <algorithm>

#include "random_jobs.hpp"
#include "seed.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/refine_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns the job with the clearance between layers that refined paths keep.
Problem to_be_refined(Problem job) {
  for (Stroke& stroke : job.arm().strokes) keep_clearance_between_layers(stroke.limits);
  return job;
}

/// Expects parts whose transitions, and rows where these begin and end, are those of `before`.
void expect_same_transitions(const std::vector<Part>& before, const std::vector<Part>& now,
                             const std::string& what) {
  ASSERT_EQ(before.size(), now.size()) << what;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const std::vector<TrajectoryRow>&was = before[k].rows, &is = now[k].rows;
    ASSERT_EQ(was.size(), is.size()) << what;
    if (!now[k].run) {
      ASSERT_EQ(before[k].cost, now[k].cost) << what;
      for (std::size_t i = 0; i < is.size(); ++i) ASSERT_EQ(was[i].q, is[i].q) << what;
      continue;
    }
    ASSERT_LE(now[k].cost, before[k].cost + 1e-9) << what;
    if (k > 0) {
      ASSERT_EQ(was.front().q, is.front().q) << what;
    }
    if (k + 1 < now.size()) {
      ASSERT_EQ(was.back().q, is.back().q) << what;
    }
  }
}

/// Expects that the rows of a run are those that refine() makes of it between its own ends.
void expect_refined_alone(const PreparedRobot& robot, const Problem& job, const Part& before,
                          const Part& now, bool first, bool last, const std::string& what) {
  RefineOptions options;
  options.keeps_begin = !first;
  options.keeps_end = !last;
  const Refined alone = refine(robot, problem_of_run(job, *now.run), before.rows, options);
  ASSERT_EQ(alone.rows.size(), now.rows.size()) << what;
  for (std::size_t i = 0; i < now.rows.size(); ++i)
    ASSERT_EQ(alone.rows[i].q, now.rows[i].q) << what << ", row " << i;
}

TEST(RefineJob, IsProvedAndNeverDearer) {
  Random random(seed("RefineJob"));
  const JobCase door("door_job.yaml"), pipe("kr6_weld_pipe_job.yaml");
  int solved = 0, refined = 0, free_ends = 0;
  double sum = 0;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const JobCase& of = trial % 5 == 4 ? pipe : door;
    const Problem job = to_be_refined(&of == &pipe ? of.episode(static_cast<std::uint64_t>(trial))
                                                   : random_job(of, random));
    const Answer plain = plan_job(of.robot, job);
    PlanOptions options;
    options.threads = 1 + trial % 3;
    options.evidence = Evidence::all();
    const Answer found = plan_job_motion(of.robot, job, options, true, {});
    ASSERT_EQ(found.status, plain.status) << what;
    ASSERT_EQ(found.refinement.has_value(), plain.has_rows()) << what;
    if (!plain.has_rows()) continue;
    ++solved;
    const std::vector<Part>&before = plain.arm().parts, &now = found.arm().parts;
    expect_same_transitions(before, now, what);
    if (HasFatalFailure()) return;
    std::size_t run = 0;
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (!now[k].run) continue;
      const Refined& one = found.refinement->runs.at(run);
      ASSERT_TRUE(found.arm().runs[run++].evidence.postures) << what;
      refined += one.refined;
      free_ends += k == 0 || k + 1 == now.size();
      if (trial % 4 == 0)
        expect_refined_alone(of.robot, job, before[k], now[k], k == 0, k + 1 == now.size(), what);
      if (HasFatalFailure()) return;
    }
    ASSERT_EQ(run, found.refinement->runs.size()) << what;
    const AnswerCheck check = check_job(of.robot, job, now);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    ASSERT_NEAR(check.cost, found.cost, 1e-6) << what;
    ASSERT_LE(found.cost, plain.cost + 1e-9) << what;
    ASSERT_EQ(found.lattice_cost, plain.lattice_cost) << what;
    ASSERT_NEAR(found.refinement->cost_before - found.refinement->cost, plain.cost - found.cost,
                1e-6)
        << what;
    sum += found.cost / plain.cost;
  }
  std::printf("%d jobs, %d solved, %d runs refined, %d with a free end, cost %.3f of before\n",
              count, solved, refined, free_ends, sum / solved);
  EXPECT_GE(solved, at_least(9));
  EXPECT_GE(refined, at_least(24));
  EXPECT_GE(free_ends, at_least(2));
}

/// Strokes in several runs, closed ones, and such of arms that are not exactly S-R-S.
TEST(RefineJob, JobsOfTheDataFolderAreRefined) {
  for (const char* const name :
       {"iiwa14_ring_job.yaml", "panda_polish_covers_job.yaml", "ur5e_deburr_plate_job.yaml"}) {
    SCOPED_TRACE(name);
    const JobCase of(name);
    Problem job = to_be_refined(of.job);
    if (job.arm().lift)  // which asks about all nodes and edges
      for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.03, .dphi = 0.2};
    const Answer plain = plan_job(of.robot, job),
                 found = plan_job_motion(of.robot, job, {}, true, {});
    ASSERT_TRUE(found.refined);
    EXPECT_LT(found.cost, plain.cost);
    expect_same_transitions(plain.arm().parts, found.arm().parts, name);
    const AnswerCheck check = check_job(of.robot, executed_problem(job, found), found.arm().parts);
    EXPECT_TRUE(check.passed) << check.failures.front();
  }
}

TEST(RefineJob, MotionsAreProved) {
  const JobCase door("door_job.yaml"), pipe("kr6_weld_pipe_job.yaml");
  int timed = 0;
  for (const JobCase* of : {&door, &pipe})
    for (int k = 0; k < trials(6); ++k) {
      const Problem job = with_motion_defaults(of->episode(static_cast<std::uint64_t>(k)));
      const std::string what = job.source + " episode " + std::to_string(k);
      constexpr double kChord = 2e-5;
      const Answer plan =
          plan_job_motion(of->robot, job, {}, true, TimingOptions{.rate = 100, .chord = kChord});
      if (!plan.timed()) continue;
      ++timed;
      ASSERT_TRUE(plan.refined) << what;
      const ArmMotion& motion = plan.timed()->arms.front();
      for (const TimedPath& run : motion.runs) ASSERT_LE(run.between_position, kChord) << what;
      std::vector<StrokeRun> order;
      for (const RunAnswer& run : plan.arm().runs) order.push_back(run.run);
      const AnswerCheck check = check_job_motion(of->robot, job, order, motion);
      ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
      const AnswerCheck rows = check_job(of->robot, job, plan.arm().parts);
      ASSERT_TRUE(rows.passed) << what << ": " << rows.failures.front();
    }
  std::printf("%d motions\n", timed);
  EXPECT_GE(timed, at_least(6));
}

/// Time may run out at any moment: what is there is proved, and what is missing is told.
TEST(RefineJob, IsStoppedAtAnyMoment) {
  const JobCase door("door_job.yaml");
  const Problem job = to_be_refined(door.job);
  int before = 0, planned = 0, all = 0;
  for (double seconds = 0.01; all == 0 && seconds < 60; seconds *= 1.3) {
    PlanOptions options;
    options.timeout_s = seconds;
    const Answer found = plan_job_motion(door.robot, job, options, true, {});
    if (!found.has_rows()) {
      ++before;
      continue;
    }
    ASSERT_TRUE(found.refinement);
    ASSERT_TRUE(found.checked);
    ASSERT_TRUE(check_job(door.robot, job, found.arm().parts).passed);
    if (!found.stopped) {
      ++all;
      continue;
    }
    ++planned;
    for (const Refined& run : found.refinement->runs) EXPECT_EQ(run.reason, "stopped");
  }
  std::printf("%d stopped before there was a job, %d before it was refined\n", before, planned);
  EXPECT_EQ(all, 1);
}

}  // namespace
}  // namespace swivel
