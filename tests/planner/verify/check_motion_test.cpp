// SPDX-License-Identifier: BSD-3-Clause
// Mutations of motions and trajectories: each must fail the check. Legal changes of them: each must
// pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "motion_mutations.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

const std::vector<Judged>& cases(bool timed) {
  static const std::vector<Judged> of_each[] = {planned_cases(false, seed("Trajectories"), 30),
                                                planned_cases(true, seed("Motions"), 30)};
  return of_each[timed];
}

std::string first(const CheckResult& result) {
  return result.failures.empty() ? "no failure" : result.failures[0];
}

class CheckOf : public testing::TestWithParam<bool> {};

TEST_P(CheckOf, MutationsFail) {
  const bool timed = GetParam();
  const auto& good = cases(timed);
  const std::uint64_t base = seed("Mutations");
  std::size_t kinds = 0;
  for (const MotionMutation& kind : motion_mutations())
    kinds += timed ? kind.of_motions : kind.of_trajectories;
  const int each = trials(static_cast<int>(1000 / kinds) + 1);
  int count = 0, number = 0;
  for (const MotionMutation& kind : motion_mutations()) {
    ++number;
    if (!(timed ? kind.of_motions : kind.of_trajectories)) continue;
    int done = 0, at_corners = 0;
    std::map<std::string, int> of;
    std::string said;
    for (int trial = 0; done < each && trial < 60 * each; ++trial) {
      Random random(base + 100000 * static_cast<std::uint64_t>(number) +
                    static_cast<std::uint64_t>(trial));
      Judged bad = good[static_cast<std::size_t>(random.below(static_cast<int>(good.size())))];
      const std::string words = kind.mutate(bad, random);
      if (words.empty()) continue;
      for (const bool margins : {false, true}) {
        if (margins && done % 8 != 0) continue;  // takes long
        const CheckResult result = judge(bad, {margins, {}});
        EXPECT_FALSE(result.passed) << kind.name << " (" << words << "), " << bad.what << ", trial "
                                    << trial << ", margins " << margins;
        EXPECT_EQ(result.failures.size(),
                  std::min<std::size_t>(20, static_cast<std::size_t>(result.failure_count)));
        if (said.empty()) said = words + ": " + first(result);
      }
      ++of[bad.what];
      at_corners += words.find("at a corner") != std::string::npos;
      ++done;
    }
    std::printf("%s: %d of %zu (%d at corners), for example %s\n", kind.name.c_str(), done,
                of.size(), at_corners, said.c_str());
    EXPECT_EQ(done, each) << kind.name;
    EXPECT_GE(at_corners, kind.name == "tool sways in a swing at rest" ? at_least(5) : 0);
    EXPECT_GE(of.size(), static_cast<std::size_t>(at_least(3))) << kind.name;
    count += done;
  }
  std::printf("%d mutations of %zu kinds, of %zu good ones\n", count, kinds, good.size());
  EXPECT_GE(count, at_least(1000));
}

TEST_P(CheckOf, LegalOnesPass) {
  const bool timed = GetParam();
  const auto& good = cases(timed);
  const std::uint64_t base = seed("Legal");
  EXPECT_GE(good.size(), 15u);
  const int most = trials(300);
  int count = 0, at_corners = 0;
  std::map<std::string, int> of;
  for (int trial = 0; count < most && trial < 40 * most; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    Judged judged = good[static_cast<std::size_t>(trial) % good.size()];
    const LegalChange& kind = legal_changes()[static_cast<std::size_t>(
        random.below(static_cast<int>(legal_changes().size())))];
    if (!(timed ? kind.of_motions : kind.of_trajectories)) continue;
    const std::string words = kind.change(judged, random);
    if (words.empty()) continue;
    const CheckResult result = judge(judged, {count % 10 == 0, {}});
    EXPECT_TRUE(result.passed) << kind.name << " (" << words << "), " << judged.what << ", trial "
                               << trial << ": " << first(result);
    ++of[kind.name];
    at_corners += words.find("at a corner") != std::string::npos;
    ++count;
  }
  for (const auto& [name, times] : of) std::printf("%s: %d\n", name.c_str(), times);
  std::printf("%d legal ones, %d swings at corners\n", count, at_corners);
  EXPECT_GE(count, at_least(300));
  for (const LegalChange& kind : legal_changes())
    EXPECT_GE(of[kind.name], (timed ? kind.of_motions : kind.of_trajectories) ? at_least(3) : 0)
        << kind.name;
}

INSTANTIATE_TEST_SUITE_P(, CheckOf, testing::Bool(), [](const auto& of) {
  return of.param ? std::string("Motions") : std::string("Trajectories");
});

/// What a plan with a speed returns beside its motion follows the rounded path: it passes where the
/// problem says nothing of corners, and the check says so.
TEST(CheckOfPlans, RowsOfATimedPlanPass) {
  PlanOptions lazy;
  lazy.planner = PlannerKind::kLazy;
  int rounded = 0, of_all = 0;
  for (const bool refined : {false, true}) {
    Random random(seed("Rows") + refined);
    for (int trial = 0; trial < 6; ++trial) {
      PathProblem problem =
          motion_problem(all_robots()[static_cast<std::size_t>(trial) % 5], random);
      problem.smooth.reset();
      Planner planner(with_motion_defaults(problem));
      const MotionPlan plan =
          plan_motion(planner, lazy, refined, TimingOptions{.speed = 0.1, .rate = 250});
      if (plan.result.status != PlanStatus::kSolved) continue;
      for (const bool margins : {false, true}) {
        const CheckResult result = check_trajectory(PreparedRobot(problem), problem,
                                                    plan.result.trajectory, {margins, {}});
        EXPECT_TRUE(result.passed) << trial << ": " << first(result);
        rounded += result.rounded;
      }
      // Where the problem itself rounds corners by less, they are on neither path.
      problem.smooth = PathSmoothing{1e-5, 1e-4};
      const CheckResult other =
          check_trajectory(PreparedRobot(problem), problem, plan.result.trajectory);
      EXPECT_FALSE(other.rounded);
      of_all += other.passed;
    }
  }
  EXPECT_GE(rounded, 6);
  EXPECT_LE(of_all, 2);
}

/// At few samples a second the tool would leave its path between them: the motion is slowed down,
/// or refused, but never wrong.
TEST(CheckOfPlans, MotionsOfFewSamplesPass) {
  int passed = 0, slowed = 0, refused = 0;
  for (const char* name : {"kr6_weld_pipe", "ur5e_deburr_edge", "iiwa14_bench"}) {
    const PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    for (const double rate : {2.0, 3.0, 5.0, 7.0, 10.0}) {
      Planner planner(with_motion_defaults(problem));
      const MotionPlan plan = plan_motion(
          planner, {}, false, TimingOptions{.speed = 0.1, .rate = rate});  // proves its answer
      ASSERT_TRUE(plan.motion) << name;
      refused += plan.motion->failure.has_value();
      if (!plan.motion->motion) continue;
      const TimedPath& motion = *plan.motion->motion;
      const CheckResult result =
          check_motion(PreparedRobot(problem), problem, motion.rows, {false, {}});
      EXPECT_TRUE(result.passed) << name << " at " << rate << ": " << first(result);
      ++passed;
      slowed += std::any_of(
          motion.warnings.begin(), motion.warnings.end(),
          [](const std::string& line) { return line.find("slowed down") != std::string::npos; });
    }
  }
  std::printf("%d passed, %d of them slowed down, %d refused\n", passed, slowed, refused);
  EXPECT_GE(passed, 10);
  EXPECT_GE(slowed, 3);
}

/// The tool turns away on the spot and comes back. A motion that rests meanwhile has the same poses
/// at its rows, and turns nowhere.
TEST(CheckOfPlans, ATurnThereAndBackIsNotLeftOut) {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Quaterniond down(Eigen::AngleAxisd(3.0, Vector3d::UnitY()));
  const Quaterniond aside = down * Quaterniond(Eigen::AngleAxisd(0.4, Vector3d::UnitX()));
  const Vector3d corner(0.5, 0, 0.6);
  problem.waypoints = {{{0.5, -0.1, 0.6}, down},
                       {corner, down},
                       {corner, aside},
                       {corner, down},
                       {{0.5, 0.1, 0.6}, down}};
  problem.resolution = {.ds = 0.02, .dphi = 0.2, .dalpha = 0.1};
  problem.smooth = PathSmoothing{1e-6, 1e-6};
  Planner planner(with_motion_defaults(problem));
  PlanOptions lazy;
  lazy.planner = PlannerKind::kLazy;
  const MotionPlan plan =
      plan_motion(planner, lazy, true, TimingOptions{.speed = 0.1, .turn_speed = 0.5, .rate = 250});
  ASSERT_TRUE(plan.motion && plan.motion->motion);
  const PreparedRobot robot(problem);
  const std::vector<TimedRow>& whole = plan.motion->motion->rows;
  const CheckResult passed = check_motion(robot, problem, whole);
  EXPECT_TRUE(passed.passed) << first(passed);
  int tried = 0;
  for (const double near : {1e-10, 1e-8, 1e-6, 1e-4}) {
    std::vector<std::size_t> at;  // rows at the corner, not turned
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const Pose tool = robot.arm().chain.tool(whole[k].row.q);
      if ((tool.translation() - corner).norm() < near &&
          tool.linear().isApprox(down.toRotationMatrix(), near))
        at.push_back(k);
    }
    if (at.size() < 2 || at.back() - at.front() < 100) continue;
    // The last of them takes the place of all rows between, and time enough.
    std::vector<TimedRow> rows(whole.begin(),
                               whole.begin() + static_cast<std::ptrdiff_t>(at.front()) + 1);
    for (std::size_t k = at.back(); k < whole.size(); ++k) rows.push_back(whole[k]);
    const CheckResult result = check_motion(robot, problem, rows);
    EXPECT_FALSE(result.passed) << near;
    EXPECT_TRUE(std::any_of(
        result.failures.begin(), result.failures.end(),
        [](const std::string& line) { return line.find("leaves the path") != std::string::npos; }))
        << near << ": " << first(result);
    ++tried;
  }
  EXPECT_GE(tried, 1);
}

/// A tool that may stand turned turns further and further at rest, each time by less than is
/// forgiven.
TEST(CheckOfPlans, SmallChangesOfTheRollDoNotAddUp) {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Quaterniond down(Eigen::AngleAxisd(3.0, Vector3d::UnitY()));
  problem.waypoints = {{{0.5, -0.1, 0.6}, down}, {{0.5, 0.1, 0.6}, down}};
  problem.roll = Roll{};
  Planner planner(with_motion_defaults(problem));
  const MotionPlan plan = plan_motion(planner, {}, false, TimingOptions{.speed = 0.1, .rate = 50});
  ASSERT_TRUE(plan.motion && plan.motion->motion);
  const PreparedRobot robot(problem);
  for (const bool far : {false, true}) {
    std::vector<TimedRow> rows = plan.motion->motion->rows;
    for (int k = 0; k < (far ? 400 : 20); ++k) {  // tool z is joint 7's axis
      TimedRow before = rows.front();
      before.t -= 100;
      before.row.q[kDof - 1] += 0.9e-3;
      before.row.roll += 0.9e-3;
      rows.insert(rows.begin(), before);
    }
    const CheckResult result = check_motion(robot, problem, rows);
    EXPECT_EQ(result.passed, !far) << first(result);
    EXPECT_EQ(first(result).find("the roll comes") != std::string::npos, far) << first(result);
  }
}

}  // namespace
}  // namespace swivel
