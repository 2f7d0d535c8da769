// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "diagnosis_of.hpp"
#include "random_problem.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

void expect_same_answer(const PlanResult& result, const PlanResult& first) {
  EXPECT_EQ(result.status, first.status);
  EXPECT_EQ(result.cost, first.cost);
  EXPECT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(first).reached_layer);
  ASSERT_EQ(result.trajectory.size(), first.trajectory.size());
  for (std::size_t i = 0; i < result.trajectory.size(); ++i)
    ASSERT_EQ(result.trajectory[i].q, first.trajectory[i].q);
}

void expect_same(const PlanResult& result, const PlanResult& first) {
  expect_same_answer(result, first);
  EXPECT_EQ(result.counters.ik_nodes, first.counters.ik_nodes);
  EXPECT_EQ(result.counters.edges, first.counters.edges);
  EXPECT_EQ(result.counters.fcl_calls, first.counters.fcl_calls);
  EXPECT_EQ(result.counters.proved_free, first.counters.proved_free);
  EXPECT_EQ(result.counters.proved_colliding, first.counters.proved_colliding);
  EXPECT_EQ(result.counters.nodes_checked, first.counters.nodes_checked);
  EXPECT_EQ(result.counters.edges_checked, first.counters.edges_checked);
  EXPECT_EQ(words(diagnosis_of(result).cause), words(diagnosis_of(first).cause));
}

/// The result of plan_with(threads) at the first of these thread counts; those at the others are
/// held against it.
template <class PlanWith>
PlanResult compared_at(std::initializer_list<int> thread_counts, const PlanWith& plan_with,
                       int& compared) {
  std::optional<PlanResult> first;
  for (const int threads : thread_counts) {
    const PlanResult result = plan_with(threads);
    if (!first) {
      first = result;
      continue;
    }
    expect_same(result, *first);
    if (testing::Test::HasFailure()) break;
    ++compared;
  }
  return *first;
}

TEST(Threads, SameResultAndCountsAtAnyThreadCount) {
  const std::uint64_t base = seed("Threads.SameResult");
  const auto robots = all_robots();
  int compared = 0;
  for (int trial = 0; trial < trials(20); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const auto plan_with = [&](int threads) {
      PlanOptions options;
      options.threads = threads;
      return plan(problem, options);
    };
    static_cast<void>(compared_at({1, 2, 3, 8}, plan_with, compared));
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(compared, 3 * trials(20));
}

/// Postures of long paths, of which most is kept from one to the next, and batches that fail.
TEST(Threads, KeptClearancesCountTheSame) {
  PathProblem base = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  base.resolution.dphi = 0.2;
  const PreparedRobot robot(base);
  int compared = 0, repaired = 0;
  for (int episode = 0; episode < 12; ++episode) {
    const PathProblem problem = episode_problem(base, 1, episode);
    const auto plan_with = [&](int threads) {
      PlanOptions options;
      options.threads = threads;
      return plan(robot, problem, options);
    };
    repaired += compared_at({1, 2, 4}, plan_with, compared).counters.iterations > 1;
    ASSERT_FALSE(HasFailure());
  }
  std::printf("%d plans compared, %d poses with failures\n", compared, repaired);
  EXPECT_EQ(compared, 24);
  EXPECT_GT(repaired, 2);
}

/// Plans on lattices so large that neighbours of failed nodes are asked about while those before
/// them are dealt with.
TEST(Parallel, RegionsOfLargeLatticesGrowAlikeAtAnyThreadCount) {
  PathProblem base = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  base.resolution.ds = 0.003;
  base.resolution.dphi = 0.04;
  const PreparedRobot robot(base);
  int compared = 0, grown = 0, solved = 0;
  for (int episode = 0; episode < trials(20); ++episode) {
    const PathProblem problem = episode_problem(base, 1, episode);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult lazy = plan(robot, problem, options);
    ASSERT_GE(lazy.lattice.nodes, 150'000);
    options.planner = PlannerKind::kParallel;
    const auto plan_with = [&](int threads) {
      options.threads = threads;
      return plan(robot, problem, options);
    };
    const PlanResult result = compared_at({1, 2, 3, 8}, plan_with, compared);
    expect_same_answer(result, lazy);
    ASSERT_FALSE(HasFailure());
    grown += result.counters.nodes_checked > 1000;
    solved += result.status == PlanStatus::kSolved;
  }
  std::printf("%d plans compared, %d episodes with regions of hundreds of nodes, %d solved\n",
              compared, grown, solved);
  EXPECT_EQ(compared, 3 * trials(20));
  EXPECT_GE(grown, at_least(5));
  EXPECT_GE(solved, at_least(5));
}

/// Every thread has a clone of one planner, moves its objects about and plans; answers are those of
/// fresh plans made before.
TEST(Planner, ClonesInThreadsAnswerAsSerialPlansDo) {
  constexpr int kThreads = 8;
  const std::uint64_t base = seed("Planner.Clones");
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  const int each = std::max(1, trials(800) / kThreads), kinds = std::min(each, 100);
  struct Step {
    PathProblem problem;
    PlanResult answer;
  };
  std::vector<Step> steps;
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Random random(base);
  for (int k = 0; k < kinds; ++k) {
    PathProblem moved =
        k % 4 == 0 ? episode_problem(problem, 1, static_cast<std::uint64_t>(k)) : problem;
    for (SceneObject& object : moved.scene)
      if (object.name != "door" && random.coin())
        object.pose.translation().z() += random.uniform(-0.05, 0.05);
    if (k % 7 == 0) moved.limits.clearance = random.uniform(0, 0.02);
    steps.push_back({moved, plan(moved, options)});
  }
  const Planner planner(problem);
  std::atomic<int> equal{0}, solved{0};
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < kThreads; ++thread)
    threads.emplace_back([&, thread, mine = std::make_shared<Planner>(planner.clone())] {
      Random own(base + static_cast<std::uint64_t>(thread) + 1);
      for (int k = 0; k < each; ++k) {
        const Step& step = steps[static_cast<std::size_t>(own.below(kinds))];
        mine->set_problem(step.problem);
        const PlanResult result = mine->plan(options);
        bool same = result.status == step.answer.status && result.cost == step.answer.cost &&
                    result.trajectory.size() == step.answer.trajectory.size() &&
                    diagnosis_of(result).reached_layer == diagnosis_of(step.answer).reached_layer;
        for (std::size_t i = 0; same && i < result.trajectory.size(); ++i)
          same = result.trajectory[i].q == step.answer.trajectory[i].q;
        equal += same;
        solved += result.status == PlanStatus::kSolved;
      }
    });
  threads.clear();
  std::printf("%d plans in %d threads, %d solved\n", kThreads * each, kThreads, solved.load());
  EXPECT_EQ(equal, kThreads * each);
  EXPECT_GT(solved, 0);
}

TEST(Stopping, DeadlineAndCancelEndEveryPlanner) {
  const PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
  const PreparedRobot robot(problem);
  for (const PlannerKind planner :
       {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel}) {
    PlanOptions options;
    options.planner = planner;
    options.timeout_s = 1e-9;
    EXPECT_EQ(plan(robot, problem, options).status, PlanStatus::kTimeout) << to_string(planner);
    const std::atomic<bool> cancelled{true};
    options.timeout_s.reset();
    options.cancel = &cancelled;
    const PlanResult result = plan(robot, problem, options);
    EXPECT_EQ(result.status, PlanStatus::kCancelled) << to_string(planner);
    EXPECT_TRUE(result.trajectory.empty());
  }
}

}  // namespace
}  // namespace swivel
