// SPDX-License-Identifier: BSD-3-Clause
// Lattices that list their nodes, of an arm without a spherical wrist: the same searches, the same
// answers as brute force.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "brute_force.hpp"
#include "diagnosis/diagnosis.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/eager/eager.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "validity/collision_validity.hpp"
#include "without.hpp"

namespace swivel::test {
namespace {

/// A configuration near `q` that reaches the pose: minimum-norm Newton steps.
std::optional<Config> projected(const Chain& chain, const Pose& pose, Config q) {
  for (int step = 0; step < 30; ++step) {
    const Pose reached = chain.tool(q);
    const Eigen::AngleAxisd turn(pose.linear() * reached.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << pose.translation() - reached.translation(), turn.angle() * turn.axis();
    if (error.norm() < 1e-12) return q;
    q += Config(chain.jacobian(q).completeOrthogonalDecomposition().solve(error));
    if (!(q.lpNorm<Eigen::Infinity>() < 50)) return std::nullopt;
  }
  return std::nullopt;
}

/// Random nodes of every layer: some found from those of the layer before, so that paths exist,
/// some from anywhere.
std::vector<std::vector<ExplicitLattice::Point>> random_layers(const Chain& chain,
                                                               const ToolPath& path,
                                                               const Config& start,
                                                               Random& random) {
  std::vector<std::vector<ExplicitLattice::Point>> layers;
  std::vector<Config> seeds{start};
  for (int layer = 0; layer < path.size(); ++layer) {
    std::vector<Config> found;
    const int wanted = 6 + random.below(14);
    for (int k = 0; k < wanted; ++k) {
      Config seed =
          random.coin(0.8)
              ? seeds[static_cast<std::size_t>(random.below(static_cast<int>(seeds.size())))]
              : random_config(chain, random);
      for (int j = 0; j < kDof; ++j) seed[j] += random.uniform(-0.3, 0.3);
      auto q = projected(chain, path.layer(layer).tool, seed);
      if (!q) continue;
      (*q)[6] = std::remainder((*q)[6], kTwoPi);
      bool inside = true;
      for (int j = 0; j < kDof - 1; ++j) {
        const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
        inside = inside && (*q)[j] >= limit.lower && (*q)[j] <= limit.upper;
      }
      if (inside) found.push_back(*q);
    }
    if (!found.empty()) seeds = found;
    auto& points = layers.emplace_back();
    for (std::size_t k = 0; k < found.size(); ++k) {
      ExplicitLattice::Point point;
      point.q = found[k];
      point.beside = {static_cast<int>(k) - 1, k + 1 < found.size() ? static_cast<int>(k) + 1 : -1};
      points.push_back(point);
    }
  }
  for (std::size_t i = 0; i < layers.size(); ++i)
    for (std::size_t k = 0; k < layers[i].size(); ++k) {
      if (i > 0 && k < layers[i - 1].size()) layers[i][k].along[0] = static_cast<int>(k);
      if (i + 1 < layers.size() && k < layers[i + 1].size())
        layers[i][k].along[1] = static_cast<int>(k);
    }
  return layers;
}

/// A random problem of an arm of the robot, whose path begins at the tool's pose at `start`.
struct ListedCase {
  PathProblem problem;
  Config start;
};

ListedCase random_listed_case(const TestRobot& robot, const Chain& chain, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.limits.joint_step = random.uniform(0.5, 1.5);
  if (problem.limits.tool_path_error) problem.limits.tool_path_error = random.uniform(0.02, 0.1);
  problem.start.reset();
  const Config start = random_config(chain, random);
  problem.waypoints[0] = waypoint_of(chain.tool(start));
  Config end = start;
  for (int j = 0; j < kDof; ++j) end[j] += random.uniform(-0.2, 0.2);
  problem.waypoints = {waypoint_of(chain.tool(start)), waypoint_of(chain.tool(end))};
  problem.resolution = {.ds = 0.04, .dphi = 0.3, .dalpha = 0.3};
  return {std::move(problem), start};
}

/// Searches a lattice with every planner and expects what brute force found.
struct EverySearch {
  const ExplicitLattice& lattice;
  const World& world;
  EdgeRule rule;
  EdgeMode edges;
  BruteForcePath truth;
  std::string what;
  Executor executor{1};
  Budget never;
  int rounds = 0, removed = 0;

  void expect_truth(const SlotPath& slots, double cost, int deepest, const char* planner) const {
    ASSERT_EQ(!slots.empty(), truth.solved) << what << ' ' << planner;
    ASSERT_EQ(slots, truth.slots) << what << ' ' << planner;
    if (truth.solved) {
      ASSERT_EQ(cost, truth.cost) << what << ' ' << planner;
    } else {
      ASSERT_EQ(deepest, truth.deepest) << what << ' ' << planner;
    }
  }
  /// `search` is eager_search() or eager_dp().
  template <class Search>
  void eagerly(const Search& search, const char* planner) {
    CollisionValidity validity(lattice, world, rule, edges, DistanceProofs::kOff, executor, 0,
                               never);
    EagerOutcome found;
    search(lattice, validity, never, found);
    expect_truth(found.path, found.cost, found.deepest.value_or(-1), planner);
  }
  void lazily(int batch) {
    CollisionValidity validity(lattice, world, rule, edges, DistanceProofs::kOn, executor,
                               batch == 1 ? 1 : 4, never);
    const auto cost_to_go = make_cost_to_go(lattice);
    cost_to_go->sweep(lattice.layers() - 1);
    SearchCounters counters;
    const SearchOutcome found = path_first(*cost_to_go, validity, {.batch = batch}, counters);
    rounds += static_cast<int>(counters.iterations);
    int deepest = -1;
    if (found.path.empty())
      deepest = deepest_valid_layer(*cost_to_go, validity, {.batch = batch}, counters);
    expect_truth(found.path, found.cost, deepest, "lazy");
    for (const Verdict verdict : cost_to_go->verdicts().nodes())
      removed += verdict == Verdict::kRemoved;
  }
};

TEST(ExplicitLattice, EverySearchAgreesWithBruteForce) {
  const std::uint64_t base = seed("ExplicitLattice.Agreement");
  const TestRobot robot = offset_robot();
  const ArmModel arm = arm_of(robot);
  int solved = 0, infeasible = 0, rounds = 0, removed = 0;
  const int count = trials(150);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto [problem, start] = random_listed_case(robot, arm.chain, random);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, what);
    const ExplicitLattice lattice(arm.chain, path, problem,
                                  random_layers(arm.chain, path, start, random));
    const World world(*robot.model, arm, problem);
    const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
    EverySearch searches{lattice,
                         world,
                         rule,
                         problem.limits.edges,
                         brute_force(lattice, world, rule, [](int, int, int) { return true; }),
                         what};
    (searches.truth.solved ? solved : infeasible) += 1;
    searches.eagerly(eager_search, "eager");
    searches.eagerly(eager_dp, "eager_dp");
    for (const int batch : {1, 32}) searches.lazily(batch);
    if (HasFatalFailure()) return;
    rounds += searches.rounds;
    removed += searches.removed;
  }
  std::printf("%d solved, %d infeasible, %d rounds, %d nodes removed\n", solved, infeasible, rounds,
              removed);
  EXPECT_GE(solved, at_least_among(count / 10 + 1));
  EXPECT_GE(infeasible, at_least_among(count / 10 + 1));
  EXPECT_GE(rounds, at_least_among(2 * count + 1));
}

/// What ends every path is found among listed nodes as on a grid: without it, brute force goes on.
TEST(ExplicitLattice, WithoutTheCauseThatIsNamedPathsGoOn) {
  const std::uint64_t base = seed("ExplicitLattice.Cause");
  const TestRobot robot = offset_robot();
  const ArmModel arm = arm_of(robot);
  int infeasible = 0, named = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = random_problem(robot, random);
    problem.limits.step_error.reset();
    problem.limits.joint_step = random.uniform(0.1, 0.5);
    problem.start.reset();
    const Config start = random_config(arm.chain, random);
    Config end = start;
    for (int j = 0; j < kDof; ++j) end[j] += random.uniform(-0.2, 0.2);
    problem.waypoints = {waypoint_of(arm.chain.tool(start)), waypoint_of(arm.chain.tool(end))};
    problem.resolution = {.ds = 0.04, .dphi = 0.3, .dalpha = 0.3};
    const ToolPath path(waypoints_in_base(problem), problem.resolution, what);
    const auto points = random_layers(arm.chain, path, start, random);
    const auto truth_of = [&](const PathProblem& posed, Diagnosis* diagnosis) {
      const ExplicitLattice lattice(arm.chain, path, posed, points);
      const World world(*posed.model, arm, posed);
      const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
      const BruteForcePath truth =
          brute_force(lattice, world, rule, [](int, int, int) { return true; });
      if (diagnosis != nullptr && !truth.solved)
        diagnose(
            lattice, world, rule,
            truth.deepest < 0 ? SlotPath{} : best_path_to(lattice, world, rule, truth.deepest, {}),
            true, {}, *diagnosis);
      return truth;
    };
    Diagnosis diagnosis;
    if (truth_of(problem, &diagnosis).solved) continue;
    ++infeasible;
    ASSERT_NE(diagnosis.cause.kind, Cause::Kind::kNone) << what;
    if (!diagnosis.without_it) continue;
    const auto relaxed = without(diagnosis.cause, problem);
    ASSERT_TRUE(relaxed.has_value()) << what;
    const BruteForcePath after = truth_of(*relaxed, nullptr);
    EXPECT_TRUE(after.solved || after.deepest >= *diagnosis.without_it)
        << what << ": " << words(diagnosis.cause);
    ++named;
  }
  std::printf("%d infeasible, one thing named in %d\n", infeasible, named);
  EXPECT_GE(infeasible, at_least_among(count / 10 + 1));
  EXPECT_GE(named, at_least_among(count / 20 + 1));
}

/// Where a curve of self-motion ends because a joint is at its limit, no node is listed past it:
/// the continuation tells.
TEST(ExplicitLattice, ALimitThatEndsTheNodesIsNamed) {
  const TestRobot robot = offset_robot();
  ArmModel arm = arm_of(robot);
  Config start, end;
  start = {0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.0};
  end = start;
  end[1] += 0.5;  // beyond the limit, which is set between
  PathProblem problem = problem_for(robot);
  problem.limits.clearance = 0;
  problem.waypoints = {waypoint_of(arm.chain.tool(start)), waypoint_of(arm.chain.tool(end))};
  problem.resolution = {.ds = 0.05, .dphi = 0.3, .dalpha = 0.3};
  const ToolPath path(waypoints_in_base(problem), problem.resolution, "");
  std::vector<std::vector<ExplicitLattice::Point>> points(static_cast<std::size_t>(path.size()));
  points[0].push_back({.q = start});
  arm.chain.limit[1].upper = start[1] + 1e-3;
  const ExplicitLattice lattice(arm.chain, path, problem, points);
  const World world(*robot.model, arm, problem);
  Diagnosis diagnosis;
  diagnose(lattice, world, world.edge_rule(motion_radii(arm.chain, world.bodies())), {0}, true, {},
           diagnosis);
  EXPECT_EQ(diagnosis.cause.kind, Cause::Kind::kLimit) << words(diagnosis.cause);
  EXPECT_EQ(diagnosis.cause.joint, arm.chain.joint_names[1]);
  EXPECT_EQ(diagnosis.cause.side, Cause::Side::kUpper);
  EXPECT_GT(diagnosis.cause.by().value_or(0), 0);
}

/// Counts what is compared between a grid and the list of its nodes.
struct GridCounts {
  int solved = 0, infeasible = 0, removals = 0;
};

/// The cost-to-go of a grid and of the list of its nodes. slots[i][k] is the grid's slot of node k
/// of layer i of the list.
struct GridAndList {
  std::unique_ptr<CostToGo> grid, list;
  std::vector<std::vector<int>> slots;
};

/// Removes from both a node or an edge of the best path, or all nodes of a layer, and repairs both.
/// `wanted` and `found` are the best path by slots of the grid and of the list.
void remove_from_both(const GridAndList& both, const SlotPath& wanted, const SlotPath& found,
                      bool whole_layer, Random& random) {
  const int layers = both.grid->lattice().layers(), layer = random.below(layers);
  const auto i = static_cast<std::size_t>(layer);
  if (whole_layer) {
    for (std::size_t k = 0; k < both.slots[i].size(); ++k) {
      both.grid->verdicts().remove_node(layer, both.slots[i][k]);
      both.list->verdicts().remove_node(layer, static_cast<int>(k));
    }
  } else if (random.coin() && layer + 1 < layers) {
    both.grid->remove_edge(layer, wanted[i], wanted[i + 1]);
    both.list->remove_edge(layer, found[i], found[i + 1]);
  } else {
    both.grid->verdicts().remove_node(layer, wanted[i]);
    both.list->verdicts().remove_node(layer, found[i]);
  }
  both.grid->repair();
  both.list->repair();
}

/// Compares the best paths of both, over five removals or until there is none.
void compare_grid_and_list(const GridAndList& both, Random& random, const std::string& what,
                           GridCounts& counts) {
  for (int round = 0; round < 5; ++round) {
    ASSERT_EQ(both.grid->best(), both.list->best()) << what;
    std::int64_t expansions = 0;
    const SlotPath wanted = best_path(*both.grid, expansions),
                   found = best_path(*both.list, expansions);
    ASSERT_EQ(wanted.size(), found.size()) << what;
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(wanted[i], both.slots[i][static_cast<std::size_t>(found[i])]) << what;
    if (found.empty()) {
      ASSERT_EQ(both.grid->deepest_reachable(), both.list->deepest_reachable()) << what;
      ++counts.infeasible;
      return;
    }
    ++counts.solved;
    remove_from_both(both, wanted, found, round == 3, random);
    ++counts.removals;
  }
}

TEST(ExplicitLattice, AGridWithAnOpenWindowListedNodeByNodeHasTheSamePath) {
  const std::uint64_t base = seed("ExplicitLattice.Grid");
  GridCounts counts;
  const auto robots = all_robots();
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem problem = random_problem(robot, random);
    problem.limits.arm_slope = 1e6;  // any arm angle may follow any other
    problem.limits.step_error.reset();
    problem.start.reset();
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, what);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, what);
    const SrsLattice grid(arm.chain, srs, path, problem);
    std::vector<std::vector<ExplicitLattice::Point>> layers(
        static_cast<std::size_t>(grid.layers()));
    std::vector<std::vector<int>> slots(layers.size());
    std::vector<Lattice::Node> nodes;
    for (std::size_t i = 0; i < layers.size(); ++i) {
      grid.layer_nodes(static_cast<int>(i), nodes);
      for (const Lattice::Node& node : nodes) {
        layers[i].push_back({.q = node.q});
        slots[i].push_back(node.slot);
      }
    }
    const ExplicitLattice listed(arm.chain, path, problem, std::move(layers));
    const GridAndList both{make_cost_to_go(grid), make_cost_to_go(listed), std::move(slots)};
    both.grid->sweep(grid.layers() - 1);
    both.list->sweep(listed.layers() - 1);
    compare_grid_and_list(both, random, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d paths compared, %d problems without one, %d removals\n", counts.solved,
              counts.infeasible, counts.removals);
  EXPECT_GE(counts.solved, at_least_among(2 * count + 1));
  EXPECT_GE(counts.infeasible, at_least_among(count / 2 + 1));
}

}  // namespace
}  // namespace swivel::test
