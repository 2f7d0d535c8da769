// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <boost/graph/graph_concepts.hpp>
#include <boost/graph/graph_traits.hpp>
#include <boost/graph/properties.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/property_map/property_map.hpp>
#include <cstdint>
#include <utility>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// The lattice as a Boost.Graph IncidenceGraph that stores no vertex and no edge: vertex = layer *
/// (most slots of a layer) + slot. The best path begins at vertex(0, CostToGo::first_slot()). Edges
/// are made when asked for: those that the cost-to-go has not removed and whose cost plus
/// cost-to-go exceeds their tail's own cost-to-go by at most `slack` (0: just the edges of best
/// paths).
class ImplicitLattice {
 public:
  using Vertex = std::int64_t;
  struct Edge {
    Vertex source = 0, target = 0;
    double cost = 0;
    bool operator==(const Edge&) const = default;
  };

  /// Makes the graph over a cost-to-go, which must outlive it.
  explicit ImplicitLattice(CostToGo& cost_to_go, double slack = 0);

  /// Returns the vertex of a node.
  [[nodiscard]] Vertex vertex(int layer, int slot) const { return layer * width_ + slot; }
  /// Returns the layer of a vertex.
  [[nodiscard]] int layer_of(Vertex v) const { return static_cast<int>(v / width_); }
  /// Returns the slot of a vertex.
  [[nodiscard]] int slot_of(Vertex v) const { return static_cast<int>(v % width_); }
  /// Returns the most slots that a layer has.
  [[nodiscard]] std::int64_t width() const { return width_; }
  /// Returns the cost-to-go of a vertex.
  [[nodiscard]] double cost_to_go(Vertex v) const {
    return cost_to_go_->at(layer_of(v), slot_of(v));
  }
  /// Returns the number of vertices, those without a node included.
  [[nodiscard]] std::int64_t vertices() const { return cost_to_go_->lattice().layers() * width_; }
  /// Returns the cost-to-go.
  [[nodiscard]] const CostToGo& values() const { return *cost_to_go_; }

  /// Returns the edges that leave v, valid until the next call: a search looks at one vertex's
  /// edges at a time.
  [[nodiscard]] const std::vector<Edge>& expand(Vertex v) const;

 private:
  CostToGo* cost_to_go_;
  double slack_;
  std::int64_t width_ = 1;
  // Scratch of the one search that walks this graph; the graph itself has no state.
  mutable std::vector<Edge> edges_;
  mutable std::vector<CostToGo::Step> steps_;
};

// Boost.Graph interface, found by argument-dependent look-up.
inline ImplicitLattice::Vertex source(const ImplicitLattice::Edge& e, const ImplicitLattice&) {
  return e.source;
}
inline ImplicitLattice::Vertex target(const ImplicitLattice::Edge& e, const ImplicitLattice&) {
  return e.target;
}
inline std::pair<std::vector<ImplicitLattice::Edge>::const_iterator,
                 std::vector<ImplicitLattice::Edge>::const_iterator>
out_edges(ImplicitLattice::Vertex v, const ImplicitLattice& g) {
  const auto& edges = g.expand(v);
  return {edges.begin(), edges.end()};
}
inline std::size_t out_degree(ImplicitLattice::Vertex v, const ImplicitLattice& g) {
  return g.expand(v).size();
}
inline std::size_t num_vertices(const ImplicitLattice& g) {
  return static_cast<std::size_t>(g.vertices());
}
inline std::pair<boost::counting_iterator<ImplicitLattice::Vertex>,
                 boost::counting_iterator<ImplicitLattice::Vertex>>
vertices(const ImplicitLattice& g) {
  return {boost::counting_iterator<ImplicitLattice::Vertex>(0),
          boost::counting_iterator<ImplicitLattice::Vertex>(g.vertices())};
}

/// Edge costs as a readable property map.
struct ImplicitCostMap {
  using key_type = ImplicitLattice::Edge;
  using value_type = double;
  using reference = double;
  using category = boost::readable_property_map_tag;
};
inline double get(const ImplicitCostMap&, const ImplicitLattice::Edge& e) {
  return e.cost;
}

}  // namespace swivel

namespace boost {

template <>
struct graph_traits<swivel::ImplicitLattice> {
  struct traversal : virtual incidence_graph_tag, virtual vertex_list_graph_tag {};
  using vertex_descriptor = swivel::ImplicitLattice::Vertex;
  using edge_descriptor = swivel::ImplicitLattice::Edge;
  using directed_category = directed_tag;
  using edge_parallel_category = disallow_parallel_edge_tag;
  using traversal_category = traversal;
  using out_edge_iterator = std::vector<swivel::ImplicitLattice::Edge>::const_iterator;
  using degree_size_type = std::size_t;
  using vertex_iterator = counting_iterator<swivel::ImplicitLattice::Vertex>;
  using vertices_size_type = std::size_t;
  static vertex_descriptor null_vertex() { return -1; }
};

}  // namespace boost
