// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

BruteForcePath truth_of(const PathProblem& problem) {
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem);
  return brute_force(lattice, robot.world(), robot.world().edge_rule(robot.radii()),
                     [&](int layer, int a, int b) { return window_allows(lattice, layer, a, b); });
}

void expect_same(const PlanResult& a, const PlanResult& b, const std::string& what) {
  ASSERT_EQ(a.status, b.status) << what;
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size()) << what;
  ASSERT_EQ(a.cost, b.cost) << what;
  ASSERT_EQ(a.lattice.cost, b.lattice.cost) << what;
  for (std::size_t i = 0; i < a.trajectory.size(); ++i) {
    ASSERT_EQ(a.trajectory[i].q, b.trajectory[i].q) << what << " row " << i;
    ASSERT_EQ(a.trajectory[i].branch, b.trajectory[i].branch) << what;
    ASSERT_EQ(a.trajectory[i].phi, b.trajectory[i].phi) << what;
  }
  ASSERT_EQ(diagnosis_of(a).reached_layer, diagnosis_of(b).reached_layer) << what;
  ASSERT_EQ(words(diagnosis_of(a).cause), words(diagnosis_of(b).cause)) << what;
  ASSERT_EQ(diagnosis_of(a).without_it, diagnosis_of(b).without_it) << what;
  ASSERT_EQ(diagnosis_of(a).together.size(), diagnosis_of(b).together.size()) << what;
  ASSERT_EQ(diagnosis_of(a).removed.size(), diagnosis_of(b).removed.size()) << what;
  for (std::size_t k = 0; k < diagnosis_of(a).removed.size(); ++k) {
    ASSERT_EQ(words(diagnosis_of(a).removed[k].cause), words(diagnosis_of(b).removed[k].cause))
        << what;
    ASSERT_EQ(diagnosis_of(a).removed[k].count, diagnosis_of(b).removed[k].count) << what;
  }
  ASSERT_EQ(diagnosis_of(a).complete, diagnosis_of(b).complete) << what;
  ASSERT_EQ(diagnosis_of(a).empty_layers.size(), diagnosis_of(b).empty_layers.size()) << what;
  for (std::size_t k = 0; k < diagnosis_of(a).empty_layers.size(); ++k) {
    ASSERT_EQ(diagnosis_of(a).empty_layers[k].first, diagnosis_of(b).empty_layers[k].first) << what;
    ASSERT_EQ(diagnosis_of(a).empty_layers[k].last, diagnosis_of(b).empty_layers[k].last) << what;
    ASSERT_TRUE(
        diagnosis_of(a).empty_layers[k].cause.same_thing(diagnosis_of(b).empty_layers[k].cause))
        << what;
  }
}

/// Counts the random problems by what they have, and the questions that the lazy planner asks.
struct AgreementCounts {
  int reduced = 0, near_motions = 0;
  int solved = 0, infeasible = 0, continuous = 0, started = 0, obstacles = 0, label_changes = 0,
      detours = 0, chosen = 0, mostly_proved = 0;
  std::int64_t proved = 0, lazy_fcl_calls = 0;
};

/// Plans the problem with every planner, with all evidence, in the order of kPlanners.
std::vector<PlanResult> plan_with_all(const PathProblem& problem) {
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners)
    results.push_back(plan(problem, with_all_evidence(planner)));
  return results;
}

/// Expects the path of least cost that brute force finds, and that it passes the check.
void expect_true_path(const PathProblem& problem, const PlanResult& result,
                      const BruteForcePath& truth, const std::string& what,
                      AgreementCounts& counts) {
  counts.chosen += truth.chosen;
  ASSERT_EQ(result.lattice.cost, truth.cost) << what;
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem);
  for (int i = 0; i < lattice.layers(); ++i) {
    const int slot = truth.slots[static_cast<std::size_t>(i)];
    ASSERT_EQ(result.trajectory[static_cast<std::size_t>(i)].phi, lattice.phi(i, slot)) << what;
    ASSERT_EQ(result.trajectory[static_cast<std::size_t>(i)].branch, lattice.branch_of(slot))
        << what;
    if (i > 0)
      counts.label_changes += lattice.solution_of(slot) !=
                              lattice.solution_of(truth.slots[static_cast<std::size_t>(i) - 1]);
  }
  const CheckResult check = check_trajectory(problem, result.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
}

/// Expects the layers that brute force finds to be reached and to be empty. `may_be_incomplete`
/// allows a diagnosis that ends before it has asked about every layer.
void expect_true_diagnosis(const Diagnosis& diagnosis, const BruteForcePath& truth,
                           bool may_be_incomplete, const std::string& what) {
  ASSERT_EQ(diagnosis.reached_layer.value_or(-1), truth.deepest) << what;
  ASSERT_FALSE(words(diagnosis.cause).empty()) << what;
  ASSERT_TRUE(diagnosis.complete || may_be_incomplete) << what;
  if (!diagnosis.complete) return;
  std::vector<int> empty;
  for (const EmptyLayers& run : diagnosis.empty_layers)
    for (int layer = run.first; layer <= run.last; ++layer) empty.push_back(layer);
  ASSERT_EQ(empty, truth.empty) << what;
}

/// Compares the answers of all planners to one problem with each other and with brute force.
void check_agreement(const PathProblem& problem, bool near_by_design, const std::string& what,
                     AgreementCounts& counts) {
  const BruteForcePath truth = truth_of(problem);
  const std::vector<PlanResult> results = plan_with_all(problem);
  const auto& lazy = results[2].counters;
  counts.proved += lazy.proved_free + lazy.proved_colliding;
  counts.lazy_fcl_calls += lazy.fcl_calls;
  counts.mostly_proved += lazy.proved_free + lazy.proved_colliding >= 10 * lazy.fcl_calls;
  ASSERT_EQ(results[0].status == PlanStatus::kSolved, truth.solved) << what;
  for (std::size_t k = 1; k < results.size(); ++k) {
    expect_same(results[0], results[k], what + " planner " + results[k].planner);
    if (::testing::Test::HasFatalFailure()) return;
  }
  const bool moves_continuously = problem.limits.edges == EdgeMode::kContinuous;
  counts.reduced += !results[0].reduced_pairs.empty();
  counts.near_motions += !results[0].reduced_pairs.empty() && truth.solved && moves_continuously;
  counts.continuous += moves_continuously;
  counts.started += problem.start.has_value();
  counts.obstacles += !problem.scene.empty();
  if (truth.solved) {
    ++counts.solved;
    counts.detours += lazy.iterations > 1;
    expect_true_path(problem, results[0], truth, what, counts);
  } else {
    ++counts.infeasible;
    // Pairs that are near by design cost questions, of which a diagnosis asks so many and no
    // more.
    expect_true_diagnosis(diagnosis_of(results[0]), truth, near_by_design, what);
  }
}

/// Prints the counts and expects enough problems of every kind among `count`.
void expect_counts(const AgreementCounts& counts, int count) {
  std::printf(
      "%d problems: %d solved (%d after failures, %d sheet changes), %d infeasible, %d continuous, "
      "%d with a start, %d with "
      "obstacles; lazy: %lld questions certified, %lld FCL calls, ten times fewer in %d\n",
      count, counts.solved, counts.detours, counts.label_changes, counts.infeasible,
      counts.continuous, counts.started, counts.obstacles, static_cast<long long>(counts.proved),
      static_cast<long long>(counts.lazy_fcl_calls), counts.mostly_proved);
  std::printf(
      "%d problems with reduced pairs, of which %d solved with motions; %d starts chosen among "
      "equal costs\n",
      counts.reduced, counts.near_motions, counts.chosen);
  EXPECT_GE(counts.chosen, at_least_among(count / 32));
  EXPECT_GE(counts.reduced, at_least_among(count / 24));
  EXPECT_GE(counts.near_motions, at_least(3));
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  // Not the sums of the questions, of which one problem may have more than all others.
  EXPECT_GE(counts.mostly_proved, at_least_among(count * 2 / 3));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.continuous, at_least_among(count / 5));
  EXPECT_GE(counts.started, at_least_among(count / 10));
  EXPECT_GE(counts.detours, at_least_among(count / 20));
}

TEST(Agreement, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("Agreement");
  const auto robots = all_robots();
  // Whose own bodies are near each other, and no SRDF says so.
  const std::vector<TestRobot> bare{near_wrist_robot(), without_srdf(data_robot("sda5f")),
                                    without_srdf(data_robot("iiwa14"))};
  AgreementCounts counts;
  const int count = trials(320);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const bool near_by_design = trial % 8 == 7;
    const PathProblem problem =
        random_problem(near_by_design ? bare[static_cast<std::size_t>(trial / 8) % bare.size()]
                                      : robots[static_cast<std::size_t>(trial) % robots.size()],
                       random);
    check_agreement(problem, near_by_design,
                    "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                        " robot " + problem.source,
                    counts);
    if (HasFatalFailure()) return;
  }
  expect_counts(counts, count);
}

/// PlanOptions::fcl_alone beside own proofs: fresh, and by a planner that remembers, after an
/// object has moved.
TEST(Agreement, FclAloneGivesTheSameAnswers) {
  const std::uint64_t base = seed("Agreement.FclAlone");
  const auto robots = all_robots();
  int solved = 0, infeasible = 0, asked = 0, moves = 0, mostly_proved = 0;
  std::int64_t alone_calls = 0, calls = 0, proved = 0;
  const int count = trials(100);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + problem.source;
    for (const PlannerKind kind : {PlannerKind::kLazy, PlannerKind::kParallel}) {
      PlanOptions options;
      options.planner = kind;
      options.threads = 2;
      PlanOptions alone_options = options;
      alone_options.fcl_alone = true;
      Planner planner(problem), alone(problem);
      const auto compare = [&](const std::string& when) {
        const PlanResult with_proofs = planner.plan(options), by_fcl = alone.plan(alone_options);
        expect_same(with_proofs, by_fcl, what + " " + by_fcl.planner + when);
        ++(with_proofs.status == PlanStatus::kSolved ? solved : infeasible);
        EXPECT_EQ(by_fcl.counters.proved_free + by_fcl.counters.proved_colliding, 0)
            << what << when;
        proved += with_proofs.counters.proved_free + with_proofs.counters.proved_colliding;
        calls += with_proofs.counters.fcl_calls;
        alone_calls += by_fcl.counters.fcl_calls;
        asked += by_fcl.counters.fcl_calls > 0;
        mostly_proved += by_fcl.counters.fcl_calls >= 10 * with_proofs.counters.fcl_calls;
      };
      compare("");
      if (HasFatalFailure()) return;
      if (problem.scene.empty()) continue;
      Pose pose = problem.scene[0].pose;
      pose.translation() += Vector3d(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                                     random.uniform(-0.02, 0.02));
      planner.move(problem.scene[0].name, pose);
      alone.move(problem.scene[0].name, pose);
      ++moves;
      compare(" moved");
      if (HasFatalFailure()) return;
    }
  }
  std::printf(
      "%d plans solved, %d infeasible, %d after a move; FCL alone: %lld calls, in %d plans; else "
      "%lld, %lld certified, ten times fewer in %d plans\n",
      solved, infeasible, moves, static_cast<long long>(alone_calls), asked,
      static_cast<long long>(calls), static_cast<long long>(proved), mostly_proved);
  EXPECT_GE(solved, at_least_among(count));
  EXPECT_GE(infeasible, at_least_among(count / 5));
  EXPECT_GE(moves, at_least_among(count));
  EXPECT_GE(asked, at_least_among(count));
  // Not the sums of the calls, of which one plan may have more than all others.
  EXPECT_GE(mostly_proved, at_least_among((solved + infeasible) * 2 / 3));
}

/// Arms along arcs, a roll that is chosen as well, and a part in the hand.
TEST(Agreement, FclAloneGivesTheSameAnswersOnOtherLattices) {
  std::int64_t more = 0;
  for (const char* name :
       {"panda_weld_seam", "kr6_weld_pipe", "torch_door", "iiwa14_deburr_in_hand"}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    problem.resolution.ds = 0.02;
    problem.resolution.dphi = 0.2;
    problem.resolution.arc = problem.resolution.droll = 0.4;
    problem.limits.edges = EdgeMode::kNodes;
    const PreparedRobot robot(problem);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult with_proofs = plan(robot, problem, options);
    options.fcl_alone = true;
    const PlanResult by_fcl = plan(robot, problem, options);
    expect_same(with_proofs, by_fcl, name);
    std::printf("%s: %s, FCL calls %lld, alone %lld\n", name, to_string(by_fcl.status),
                static_cast<long long>(with_proofs.counters.fcl_calls),
                static_cast<long long>(by_fcl.counters.fcl_calls));
    EXPECT_GE(by_fcl.counters.fcl_calls, with_proofs.counters.fcl_calls)
        << name;  // bounds may clear all
    more += by_fcl.counters.fcl_calls > with_proofs.counters.fcl_calls;
  }
  EXPECT_GE(more, 3);
}

/// Weights of every size, some or all of them zero, in one table so that each kind is met equally
/// often.
enum class Weights { kAllZero, kSomeZero, kLeast, kMost, kBothEnds, kCount };

void set_weights(Weights kind, Random& random, Cost& cost) {
  for (double& weight : cost.weights.emplace()) switch (kind) {
      case Weights::kAllZero:
        weight = 0;
        break;
      case Weights::kSomeZero:
        weight = random.coin() ? 0 : random.uniform(0.1, 2);
        break;
      case Weights::kLeast:
        weight = 1e-6 * random.uniform(1, 3);
        break;
      case Weights::kMost:
        weight = 1e6 * random.uniform(0.3, 1);
        break;
      default:
        weight = random.coin() ? 1e-6 : random.coin() ? 1e6 : 0;
    }
}

TEST(Agreement, FourPlannersAndBruteForceAtWeightsOfAnySize) {
  const std::uint64_t base = seed("Agreement.Weights");
  const auto robots = all_robots();
  constexpr int kKinds = static_cast<int>(Weights::kCount);
  std::array<int, kKinds> solved{}, infeasible{};
  const int count = trials(150);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial / kKinds) % robots.size()], random);
    const auto kind = static_cast<std::size_t>(trial % kKinds);
    problem.limits.step_error = std::nullopt;
    if (random.coin(0.3))
      problem.limits.joint_step =
          random.uniform(0.1, 0.4);  // where no path is, moves are what is missing
    set_weights(static_cast<Weights>(kind), random, problem.cost);
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + problem.source + " kind " +
                             std::to_string(kind);
    const BruteForcePath truth = truth_of(problem);
    (truth.solved ? solved : infeasible)[kind] += 1;
    std::vector<PlanResult> results;
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options;
      options.planner = planner;
      options.threads = 2;
      options.timeout_s = 20;  // a search that never ends fails here
      results.push_back(plan(problem, options));
      ASSERT_EQ(results.back().status, truth.solved ? PlanStatus::kSolved : PlanStatus::kInfeasible)
          << what << " planner " << results.back().planner;
      expect_same(results[0], results.back(), what + " planner " + results.back().planner);
      if (HasFatalFailure()) return;
    }
    if (!truth.solved) {
      ASSERT_EQ(diagnosis_of(results[0]).reached_layer.value_or(-1), truth.deepest) << what;
      continue;
    }
    ASSERT_EQ(results[0].lattice.cost, truth.cost) << what;
    const PreparedRobot robot(problem);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
    const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem);
    for (int i = 0; i < lattice.layers(); ++i)
      ASSERT_EQ(results[0].trajectory[static_cast<std::size_t>(i)].phi,
                lattice.phi(i, truth.slots[static_cast<std::size_t>(i)]))
          << what;
  }
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    std::printf("weights of kind %zu: %d solved, %d infeasible\n", kind, solved[kind],
                infeasible[kind]);
    EXPECT_GE(solved[kind], at_least_among(count / 50));
    EXPECT_GE(infeasible[kind], at_least_among(count / 50));
  }
}

/// A problem whose start may be in one of the slivers at the ends of the joints' ranges.
struct SliverCase {
  PathProblem problem;
  int in_sliver = 0;  ///< how many joints start in the sliver at their upper limit
};

/// Draws the case; `wide` gives joint 4 a range of over 64 turns.
SliverCase random_sliver_case(bool wide, Random& random) {
  const std::array slivers{random.uniform(0, 1e-3), random.uniform(0, 1e-3)};
  const TestRobot robot = with_limits(windings_robot(), [&](int number, Joint& joint) {
    if (number == 0) joint.lower = -kPi, joint.upper = kPi + slivers[0];
    if (number == 4 && wide) joint.lower = -1000, joint.upper = 3000;
    if (number == 6) joint.lower = -kTwoPi, joint.upper = kTwoPi + slivers[1];
  });
  SliverCase drawn;
  PathProblem& problem = drawn.problem;
  problem = random_problem(robot, random);
  const Chain chain = arm_of(robot).chain;
  Config q = random_config(chain, random);
  if (random.coin(0.8)) q[4] = random.uniform(-3, 3);
  for (const int j : {0, 6}) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double sliver = slivers[j == 0 ? 0 : 1];
    if (random.coin(0.3))
      q[j] = limit.lower + random.uniform(0, sliver);
    else if (random.coin(0.6))
      q[j] = limit.upper - random.uniform(0, sliver), ++drawn.in_sliver;
  }
  Config end = q;
  for (int j = 0; j < kDof; ++j) end[j] += random.uniform(-0.2, 0.2);
  problem.waypoints = {waypoint_of(chain.tool(q)), waypoint_of(chain.tool(end))};
  problem.limits.step_error = std::nullopt;
  problem.limits.joint_margin = 0;
  problem.limits.tool_path_error = 0.1;
  problem.scene.resize(std::min<std::size_t>(problem.scene.size(), 1));
  problem.start = q;
  return drawn;
}

/// Compares all planners with brute force, and expects a warning where a range is too wide.
void check_slivers(const PathProblem& problem, const BruteForcePath& truth, bool wide,
                   const std::string& what) {
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  ASSERT_EQ(SrsLattice(robot.arm().chain, robot.srs(), path, problem).windings(), 2) << what;
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options;
    options.planner = planner;
    options.threads = 2;
    results.push_back(plan(problem, options));
    ASSERT_LE(results.back().lattice.grid->windings, 2) << what;  // 1 where joint 7 is a circle
    expect_same(results[0], results.back(), what + " planner " + results.back().planner);
    if (::testing::Test::HasFatalFailure()) return;
  }
  ASSERT_EQ(results[0].status == PlanStatus::kSolved, truth.solved) << what;
  const auto of_limits = [](const std::string& warning) {
    return warning.find("turns apart") != std::string::npos;
  };
  ASSERT_EQ(std::none_of(results[0].warnings.begin(), results[0].warnings.end(), of_limits), !wide)
      << what;
  if (!truth.solved) return;
  ASSERT_EQ(results[0].lattice.cost, truth.cost) << what;
  ASSERT_EQ(results[0].trajectory[0].q, *problem.start) << what;
  const CheckResult check = check_trajectory(problem, results[0].trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
}

/// Ranges of a turn and a sliver, two turns and a sliver, and over 64 turns; a start at the limits,
/// in the slivers and beside them.
TEST(Agreement, FourPlannersAndBruteForceWhereRangesEndInSlivers) {
  const std::uint64_t base = seed("Agreement.Slivers");
  int solved = 0, infeasible = 0, in_sliver = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const bool wide = trial % 3 == 0;
    const SliverCase drawn = random_sliver_case(wide, random);
    in_sliver += drawn.in_sliver;
    const BruteForcePath truth = truth_of(drawn.problem);
    (truth.solved ? solved : infeasible) += 1;
    check_slivers(drawn.problem, truth, wide,
                  "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial));
    if (HasFatalFailure()) return;
  }
  std::printf("%d problems: %d solved, %d infeasible; %d joints began in a sliver\n", count, solved,
              infeasible, in_sliver);
  EXPECT_GE(solved, at_least_among(count / 4));
  EXPECT_GE(in_sliver, at_least_among(count / 2));
}

TEST(Agreement, LimitsRoundedUpGiveTheSamePath) {
  const auto iiwa = [](double limit) {
    return with_limits(data_robot("iiwa14"), [&](int number, Joint& joint) {
      if (number % 2 == 0) joint.lower = -limit, joint.upper = limit;
    });
  };
  const Chain chain = arm_of(iiwa(3)).chain;
  Config q0, q1;
  q0 = {0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.0};
  q1 = {0.5, 0.7, 0.1, -1.0, 0.3, 0.8, 0.2};
  std::vector<PlanResult> results;
  for (const double limit : {3.14159, 3.1416}) {
    PathProblem problem = problem_for(iiwa(limit));
    problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
    results.push_back(plan(problem));
    EXPECT_EQ(results.back().lattice.grid->windings, 1);
  }
  ASSERT_EQ(results[0].status, PlanStatus::kSolved);
  expect_same(results[0], results[1], "3.14159 and 3.1416");
}

class Experiments : public testing::TestWithParam<const char*> {};

TEST_P(Experiments, FourPlannersAgreeAtTheCoarseResolution) {
  PathProblem problem =
      io::load_path_problem(data_dir() / "problems" / (std::string(GetParam()) + ".yaml"));
  problem.resolution.ds = 0.02;
  problem.resolution.dphi = 0.2;
  problem.limits.edges = EdgeMode::kNodes;
  const PreparedRobot robot(problem);
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options;
    options.planner = planner;
    results.push_back(plan(robot, problem, options));
    expect_same(results[0], results.back(), results.back().planner);
    std::printf("%s %s: %s, cost %.12g, %lld nodes checked, %lld FCL calls, plan %.1f ms\n",
                GetParam(), results.back().planner.c_str(), to_string(results.back().status),
                results.back().cost, static_cast<long long>(results.back().counters.nodes_checked),
                static_cast<long long>(results.back().counters.fcl_calls),
                results.back().time_ms["plan"]);
  }
  ASSERT_EQ(results[0].status, PlanStatus::kSolved);
  EXPECT_TRUE(check_trajectory(problem, results[0].trajectory).passed);
}
INSTANTIATE_TEST_SUITE_P(Paper, Experiments,
                         testing::Values("experiment_a", "experiment_b", "experiment_c"));

}  // namespace
}  // namespace swivel
