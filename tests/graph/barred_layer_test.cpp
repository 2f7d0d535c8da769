// SPDX-License-Identifier: BSD-3-Clause
// Layers that are barred, or all but barred: the search says what a whole sweep without their nodes
// says.
#include <gtest/gtest.h>

#include <algorithm>

#include "robots.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {
namespace {

using namespace test;

/// Nodes fail by a table.
class Table final : public Validity {
 public:
  explicit Table(const Lattice& lattice)
      : lattice_(&lattice), fails_(static_cast<std::size_t>(lattice.nodes())) {}
  [[nodiscard]] std::uint8_t& fails(int layer, int slot) {
    return fails_[static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->slots(0)) +
                  static_cast<std::size_t>(slot)];
  }
  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k)
      answers[k].valid = !fails(questions[k].layer, questions[k].slot);
  }
  /// Answers as other threads may: from the questions as they were, before `work` or after it.
  void nodes_overlapped(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                        const std::function<void()>& work) override {
    const std::vector<NodeQuestion> asked(questions.begin(), questions.end());
    const bool before = ++waves_ % 2 == 0;
    if (before) nodes(asked, answers);
    work();
    if (!before) nodes(asked, answers);
    const auto was_asked = [&](const NodeQuestion& x) {
      return std::any_of(wave_.begin(), wave_.end(), [&](const NodeQuestion& y) {
        return x.layer == y.layer && x.slot == y.slot;
      });
    };
    EXPECT_TRUE(std::none_of(asked.begin(), asked.end(), was_asked));
    wave_ = asked;
  }
  [[nodiscard]] std::int64_t waves() const { return waves_; }
  void edges(std::span<const EdgeQuestion>, std::span<std::uint8_t>) override {}
  [[nodiscard]] bool asks_edges() const override { return false; }

 private:
  const Lattice* lattice_;
  std::vector<std::uint8_t> fails_;
  std::vector<NodeQuestion> wave_;  // asked about last
  std::int64_t waves_ = 0;
};

/// Returns a problem of 70 to 99 steps between two random poses near one another.
PathProblem random_problem(const TestRobot& robot, const Chain& chain, Random& random) {
  PathProblem problem = problem_for(robot);
  const Config q0 = random_config(chain, random);
  Config q1 = q0;
  for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.3, 0.3);
  problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
  const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
  problem.resolution = {.ds = length / (70 + random.below(30)),
                        .dphi = robot.name == "windings" ? 0.4 : 0.15,
                        .dalpha = 10};
  return problem;
}

/// Lets fail a layer but for at most a few of its nodes, one node in fifty of the others, and in
/// every other problem a block of them. Returns at most how many nodes of the layer do
/// not fail: 0 where it is barred.
int bar_a_layer(Table& table, const SrsLattice& lattice, Random& random) {
  const int layer = random.below(lattice.layers()), left = random.coin() ? 0 : 1 + random.below(3);
  const int angles = random.coin() ? lattice.angles() / 3 : 0,
            angle = random.below(lattice.angles());
  const int first = random.below(lattice.layers()), last = first + lattice.layers() / 4;
  const auto blocked = [&](int k, int slot) {
    return k >= first && k <= last &&
           (lattice.angle_of(slot) - angle + lattice.angles()) % lattice.angles() < angles;
  };
  for (int k = 0; k < lattice.layers(); ++k)
    for (int slot = 0; slot < lattice.slots(k); ++slot)
      table.fails(k, slot) = k == layer || blocked(k, slot) || random.coin(0.02);
  std::vector<Lattice::Node> nodes;
  lattice.layer_nodes(layer, nodes);
  for (int k = 0; k < left && !nodes.empty(); ++k)
    table.fails(
        layer, nodes[static_cast<std::size_t>(random.below(static_cast<int>(nodes.size())))].slot) =
        0;
  return left;
}

/// Counts what the searches met.
struct Searches {
  int barred = 0, gaps = 0, solved = 0;
  std::int64_t rounds_of_barred = 0, waves = 0;
};

/// Removes the nodes that the table lets fail, sweeps the whole lattice and expects of every way to
/// search what the sweep says. `left` is the number that bar_a_layer() returned.
void expect_outcome_of_whole_sweep(const Lattice& lattice, Table& table, int left,
                                   const std::string& what, Searches& searches) {
  const auto truth = make_cost_to_go(lattice);
  for (int k = 0; k < lattice.layers(); ++k)
    for (int slot = 0; slot < lattice.slots(k); ++slot)
      if (table.fails(k, slot)) truth->verdicts().remove_node(k, slot);
  truth->sweep(lattice.layers() - 1);
  std::int64_t expansions = 0;
  const SlotPath expected = best_path(*truth, expansions);
  const auto unbarred = make_cost_to_go(lattice);
  unbarred->sweep(lattice.layers() - 1);
  const bool only_by_table = unbarred->best() != kUnreachable;

  for (const PathFirstOptions& options : {PathFirstOptions{.batch = 1},
                                          {.batch = 32},
                                          {.batch = 32, .overlap_region_questions = true}}) {
    const auto cost_to_go = make_cost_to_go(lattice, Pruning::kByBound);
    cost_to_go->sweep(lattice.layers() - 1);
    SearchCounters counters;
    const SearchOutcome found = path_first(*cost_to_go, table, options, counters);
    const std::int64_t rounds = counters.iterations;
    ASSERT_EQ(found.path, expected) << what;
    if (expected.empty()) {
      ASSERT_EQ(deepest_valid_layer(*cost_to_go, table, options, counters),
                truth->deepest_reachable())
          << what;
    } else {
      ASSERT_EQ(found.cost, truth->at(0, expected.front())) << what;
    }
    if (!only_by_table) continue;
    (left == 0 ? searches.barred : searches.gaps) += 1;
    searches.solved += !expected.empty();
    if (left == 0) searches.rounds_of_barred += rounds;
  }
  searches.waves += table.waves();
}

TEST(PathFirst, SeesThatALayerIsBarred) {
  const std::uint64_t base = seed("PathFirst.BarredLayer");
  Searches searches;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(20); ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial));
      const PathProblem problem = random_problem(robot, arm.chain, random);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);
      Table table(lattice);
      const int left = bar_a_layer(table, lattice, random);
      expect_outcome_of_whole_sweep(lattice, table, left,
                                    "SWIVEL_TEST_SEED=" + std::to_string(base) + " " + robot.name +
                                        " trial " + std::to_string(trial),
                                    searches);
      if (HasFatalFailure()) return;
    }
  }
  const auto& [barred, gaps, solved, rounds_of_barred, waves] = searches;
  std::printf(
      "%d searches of a barred layer in %lld rounds, %d of one with gaps, %d solved, %lld waves "
      "beside work\n",
      barred, static_cast<long long>(rounds_of_barred), gaps, solved,
      static_cast<long long>(waves));
  EXPECT_GE(waves, at_least(1000));
  EXPECT_GE(barred, at_least(40));
  EXPECT_GE(solved, at_least(10));
  if (at_least(8) > 0) {
    EXPECT_LE(rounds_of_barred, 20 * barred);  // 30 where nobody asks about the rest of a layer
  }
}

/// Bars a layer, as a search does that sees that all of its nodes fail, and looks how far paths
/// lead. Returns the deepest layer, that paths lead to it, and the cost of the cheapest one.
std::pair<int, double> depth_before(int layer, CostToGo& values) {
  const Lattice& lattice = values.lattice();
  if (!values.restart({})) values.sweep(lattice.layers() - 1);
  for (int slot = 0; slot < lattice.slots(layer); ++slot)
    values.verdicts().remove_node(layer, slot);
  const int deepest = values.deepest_reachable();
  if (deepest < 0) return {deepest, kUnreachable};
  values.sweep(deepest);
  return {deepest, values.best()};
}

TEST(PathFirst, ForgetsTheLayerThatWasBarredBefore) {
  const std::uint64_t base = seed("PathFirst.ForgetsTheLayerThatWasBarredBefore");
  int grids = 0, lists = 0, reached = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    TestRobot robot = data_robot(trial % 2 == 0 ? "sda5f" : "xarm7_like");
    if (trial % 2 == 1) robot.tip_link = "flange";
    const Chain chain = arm_of(robot).chain;
    PathProblem problem = random_problem(robot, chain, random);
    problem.resolution.ds *= 4;
    problem.resolution.arc = 0.6;
    const ArmClass arm = classify(chain, robot.name);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
    const auto plain = make_lattice(chain, arm, path, problem);
    std::vector<Lattice::Node> nodes;
    plain->layer_nodes(0, nodes);
    if (nodes.empty()) continue;
    if (random.coin()) problem.start = plain->exact_config(0, nodes.front().slot);
    const auto lattice = make_lattice(chain, arm, path, problem);
    (trial % 2 == 0 ? grids : lists) += 1;
    const auto kept = make_cost_to_go(*lattice, Pruning::kByBound);
    for (int search = 0; search < 4; ++search) {
      const int layer = 1 + random.below(lattice->layers() - 1);
      const auto found = depth_before(layer, *kept);
      ASSERT_EQ(found, depth_before(layer, *make_cost_to_go(*lattice, Pruning::kByBound)))
          << "SWIVEL_TEST_SEED=" << base << " trial " << trial << ", search " << search;
      reached += found.first == layer - 1;
    }
  }
  EXPECT_GE(grids, at_least(count / 4));
  EXPECT_GE(lists, at_least(count / 4));
  EXPECT_GE(reached, at_least(count));
}

}  // namespace
}  // namespace swivel
