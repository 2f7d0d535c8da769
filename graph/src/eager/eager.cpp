// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/eager/eager.hpp"

#include <algorithm>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/iterator/transform_iterator.hpp>

#include "cost_to_go/best_start.hpp"
#include "eager/valid_nodes.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/graph/search/closed_path.hpp"

namespace swivel {

namespace {

struct EdgeCost {
  double cost = 0;
};
/// The explicit graph. Edges point from the goal towards the start, so that a search from the goal
/// yields every node's cost-to-go and ties can be settled from layer 0 on. Vertex 0 is the goal,
/// joined to every node of the last layer. The edges that lead to a node include what it costs
/// itself.
using Graph =
    boost::compressed_sparse_row_graph<boost::bidirectionalS, boost::no_property, EdgeCost>;
using Vertex = boost::graph_traits<Graph>::vertex_descriptor;

struct Built {
  Graph graph;
  std::vector<std::size_t> first;    // [layer] vertex of the layer's first node
  std::vector<double> least_before;  // [layer] a lower bound on the cost from layer 0
  [[nodiscard]] std::size_t layer_of(Vertex v) const {
    return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), v) -
                                    first.begin()) -
           1;
  }
};

struct PollingEdges {
  using Ends = std::pair<std::size_t, std::size_t>;
  const Budget* budget;
  mutable int count = 0;
  const Ends& operator()(const Ends& edge) const {
    if (++count % 4096 == 0) budget->poll();
    return edge;
  }
};

Built build(const Lattice& lattice, const ValidNodes& valid, Validity& validity,
            const Budget& budget, EagerOutcome& outcome) {
  const TraceSpan span("all edges");
  Built built;
  std::size_t vertices = 1;
  for (const auto& layer : valid.layers) {
    built.first.push_back(vertices);
    vertices += layer.size();
  }
  std::vector<std::pair<std::size_t, std::size_t>> ends;
  std::vector<EdgeCost> costs;
  for (std::size_t k = 0; k < valid.layers.back().size(); ++k) {
    ends.emplace_back(0, built.first.back() + k);
    costs.push_back({valid.cost(valid.layers.size() - 1, k)});
  }
  built.least_before.assign(valid.layers.size(), 0.0);
  std::vector<EdgeQuestion> questions;
  std::vector<std::uint8_t> answers;
  std::vector<std::pair<std::size_t, std::size_t>> candidate_ends;
  std::vector<EdgeCost> candidate_costs;
  Successors successors(lattice);
  for (int layer = 0; layer + 1 < lattice.layers(); ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    const auto& next = valid.layers[i + 1];
    successors.enter(layer, next);
    questions.clear();
    candidate_ends.clear();
    candidate_costs.clear();
    for (std::size_t a = 0; a < valid.layers[i].size(); ++a) {
      if (a % 16 == 0) budget.poll();
      const ValidNodes::Node& node = valid.layers[i][a];
      successors.for_each(node, outcome.edges, [&](int b, const Config& delta) {
        const auto& head = next[static_cast<std::size_t>(b)];
        candidate_ends.emplace_back(built.first[i + 1] + static_cast<std::size_t>(b),
                                    built.first[i] + a);
        candidate_costs.push_back({valid.cost(i, a) + lattice.edge_cost(delta)});
        if (validity.asks_edges())
          questions.push_back({layer, node.slot, head.slot, node.q, head.q});
      });
    }
    answers.assign(candidate_ends.size(), 1);
    if (validity.asks_edges()) validity.edges(questions, answers);
    double least = kUnreachable;
    for (std::size_t e = 0; e < candidate_ends.size(); ++e) {
      if (!answers[e]) continue;
      ends.push_back(candidate_ends[e]);
      costs.push_back(candidate_costs[e]);
      least = std::min(least, candidate_costs[e].cost);
    }
    built.least_before[i + 1] = built.least_before[i] + (least == kUnreachable ? 0.0 : least);
  }
  // reading the edges, which Boost does several times, takes seconds
  const PollingEdges polled{&budget};
  built.graph = Graph(boost::edges_are_unsorted_multi_pass,
                      boost::make_transform_iterator(ends.begin(), polled),
                      boost::make_transform_iterator(ends.end(), polled), costs.begin(), vertices);
  return built;
}

/// Polls the budget during a search.
struct PollingVisitor : boost::default_dijkstra_visitor {
  const Budget* budget;
  mutable int count = 0;
  explicit PollingVisitor(const Budget* b) : budget(b) {}
  void examine_vertex(Vertex, const Graph&) const {
    if (++count % 256 == 0) budget->poll();
  }
};

std::vector<double> costs_to_go(const Graph& graph, const Budget& budget, EagerOutcome& outcome) {
  const TraceSpan span("graph search");
  std::vector<double> distance(num_vertices(graph), kUnreachable);
  const auto index = get(boost::vertex_index, graph);
  boost::dijkstra_shortest_paths(
      graph, Vertex{0},
      boost::weight_map(get(&EdgeCost::cost, graph))
          .distance_map(boost::make_iterator_property_map(distance.begin(), index))
          .distance_inf(kUnreachable)
          .visitor(PollingVisitor(&budget)));
  outcome.expansions = static_cast<std::int64_t>(num_vertices(graph)) - 1;
  return distance;
}

/// Returns the least costs from all vertices to the nodes of the last layer in a run of slots, with
/// what the nodes themselves cost.
std::vector<double> costs_into(const Lattice::SlotRun& run, const Built& built,
                               const ValidNodes& valid, const Budget& budget) {
  std::vector<double> distance(num_vertices(built.graph), kUnreachable);
  const std::size_t last = valid.layers.size() - 1;
  for (std::size_t k = 0; k < valid.layers[last].size(); ++k)
    if (const int slot = valid.layers[last][k].slot; slot >= run.first && slot < run.last)
      distance[built.first[last] + k] = valid.cost(last, k);
  for (std::size_t layer = last; layer > 0; --layer) {
    budget.poll();
    for (std::size_t k = 0; k < valid.layers[layer].size(); ++k) {
      const Vertex v = built.first[layer] + k;
      if (distance[v] == kUnreachable) continue;
      for (auto [e, end] = out_edges(v, built.graph); e != end; ++e) {
        double& least = distance[target(*e, built.graph)];
        least = std::min(least, built.graph[*e].cost + distance[v]);
      }
    }
  }
  return distance;
}

/// Returns the best path from the k-th valid node of layer 0, the smallest slots first among equal
/// costs: vertices of a layer are numbered in slot order.
SlotPath path_from(int k, const Built& built, const ValidNodes& valid,
                   const std::vector<double>& distance) {
  Vertex at = built.first[0] + static_cast<std::size_t>(k);
  SlotPath path;
  for (std::size_t layer = 0;; ++layer) {
    path.push_back(valid.layers[layer][at - built.first[layer]].slot);
    if (layer + 1 == valid.layers.size()) return path;
    Vertex next = 0;
    for (auto [e, end] = in_edges(at, built.graph); e != end; ++e) {
      const Vertex b = source(*e, built.graph);
      if (built.graph[*e].cost + distance[b] == distance[at] && (next == 0 || b < next)) next = b;
    }
    at = next;
  }
}

/// Returns the best path that begins and ends in a run of slots.
SearchOutcome best_within(const Lattice::SlotRun& run, const Built& built, const ValidNodes& valid,
                          const Budget& budget) {
  const std::vector<double> distance = costs_into(run, built, valid, budget);
  SearchOutcome best{{}, kUnreachable};
  int first = -1;
  for (std::size_t k = 0; k < valid.layers[0].size(); ++k) {
    const int slot = valid.layers[0][k].slot;
    const double cost = distance[built.first[0] + k];
    if (slot >= run.first && slot < run.last && cost < best.cost)
      best.cost = cost, first = static_cast<int>(k);
  }
  if (first >= 0) best.path = path_from(first, built, valid, distance);
  return best;
}

/// Returns the best path from the node at which the answer begins.
SlotPath extract(const Lattice& lattice, const Built& built, const ValidNodes& valid,
                 const std::vector<double>& distance, double& cost) {
  cost = kUnreachable;
  const auto of_start = [&](int k) {
    return distance[built.first[0] + static_cast<std::size_t>(k)];
  };
  const int starts = static_cast<int>(valid.layers[0].size());
  for (int k = 0; k < starts; ++k) cost = std::min(cost, of_start(k));
  const int first = best_start(lattice, starts, cost, of_start, [&](int k) {
    return valid.layers[0][static_cast<std::size_t>(k)].q;
  });
  if (first < 0) return {};
  cost = distance[built.first[0] + static_cast<std::size_t>(first)];
  return path_from(first, built, valid, distance);
}

std::optional<int> deepest_layer(const Built& built, const ValidNodes& valid,
                                 const Budget& budget) {
  std::vector<char> reached(num_vertices(built.graph), 0);
  for (std::size_t k = 0; k < valid.layers[0].size(); ++k) reached[built.first[0] + k] = 1;
  int deepest = valid.layers[0].empty() ? -1 : 0;
  for (std::size_t layer = 1; layer < valid.layers.size() && deepest == static_cast<int>(layer) - 1;
       ++layer)
    for (std::size_t k = 0; k < valid.layers[layer].size(); ++k) {
      if (k % 1024 == 0 && budget.spent()) return std::nullopt;
      for (auto [e, end] = out_edges(built.first[layer] + k, built.graph); e != end; ++e)
        if (reached[target(*e, built.graph)]) {
          reached[built.first[layer] + k] = 1;
          deepest = static_cast<int>(layer);
        }
    }
  return deepest;
}

}  // namespace

void eager_search(const Lattice& lattice, Validity& validity, const Budget& budget,
                  EagerOutcome& outcome) {
  const ValidNodes valid = find_valid_nodes(lattice, validity, budget, outcome.ik_nodes);
  const Built built = build(lattice, valid, validity, budget, outcome);
  if (lattice.is_closed()) {
    static_cast<SearchOutcome&>(outcome) = closed_path_first(
        lattice, budget,
        [&](const Lattice::SlotRun& run) { return best_within(run, built, valid, budget); });
  } else {
    const std::vector<double> distance = costs_to_go(built.graph, budget, outcome);
    outcome.path = extract(lattice, built, valid, distance, outcome.cost);
  }
  if (outcome.path.empty()) outcome.deepest = deepest_layer(built, valid, budget);
}

}  // namespace swivel
