// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "job/order/order_program.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"

namespace swivel {

/// Lower bounds of what jobs cost in any order of their strokes, whatever their transitions. The
/// nodes at which runs begin and end are put into groups; a run costs from group to group what it
/// costs between the cheapest of their nodes, and a transition the least joint distance between
/// two. Groups are divided where a job that costs less than the best one known may use them, and
/// left out elsewhere, so that bounds become those of the nodes themselves.
class OrderBounds {
 public:
  /// `runs`: the cost-to-go of each run as OrderGraph numbers them, made with Pruning::kNone; null
  /// where a run is not allowed. From now on nothing else may sweep them. `metric` says what
  /// transitions cost. All must outlive it. Throws Stopped.
  OrderBounds(const std::vector<CostToGo*>& runs, const std::optional<Config>& home,
              const Lattice& metric, ParallelFor work, const Budget& budget);

  /// Returns the costs between groups.
  [[nodiscard]] const OrderGraph& graph() const { return graph_; }
  /// Raises costs by what was removed from the runs. Throws Stopped.
  void take_removals();
  /// Leaves out groups of which OrderProgram::uses() is not less than `most`, and divides the
  /// others in two. Returns false, and does nothing, where none can be divided, or where the
  /// program over all orders would take too long. Throws Stopped.
  bool divide(const OrderProgram::Uses& uses, double most);

 private:
  struct Node {
    int slot = 0;
    Config q = Config::Zero();  // of the row, rad
  };
  struct Group {
    std::vector<Node> nodes;
    Config lower = Config::Zero(), upper = Config::Zero();  // of the nodes
  };
  struct Run {
    CostToGo* values = nullptr;
    std::vector<Group> begins, ends;
    /// [end group][slot of layer 0]: the least cost of the run from there to a node of the group;
    /// empty until it is swept.
    std::vector<std::vector<double>> costs;
    std::int64_t removed = 0;  // nodes and edges, when it was swept
    [[nodiscard]] bool is_closed() const { return values->lattice().is_closed(); }
  };
  static Group group_of(std::vector<Node> nodes);
  static Group nodes_of(CostToGo& values, int layer);
  [[nodiscard]] std::vector<Group> divided(const Group& group) const;
  [[nodiscard]] std::vector<Group> divided(const std::vector<Group>& groups) const;
  [[nodiscard]] double distance(const Group& from, const Group& to) const;
  void sweep(Run& run) const;
  void sweep_all();
  void compute_distances();
  void compute_distances(std::size_t run);

  std::vector<Run> runs_;
  std::optional<Group> home_;
  const Lattice* metric_;
  ParallelFor work_;
  Budget budget_;
  OrderGraph graph_;
};

}  // namespace swivel
