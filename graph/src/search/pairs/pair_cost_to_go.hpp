// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// The least cost from each pair of simultaneous nodes to a pair of the last layer, over pairs of
/// nodes that Between::find_barred() does not bar. What both arms do on the moves between layers is
/// not asked: no pair of paths without conflict costs less. Since the cost of a step is the sum of
/// both arms' costs, one arm after the other takes its step in the program over layers: that takes
/// as many operations as there are pairs times the edges of a node, not times their square. Memory:
/// 8 bytes a pair.
class PairCostToGo {
 public:
  /// Computes the values. `arms` says what may be left out of each lattice, and need not outlive
  /// the object. Throws Stopped.
  PairCostToGo(const std::array<CostToGo*, 2>& arms, Between& between, const Budget& budget);

  /// Returns how many pairs there are of nodes that reach the last layer.
  [[nodiscard]] static std::int64_t pairs(const std::array<CostToGo*, 2>& arms);

  /// Returns the least cost from a pair; kUnreachable where no path is known.
  [[nodiscard]] double at(int layer, const std::array<int, 2>& slots) const;

 private:
  struct Layer {
    std::array<std::vector<int>, 2> slots;  // those that reach the last layer, in their order
    std::vector<double> cost;               // [index of arm 0's slot][index of arm 1's slot]
  };
  /// An edge to the next layer, by the index of its slot there.
  struct Edge {
    std::size_t to = 0;
    double cost = 0;
  };
  using Edges = std::vector<std::vector<Edge>>;  // [index of slot]
  [[nodiscard]] static std::vector<int> live_slots(const CostToGo& arm, int layer);
  [[nodiscard]] static Edges edges(CostToGo& arm, int layer, const std::vector<int>& from,
                                   const std::vector<int>& to);
  void relax(std::size_t layer, const std::array<CostToGo*, 2>& arms, const Budget& budget);
  void bar(std::size_t layer, const std::array<CostToGo*, 2>& arms, Between& between);

  std::vector<Layer> layers_;
};

}  // namespace swivel
