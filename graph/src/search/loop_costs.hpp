// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// Sweeps a cost-to-go whose goals are the slots of a run in the last layer, of these only those
/// whose item of `allowed` is not 0: exit costs become 0 there and kUnreachable elsewhere. An empty
/// `allowed` allows all.
void sweep_to(const Lattice::SlotRun& goals, CostToGo& cost_to_go,
              std::span<const std::uint8_t> allowed = {});

/// What it costs at least to go from each slot of layer 0 of a closed lattice back to it, over what
/// is not removed: the least cost to any slot of the same run of slots. Runs are cut as needed,
/// down to single slots. Costs only rise.
class LoopCosts {
 public:
  /// Sweeps to all slots. The cost-to-go must be whole (Pruning::kNone), and is swept by this alone
  /// from now on.
  explicit LoopCosts(CostToGo& cost_to_go);

  /// Returns a lower bound of what any path from a slot back to it costs; kUnreachable where none
  /// is left.
  [[nodiscard]] double at(int slot) const { return costs_[static_cast<std::size_t>(slot)]; }
  /// Returns the best path from a slot back to it, the first in slot order, if it costs at(slot);
  /// else an empty one, once at(slot) has risen. The slot must have a finite cost. Adds to
  /// `expansions`. Throws Stopped.
  [[nodiscard]] SlotPath loop_from(int slot, std::int64_t& expansions);
  /// Takes the values of the cost-to-go after a repair.
  void take_values();

 private:
  void sweep_run_of(int slot);

  CostToGo* cost_to_go_;
  std::vector<double> costs_;
  std::vector<std::uint8_t> begins_;  // by slot: whether a run begins there
  Lattice::SlotRun swept_;            // the run to which the cost-to-go leads
};

}  // namespace swivel
