// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/shared_work.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"

namespace swivel {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The cost from the nodes to the goal layer over the lattice minus what has been removed from it, what the nodes themselves cost
/// included, first and last: a backward dynamic program over layers. Repaired, not recomputed, after removals and where nodes turn
/// out to cost something; so it is always the perfect heuristic of what is known. How it is computed depends on the kind of
/// lattice, see make_cost_to_go.
/// Whatever takes long throws Stopped once the budget is spent; verdicts are kept, and at() means nothing then.
class CostToGo {
 public:
  virtual ~CostToGo() = default;
  CostToGo(const CostToGo&) = delete;
  CostToGo& operator=(const CostToGo&) = delete;

  [[nodiscard]] virtual const Lattice& lattice() const = 0;
  [[nodiscard]] const Budget& budget() const { return budget_; }

  /// Forgets removals and counts, and begins again within another budget. True where values are now those of a lattice without
  /// removals and the last layer as its goal, as they were found before; else sweep() comes next.
  [[nodiscard]] bool restart(const Budget& budget);
  /// Threads to share work with from now on; none unless said. Values are the same, bit for bit.
  void share(const SharedWork& work) { work_ = work; }
  /// Nothing is kept for restart() from now on.
  void never_restarts() { restarts_ = false; }

  /// Cost-to-go with every node of `goal_layer` as a goal; verdicts are kept.
  void sweep(int goal_layer);
  [[nodiscard]] int goal_layer() const { return goal_; }
  /// Exact on every best path from a node of layer 0 whose coarse cost (Lattice) is that of best(); kUnreachable where none is
  /// known.
  [[nodiscard]] virtual double at(int layer, int slot) const = 0;
  /// Least over layer 0, exact; kUnreachable when no path is left.
  [[nodiscard]] virtual double best() const = 0;

  /// The slot of layer 0 that the best path begins at, by the order of answers: of the nodes whose coarse cost is that of best(),
  /// the one nearest to the middle of the joints' ranges, the first of them; -1 when no path is left.
  [[nodiscard]] int first_slot();

  /// What has been asked, what is removed, what nodes cost: values follow at the next repair().
  [[nodiscard]] Verdicts& verdicts() { return verdicts_; }
  [[nodiscard]] const Verdicts& verdicts() const { return verdicts_; }
  void remove_edge(int layer, int a, int b);
  /// Makes best() exact again after removals and costs.
  void repair();

  /// Deepest layer that layer 0 reaches over what remains; -1 when layer 0 is empty.
  [[nodiscard]] virtual int deepest_reachable() = 0;

  /// One node's joints.
  [[nodiscard]] virtual Config config(int layer, int slot) = 0;
  /// The same, before the first sweep too; none where there is no such node.
  [[nodiscard]] virtual std::optional<Config> node(int layer, int slot) { return lattice().node(layer, slot); }
  struct Step {
    int slot = 0;
    double cost = 0;  ///< of the edge and of the node that it leaves
  };
  /// Replaces `out` by the edges that are left from a node to the next layer with cost + at() <= bound, in the order of slots.
  virtual void steps(int layer, int slot, double bound, std::vector<Step>& out) = 0;

  /// Work so far: nodes solved and edges compared, repeats counted.
  [[nodiscard]] std::int64_t ik_nodes() const { return ik_nodes_; }
  [[nodiscard]] std::int64_t edges() const { return edges_; }

 protected:
  CostToGo(const Lattice& lattice, const Budget& budget) : budget_(budget), verdicts_(lattice) {}
  virtual void compute(int goal_layer) = 0;
  virtual void compute_removals() = 0;
  /// Keeps the present values for restore(), which brings them back as often as asked.
  virtual void save() = 0;
  virtual void restore() = 0;

  Budget budget_;
  SharedWork work_;
  int goal_ = 0;
  Verdicts verdicts_;
  std::int64_t ik_nodes_ = 0, edges_ = 0;

 private:
  /// Of the values without removals and the last layer as the goal.
  enum class Unremoved { kUnknown, kPresent, kSaved };
  void save_unremoved();
  Unremoved unremoved_ = Unremoved::kUnknown;
  bool restarts_ = true;
};

/// kBounded may leave out nodes that a lower bound proves to lie on no best path: they then read as unreachable, or as costlier
/// than they are. best(), first_slot() and every best path are exact all the same.
enum class Extent { kWhole, kBounded };
/// The cost-to-go of a lattice: of a grid (SrsLattice) in vector code, of an explicit lattice by plain loops and always whole, of a
/// RollLattice layer by layer over rolls and arm angles. What `retired`, of any lattice, had allocated serves again: pages fresh
/// from the system take a quarter of a plan that meets obstacles.
[[nodiscard]] std::unique_ptr<CostToGo> make_cost_to_go(const Lattice& lattice, Extent extent = Extent::kWhole,
                                                        const Budget& budget = {}, std::unique_ptr<CostToGo> retired = nullptr);

}  // namespace swivel
