// SPDX-License-Identifier: BSD-3-Clause
// The search of `lazy` and `parallel`: Boost.Graph's A* over the lattice that is never stored. Its heuristic is exact: CostToGo is
// a backward dynamic program over all layers, repaired after every removal, so what it says of a node is the cost of the best path
// that is left from there, and not just a lower bound. With an exact heuristic, distance + heuristic is the same at every vertex of
// a best path, and larger at all others, which ImplicitLattice does not even list. So A* walks straight to the goal and expands one
// vertex a layer. Costs are multiples of one unit and their sums exact, so that equal costs compare equal.
#include <algorithm>
#include <boost/graph/astar_search.hpp>
#include <stdexcept>
#include <unordered_map>

#include "swivel/core/timeline.hpp"
#include "swivel/graph/implicit_lattice.hpp"
#include "swivel/graph/path_first.hpp"

namespace swivel {

namespace {

using Vertex = ImplicitLattice::Vertex;

/// What orders the queue: cost, then depth (deepest first), then slot. With a perfect heuristic every queued vertex lies on an
/// optimal path, so the first to reach the goal is the smallest in slot order.
struct Rank {
  double cost = kUnreachable;
  std::int64_t tie = 0;
};
struct Estimate {
  double cost = 0;
  std::int64_t tie = 0;
};
struct Combine {
  double operator()(double distance, double cost) const { return distance + cost; }
  Rank operator()(double distance, const Estimate& rest) const { return {distance + rest.cost, rest.tie}; }
};
struct Compare {
  bool operator()(double a, double b) const { return a < b; }
  bool operator()(double cost, const Rank& zero) const { return cost < zero.cost; }
  bool operator()(const Rank& a, const Rank& b) const { return a.cost != b.cost ? a.cost < b.cost : a.tie < b.tie; }
};

/// What A* knows of the few vertices it has touched.
struct Record {
  double distance = kUnreachable;
  Rank rank;
  Vertex predecessor = -1;
  boost::default_color_type color = boost::white_color;
  std::size_t index = 0;
};
using Records = std::unordered_map<Vertex, Record>;

Record& record(Records& records, Vertex v) {
  const auto [found, fresh] = records.try_emplace(v);
  if (fresh) found->second.index = records.size() - 1;
  return found->second;
}

/// A field of the records as a property map.
template <class T, T Record::*kField>
struct Field {
  using key_type = Vertex;
  using value_type = T;
  using reference = T&;
  using category = boost::lvalue_property_map_tag;
  Records* records = nullptr;
  T& operator[](Vertex v) const { return record(*records, v).*kField; }
  friend T& get(const Field& map, Vertex v) { return map[v]; }
  friend void put(const Field& map, Vertex v, const T& value) { map[v] = value; }
};

struct Found {
  Vertex goal;
};

struct Visitor : boost::default_astar_visitor {
  int goal_layer;
  std::int64_t* expansions;
  const Budget* budget;
  Visitor(int goal, std::int64_t* count, const Budget* b) : goal_layer(goal), expansions(count), budget(b) {}
  void examine_vertex(Vertex v, const ImplicitLattice& g) const {
    if (v == g.root()) return;
    if (++*expansions % 16 == 0) budget->poll();
    if (g.layer_of(v) == goal_layer) throw Found{v};  // the one way out of a Boost.Graph search
  }
};

}  // namespace

SlotPath best_path(CostToGo& cost_to_go, std::int64_t& expansions) {
  const TraceSpan span("best path");
  if (cost_to_go.best() == kUnreachable) return {};
  const ImplicitLattice graph(cost_to_go);
  Records records;
  records.reserve(static_cast<std::size_t>(4 * cost_to_go.goal_layer() + 64));
  const Vertex root = graph.root();
  const auto heuristic = [&](Vertex v) -> Estimate {
    if (v == root) return {cost_to_go.best(), 0};
    const std::int64_t depth = graph.layer_of(v);
    return {graph.cost_to_go(v), (cost_to_go.goal_layer() - depth) * graph.width() + graph.slot_of(v)};
  };
  record(records, root).distance = 0;
  record(records, root).rank = {cost_to_go.best(), 0};
  try {
    boost::astar_search_no_init(graph, root, heuristic, Visitor(cost_to_go.goal_layer(), &expansions, &cost_to_go.budget()),
                                Field<Vertex, &Record::predecessor>{&records}, Field<Rank, &Record::rank>{&records},
                                Field<double, &Record::distance>{&records}, ImplicitCostMap{},
                                Field<boost::default_color_type, &Record::color>{&records},
                                Field<std::size_t, &Record::index>{&records}, Compare{}, Combine{}, Rank{}, Rank{0, 0});
  } catch (const Found& found) {
    SlotPath path;
    for (Vertex v = found.goal; v != root; v = records.at(v).predecessor) path.push_back(graph.slot_of(v));
    std::reverse(path.begin(), path.end());
    return path;
  }
  throw std::logic_error("the cost-to-go knows a path that the search does not find");
}

}  // namespace swivel
