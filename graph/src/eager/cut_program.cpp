// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/eager/cut_program.hpp"

#include <algorithm>
#include <utility>

#include "eager/valid_nodes.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

namespace {

/// Returns what a straight move of the joints from the end of a run to the begin of the next costs.
/// The roll of a six-joint arm is no joint.
double move_cost(const Lattice& lattice, const Config& from, const Config& to) {
  Config delta = lattice.delta(from, to);
  if (lattice.chain().roll) delta[kDof - 1] = 0;
  return lattice.edge_cost(delta);
}

/// Edges from the nodes of a layer to the next, of each node the best ones first.
class BestEdges {
 public:
  struct Edge {
    std::size_t to = 0;
    double cost = 0;  // to the end
  };
  explicit BestEdges(std::size_t nodes) : edges_(nodes), next_(nodes, 0) {}
  void add(std::size_t node, const Edge& edge) { edges_[node].push_back(edge); }
  void sort() {
    for (std::vector<Edge>& edges : edges_)
      std::stable_sort(edges.begin(), edges.end(),
                       [](const Edge& a, const Edge& b) { return a.cost < b.cost; });
  }
  /// Returns the best edge of a node that has not failed; null where all have.
  [[nodiscard]] const Edge* best(std::size_t node) const {
    return next_[node] < edges_[node].size() ? &edges_[node][next_[node]] : nullptr;
  }
  void fail(std::size_t node) { ++next_[node]; }

 private:
  std::vector<std::vector<Edge>> edges_;
  std::vector<std::size_t> next_;
};

/// Returns from each node of a layer the least cost to the end, given those of the next layer.
std::vector<double> costs_of_layer(const Lattice& lattice, int layer, const ValidNodes& valid,
                                   const std::vector<double>& ahead, Successors& successors,
                                   Validity& validity) {
  const auto i = static_cast<std::size_t>(layer);
  const std::vector<Lattice::Node>&own = valid.layers[i], &next = valid.layers[i + 1];
  successors.enter(layer, next);
  BestEdges edges(own.size());
  std::int64_t compared = 0;
  for (std::size_t a = 0; a < own.size(); ++a)
    successors.for_each(own[a], compared, [&](int b, const Config& delta) {
      const auto to = static_cast<std::size_t>(b);
      if (ahead[to] < kUnreachable) edges.add(a, {to, lattice.edge_cost(delta) + ahead[to]});
    });
  edges.sort();
  std::vector<std::size_t> open(own.size());
  for (std::size_t a = 0; a < own.size(); ++a) open[a] = a;
  std::vector<EdgeQuestion> questions;
  std::vector<std::uint8_t> answers;
  while (!open.empty()) {
    std::erase_if(open, [&](std::size_t a) { return edges.best(a) == nullptr; });
    questions.clear();
    for (const std::size_t a : open) {
      const Lattice::Node& to = next[edges.best(a)->to];
      questions.push_back({layer, own[a].slot, to.slot, own[a].q, to.q});
    }
    answers.assign(questions.size(), 1);
    if (validity.asks_edges()) validity.edges(questions, answers);
    std::vector<std::size_t> failed;
    for (std::size_t k = 0; k < open.size(); ++k)
      if (answers[k] == 0) failed.push_back(open[k]);
    for (const std::size_t a : failed) edges.fail(a);
    open = failed;
  }
  std::vector<double> costs;
  for (std::size_t a = 0; a < own.size(); ++a)
    costs.push_back(edges.best(a) ? edges.best(a)->cost : kUnreachable);
  return costs;
}

}  // namespace

CostsToEnd costs_to_end(const Lattice& lattice, Validity& validity, const Budget& budget) {
  std::int64_t ik_nodes = 0;
  ValidNodes valid = find_valid_nodes(lattice, validity, budget, ik_nodes);
  Successors successors(lattice);
  std::vector<double> costs(valid.layers.back().size(), 0.0);
  for (int layer = lattice.layers() - 1; layer-- > 0;) {
    budget.poll();
    costs = costs_of_layer(lattice, layer, valid, costs, successors, validity);
  }
  return {std::move(valid.layers.front()), std::move(costs)};
}

CutProgram::CutProgram(const Lattice& lattice, Validity& validity, const Budget& budget)
    : lattice_(&lattice) {
  std::int64_t ik_nodes = 0;
  nodes_ = find_valid_nodes(lattice, validity, budget, ik_nodes).layers;
  begin_costs_.resize(nodes_.size());
  end_costs_.resize(nodes_.size());
  places_.resize(nodes_.size());
  find_edges(lattice, validity, budget);
}

void CutProgram::find_edges(const Lattice& lattice, Validity& validity, const Budget& budget) {
  const TraceSpan span("all edges");
  Successors successors(lattice);
  std::vector<EdgeQuestion> questions;
  std::vector<std::uint8_t> answers;
  std::int64_t compared = 0;
  edges_.resize(nodes_.size());
  for (std::size_t layer = 0; layer + 1 < nodes_.size(); ++layer) {
    budget.poll();
    const auto i = static_cast<int>(layer);
    const std::vector<Lattice::Node>&own = nodes_[layer], &next = nodes_[layer + 1];
    successors.enter(i, next);
    questions.clear();
    std::vector<std::pair<std::size_t, Edge>> found;
    for (std::size_t a = 0; a < own.size(); ++a)
      successors.for_each(own[a], compared, [&](int b, const Config& delta) {
        const Lattice::Node& to = next[static_cast<std::size_t>(b)];
        questions.push_back({i, own[a].slot, to.slot, own[a].q, to.q});
        found.push_back({a, {b, lattice.edge_cost(delta)}});
      });
    answers.assign(questions.size(), 1);
    if (validity.asks_edges()) validity.edges(questions, answers);
    edges_[layer].resize(own.size());
    for (std::size_t k = 0; k < found.size(); ++k)
      if (answers[k] != 0) edges_[layer][found[k].first].push_back(found[k].second);
  }
}

// --- reach: which nodes a run can come to

void CutProgram::spread(Flags& reached) const {
  for (std::size_t layer = 0; layer + 1 < nodes_.size(); ++layer)
    for (std::size_t a = 0; a < nodes_[layer].size(); ++a)
      if (reached[layer][a] != 0)
        for (const Edge& edge : edges_[layer][a])
          reached[layer + 1][static_cast<std::size_t>(edge.to)] = 1;
}

CutProgram::Flags CutProgram::first_run() const {
  Flags reached;
  for (const auto& layer : nodes_) reached.emplace_back(layer.size(), std::uint8_t{0});
  for (std::size_t a = 0; a < nodes_.front().size(); ++a)
    reached.front()[a] = begin_cost(0, a) < kUnreachable ? 1 : 0;
  spread(reached);
  return reached;
}

CutProgram::Flags CutProgram::next_run(const Flags& before) const {
  Flags reached;
  for (const auto& layer : nodes_) reached.emplace_back(layer.size(), std::uint8_t{0});
  for (std::size_t layer = 0; layer < nodes_.size(); ++layer) {
    if (!may_cut(layer)) continue;
    bool ends_here = false;
    for (std::size_t a = 0; a < nodes_[layer].size() && !ends_here; ++a)
      ends_here = before[layer][a] != 0 && end_cost(layer, a) < kUnreachable;
    if (!ends_here) continue;
    const auto begin = static_cast<std::size_t>(places_[layer].resumed);
    for (std::size_t a = 0; a < nodes_[begin].size(); ++a)
      if (begin_cost(begin, a) < kUnreachable) reached[begin][a] = 1;
  }
  spread(reached);
  return reached;
}

bool CutProgram::ends(const Flags& reached) const {
  const std::size_t last = nodes_.size() - 1;
  for (std::size_t a = 0; a < nodes_[last].size(); ++a)
    if (reached[last][a] != 0 && end_cost(last, a) < kUnreachable) return true;
  return false;
}

int CutProgram::reach(int layer) const {
  Flags reached;
  for (const auto& nodes : nodes_) reached.emplace_back(nodes.size(), std::uint8_t{0});
  auto& first = reached[static_cast<std::size_t>(layer)];
  std::fill(first.begin(), first.end(), std::uint8_t{1});
  spread(reached);
  for (std::size_t i = nodes_.size(); i-- > 0;)
    if (std::find(reached[i].begin(), reached[i].end(), 1) != reached[i].end())
      return static_cast<int>(i);
  return -1;
}

std::optional<int> CutProgram::least_cuts() const {
  Flags reached = first_run();
  // a run more adds a node, or none ever will: with overlaps a run may reach less than the one
  // before, so that what was reached so far counts
  Flags known = reached;
  for (int cuts = 0;; ++cuts) {
    if (ends(reached)) return cuts;
    reached = next_run(reached);
    bool more = false;
    for (std::size_t layer = 0; layer < nodes_.size(); ++layer)
      for (std::size_t a = 0; a < nodes_[layer].size(); ++a)
        if (reached[layer][a] != 0 && known[layer][a] == 0) {
          known[layer][a] = 1;
          more = true;
        }
    if (!more && !ends(reached)) return std::nullopt;
  }
}

// --- cost

/// The values of one number of cuts left: least cost from each node to the end, and the way there.
struct CutProgram::Program {
  explicit Program(const CutProgram& of) {
    for (const auto& layer : of.nodes_) {
      values.emplace_back(layer.size(), kUnreachable);
      next.emplace_back(layer.size(), -1);
      lifted.emplace_back(layer.size(), -1);
    }
  }
  Costs values;
  // by layer and node: the node of the next layer, or, where a cut is best, that of the next run
  std::vector<std::vector<int>> next, lifted;
};

void CutProgram::cut_at(std::size_t layer, std::size_t a, const Program& ahead,
                        Program& own) const {
  if (end_cost(layer, a) == kUnreachable) return;
  const auto begin = static_cast<std::size_t>(places_[layer].resumed);
  double& value = own.values[layer][a];
  for (std::size_t b = 0; b < nodes_[begin].size(); ++b) {
    const double known = end_cost(layer, a) + begin_cost(begin, b) + ahead.values[begin][b];
    if (!(known < value)) continue;
    const double cost = known + move_cost(*lattice_, nodes_[layer][a].q, nodes_[begin][b].q);
    if (!(cost < value)) continue;
    value = cost;
    own.lifted[layer][a] = static_cast<int>(b);
  }
}

void CutProgram::go_on_from(std::size_t layer, std::size_t a, Program& own) const {
  double& value = own.values[layer][a];
  for (const Edge& edge : edges_[layer][a]) {
    const double cost = edge.cost + own.values[layer + 1][static_cast<std::size_t>(edge.to)];
    if (!(cost < value)) continue;
    value = cost;
    own.next[layer][a] = edge.to;
    own.lifted[layer][a] = -1;
  }
}

std::optional<CutPath> CutProgram::path_of(const std::vector<Program>& programs) const {
  int node = -1;
  CutPath found{{}, kUnreachable};
  for (std::size_t a = 0; a < nodes_.front().size(); ++a) {
    const double cost = begin_cost(0, a) + programs.back().values.front()[a];
    if (cost < found.cost) found.cost = cost, node = static_cast<int>(a);
  }
  if (node < 0) return std::nullopt;
  std::size_t left = programs.size() - 1;
  for (std::size_t layer = 0; layer + 1 < nodes_.size();) {
    const auto a = static_cast<std::size_t>(node);
    const Program& own = programs[left];
    if (own.lifted[layer][a] >= 0) {
      found.ends.push_back(static_cast<int>(layer));
      node = own.lifted[layer][a];
      layer = static_cast<std::size_t>(places_[layer].resumed);
      --left;
    } else {
      node = own.next[layer][a];
      ++layer;
    }
  }
  return found;
}

std::optional<CutPath> CutProgram::best(int cuts, const std::vector<Cut>& without,
                                        const Budget& budget) const {
  std::vector<Flags> reached{first_run()};
  for (int k = 0; k < cuts; ++k) reached.push_back(next_run(reached.back()));
  std::vector<Program> programs;
  const std::size_t last = nodes_.size() - 1;
  for (int left = 0; left <= cuts; ++left) {
    programs.emplace_back(*this);
    Program& own = programs.back();
    const Flags& used = reached[static_cast<std::size_t>(cuts - left)];
    if (left == 0)
      for (std::size_t a = 0; a < nodes_[last].size(); ++a)
        if (used[last][a] != 0) own.values[last][a] = end_cost(last, a);
    for (std::size_t layer = last; layer-- > 0;) {
      budget.poll();
      const Cut here{cuts - left, static_cast<int>(layer)};
      const bool cut = left > 0 && may_cut(layer) &&
                       std::find(without.begin(), without.end(), here) == without.end();
      for (std::size_t a = 0; a < nodes_[layer].size(); ++a) {
        if (used[layer][a] == 0) continue;
        if (cut) cut_at(layer, a, programs[programs.size() - 2], own);
        go_on_from(layer, a, own);
      }
    }
  }
  return path_of(programs);
}

}  // namespace swivel
