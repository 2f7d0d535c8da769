// SPDX-License-Identifier: BSD-3-Clause
#include <boost/graph/breadth_first_search.hpp>
#include <swivel/graph/lattice_graph/implicit_lattice.hpp>

void visit_all(swivel::CostToGo& cost_to_go, boost::queue<swivel::ImplicitLattice::Vertex>& queue,
               std::map<swivel::ImplicitLattice::Vertex, boost::default_color_type>& colors) {
  const swivel::ImplicitLattice graph(cost_to_go);
  boost::breadth_first_visit(graph, graph.vertex(0, cost_to_go.first_slot()), queue,
                             boost::default_bfs_visitor(), boost::make_assoc_property_map(colors));
}
