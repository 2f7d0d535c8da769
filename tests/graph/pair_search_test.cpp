// SPDX-License-Identifier: BSD-3-Clause
// Pairs of arms against a plain program over all pairs of nodes and all pairs of moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <set>
#include <thread>
#include <tuple>

#include "chance.hpp"
#include "robots.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {
namespace {

using namespace test;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

constexpr int kNoEnd = 1 << 30;

/// A validity of which chance decides, whose nodes fail by one of three causes. Counts questions
/// that are asked again.
class FakeValidity : public ChanceValidity {
 public:
  using ChanceValidity::ChanceValidity;
  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override {
    count(questions.size());
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const auto& [layer, slot, q, suspected, only_scene] = questions[k];
      nodes_twice += !only_scene && !nodes_.insert({layer, slot}).second;
      wrong += *lattice().node(layer, slot) != q;
      answers[k] = {.valid = node(layer, slot)};
      if (answers[k].valid) continue;
      answers[k].failure = slot % 3;
      if (only_scene && suspected != slot % 3) answers[k] = {.valid = true};
    }
  }
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override {
    count(questions.size());
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const EdgeQuestion& x = questions[k];
      edges_twice += !edges_.insert({x.layer, x.a, x.b}).second;
      wrong += *lattice().node(x.layer, x.a) != x.qa || *lattice().node(x.layer + 1, x.b) != x.qb;
      answers[k] = edge(x.layer, x.a, x.b);
    }
  }
  void forget() {
    nodes_.clear();
    edges_.clear();
    asked = nodes_twice = edges_twice = 0;
  }
  int asked = 0, most_asked = kNoEnd, nodes_twice = 0, edges_twice = 0, wrong = 0;

 private:
  void count(std::size_t questions) {
    asked += static_cast<int>(questions);
    if (asked > most_asked) throw Stopped();
  }
  std::set<std::pair<int, int>> nodes_;
  std::set<std::tuple<int, int, int>> edges_;
};

using Lattices = std::array<std::unique_ptr<Lattice>, 2>;

/// Two arms that meet in bands: each node has a place between 0 and 1, along the slots of its layer
/// or by chance, and two arms are in conflict where the difference of their places is near a number
/// that drifts along the layers. Moves are where their nodes are in the mean.
class FakeBetween : public Between {
 public:
  FakeBetween(const Lattices& lattices, std::uint64_t seed, Random& random)
      : lattices_(&lattices), seed_(seed) {
    const int layers = lattices[0]->layers();
    scattered_ = random.coin(0.3);
    large_ = random.coin(0.6);
    first_ = random.below(layers);
    last_ = first_ + random.below(layers);
    centre_ = random.uniform(-0.5, 0.5);
    drift_ = random.uniform(-0.2, 0.2);
    if (random.coin(0.75)) width_ = random.uniform(0.05, random.coin(0.3) ? 1.5 : 0.6);
    if (random.coin(0.5)) move_width_ = random.uniform(0.05, 0.4);
  }
  [[nodiscard]] double place(int arm, int layer, int slot) const {
    if (scattered_) return chance(seed_ + at(arm), at(layer), at(slot));
    return (slot + 0.5) / (*lattices_)[at(arm)]->slots(layer);
  }
  [[nodiscard]] double off(double p, double q, int layer) const {
    return std::abs(p - q - centre_ - drift_ * layer);
  }
  [[nodiscard]] bool node(int layer, int a, int b) const {
    return layer < first_ || layer > last_ ||
           off(place(0, layer, a), place(1, layer, b), layer) >= width_;
  }
  [[nodiscard]] double middle(int arm, int layer, const SlotMove& move) const {
    return (place(arm, layer, move.from) + place(arm, layer + 1, move.to)) / 2;
  }
  [[nodiscard]] bool move(int layer, const SlotMove& a, const SlotMove& b) const {
    return layer < first_ || layer > last_ ||
           off(middle(0, layer, a), middle(1, layer, b), layer) >= move_width_;
  }
  void nodes(std::span<const NodePair> questions, std::span<std::uint8_t> apart) override {
    count(questions.size());
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const auto& [layer, slots, q] = questions[k];
      twice += !nodes_.insert({layer, slots[0], slots[1]}).second;
      for (std::size_t arm = 0; arm < 2; ++arm)
        wrong += *(*lattices_)[arm]->node(layer, slots[arm]) != q[arm];
      apart[k] = node(layer, slots[0], slots[1]);
    }
  }
  void moves(std::span<const MovePair> questions, std::span<std::uint8_t> apart) override {
    count(questions.size());
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const auto& [layer, moves, from, to] = questions[k];
      twice +=
          !moves_.insert({layer, moves[0].from, moves[0].to, moves[1].from, moves[1].to}).second;
      for (std::size_t arm = 0; arm < 2; ++arm)
        wrong += *(*lattices_)[arm]->node(layer, moves[arm].from) != from[arm] ||
                 *(*lattices_)[arm]->node(layer + 1, moves[arm].to) != to[arm];
      wrong += !node(layer, moves[0].from, moves[1].from);
      wrong += !node(layer + 1, moves[0].to, moves[1].to);
      apart[k] = move(layer, moves[0], moves[1]);
    }
  }
  /// Leaves out some of the pairs that are not apart.
  void find_barred(int layer, const std::array<std::vector<int>, 2>& slots,
                   const std::array<std::vector<Config>, 2>& q,
                   std::span<std::uint8_t> barred) override {
    for (std::size_t a = 0, k = 0; a < slots[0].size(); ++a)
      for (std::size_t b = 0; b < slots[1].size(); ++b, ++k) {
        wrong += *(*lattices_)[0]->node(layer, slots[0][a]) != q[0][a] ||
                 *(*lattices_)[1]->node(layer, slots[1][b]) != q[1][b];
        if (!barred[k] && chance(seed_ + 2, at(layer), k) < 0.8)
          barred[k] = !node(layer, slots[0][a], slots[1][b]);
      }
  }
  [[nodiscard]] bool asks_moves() const override { return move_width_ > 0; }
  [[nodiscard]] std::array<std::vector<int>, 2> region(const NodePair& x, bool) override {
    if (!large_) return {std::vector{x.slots[0]}, std::vector{x.slots[1]}};
    const auto [a, b] = x.slots;
    const double p = place(0, x.layer, a), q = place(1, x.layer, b);
    const double reach = 0.49 * (width_ - off(p, q, x.layer));
    std::array<std::vector<int>, 2> sides;
    for (int arm = 0; arm < 2; ++arm)
      for (int slot = 0; slot < (*lattices_)[at(arm)]->slots(x.layer); ++slot)
        if (std::abs(place(arm, x.layer, slot) - (arm == 0 ? p : q)) <= reach)
          sides[at(arm)].push_back(slot);
    for (int arm = 0; arm < 2; ++arm) add_rest(x.layer, arm, sides);
    return sides;
  }
  [[nodiscard]] std::array<std::vector<SlotMove>, 2> region(const MovePair& x,
                                                            bool thorough) override {
    if (!large_) return Between::region(x, thorough);
    const double p = middle(0, x.layer, x.moves[0]), q = middle(1, x.layer, x.moves[1]);
    const double reach = 0.49 * (move_width_ - off(p, q, x.layer));
    std::array<std::vector<SlotMove>, 2> sides;
    for (int arm = 0; arm < 2; ++arm)
      for (int from = 0; from < (*lattices_)[at(arm)]->slots(x.layer); ++from)
        for (int to = 0; to < (*lattices_)[at(arm)]->slots(x.layer + 1); ++to)
          if (const SlotMove move{from, to};
              std::abs(middle(arm, x.layer, move) - (arm == 0 ? p : q)) <= reach)
            sides[at(arm)].push_back(move);
    return sides;
  }
  void forget() {
    nodes_.clear();
    moves_.clear();
    asked = twice = 0;
  }
  /// Returns whether regions are much larger than the conflict that they are about.
  [[nodiscard]] bool has_large_regions() const { return large_ && !scattered_; }
  int asked = 0, most_asked = kNoEnd, twice = 0, wrong = 0;

 private:
  /// Adds to the side of an arm what else of the layer meets all of the other side.
  void add_rest(int layer, int arm, std::array<std::vector<int>, 2>& sides) const {
    std::vector<int>& side = sides[at(arm)];
    for (int slot = 0; slot < (*lattices_)[at(arm)]->slots(layer); ++slot)
      if (std::find(side.begin(), side.end(), slot) == side.end() &&
          std::all_of(sides[at(1 - arm)].begin(), sides[at(1 - arm)].end(), [&](int other) {
            return arm == 0 ? !node(layer, slot, other) : !node(layer, other, slot);
          }))
        side.push_back(slot);
  }
  void count(std::size_t questions) {
    asked += static_cast<int>(questions);
    if (asked > most_asked) throw Stopped();
  }
  const Lattices* lattices_;
  std::uint64_t seed_;
  bool scattered_ = false, large_ = false;
  int first_ = 0, last_ = 0;
  double centre_ = 0, drift_ = 0, width_ = 0, move_width_ = 0;
  std::set<std::tuple<int, int, int>> nodes_;
  std::set<std::tuple<int, int, int, int, int>> moves_;
};

/// Two arms on random paths of equally many layers.
struct Task {
  std::array<std::unique_ptr<ToolPath>, 2> paths;
  Lattices lattices;
  std::array<std::unique_ptr<FakeValidity>, 2> validities;
  std::unique_ptr<FakeBetween> between;
};

std::unique_ptr<Lattice> random_list(const Chain& chain, const ToolPath& path,
                                     const PathProblem& problem, const Config& q0, Random& random) {
  std::vector<std::vector<ExplicitLattice::Point>> points(at(path.size()));
  for (auto& layer : points)
    for (int k = 1 + random.below(6); k > 0; --k) {
      Config q = q0;
      for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.6, 0.6);
      layer.push_back({.q = q});
    }
  return std::make_unique<ExplicitLattice>(chain, path, problem, std::move(points));
}

/// Draws a task. With `grids` its arms have lattices of arm angles, else lists of nodes.
std::unique_ptr<Task> random_task(const TestRobot& robot, const ArmModel& arm, const SrsArm& srs,
                                  bool grids, Random& random) {
  auto task = std::make_unique<Task>();
  const auto base = static_cast<std::uint64_t>(random.uniform(0, 1e15));
  const int steps = 1 + random.below(grids ? 3 : 6);
  const bool free_of_charge = random.coin(0.15);  // all paths are equal, the first one wins
  const double cost = random.coin(0.3) ? random.uniform(0, 0.5) : 0;
  for (std::size_t k = 0; k < 2; ++k) {
    PathProblem problem = problem_for(robot);
    const Config q = random_config(arm.chain, random);
    Config end = q;
    for (int j = 0; j < kDof; ++j) end[j] += random.uniform(-0.3, 0.3);
    problem.waypoints = {waypoint_of(arm.chain.tool(q)), waypoint_of(arm.chain.tool(end))};
    const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
    problem.resolution = {
        .ds = length / (steps - 0.5), .dphi = random.uniform(0.6, 1.2), .dalpha = 10};
    problem.limits.arm_slope = 1e6;
    problem.limits.joint_step = random.uniform(0.7, 1.8);
    if (free_of_charge) problem.cost.weights = {0, 0, 0, 0, 0, 0, 0};
    task->paths[k] =
        std::make_unique<ToolPath>(waypoints_in_base(problem), problem.resolution, "test");
    if (grids)
      task->lattices[k] = std::make_unique<SrsLattice>(arm.chain, srs, *task->paths[k], problem);
    else
      task->lattices[k] = random_list(arm.chain, *task->paths[k], problem, q, random);
    const double nodes_fail = random.coin(0.3) ? 0 : random.uniform(0, 0.3),
                 edges_fail = random.coin(0.3) ? 0 : random.uniform(0, 0.3);
    task->validities[k] = std::make_unique<FakeValidity>(*task->lattices[k], base + 10 * k,
                                                         nodes_fail, edges_fail, cost);
  }
  task->between = std::make_unique<FakeBetween>(task->lattices, base + 100, random);
  return task;
}

/// The valid nodes and edges of one arm.
struct PlainArm {
  PlainArm(const Lattice& lattice, const FakeValidity& validity) {
    layers.resize(at(lattice.layers()));
    for (int layer = lattice.layers() - 1; layer >= 0; --layer) {
      std::vector<Lattice::Node> nodes;
      lattice.layer_nodes(layer, nodes);
      for (const Lattice::Node& node : nodes) {
        if (!validity.node(layer, node.slot)) continue;
        Node& here = layers[at(layer)].emplace_back(
            Node{node.slot, node.q, validity.cost(layer, node.slot), {}});
        if (layer + 1 == lattice.layers()) continue;
        const std::vector<Node>& next = layers[at(layer) + 1];
        for (std::size_t b = 0; b < next.size(); ++b) {
          const Config delta = lattice.delta(node.q, next[b].q);
          if (lattice.in_window(layer, node.slot, next[b].slot) &&
              lattice.step_allowed(layer, delta) &&
              (!validity.asks_edges() || validity.edge(layer, node.slot, next[b].slot)))
            here.edges.push_back({b, lattice.edge_cost(delta)});
        }
      }
    }
  }
  struct Edge {
    std::size_t to;
    double cost;
  };
  struct Node {
    int slot;
    Config q;
    double cost;
    std::vector<Edge> edges;
  };
  std::vector<std::vector<Node>> layers;
};

/// The cheapest pair of paths by the definition: every pair of nodes, every pair of moves.
class PlainPair {
 public:
  explicit PlainPair(const Task& task)
      : between_(*task.between),
        arms_{PlainArm(*task.lattices[0], *task.validities[0]),
              PlainArm(*task.lattices[1], *task.validities[1])} {
    values_.resize(arms_[0].layers.size());
    for (std::size_t layer = values_.size(); layer-- > 0;) {
      const auto &first = arms_[0].layers[layer], &second = arms_[1].layers[layer];
      values_[layer].assign(first.size(), std::vector<double>(second.size(), kUnreachable));
      for (std::size_t a = 0; a < first.size(); ++a)
        for (std::size_t b = 0; b < second.size(); ++b) values_[layer][a][b] = value(layer, a, b);
    }
    for (const auto& row : values_[0])
      for (const double value : row) cost_ = std::min(cost_, value);
  }
  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] const std::array<PlainArm, 2>& arms() const { return arms_; }
  /// Returns the first pair of paths of the least cost in the order of answers.
  [[nodiscard]] std::array<SlotPath, 2> paths() const {
    std::array<SlotPath, 2> paths;
    std::size_t a = 0, b = 0;
    while (values_[0][a][b] != cost_)
      if (++b == values_[0][a].size()) ++a, b = 0;
    for (std::size_t layer = 0;; ++layer) {
      const PlainArm::Node &x = arms_[0].layers[layer][a], &y = arms_[1].layers[layer][b];
      paths[0].push_back(x.slot);
      paths[1].push_back(y.slot);
      if (layer + 1 == values_.size()) return paths;
      std::tie(a, b) = next(layer, a, b);
    }
  }

 private:
  template <class Visit>
  void each_step(std::size_t layer, std::size_t a, std::size_t b, const Visit& visit) const {
    const PlainArm::Node &x = arms_[0].layers[layer][a], &y = arms_[1].layers[layer][b];
    for (const auto& [to_a, cost_a] : x.edges)
      for (const auto& [to_b, cost_b] : y.edges) {
        const double rest = values_[layer + 1][to_a][to_b];
        const SlotMove p{x.slot, arms_[0].layers[layer + 1][to_a].slot},
            q{y.slot, arms_[1].layers[layer + 1][to_b].slot};
        if (rest == kUnreachable ||
            (between_.asks_moves() && !between_.move(static_cast<int>(layer), p, q)))
          continue;
        visit(to_a, to_b, (x.cost + y.cost) + ((cost_a + cost_b) + rest));
      }
  }
  [[nodiscard]] double value(std::size_t layer, std::size_t a, std::size_t b) const {
    const PlainArm::Node &x = arms_[0].layers[layer][a], &y = arms_[1].layers[layer][b];
    if (!between_.node(static_cast<int>(layer), x.slot, y.slot)) return kUnreachable;
    if (layer + 1 == values_.size()) return x.cost + y.cost;
    double best = kUnreachable;
    each_step(layer, a, b, [&](auto, auto, double cost) { best = std::min(best, cost); });
    return best;
  }
  [[nodiscard]] std::pair<std::size_t, std::size_t> next(std::size_t layer, std::size_t a,
                                                         std::size_t b) const {
    std::optional<std::pair<std::size_t, std::size_t>> first;
    each_step(layer, a, b, [&](std::size_t to_a, std::size_t to_b, double cost) {
      if (cost == values_[layer][a][b] && !first) first = {to_a, to_b};
    });
    return first.value();
  }

  const FakeBetween& between_;
  std::array<PlainArm, 2> arms_;
  std::vector<std::vector<std::vector<double>>> values_;
  double cost_ = kUnreachable;
};

ParallelFor threads(int count) {
  return {count, [count](int parts, const std::function<void(int, int)>& body) {
            std::atomic<int> next{0};
            std::vector<std::jthread> team;
            for (int worker = 0; worker < count; ++worker)
              team.emplace_back([&, worker] {
                for (int part = next++; part < parts; part = next++) body(part, worker);
              });
          }};
}

/// Searches a task. With `planned` its arms have been planned by themselves before.
PairOutcome search(const Task& task, const PairSearchOptions& options, Pruning pruning,
                   bool planned = false) {
  std::array<std::unique_ptr<CostToGo>, 2> values;
  std::array<PairArm, 2> arms;
  task.between->forget();
  for (std::size_t k = 0; k < 2; ++k) {
    values[k] = make_cost_to_go(*task.lattices[k], pruning);
    arms[k] = {values[k].get(), task.validities[k].get()};
    task.validities[k]->forget();
    if (!planned) continue;
    values[k]->sweep(task.lattices[k]->layers() - 1);
    SearchCounters counters;
    static_cast<void>(path_first(*values[k], *task.validities[k], {}, counters));
  }
  const PairOutcome found = search_pair(arms, *task.between, options);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(task.validities[k]->wrong, 0);
    EXPECT_EQ(task.validities[k]->nodes_twice, 0);
    EXPECT_TRUE(planned || task.validities[k]->edges_twice == 0);
  }
  EXPECT_EQ(task.between->wrong, 0);
  EXPECT_EQ(task.between->twice, 0);
  return found;
}

/// Returns the answer of each arm by itself.
std::array<SearchOutcome, 2> alone(const Task& task) {
  std::array<SearchOutcome, 2> answers;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto values = make_cost_to_go(*task.lattices[k]);
    values->sweep(task.lattices[k]->layers() - 1);
    SearchCounters counters;
    answers[k] = path_first(*values, *task.validities[k], {}, counters);
  }
  return answers;
}

bool has_conflict(const FakeBetween& between, const std::array<SlotPath, 2>& paths) {
  for (std::size_t layer = 0; layer < paths[0].size(); ++layer) {
    const int i = static_cast<int>(layer);
    if (!between.node(i, paths[0][layer], paths[1][layer])) return true;
    if (between.asks_moves() && layer + 1 < paths[0].size() &&
        !between.move(i, {paths[0][layer], paths[0][layer + 1]},
                      {paths[1][layer], paths[1][layer + 1]}))
      return true;
  }
  return false;
}

/// Returns what a valid path costs; kUnreachable where it is not valid.
double cost_of(const PlainArm& arm, const SlotPath& path) {
  double cost = 0;
  const PlainArm::Edge* edge = nullptr;
  for (std::size_t layer = 0; layer < path.size(); ++layer) {
    const auto& nodes = arm.layers[layer];
    const auto node = std::find_if(nodes.begin(), nodes.end(),
                                   [&](const auto& x) { return x.slot == path[layer]; });
    if (node == nodes.end()) return kUnreachable;
    cost += node->cost;
    if (layer + 1 == path.size()) return cost;
    edge = nullptr;
    for (const PlainArm::Edge& x : node->edges)
      if (arm.layers[layer + 1][x.to].slot == path[layer + 1]) edge = &x;
    if (!edge) return kUnreachable;
    cost += edge->cost;
  }
  return kUnreachable;
}

/// Returns whether an arm has a path that keeps away from its sides of regions.
bool has_path(const PlainArm& arm, const std::vector<const ConflictRegion*>& regions,
              std::size_t side) {
  const auto barred_node = [&](std::size_t layer, int slot) {
    return std::any_of(regions.begin(), regions.end(), [&](const ConflictRegion* x) {
      return at(x->layer) == layer &&
             std::count(x->slots[side].begin(), x->slots[side].end(), slot) > 0;
    });
  };
  const auto barred_move = [&](std::size_t layer, const SlotMove& move) {
    return std::any_of(regions.begin(), regions.end(), [&](const ConflictRegion* x) {
      return at(x->layer) == layer &&
             std::count(x->moves[side].begin(), x->moves[side].end(), move) > 0;
    });
  };
  std::vector<bool> reached(arm.layers[0].size(), true), next;
  for (std::size_t layer = 0;; ++layer) {
    const auto& nodes = arm.layers[layer];
    for (std::size_t a = 0; a < nodes.size(); ++a)
      reached[a] = reached[a] && !barred_node(layer, nodes[a].slot);
    if (layer + 1 == arm.layers.size())
      return std::any_of(reached.begin(), reached.end(), [](bool x) { return x; });
    next.assign(arm.layers[layer + 1].size(), false);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (const PlainArm::Edge& edge : nodes[a].edges)
        if (reached[a] && !barred_move(layer, {nodes[a].slot, arm.layers[layer + 1][edge.to].slot}))
          next[edge.to] = true;
    reached.swap(next);
  }
}

void expect_region(const FakeBetween& between, const ConflictRegion& region) {
  for (const int a : region.slots[0])
    for (const int b : region.slots[1]) ASSERT_FALSE(between.node(region.layer, a, b));
  for (const SlotMove& a : region.moves[0])
    for (const SlotMove& b : region.moves[1]) ASSERT_FALSE(between.move(region.layer, a, b));
}

/// Expects a tree to prove that there is no pair: by plain loops.
void expect_proof(const Task& task, const PlainPair& plain, const std::vector<RegionBranch>& tree) {
  ASSERT_FALSE(tree.empty());
  std::vector<std::array<int, 2>> children(tree.size());
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const RegionBranch& branch = tree[k];
    ASSERT_NE(branch.region.has_value(), branch.arm_without_path.has_value());
    if (k > 0) {
      ASSERT_LT(at(branch.parent), k);
      ++children[at(branch.parent)][at(branch.arm)];
    }
    if (branch.region) {
      expect_region(*task.between, *branch.region);
      continue;
    }
    std::vector<const ConflictRegion*> regions;
    for (const RegionBranch* x = &branch; x->parent >= 0; x = &tree[at(x->parent)])
      if (x->arm == *branch.arm_without_path) regions.push_back(&*tree[at(x->parent)].region);
    const std::size_t arm = at(*branch.arm_without_path);
    ASSERT_FALSE(has_path(plain.arms()[arm], regions, arm));
  }
  for (std::size_t k = 0; k < tree.size(); ++k)
    ASSERT_EQ(children[k], (tree[k].region ? std::array{1, 1} : std::array{0, 0}));
}

/// Counts what the tasks met.
struct Met {
  int tasks = 0, apart = 0, solved = 0, dearer = 0, none = 0, without_path = 0, by_product = 0,
      by_regions = 0, by_pair_values = 0, stopped = 0, stopped_with_pair = 0;
  std::int64_t rounds = 0, pops = 0;
};

/// A task with its right answer.
struct Known {
  const Task& task;
  PlainPair plain;
  std::array<SearchOutcome, 2> alone;
  bool is_apart = false;  ///< the answers of the arms alone
};

/// Expects what a search found to be the right answer.
void expect_answer(const Known& known, const PairOutcome& found) {
  ASSERT_TRUE(found.decided());
  for (std::size_t k = 0; k < 2; ++k)
    ASSERT_EQ(found.least_costs[k] == kUnreachable, known.alone[k].path.empty());
  if (known.is_apart) {
    ASSERT_EQ(found.decided_by, PairSearcher::kArmsAlone);
    for (std::size_t k = 0; k < 2; ++k) {
      ASSERT_EQ(found.paths[k], known.alone[k].path);
      ASSERT_EQ(found.costs[k], known.alone[k].cost);
    }
    ASSERT_EQ(found.bound, known.plain.cost());
    ASSERT_LE(found.cost - known.plain.cost(), 2 * 0x1p-24 * known.task.lattices[0]->cost_unit());
    return;
  }
  ASSERT_EQ(found.cost, known.plain.cost());
  ASSERT_EQ(found.bound, known.plain.cost());
  if (found.cost == kUnreachable) {
    ASSERT_TRUE(found.paths[0].empty() && found.paths[1].empty());
    if (found.decided_by != PairSearcher::kProduct)
      expect_proof(known.task, known.plain, found.tree);
    return;
  }
  ASSERT_EQ(found.paths, known.plain.paths());
  ASSERT_FALSE(has_conflict(*known.task.between, found.paths));
  for (std::size_t k = 0; k < 2; ++k)
    ASSERT_EQ(found.costs[k], cost_of(known.plain.arms()[k], found.paths[k]));
}

void expect_alike(const PairOutcome& a, const PairOutcome& b) {
  const auto counts = [](const PairOutcome& x) {
    return std::tuple(x.decided_by, x.paths, x.cost, x.costs, x.bound, x.tree.size(), x.rounds,
                      x.solves, x.turns, x.pops, x.node_pairs, x.move_pairs, x.nodes, x.edges);
  };
  ASSERT_EQ(counts(a), counts(b));
}

/// Expects a search that is stopped to have a bound, and a pair that is valid if it has one.
void expect_bound_when_stopped(const Known& known, PairSearchOptions options, Random& random,
                               Met& met) {
  FakeBetween& between = *known.task.between;
  FakeValidity& validity = *known.task.validities[random.coin()];
  const bool by_between = random.coin(0.7);
  int& most_asked = by_between ? between.most_asked : validity.most_asked;
  most_asked = random.below((by_between ? between.asked : validity.asked) + 1);
  if (random.coin(0.1)) options.work = threads(2);
  const PairOutcome found = search(known.task, options, Pruning::kNone);
  most_asked = kNoEnd;
  if (found.decided()) return expect_answer(known, found);
  ++met.stopped;
  ASSERT_LE(found.bound, known.plain.cost());
  if (found.paths[0].empty()) {
    ASSERT_EQ(found.cost, kUnreachable);
    return;
  }
  ++met.stopped_with_pair;
  ASSERT_FALSE(has_conflict(between, found.paths));
  double cost = 0;
  for (std::size_t k = 0; k < 2; ++k) cost += cost_of(known.plain.arms()[k], found.paths[k]);
  ASSERT_EQ(found.cost, cost);
}

void count(const Known& known, const PairOutcome& found, Met& met) {
  ++met.tasks;
  met.rounds += found.rounds;
  met.pops += found.pops;
  const bool lacking = known.alone[0].path.empty() || known.alone[1].path.empty();
  met.without_path += lacking;
  met.apart += known.is_apart;
  if (known.is_apart || lacking) return;
  met.solved += found.cost != kUnreachable;
  met.none += found.cost == kUnreachable;
  met.dearer +=
      found.cost != kUnreachable && found.cost > found.least_costs[0] + found.least_costs[1];
  met.by_product += found.decided_by == PairSearcher::kProduct;
  met.by_regions += found.decided_by == PairSearcher::kRegions;
}

void expect_plain_program(const Task& task, bool few_nodes, Random& random, Met& met) {
  Known known{task, PlainPair(task), alone(task)};
  known.is_apart = !known.alone[0].path.empty() && !known.alone[1].path.empty() &&
                   !has_conflict(*task.between, {known.alone[0].path, known.alone[1].path});
  PairSearchOptions regions{.pops = 0}, product{.rounds = 0},
      both{.rounds = 1 + random.below(3),
           .pops = 1 + random.below(few_nodes ? 20 : 400),
           .growth = 2};
  both.quick_rounds = regions.quick_rounds = random.below(8);
  const Pruning pruning = random.coin() ? Pruning::kNone : Pruning::kByBound;
  // where regions are small, they alone would take very many rounds on most tasks
  const bool regions_suffice =
      task.between->has_large_regions() || (few_nodes && task.lattices[0]->layers() <= 3);
  if (regions_suffice && random.coin(0.2)) both.most_pops = 64;
  if (random.coin(0.3)) both.most_pairs = 0;
  for (const PairSearchOptions& options : {regions, product}) {
    if (options.pops == 0 && !regions_suffice) continue;
    SCOPED_TRACE(options.pops == 0 ? "regions" : "pairs of nodes");
    expect_answer(known, search(task, options, pruning, random.coin(0.3)));
    if (::testing::Test::HasFailure()) return;
  }
  const PairOutcome found = search(task, both, pruning);
  count(known, found, met);
  met.by_pair_values +=
      found.decided_by == PairSearcher::kProduct && found.turns > 1 && both.most_pairs > 0;
  expect_answer(known, found);
  if (::testing::Test::HasFailure()) return;
  if (met.tasks % 4 == 0) {
    PairSearchOptions shared = both;
    shared.work = threads(3);
    expect_alike(search(task, shared, pruning), found);
  }
  expect_bound_when_stopped(known, both, random, met);
}

void expect_plain_programs(bool grids, int usual) {
  const std::uint64_t base = seed(grids ? "PairSearch grids" : "PairSearch lists");
  Random random(base);
  Met met;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(usual); ++trial) {
      SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " " + robot.name + " trial " +
                   std::to_string(trial));
      const auto task = random_task(robot, arm, srs, grids, random);
      expect_plain_program(*task, !grids, random, met);
      if (::testing::Test::HasFailure()) return;
    }
  }
  std::printf(
      "%d tasks: %d without conflict, %d with an arm without path; of those in conflict %d solved "
      "(%d dearer than both alone), %d without a pair; %d decided by regions, %d by the product "
      "(%d with the cost-to-go of pairs), "
      "%lld rounds, %lld pairs taken; %d stopped before the end, %d of them with a pair\n",
      met.tasks, met.apart, met.without_path, met.solved, met.dearer, met.none, met.by_regions,
      met.by_product, met.by_pair_values, static_cast<long long>(met.rounds),
      static_cast<long long>(met.pops), met.stopped, met.stopped_with_pair);
  EXPECT_GE(met.apart, at_least(grids ? 20 : 300));
  EXPECT_GE(met.solved, at_least(grids ? 20 : 300));
  EXPECT_GE(met.none, at_least(grids ? 3 : 60));
  EXPECT_GE(met.by_regions, at_least(grids ? 5 : 100));
  EXPECT_GE(met.by_product, at_least(grids ? 5 : 100));
  EXPECT_GE(met.by_pair_values, at_least(grids ? 2 : 40));
  EXPECT_GE(met.stopped_with_pair, at_least(grids ? 1 : 20));
}

TEST(PairSearch, AnswersAreThoseOfAPlainProgramOverListsOfNodes) {
  expect_plain_programs(false, 400);
}
TEST(PairSearch, AnswersAreThoseOfAPlainProgramOverArmAngles) {
  expect_plain_programs(true, 24);
}

/// Two arms that are nowhere apart, with regions that lack the conflict.
class Misled : public Between {
 public:
  void nodes(std::span<const NodePair>, std::span<std::uint8_t> apart) override {
    std::fill(apart.begin(), apart.end(), std::uint8_t{0});
  }
  void moves(std::span<const MovePair>, std::span<std::uint8_t>) override {}
  [[nodiscard]] bool asks_moves() const override { return false; }
  [[nodiscard]] std::array<std::vector<int>, 2> region(const NodePair& x, bool) override {
    return {std::vector{x.slots[0]}, {}};
  }
};

TEST(PairSearch, TellsMisuse) {
  const TestRobot robot = all_robots().front();
  const ArmModel arm = arm_of(robot);
  Random random(seed("PairSearch misuse"));
  const Config q = random_config(arm.chain, random);
  PathProblem problem = problem_for(robot);
  problem.waypoints = {waypoint_of(arm.chain.tool(q)), waypoint_of(arm.chain.tool(q))};
  problem.waypoints[1].position.x() += 0.1;
  std::array<std::unique_ptr<ToolPath>, 2> paths;
  std::array<std::unique_ptr<CostToGo>, 2> values;
  Lattices lattices;
  for (std::size_t k = 0; k < 2; ++k) {
    problem.resolution.ds = k == 0 ? 0.1 : 0.05;
    paths[k] = std::make_unique<ToolPath>(waypoints_in_base(problem), problem.resolution, "test");
    lattices[k] = std::make_unique<ExplicitLattice>(
        arm.chain, *paths[k], problem,
        std::vector<std::vector<ExplicitLattice::Point>>(at(paths[k]->size()), {{.q = q}}));
    values[k] = make_cost_to_go(*lattices[k]);
  }
  FakeValidity validity(*lattices[0], 1, 0, 0, 0);
  const PairArm one{values[0].get(), &validity}, other{values[1].get(), &validity};
  Misled between;
  EXPECT_THROW(static_cast<void>(search_pair({one, other}, between, {})), std::invalid_argument);
  const auto twin = make_cost_to_go(*lattices[0]);
  const std::array<PairArm, 2> arms{one, PairArm{twin.get(), &validity}};
  EXPECT_THROW(static_cast<void>(search_pair(arms, between, {.rounds = 0, .pops = 0})),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(search_pair(arms, between, {})), std::logic_error);
  const PairOutcome found = search_pair(arms, between, {.rounds = 0});
  EXPECT_EQ(found.decided_by, PairSearcher::kProduct);
  EXPECT_EQ(found.bound, kUnreachable);
}

}  // namespace
}  // namespace swivel
