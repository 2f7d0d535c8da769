// SPDX-License-Identifier: BSD-3-Clause
// Rules and costs of the caller's own: all planners and brute force honour them alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <thread>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/graph/eager/eager.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

/// A smooth function of the joints, from -1 to 1, that repeats with every turn of any joint.
class Wave {
 public:
  explicit Wave(Random& random) {
    for (int j = 0; j < kDof; ++j) {
      turns_[j] = random.below(4);
      shift_[j] = random.uniform(0, kTwoPi);
    }
  }
  double operator()(const Config& q) const {
    double sum = 0;
    for (int j = 0; j < kDof; ++j) sum += std::sin(turns_[j] * q[j] + shift_[j]);
    return std::sin(2 * sum);
  }

 private:
  Config turns_, shift_;
};

/// Refuses where a wave is high, of motions: half way. Counts what it is asked, and that nobody
/// else asks meanwhile.
class WaveCheck : public StateCheck {
 public:
  WaveCheck(Random& random, double states_above, double motions_above)
      : wave_(random), states_above_(states_above), motions_above_(motions_above) {}
  [[nodiscard]] std::string name() const override { return "wave"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    const Alone alone(*this);
    ++calls;
    ASSERT_EQ(states.size(), allowed.size());
    ASSERT_FALSE(states.empty());
    for (std::size_t k = 0; k < states.size(); ++k) {
      allowed[k] = wave_(states[k]) <= states_above_;
      ++asked;
      refused += !allowed[k];
      if (world_ && query_->find_violating_pair(states[k], ClearanceRule::kNode)) ++in_collision;
    }
  }
  [[nodiscard]] bool checks_motions() const override { return motions_above_ < 1; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    const Alone alone(*this);
    ++calls;
    ASSERT_EQ(motions.size(), allowed.size());
    ASSERT_FALSE(motions.empty());
    for (std::size_t k = 0; k < motions.size(); ++k) {
      allowed[k] = wave_((motions[k].from + motions[k].to) / 2) <= motions_above_;
      ++asked;
      refused += !allowed[k];
      ASSERT_LE((motions[k].to - motions[k].from).lpNorm<Eigen::Infinity>(), kPi);
    }
  }
  /// Every state that is asked about is held against the scene.
  void look_for_collisions(const World& with) {
    world_ = &with;
    query_.emplace(with);
  }

  std::int64_t asked = 0, refused = 0, calls = 0, in_collision = 0;
  std::atomic<int> at_once{0}, most_at_once{0};

 private:
  struct Alone {
    explicit Alone(WaveCheck& check) : of(check) {
      of.most_at_once = std::max(of.most_at_once.load(), ++of.at_once);
    }
    ~Alone() { --of.at_once; }
    WaveCheck& of;
  };
  Wave wave_;
  double states_above_, motions_above_;
  const World* world_ = nullptr;
  std::optional<World::Query> query_;
};

/// A wave from 0 to `most` where it is above `from`: nearly everywhere, or here and there.
class WaveCost : public StateCost {
 public:
  WaveCost(Random& random, double from, double most) : wave_(random), from_(from), most_(most) {}
  [[nodiscard]] std::string name() const override { return "wave"; }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    ASSERT_EQ(states.size(), costs.size());
    ++calls;
    for (std::size_t k = 0; k < states.size(); ++k) costs[k] = of(states[k]);
    asked += static_cast<std::int64_t>(states.size());
  }
  [[nodiscard]] double of(const Config& q) const {
    return most_ * std::max(0.0, wave_(q) - from_) / (1 - from_);
  }

  std::int64_t asked = 0, calls = 0;

 private:
  Wave wave_;
  double from_, most_;
};

std::shared_ptr<WaveCheck> random_check(Random& random) {
  const double states = std::array{1.0, 0.9, 0.5, -0.5}[static_cast<std::size_t>(random.below(4))];
  const double motions = std::array{1.0, 0.9, 0.4}[static_cast<std::size_t>(random.below(3))];
  return std::make_shared<WaveCheck>(random, states, motions);
}

std::shared_ptr<WaveCost> random_cost(Random& random, double unit) {
  const double from = std::array{-0.999, 0.0, 0.8}[static_cast<std::size_t>(random.below(3))];
  const double most =
      unit * std::array{1e-4, 0.02, 0.3, 5.0, 300.0}[static_cast<std::size_t>(random.below(5))];
  return std::make_shared<WaveCost>(random, from, most);
}

PlanOptions options_for(PlannerKind planner) {
  PlanOptions options;
  options.planner = planner;
  options.threads = 2;
  return options;
}

/// Holds one random problem with rules and costs of the caller's own, and its answer by brute
/// force.
struct Case {
  Case(const TestRobot& model, int trial, Random& random)
      : problem(random_problem(model, random)),
        robot(problem),
        path(problem_path(problem, robot.arm().chain)),
        lattice(robot.arm().chain, robot.srs(), path, problem),
        check(trial % 4 == 1 ? nullptr : random_check(random)),
        cost(trial % 4 == 2 ? nullptr : random_cost(random, lattice.cost_unit())),
        hooks{check, cost},
        world(robot.world(), problem),
        truth(brute_force(
            lattice, world, world.edge_rule(robot.radii()),
            [&](int layer, int a, int b) { return window_allows(lattice, layer, a, b); }, hooks)) {
    if (check) check->look_for_collisions(world);
  }

  const PathProblem problem;
  const PreparedRobot robot;
  const ToolPath path;
  const SrsLattice lattice;
  const std::shared_ptr<WaveCheck> check;
  const std::shared_ptr<WaveCost> cost;
  const Hooks hooks;
  const World world;
  const BruteForcePath truth;
};

/// Counts the problems by what they have and by how they end, and the questions to the caller.
struct Counts {
  int solved = 0, infeasible = 0, with_cost = 0, with_check = 0, with_motions = 0, other_path = 0,
      other_verdict = 0, by_check = 0, confirmed = 0;
  std::int64_t asked = 0, refused = 0, lazy_costs = 0, eager_costs = 0;
};

/// Checks a planner's answer against brute force, and its rows and reasons against the first
/// planner's.
void expect_truth(const Case& one, const PlanResult& result, const PlanResult& first,
                  const std::string& who) {
  const BruteForcePath& truth = one.truth;
  ASSERT_EQ(result.status, truth.solved ? PlanStatus::kSolved : PlanStatus::kInfeasible) << who;
  ASSERT_EQ(result.cost, truth.solved ? truth.cost : 0) << who;
  for (int i = 0; truth.solved && i < one.lattice.layers(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    ASSERT_EQ(result.trajectory[row].phi, one.lattice.phi(i, truth.slots[row]))
        << who << " row " << i;
    ASSERT_EQ(result.trajectory[row].branch, one.lattice.branch(i, truth.slots[row]))
        << who << " row " << i;
    ASSERT_EQ(result.trajectory[row].q, first.trajectory[row].q) << who << " row " << i;
  }
  ASSERT_EQ(words(diagnosis_of(result).cause), words(diagnosis_of(first).cause)) << who;
  ASSERT_EQ(diagnosis_of(result).removed, diagnosis_of(first).removed) << who;
  ASSERT_EQ(result.partial.size(), first.partial.size()) << who;
  for (std::size_t i = 0; i < result.partial.size(); ++i)
    ASSERT_EQ(result.partial[i].q, first.partial[i].q) << who << " row " << i;
  if (!truth.solved) {
    ASSERT_EQ(diagnosis_of(result).reached_layer.value_or(-1), truth.deepest) << who;
    ASSERT_NE(diagnosis_of(result).cause.kind, Cause::Kind::kNone) << who;
    std::vector<int> empty;
    for (const EmptyLayers& run : diagnosis_of(result).empty_layers)
      for (int layer = run.first; layer <= run.last; ++layer) empty.push_back(layer);
    ASSERT_TRUE(!diagnosis_of(result).complete || empty == truth.empty) << who;
  }
}

/// Plans with each planner and checks its answer, and that the caller's check is asked by one at a
/// time and about no state in collision. Puts the first planner's answer into `first`.
void plan_with_each(const Case& one, const std::string& what, std::optional<PlanResult>& first,
                    Counts& counts) {
  const auto& check = one.check;
  const auto& cost = one.cost;
  for (int k = 0; k < 4; ++k) {
    PlanOptions options = options_for(kPlanners[k]);
    options.evidence.layers = true;
    options.hooks = one.hooks;
    if (check) check->asked = check->refused = 0;
    if (cost) cost->asked = 0;
    const PlanResult result = plan(one.robot, one.problem, options);
    if (!first) first = result;
    const std::string who = what + " planner " + result.planner;
    expect_truth(one, result, *first, who);
    if (::testing::Test::HasFatalFailure()) return;
    if (check) {
      ASSERT_EQ(check->in_collision, 0) << who;
      ASSERT_LE(check->most_at_once, 1) << who;
      counts.asked += check->asked;
      counts.refused += check->refused;
    }
    if (cost && k == 1) counts.eager_costs += cost->asked;
    if (cost && k == 2) counts.lazy_costs += cost->asked;
  }
}

/// Checks that the trajectory passes, and that its cost is that of its motions and of its states.
void expect_cost_of_states(const Case& one, const std::vector<TrajectoryRow>& rows,
                           const std::string& what) {
  const CheckResult checked = check_trajectory(one.robot, one.problem, rows);
  ASSERT_TRUE(checked.passed) << what << ": "
                              << (checked.failures.empty() ? "" : checked.failures[0]);
  double of_states = 0;
  for (const TrajectoryRow& row : rows) of_states += one.cost ? one.cost->of(row.q) : 0;
  ASSERT_NEAR(checked.cost + of_states, one.truth.cost, 1e-9 * std::max(1.0, one.truth.cost))
      << what;
}

/// Plans without hooks: counts what they changed, and checks a path that is said to be possible
/// without the check.
void compare_with_plain(const Case& one, const PlanResult& hooked, const std::string& what,
                        Counts& counts) {
  const PlanResult plain = plan(one.robot, one.problem, options_for(PlannerKind::kLazy));
  counts.other_verdict += plain.status != hooked.status;
  if (const Diagnosis& d = diagnosis_of(hooked); !one.truth.solved && one.check && d.without_it) {
    ASSERT_EQ(d.cause.kind, Cause::Kind::kCheck) << what;
    ASSERT_TRUE(plain.status == PlanStatus::kSolved ||
                diagnosis_of(plain).reached_layer.value_or(-1) >= *d.without_it)
        << what;
    ++counts.confirmed;
  }
  if (one.truth.solved)
    counts.other_path +=
        !std::equal(plain.trajectory.begin(), plain.trajectory.end(), hooked.trajectory.begin(),
                    [](const TrajectoryRow& a, const TrajectoryRow& b) { return a.q == b.q; });
}

/// Checks all planners on one problem, and what its hooks changed.
void check_case(const Case& one, const std::string& what, Counts& counts) {
  (one.truth.solved ? counts.solved : counts.infeasible) += 1;
  counts.with_cost += one.cost != nullptr;
  counts.with_check += one.check != nullptr;
  counts.with_motions += one.check && one.check->checks_motions();
  std::optional<PlanResult> first;
  plan_with_each(one, what, first, counts);
  if (::testing::Test::HasFatalFailure()) return;
  counts.by_check += words(diagnosis_of(*first).cause).starts_with("check wave");
  if (one.truth.solved) expect_cost_of_states(one, first->trajectory, what);
  if (::testing::Test::HasFatalFailure()) return;
  compare_with_plain(one, *first, what, counts);
}

TEST(Hooks, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("Hooks");
  const auto robots = all_robots();
  Counts counts;
  const int count = trials(200);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Case one(robots[static_cast<std::size_t>(trial) % robots.size()], trial, random);
    check_case(one,
               "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                   " robot " + one.problem.source,
               counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d infeasible (%d by a check, %d confirmed without it); %d with "
      "costs, %d with checks, %d of "
      "motions; another path %d times, "
      "another verdict %d times; %lld asked, %lld refused; costs asked: %lld lazily, %lld "
      "eagerly\n",
      count, counts.solved, counts.infeasible, counts.by_check, counts.confirmed, counts.with_cost,
      counts.with_check, counts.with_motions, counts.other_path, counts.other_verdict,
      static_cast<long long>(counts.asked), static_cast<long long>(counts.refused),
      static_cast<long long>(counts.lazy_costs), static_cast<long long>(counts.eager_costs));
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 10));
  EXPECT_GE(counts.with_motions, at_least_among(count / 4));
  EXPECT_GE(counts.other_path, at_least_among(count / 10));
  EXPECT_GE(counts.other_verdict, at_least_among(count / 40));
  EXPECT_GE(counts.by_check, at_least_among(count / 40));
  EXPECT_GE(counts.confirmed, at_least_among(count / 80));
  EXPECT_GE(counts.refused, at_least_among(counts.asked / 20 + 1));
  EXPECT_LT(counts.lazy_costs, counts.eager_costs);
}

/// Makes a random problem on a coarse lattice whose last pose is within a wall.
PathProblem walled_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.limits.arm_slope = Limits().arm_slope;
  problem.limits.joint_step = 1;
  problem.resolution.arc = 0.4;
  problem.start.reset();
  SceneObject wall;  // about the last pose
  wall.name = "wall";
  wall.shape = Sphere{0.1};
  wall.pose.translation() = waypoints_in_base(problem).back().position;
  problem.scene.push_back(wall);
  return problem;
}

/// How far the tool comes, and by which path, depends neither on what a planner planned before nor
/// on threads, although remembered failures may end every path before any cost is asked.
TEST(Hooks, PartialPathsAreTheSameWhateverWasPlannedBefore) {
  const std::uint64_t base = seed("Hooks.Partial");
  TestRobot panda = data_robot("panda_like");
  panda.tip_link = "flange";
  const std::vector<TestRobot> robots{data_robot("iiwa14"), panda, data_robot("sda5f"),
                                      windings_robot()};
  int infeasible = 0, rows = 0, costs_mattered = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        walled_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + problem.source;
    std::optional<PlanResult> first;
    for (const auto& [kind, threads] :
         {std::pair(PlannerKind::kLazy, 1), std::pair(PlannerKind::kParallel, 1),
          std::pair(PlannerKind::kParallel, 3), std::pair(PlannerKind::kEagerDp, 1)}) {
      Planner planner(problem);
      for (int time = 0; time < 3; ++time) {
        PlanOptions options = options_for(kind);
        options.threads = threads;
        options.evidence.layers = true;
        Random of_cost(base + static_cast<std::uint64_t>(trial));
        options.hooks.cost = std::make_shared<WaveCost>(of_cost, -0.999, 1.0);
        const PlanResult result = planner.plan(options);
        if (!first) first = result;
        const std::string who =
            what + " planner " + result.planner + " plan " + std::to_string(time);
        ASSERT_EQ(result.status, first->status) << who;
        ASSERT_EQ(result.partial.size(), first->partial.size()) << who;
        for (std::size_t i = 0; i < result.partial.size(); ++i)
          ASSERT_EQ(result.partial[i].q, first->partial[i].q) << who;
        ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(*first).cause) << who;
        ASSERT_EQ(diagnosis_of(result).removed, diagnosis_of(*first).removed) << who;
        ASSERT_EQ(diagnosis_of(result).without_it, diagnosis_of(*first).without_it) << who;
      }
    }
    if (first->status != PlanStatus::kInfeasible) continue;
    ++infeasible;
    rows += static_cast<int>(first->partial.size());
    const PlanResult plain = plan(problem, options_for(PlannerKind::kLazy));
    costs_mattered += !std::equal(
        plain.partial.begin(), plain.partial.end(), first->partial.begin(), first->partial.end(),
        [](const TrajectoryRow& a, const TrajectoryRow& b) { return a.q == b.q; });
  }
  std::printf(
      "%d problems without a path, %d rows of the way there; in %d of them costs changed it\n",
      infeasible, rows, costs_mattered);
  EXPECT_GE(infeasible, at_least_among(count / 2));
  EXPECT_GE(costs_mattered, at_least_among(count / 8));
}

/// Makes a random problem without a start and without a limit of step errors.
PathProblem startless_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.start.reset();
  return problem;
}

/// Lists a random half of the nodes of each layer of a grid.
std::vector<std::vector<ExplicitLattice::Point>> half_of_nodes(const SrsLattice& grid,
                                                               Random& random) {
  std::vector<std::vector<ExplicitLattice::Point>> layers(static_cast<std::size_t>(grid.layers()));
  std::vector<Lattice::Node> nodes;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    grid.layer_nodes(static_cast<int>(i), nodes);
    for (const Lattice::Node& node : nodes)
      if (random.coin(0.5)) layers[i].push_back({.q = node.q});
  }
  return layers;
}

/// Holds a lattice of listed nodes with hooks, and its answer by brute force.
struct ListedCase {
  ListedCase(const TestRobot& robot, Random& random, const std::string& what)
      : problem(startless_problem(robot, random)),
        arm(arm_of(robot)),
        srs(fit_srs(arm.chain, what)),
        path(problem_path(problem, arm.chain)),
        grid(arm.chain, srs, path, problem),
        lattice(arm.chain, path, problem, half_of_nodes(grid, random)),
        world(*robot.model, arm, problem),
        rule(world.edge_rule(motion_radii(arm.chain, world.bodies()))),
        hooks{random_check(random), random_cost(random, lattice.cost_unit())},
        truth(brute_force(
            lattice, world, rule, [](int, int, int) { return true; }, hooks)) {}

  /// Checks what a search found: its path and cost, or how deep paths reach.
  void expect_truth(const SlotPath& slots, double cost, int deepest, const std::string& who) const {
    ASSERT_EQ(slots, truth.slots) << who;
    ASSERT_TRUE(!truth.solved || cost == truth.cost) << who;
    ASSERT_TRUE(truth.solved || deepest == truth.deepest) << who;
  }

  const PathProblem problem;
  const ArmModel arm;
  const SrsArm srs;
  const ToolPath path;
  const SrsLattice grid;
  const ExplicitLattice lattice;
  const World world;
  const EdgeRule rule;
  const Hooks hooks;
  const BruteForcePath truth;
};

/// Checks the searches that ask about every node, with stored edges and without.
void check_eager_searches(const ListedCase& one, const std::string& what) {
  Executor executor(1);
  const Budget never;
  for (const bool stored : {true, false}) {
    CollisionValidity collision(one.lattice, one.world, one.rule, one.problem.limits.edges,
                                DistanceProofs::kOff, executor, 0, never);
    HookedValidity validity(one.lattice, collision, one.hooks, never);
    EagerOutcome found;
    (stored ? eager_search : eager_dp)(one.lattice, validity, never, found);
    one.expect_truth(found.path, found.cost, found.deepest.value_or(-1), what + " eager");
  }
}

/// Checks the search that asks along paths only, about 1 and 32 at once; returns its rounds.
int check_lazy_searches(const ListedCase& one, const std::string& what) {
  Executor executor(1);
  const Budget never;
  int rounds = 0;
  for (const int batch : {1, 32}) {
    CollisionValidity collision(one.lattice, one.world, one.rule, one.problem.limits.edges,
                                DistanceProofs::kOn, executor, batch == 1 ? 1 : 4, never);
    HookedValidity validity(one.lattice, collision, one.hooks, never);
    const auto cost_to_go = make_cost_to_go(one.lattice);
    cost_to_go->sweep(one.lattice.layers() - 1);
    SearchCounters counters;
    const SearchOutcome found = path_first(*cost_to_go, validity, {.batch = batch}, counters);
    rounds += static_cast<int>(counters.iterations);
    int deepest = -1;
    if (found.path.empty())
      deepest = deepest_valid_layer(*cost_to_go, validity, {.batch = batch}, counters);
    one.expect_truth(found.path, found.cost, deepest, what + " lazy");
  }
  return rounds;
}

TEST(Hooks, SearchesOfListsAgreeWithBruteForce) {
  const std::uint64_t base = seed("Hooks.Lists");
  const auto robots = all_robots();
  int solved = 0, infeasible = 0, rounds = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const ListedCase one(robots[static_cast<std::size_t>(trial) % robots.size()], random, what);
    (one.truth.solved ? solved : infeasible) += 1;
    check_eager_searches(one, what);
    rounds += check_lazy_searches(one, what);
    if (HasFatalFailure()) return;
  }
  std::printf("%d solved, %d infeasible, %d rounds\n", solved, infeasible, rounds);
  EXPECT_GE(solved, at_least_among(count / 5));
  EXPECT_GE(infeasible, at_least_among(count / 10));
  EXPECT_GT(rounds, 4 * count);
}

PathProblem experiment(const char* name, double ds, double dphi) {
  PathProblem problem =
      io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
  problem.resolution.ds = ds;
  problem.resolution.dphi = dphi;
  return problem;
}

/// A check that asks a function about each state.
template <class Of>
class CheckOf : public StateCheck {
 public:
  explicit CheckOf(Of of) : of_(std::move(of)) {}
  [[nodiscard]] std::string name() const override { return "of the test"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < states.size(); ++k) allowed[k] = of_(states[k]);
  }

 private:
  Of of_;
};
template <class Of>
class CostOf : public StateCost {
 public:
  explicit CostOf(Of of) : of_(std::move(of)) {}
  [[nodiscard]] std::string name() const override { return "of the test"; }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    for (std::size_t k = 0; k < states.size(); ++k) costs[k] = of_(states[k]);
  }

 private:
  Of of_;
};
template <class Of>
std::shared_ptr<StateCheck> check_of(Of of) {
  return std::make_shared<CheckOf<Of>>(std::move(of));
}
template <class Of>
std::shared_ptr<StateCost> cost_of(Of of) {
  return std::make_shared<CostOf<Of>>(std::move(of));
}

void expect_same(const PlanResult& a, const PlanResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.cost, b.cost);
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size());
  for (std::size_t i = 0; i < a.trajectory.size(); ++i)
    EXPECT_EQ(a.trajectory[i].q, b.trajectory[i].q);
}

TEST(Hooks, ThatSayNothingChangeNothing) {
  const PathProblem problem = experiment("experiment_a", 0.02, 0.1);
  const PreparedRobot robot(problem);
  for (const PlannerKind planner : kPlanners) {
    const PlanResult plain = plan(robot, problem, options_for(planner));
    PlanOptions options = options_for(planner);
    options.hooks = {check_of([](const Config&) { return true; }),
                     cost_of([](const Config&) { return 0.0; })};
    const PlanResult hooked = plan(robot, problem, options);
    ASSERT_EQ(plain.status, PlanStatus::kSolved);
    expect_same(plain, hooked);
    EXPECT_EQ(plain.counters.nodes_checked, hooked.counters.nodes_checked);
    EXPECT_EQ(plain.counters.iterations, hooked.counters.iterations);
  }
}

/// An arm without an arm angle has nodes at knots, but not where its states cost something: the
/// states of all layers count, and `knot`, which then means nothing, is warned of.
TEST(Hooks, CostsOfStatesCountAtEveryLayerOfArmsAlongArcs) {
  const PathProblem problem = experiment("panda_weld_seam", 0.02, 0.1);
  const PreparedRobot robot(problem);
  const auto bowl = [](const Config& q) { return 0.02 * std::abs(q[0] - 0.2); };
  Planner again(problem);  // whose lattice serves plans with and without a cost
  const PlanResult on_knots = again.plan();
  ASSERT_EQ(on_knots.status, PlanStatus::kSolved);
  ASSERT_TRUE(on_knots.lattice.knots);
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options = options_for(planner);
    options.hooks.cost = cost_of(bowl);
    const PlanResult found = again.plan(options);
    ASSERT_EQ(found.status, PlanStatus::kSolved);
    EXPECT_FALSE(found.lattice.knots);
    double states = 0;
    for (const TrajectoryRow& row : found.trajectory) states += bowl(row.q);
    EXPECT_GT(states, 0.05);
    EXPECT_NEAR(found.cost, check_trajectory(robot, problem, found.trajectory).cost + states, 1e-9);
    PathProblem every_layer = problem;
    every_layer.resolution.knot = 0;
    expect_same(found, plan(robot, every_layer, options));
    EXPECT_EQ(found.warnings, on_knots.warnings);
    every_layer.resolution.knot = 0.05;
    EXPECT_NE(plan(robot, every_layer, options).warnings, on_knots.warnings);
    expect_same(again.plan(), on_knots);
  }
}

TEST(Hooks, ACheckThatRefusesIsTheCause) {
  const PathProblem problem = experiment("experiment_a", 0.02, 0.2);
  const PreparedRobot robot(problem);
  class NoMotion : public StateCheck {
   public:
    [[nodiscard]] std::string name() const override { return "rest"; }
    void states(std::span<const Config>, std::span<bool> allowed) override {
      std::fill(allowed.begin(), allowed.end(), true);
    }
    [[nodiscard]] bool checks_motions() const override { return true; }
    void motions(std::span<const Motion>, std::span<bool>) override {}  // nothing said is no
  };
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options = options_for(planner);
    options.evidence.layers = true;
    options.hooks.check = check_of([](const Config&) { return false; });
    PlanResult result = plan(robot, problem, options);
    EXPECT_EQ(result.status, PlanStatus::kInfeasible);
    EXPECT_FALSE(diagnosis_of(result).reached_layer.has_value());
    EXPECT_EQ(words(diagnosis_of(result).cause), "check of the test");
    EXPECT_TRUE(diagnosis_of(result).without_it.has_value());
    ASSERT_EQ(diagnosis_of(result).empty_layers.size(), 1U);
    const EmptyLayers& run = diagnosis_of(result).empty_layers[0];
    EXPECT_EQ(run.first, 0);
    EXPECT_GT(run.last, 5);
    EXPECT_EQ(words(run.cause), "check of the test");
    options.hooks.check = std::make_shared<NoMotion>();
    result = plan(robot, problem, options);
    EXPECT_EQ(result.status, PlanStatus::kInfeasible);
    EXPECT_EQ(diagnosis_of(result).reached_layer, 0);
    EXPECT_EQ(words(diagnosis_of(result).cause), "check rest between layers");
    const auto& removed = diagnosis_of(result).removed;
    EXPECT_TRUE(std::any_of(removed.begin(), removed.end(), [](const Diagnosis::Removed& one) {
      return words(one.cause) == "check rest between layers" && one.count > 0;
    }));
  }
}

TEST(Hooks, WhatIsNoCostIsRefusedByName) {
  const PathProblem problem = experiment("experiment_a", 0.02, 0.2);
  const PreparedRobot robot(problem);
  for (const auto& [cost, said] : {std::pair{-1e-300, "is -1e-300"},
                                   {std::nan(""), "nan"},
                                   {std::numeric_limits<double>::infinity(), "is inf"},
                                   {1000.001, "allowed is a number from 0 to 1000"}})
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options = options_for(planner);
      options.hooks.cost = cost_of([c = cost](const Config&) { return c; });
      try {
        static_cast<void>(plan(robot, problem, options));
        ADD_FAILURE() << cost;
      } catch (const InvalidArgument& error) {
        EXPECT_NE(std::string(error.what()).find("state cost 'of the test'"), std::string::npos)
            << error.what();
        EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
      }
    }
}

TEST(Hooks, WhatTheyThrowComesThroughAndNothingElseIsLost) {
  const PathProblem problem = experiment("experiment_a", 0.02, 0.2);
  const PreparedRobot robot(problem);
  const PlanResult plain = plan(robot, problem, options_for(PlannerKind::kLazy));
  struct Own {
    int number;
  };
  int thrown = 0;
  for (const PlannerKind planner : kPlanners)
    for (const int after : {0, 1, 7, 20}) {
      PlanOptions options = options_for(planner);
      int calls = 0;
      options.hooks.check = check_of([&](const Config&) {
        if (calls++ == after) throw Own{after};
        return true;
      });
      try {
        static_cast<void>(plan(robot, problem, options));
        ADD_FAILURE();
      } catch (const Own& own) {
        EXPECT_EQ(own.number, after);
        ++thrown;
      }
      options.hooks.cost =
          cost_of([](const Config&) -> double { throw std::runtime_error("of the user"); });
      calls = 1000;
      EXPECT_THROW(static_cast<void>(plan(robot, problem, options)), std::runtime_error);
      options.hooks.cost = nullptr;
      expect_same(plan(robot, problem, options), plain);
    }
  EXPECT_EQ(thrown, 16);
}

TEST(Hooks, ASlowOneEndsAtTheDeadline) {
  const PathProblem problem = experiment("experiment_a", 0.01, 0.05);
  const PreparedRobot robot(problem);
  using Clock = std::chrono::steady_clock;
  const auto slow = [](const Config&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  };
  for (const PlannerKind planner : {PlannerKind::kLazy, PlannerKind::kParallel}) {
    PlanOptions options = options_for(planner);
    options.timeout_s = 0.02;
    options.hooks.check = check_of(slow);
    const auto begin = Clock::now();
    EXPECT_EQ(plan(robot, problem, options).status, PlanStatus::kTimeout);
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(5));  // the machine may be busy
    // Another plan's turn is waited for no longer than that.
    options.hooks.check = check_of([](const Config&) { return true; });
    const std::lock_guard turn(options.hooks.check->turn());
    EXPECT_EQ(plan(robot, problem, options).status, PlanStatus::kTimeout);
  }
}

TEST(Hooks, PlansInSeveralThreadsTakeTurns) {
  const PathProblem problem = experiment("experiment_a", 0.02, 0.2);
  const PreparedRobot robot(problem);
  Random random(1);
  const auto check = std::make_shared<WaveCheck>(random, 0.9, 1);
  PlanOptions options = options_for(PlannerKind::kLazy);
  options.hooks.check = check;
  const PlanResult alone = plan(robot, problem, options);
  std::vector<PlanResult> results(8);
  std::vector<std::thread> threads;
  for (PlanResult& result : results)
    threads.emplace_back([&] { result = plan(robot, problem, options); });
  for (std::thread& thread : threads) thread.join();
  for (const PlanResult& result : results) expect_same(result, alone);
  EXPECT_EQ(check->most_at_once, 1);
  EXPECT_GT(check->calls, 8);
}

}  // namespace
}  // namespace swivel
