// SPDX-License-Identifier: BSD-3-Clause
// Deadlines and Ctrl-C: every stage hears them, soon, and what is known by then stays.
#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "cost_to_go/grid/chord_lower_bound.hpp"
#include "diagnosis/diagnosis.hpp"
#include "diagnosis_of.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/eager/eager.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {
namespace {

using namespace test;

PathProblem experiment(const std::string& name) {
  return io::load_path_problem(data_dir() / "problems" / (name + ".yaml"));
}

/// Experiment A with a plate before the tool half way: no path, for a cause that must be searched
/// for.
PathProblem infeasible() {
  PathProblem problem = experiment("experiment_a");
  SceneObject plate;
  plate.name = "plate";
  plate.shape = Box{Vector3d(0.02, 0.1, 0.4)};
  plate.pose.translation() = Vector3d(0.6, 0.2, 0.9);
  problem.scene.push_back(plate);
  return problem;
}

TEST(Budget, EveryPositiveTimeOutHolds) {
  for (const double seconds :
       {1.0, 1e8, 9.2e9, 9.3e9, 1e10, 1e300, std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(Budget(seconds).spent()) << seconds;
  EXPECT_FALSE(Budget().spent());
  EXPECT_TRUE(Budget(1e-300).spent());
  PathProblem problem = experiment("experiment_a");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  PlanOptions options;
  options.timeout_s = 1e10;
  EXPECT_EQ(plan(problem, options).status, PlanStatus::kSolved);
}

TEST(Budget, AFlagComesBeforeTheDeadline) {
  const std::atomic<bool> cancel{true};
  EXPECT_TRUE(Budget(1e-9, &cancel).cancelled());
  EXPECT_TRUE(Budget({}, &cancel).spent());
  EXPECT_FALSE(Budget(1e-9).cancelled());
}

/// A problem without a path, what its stages need, and a budget that is spent.
struct SpentPlan {
  using Stages = std::vector<std::pair<const char*, std::function<void()>>>;

  PathProblem problem = infeasible();
  Budget spent{1e-12};
  PreparedRobot robot{problem};
  std::vector<Waypoint> waypoints = waypoints_in_base(problem);
  ToolPath path{waypoints, problem.resolution, problem.source};
  SrsLattice lattice{robot.arm().chain, robot.srs(), path, problem};
  World world{robot.world(), problem.scene};
  EdgeRule rule = world.edge_rule(robot.radii());
  Executor executor{2};
  Config q = Config::Zero(), away = Config::Constant(0.5);
  std::unique_ptr<CostToGo> cost_to_go = make_cost_to_go(lattice, Pruning::kByBound, spent);
  SearchCounters counters;
  EagerOutcome eager;
  Diagnosis diagnosis;

  CollisionValidity validity() {
    return {lattice, world, rule, problem.limits.edges, DistanceProofs::kOn, executor, 4, spent};
  }

  /// Returns the stages that make what a search needs.
  Stages of_preparation() {
    return {
        {"robot", [this] { PreparedRobot(problem, spent); }},
        {"tool path",
         [this] {
           Resolution fine = problem.resolution;
           fine.ds = 1e-5;
           ToolPath(waypoints, fine, problem.source, spent);
         }},
        {"lattice", [this] { SrsLattice(robot.arm().chain, robot.srs(), path, problem, spent); }},
        {"scene", [this] { World(robot.world(), problem.scene, spent); }},
        {"chord bound", [this] { ChordLowerBound(lattice, spent); }},
        {"sweep", [this] { cost_to_go->sweep(lattice.layers() - 1); }},
    };
  }
  /// Returns the stages that ask about nodes and edges.
  Stages of_questions() {
    return {
        {"nodes",
         [this] {
           auto asked = validity();
           const NodeQuestion question{0, 0, q};
           NodeAnswer answer;
           asked.nodes({&question, 1}, {&answer, 1});
         }},
        {"edges",
         [this] {
           auto asked = validity();
           const EdgeQuestion question{0, 0, 1, q, q};
           std::uint8_t answer = 0;
           asked.edges({&question, 1}, {&answer, 1});
         }},
        {"one edge",
         [this] {
           World::Query query(world, DistanceProofs::kOn);
           static_cast<void>(edge_blocked(query, rule, q, away, spent));
         }},
    };
  }
  /// Returns the stages that search, or say why there is no path.
  Stages of_searches() {
    return {
        {"search",
         [this] {
           auto asked = validity();
           static_cast<void>(path_first(*cost_to_go, asked, {}, counters));
         }},
        {"furthest layer",
         [this] {
           auto asked = validity();
           static_cast<void>(deepest_valid_layer(*cost_to_go, asked, {}, counters));
         }},
        {"eager",
         [this] {
           auto asked = validity();
           eager_search(lattice, asked, spent, eager);
         }},
        {"eager_dp",
         [this] {
           auto asked = validity();
           eager_dp(lattice, asked, spent, eager);
         }},
        {"diagnosis",
         [this] {
           diagnose(lattice, world, rule, {0, 0, 0, 0}, true, spent, diagnosis);
         }},
    };
  }
};

TEST(Budget, NoStageGoesOnWhenItIsSpent) {
  SpentPlan plan;
  for (const auto& stages : {plan.of_preparation(), plan.of_questions(), plan.of_searches()})
    for (const auto& [name, stage] : stages) EXPECT_THROW(stage(), Stopped) << name;
  EXPECT_EQ(plan.cost_to_go->edges(), 0);
  EXPECT_EQ(plan.eager.ik_nodes, 0);
  EXPECT_FALSE(plan.diagnosis.complete);
  EXPECT_EQ(plan.diagnosis.reached_layer, 3);
}

/// Cancelled at the beginning of one stage after the other, which progress tells.
TEST(Budget, APlanStopsInTheStageThatItIsIn) {
  int stopped = 0, verdicts_kept = 0;
  for (const PathProblem& problem : {experiment("experiment_b"), infeasible()})
    for (const PlannerKind planner :
         {PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel}) {
      PathProblem coarse = problem;
      if (planner == PlannerKind::kEagerDp) coarse.resolution = {.ds = 0.02, .dphi = 0.2};
      const PreparedRobot robot(coarse);
      PlanOptions options;
      options.planner = planner;
      options.threads = 2;
      options.evidence = Evidence::all();
      int calls = 0;
      options.progress = [&](const Progress&) { ++calls; };
      const PlanResult whole = plan(robot, coarse, options);
      ASSERT_GT(calls, 3);
      for (int call = 0; call < calls;
           call = call < calls - 6 ? call + std::max(1, calls / 12) : call + 1) {
        std::atomic<bool> cancel{false};
        options.cancel = &cancel;
        int heard = 0, after = 0;
        std::string phrase;
        bool last_step = false;  // of its stage, so that nothing is left to be stopped
        options.progress = [&](const Progress& progress) {
          EXPECT_LE(progress.done, std::max<std::int64_t>(progress.of, 0));
          after += cancel;
          if (heard++ == call) {
            phrase = to_string(progress.stage);
            last_step = progress.done + 1 == progress.of;
            cancel = true;
          }
        };
        const PlanResult result = plan(robot, coarse, options);
        const std::string what = result.planner + " cancelled at '" + phrase + "'";
        EXPECT_LE(after, 1) << what;  // a verdict that is just known begins one more stage
        EXPECT_LE(result.counters.nodes_checked, whole.counters.nodes_checked) << what;
        if (result.status == PlanStatus::kCancelled) {
          ++stopped;
          EXPECT_TRUE(result.trajectory.empty()) << what;
          EXPECT_TRUE(!phrase.starts_with("laying") || result.lattice.layers == 0) << what;
          EXPECT_TRUE(!phrase.starts_with("sweeping") ||
                      result.counters.edges <= whole.counters.edges)
              << what;
          continue;
        }
        ++verdicts_kept;
        ASSERT_EQ(result.status, whole.status) << what;
        EXPECT_EQ(result.cost, whole.cost) << what;
        EXPECT_EQ(result.trajectory.size(), whole.trajectory.size()) << what;
        EXPECT_TRUE(!result.evidence.postures || last_step) << what;
        EXPECT_TRUE(whole.status == PlanStatus::kSolved || !diagnosis_of(result).complete) << what;
      }
      options.cancel = nullptr;
    }
  std::printf("%d plans stopped before their verdict, %d after it\n", stopped, verdicts_kept);
  EXPECT_GE(stopped, 20);
  EXPECT_GE(verdicts_kept, 6);
}

TEST(Budget, NothingIsWorkedOutThatWasNotAskedFor) {
  PathProblem problem = experiment("experiment_a");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  const PlanResult least = plan(problem);
  ASSERT_EQ(least.status, PlanStatus::kSolved);
  EXPECT_FALSE(least.min_clearance.has_value());
  EXPECT_TRUE(least.arm_angle.empty());
  PlanOptions options;
  options.evidence = {.tool_path_error = true};
  const PlanResult error = plan(problem, options);
  EXPECT_GT(error.tool_path_error_mm.max, 0);
  EXPECT_TRUE(error.arm_angle.empty());
  options.evidence = Evidence::all();
  const PlanResult all = plan(problem, options);
  EXPECT_EQ(all.tool_path_error_mm.max, error.tool_path_error_mm.max);
  EXPECT_TRUE(all.min_clearance.has_value());
  EXPECT_EQ(all.arm_angle.size(), all.trajectory.size());
  EXPECT_GT(all.min_manipulability, 0);

  PathProblem blocked = infeasible();
  blocked.resolution = {.ds = 0.02, .dphi = 0.2};
  const PlanResult cause = plan(blocked), evidence = plan(blocked, options);
  ASSERT_EQ(cause.status, PlanStatus::kInfeasible);
  EXPECT_EQ(words(diagnosis_of(cause).cause), words(diagnosis_of(evidence).cause));
  EXPECT_EQ(diagnosis_of(cause).reached_layer, diagnosis_of(evidence).reached_layer);
  EXPECT_TRUE(diagnosis_of(cause).complete);
  EXPECT_TRUE(diagnosis_of(cause).empty_layers.empty());
  EXPECT_TRUE(diagnosis_of(cause).removed.empty());
  EXPECT_FALSE(diagnosis_of(evidence).empty_layers.empty());
  EXPECT_FALSE(diagnosis_of(evidence).removed.empty());
}

/// Large allocations, long loops and destructors between the polls are what could make a stop late.
/// Processor time, since on a busy machine the clock measures others.
TEST(Budget, ADeadlineHoldsOnLargeLattices) {
  struct Size {
    double ds, dphi;
  };
  for (const auto& [name, problem] :
       {std::pair("solved", experiment("experiment_a")), std::pair("infeasible", infeasible())})
    for (const Size size :
         {Size{0.005, 0.05}, Size{0.001, 0.01}, Size{0.0005, 0.003}, Size{1e-6, 0.5}}) {
      PathProblem fine = problem;
      fine.resolution = {.ds = size.ds, .dphi = size.dphi};
      const PreparedRobot robot(fine);
      for (const auto& [planner, timeout_s] :
           {std::pair(PlannerKind::kEager, 0.005), std::pair(PlannerKind::kEagerDp, 0.005),
            std::pair(PlannerKind::kLazy, 0.005), std::pair(PlannerKind::kParallel, 0.005),
            std::pair(PlannerKind::kLazy, 0.1)}) {
        if (planner == PlannerKind::kEager && size.dphi < 0.01)
          continue;  // refused for its memory on small machines
        PlanOptions options;
        options.planner = planner;
        options.evidence = Evidence::all();
        options.threads = 1;
        options.timeout_s = timeout_s;
        const auto start = std::chrono::steady_clock::now();
        const std::clock_t used = std::clock();
        const PlanResult result = plan(robot, fine, options);
        const double cpu_ms = 1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count();
        std::printf("%s, ds %g, dphi %g, %s, %g s: %s after %.1f ms, of which %.1f ms worked\n",
                    name, size.ds, size.dphi, result.planner.c_str(), timeout_s,
                    to_string(result.status), ms, cpu_ms);
        EXPECT_LT(cpu_ms, 1e3 * timeout_s + 250)
            << result.planner << " ds " << size.ds << " dphi " << size.dphi;
      }
    }
}

/// A row without its columns would be a wrong answer.
TEST(Budget, ACampaignLeavesOutTheEpisodeThatWasStopped) {
  PathProblem problem = infeasible();
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  const PreparedRobot robot(problem);
  CampaignOptions options;
  options.episodes = 1;
  options.plan.planner = PlannerKind::kLazy;
  std::vector<EpisodeRow> rows;
  run_campaign(robot, problem, options, [&](const EpisodeRow& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_FALSE(rows[0].reason.empty());
  const std::atomic<bool> cancelled{true};
  options.plan.cancel = &cancelled;
  rows.clear();
  run_campaign(robot, problem, options, [&](const EpisodeRow& row) { rows.push_back(row); });
  EXPECT_TRUE(rows.empty());
}

}  // namespace
}  // namespace swivel
