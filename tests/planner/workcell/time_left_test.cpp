// SPDX-License-Identifier: BSD-3-Clause
// The diagnosis of an arm or of a stroke that has no path keeps to the time-out of the whole plan.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel {
namespace {

using namespace test;
using Seconds = std::chrono::duration<double>;

/// Plans with a time-out that the first report of progress takes a part of, and the first one of
/// the diagnosis what is left. `plan(options)` returns the diagnosis. Returns whether that was
/// complete.
bool is_complete(const std::function<Diagnosis(const PlanOptions&)>& plan) {
  constexpr Seconds kTimeout(2), kFirst(1);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  options.timeout_s = kTimeout.count();
  bool is_first = true, is_diagnosed = false;
  const auto begun = std::chrono::steady_clock::now();
  options.progress = [&](const Progress& now) {
    if (is_first) std::this_thread::sleep_for(kFirst);
    is_first = false;
    if (is_diagnosed || (now.stage != Stage::kReach && now.stage != Stage::kDiagnosis)) return;
    is_diagnosed = true;
    std::this_thread::sleep_until(begun + kTimeout);
  };
  const Diagnosis diagnosis = plan(options);
  EXPECT_TRUE(is_diagnosed);
  return diagnosis.complete;
}

TEST(TimeLeft, AnArmOfAWorkcellIsDiagnosedInIt) {
  Random random(seed("TimeLeft.Workcell"));
  Problem cell = random_workcell(data_robot("sda10f"), random);
  cell.arms[1].path().waypoints[1].position.x() += 0.6;  // out of reach
  const Answer whole = plan_workcell(cell);
  ASSERT_EQ(whole.status, PlanStatus::kInfeasible);
  ASSERT_TRUE(whole.arms[1].run().diagnosis->complete);
  const PreparedWorkcell prepared(cell);
  EXPECT_FALSE(is_complete([&](const PlanOptions& options) {
    const Answer result = plan_workcell(prepared, options);
    EXPECT_EQ(result.status, PlanStatus::kInfeasible);
    return *result.arms[1].run().diagnosis;
  }));
}

TEST(TimeLeft, AStrokeIsDiagnosedInIt) {
  Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/door_job.yaml");
  job.arm().strokes.resize(1);
  job.arm().strokes[0].resolution = {.ds = 0.02, .dphi = 0.1, .knot = 0};
  job.arm().strokes[0].waypoints.back().position.x() += 3;  // out of reach
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  const auto diagnosis_of = [](const Answer& result) {
    EXPECT_EQ(result.status, PlanStatus::kInfeasible);
    EXPECT_TRUE(result.arm().runs.at(0).diagnosis);
    return result.arm().runs.at(0).diagnosis.value_or(Diagnosis());
  };
  ASSERT_TRUE(diagnosis_of(plan_job(robot, job)).complete);
  EXPECT_FALSE(is_complete(
      [&](const PlanOptions& options) { return diagnosis_of(plan_job(robot, job, options)); }));
}

}  // namespace
}  // namespace swivel
