// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// Where a path may be cut into runs, by layer of its lattice.
struct CutPlace {
  bool allowed = false;  ///< a run may end at this layer
  int resumed = 0;       ///< layer at which the next run begins then: this one, or one before
};

/// The valid nodes of a lattice's layer 0, and from each the least cost to the last layer over
/// valid nodes and edges; kUnreachable where there is no path.
struct CostsToEnd {
  std::vector<Lattice::Node> nodes;
  std::vector<double> costs;
};
/// Asks about all nodes, and about an edge only where it would be the best from its node. Throws
/// Stopped.
[[nodiscard]] CostsToEnd costs_to_end(const Lattice& lattice, Validity& validity,
                                      const Budget& budget);

/// A path in several runs: the layers at which all runs but the last end, and the cost of all runs
/// with the joint moves from the end of each to the begin of the next.
struct CutPath {
  std::vector<int> ends;
  double cost = 0;
};

/// Cuts the path of a lattice into runs, by a layered dynamic program over copies of the lattice,
/// one for each number of runs that are left. It asks about all nodes and edges of the lattice
/// first, and stores those that are valid. A move from the end of a run to the begin of the next
/// counts as straight and free.
class CutProgram {
 public:
  /// Asks about all nodes and edges. The lattice must outlive this. Throws Stopped.
  CutProgram(const Lattice& lattice, Validity& validity, const Budget& budget);

  /// Returns the valid nodes of a layer, in the order of slots.
  [[nodiscard]] const std::vector<Lattice::Node>& nodes(int layer) const {
    return nodes_[static_cast<std::size_t>(layer)];
  }

  /// Says where the path may be cut, one item for each layer; a cut in layer 0 or in the last layer
  /// is never one.
  void set_places(std::vector<CutPlace> places) { places_ = std::move(places); }
  /// Says what it costs to come to the valid nodes of a layer at the begin of a run, or to leave
  /// them at its end, one item for each node in the order of nodes(): kUnreachable where that is
  /// impossible. Layers that are not set cost nothing.
  void set_begin_costs(int layer, std::vector<double> costs) {
    begin_costs_[static_cast<std::size_t>(layer)] = std::move(costs);
  }
  void set_end_costs(int layer, std::vector<double> costs) {
    end_costs_[static_cast<std::size_t>(layer)] = std::move(costs);
  }

  /// Returns the furthest layer that a run from a layer reaches, whatever it costs to begin and to
  /// end there; -1 where the layer has no valid node.
  [[nodiscard]] int reach(int layer) const;
  /// Returns the least number of cuts with which there are runs from layer 0 to the last one; none
  /// where no number suffices.
  [[nodiscard]] std::optional<int> least_cuts() const;
  /// Cut number `cut`, from 0, at a layer.
  struct Cut {
    int cut = 0, layer = 0;
    bool operator==(const Cut&) const = default;
  };
  /// Returns the cheapest way to cut the path with a number of cuts, none of them among `without`;
  /// the earliest cuts of several; none if there is no way. Throws Stopped.
  [[nodiscard]] std::optional<CutPath> best(int cuts, const std::vector<Cut>& without,
                                            const Budget& budget) const;

 private:
  struct Edge {
    int to = 0;  // index of a valid node in the next layer
    double cost = 0;
  };
  using Flags = std::vector<std::vector<std::uint8_t>>;  // by layer and valid node
  using Costs = std::vector<std::vector<double>>;
  [[nodiscard]] double begin_cost(std::size_t layer, std::size_t node) const {
    return begin_costs_[layer].empty() ? 0 : begin_costs_[layer][node];
  }
  [[nodiscard]] double end_cost(std::size_t layer, std::size_t node) const {
    return end_costs_[layer].empty() ? 0 : end_costs_[layer][node];
  }
  [[nodiscard]] bool may_cut(std::size_t layer) const {
    return layer > 0 && layer + 1 < nodes_.size() && places_[layer].allowed;
  }
  void find_edges(const Lattice& lattice, Validity& validity, const Budget& budget);
  [[nodiscard]] Flags first_run() const;
  [[nodiscard]] Flags next_run(const Flags& before) const;
  void spread(Flags& reached) const;
  [[nodiscard]] bool ends(const Flags& reached) const;
  struct Program;
  /// Lets node `a` be the end of a run, if that is cheaper than what is known.
  void cut_at(std::size_t layer, std::size_t a, const Program& ahead, Program& own) const;
  /// Lets the run go on from node `a`, if that is cheaper than what is known.
  void go_on_from(std::size_t layer, std::size_t a, Program& own) const;
  [[nodiscard]] std::optional<CutPath> path_of(const std::vector<Program>& programs) const;

  const Lattice* lattice_;
  std::vector<std::vector<Lattice::Node>> nodes_;
  std::vector<std::vector<std::vector<Edge>>> edges_;  // by layer and valid node
  Costs begin_costs_, end_costs_;
  std::vector<CutPlace> places_;
};

}  // namespace swivel
