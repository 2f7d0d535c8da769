// SPDX-License-Identifier: BSD-3-Clause
// The search of the planners `lazy` and `parallel`: Boost.Graph's A* over a lattice that is never
// stored. Its heuristic is exact: CostToGo is a backward dynamic program over all layers, repaired
// after every removal, so what it says of a node is the cost of the best path that is left from
// there, not just a lower bound. With an exact heuristic, distance + heuristic is the same at every
// vertex of a best path, and larger at all others, which ImplicitLattice does not even list. So A*
// walks straight to the goal and expands one vertex a layer, until it comes to a node from which an
// earlier path still holds (PathCache). Costs are multiples of one unit and their sums exact, so
// that equal costs compare equal.
#include <algorithm>
#include <boost/graph/astar_search.hpp>
#include <stdexcept>
#include <unordered_map>

#include "swivel/core/base/timeline.hpp"
#include "swivel/graph/lattice_graph/implicit_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

namespace {

using Vertex = ImplicitLattice::Vertex;

/// Orders the queue: by cost, then depth (deepest first), then slot. With a perfect heuristic every
/// queued vertex lies on a best path, so the first to reach the goal is the smallest in slot order.
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
  Rank operator()(double distance, const Estimate& rest) const {
    return {distance + rest.cost, rest.tie};
  }
};
struct Compare {
  bool operator()(double a, double b) const { return a < b; }
  bool operator()(double cost, const Rank& zero) const { return cost < zero.cost; }
  bool operator()(const Rank& a, const Rank& b) const {
    return a.cost != b.cost ? a.cost < b.cost : a.tie < b.tie;
  }
};

/// What A* knows of a vertex that it has touched; these are few.
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
  Vertex last;
  const SlotPath* then;  // earlier path that it goes on with; null at the goal
};

struct Visitor : boost::default_astar_visitor {
  PathCache* earlier;
  std::int64_t* expansions;
  Visitor(PathCache* paths, std::int64_t* count) : earlier(paths), expansions(count) {}
  void examine_vertex(Vertex v, const ImplicitLattice& g) const {
    const CostToGo& values = g.values();
    if (++*expansions % 16 == 0) values.budget().poll();
    // An exception is the one way out of a Boost.Graph search.
    if (g.layer_of(v) == values.goal_layer()) throw Found{v, nullptr};
    if (const SlotPath* path =
            earlier ? earlier->from(g.layer_of(v), g.slot_of(v), values) : nullptr)
      throw Found{v, path};
  }
};

}  // namespace

void PathCache::add(const SlotPath& path, const CostToGo& cost_to_go) {
  if (path.empty()) return;
  if (earlier_.size() == kMost) earlier_.pop_back();
  Earlier& added = earlier_.emplace_front(Earlier{path, {}});
  added.values.reserve(path.size());
  for (int layer = 0; layer < static_cast<int>(path.size()); ++layer)
    added.values.push_back(cost_to_go.at(layer, path[static_cast<std::size_t>(layer)]));
}

const SlotPath* PathCache::from(int layer, int slot, const CostToGo& cost_to_go) {
  for (Earlier& earlier : earlier_) {
    const bool of_goal = static_cast<int>(earlier.path.size()) == cost_to_go.goal_layer() + 1;
    if (of_goal && earlier.path[static_cast<std::size_t>(layer)] == slot &&
        still_optimal_from(layer, earlier, cost_to_go))
      return &earlier.path;
  }
  return nullptr;
}

bool PathCache::still_optimal_from(int layer, Earlier& earlier, const CostToGo& cost_to_go) {
  if (layer <= earlier.deepest_changed_layer) return false;
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  for (const int goal = cost_to_go.goal_layer(); layer <= goal; ++layer) {
    const int slot = earlier.path[at(layer)];
    if (cost_to_go.at(layer, slot) != earlier.values[at(layer)] ||
        (layer < goal && cost_to_go.verdicts().edge(layer, slot, earlier.path[at(layer) + 1]) ==
                             Verdict::kRemoved)) {
      earlier.deepest_changed_layer = layer;
      return false;
    }
  }
  return true;
}

SlotPath best_path(CostToGo& cost_to_go, std::int64_t& expansions, PathCache* earlier) {
  const int first = cost_to_go.first_slot();
  return first < 0 ? SlotPath() : best_path_from(first, cost_to_go, expansions, earlier);
}

SlotPath best_path_from(int first, CostToGo& cost_to_go, std::int64_t& expansions,
                        PathCache* earlier) {
  const TraceSpan span("best path");
  const double cost = cost_to_go.at(0, first);
  if (cost == kUnreachable) return {};
  if (cost >= PathCache::kExact * cost_to_go.lattice().cost_unit()) earlier = nullptr;
  const ImplicitLattice graph(cost_to_go);
  Records records;
  records.reserve(static_cast<std::size_t>(4 * cost_to_go.goal_layer() + 64));
  const Vertex start = graph.vertex(0, first);
  const auto heuristic = [&](Vertex v) -> Estimate {
    const std::int64_t depth = graph.layer_of(v);
    return {graph.cost_to_go(v),
            (cost_to_go.goal_layer() - depth) * graph.width() + graph.slot_of(v)};
  };
  record(records, start).distance = 0;
  record(records, start).rank = {cost, heuristic(start).tie};
  try {
    boost::astar_search_no_init(
        graph, start, heuristic, Visitor(earlier, &expansions),
        Field<Vertex, &Record::predecessor>{&records}, Field<Rank, &Record::rank>{&records},
        Field<double, &Record::distance>{&records}, ImplicitCostMap{},
        Field<boost::default_color_type, &Record::color>{&records},
        Field<std::size_t, &Record::index>{&records}, Compare{}, Combine{}, Rank{}, Rank{0, 0});
  } catch (const Found& found) {
    SlotPath path;
    for (Vertex v = found.last; v >= 0; v = records.at(v).predecessor)
      path.push_back(graph.slot_of(v));
    std::reverse(path.begin(), path.end());
    if (found.then)
      path.insert(path.end(), found.then->begin() + static_cast<std::ptrdiff_t>(path.size()),
                  found.then->end());
    return path;
  }
  throw std::logic_error("the cost-to-go knows a path that the search does not find");
}

}  // namespace swivel
