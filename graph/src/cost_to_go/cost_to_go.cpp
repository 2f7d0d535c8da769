// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

#include <utility>

#include "cost_to_go/best_start.hpp"

namespace swivel {

bool CostToGo::restart(const Budget& budget) {
  budget_ = budget;
  if (restarts_ && unremoved_ == Unremoved::kSaved) keep_removals();
  verdicts_.clear();
  ik_nodes_ = edges_ = 0;
  if (unremoved_ == Unremoved::kSaved) restore(*saved_);
  return unremoved_ != Unremoved::kUnknown;
}

void CostToGo::save_unremoved() {
  if (unremoved_ != Unremoved::kPresent) return;
  if (!restarts_) {
    unremoved_ = Unremoved::kUnknown;
    return;
  }
  saved_ = save();
  unremoved_ = Unremoved::kSaved;
}

std::shared_ptr<const CostToGo::SavedValues> CostToGo::values_without_removals() {
  save_unremoved();
  return unremoved_ == Unremoved::kSaved ? saved_ : nullptr;
}

void CostToGo::begin_with(std::shared_ptr<const SavedValues> values) {
  saved_ = std::move(values);
  unremoved_ = Unremoved::kSaved;
}

void CostToGo::sweep(int goal_layer) {
  save_unremoved();
  goal_ = goal_layer;
  compute(goal_layer);
  if (unremoved_ == Unremoved::kUnknown && goal_ == lattice().layers() - 1 &&
      verdicts_.removed() == 0 && !verdicts_.has_exit_costs())
    unremoved_ = Unremoved::kPresent;
}

void CostToGo::repair() {
  save_unremoved();
  compute_removals();
}

int CostToGo::first_slot() {
  return best_start(
      lattice(), lattice().slots(0), best(), [&](int slot) { return at(0, slot); },
      [&](int slot) { return config(0, slot); });
}

void CostToGo::remove_edge(int layer, int a, int b) {
  verdicts_.remove_edge(
      layer, a, b, lattice().edge_cost(lattice().delta(config(layer, a), config(layer + 1, b))));
}

}  // namespace swivel
