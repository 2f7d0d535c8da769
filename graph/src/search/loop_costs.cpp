// SPDX-License-Identifier: BSD-3-Clause
#include "search/loop_costs.hpp"

#include <algorithm>

namespace swivel {

void sweep_to(const Lattice::SlotRun& goals, CostToGo& cost_to_go,
              std::span<const std::uint8_t> allowed) {
  const Lattice& lattice = cost_to_go.lattice();
  const int last = lattice.layers() - 1, slots = lattice.slots(last);
  Verdicts& verdicts = cost_to_go.verdicts();
  verdicts.forget_exit_costs();
  std::vector<double> costs(static_cast<std::size_t>(slots), kUnreachable);
  for (int slot = goals.first; slot < goals.last; ++slot)
    if (const auto k = static_cast<std::size_t>(slot); allowed.empty() || allowed[k] != 0)
      costs[k] = 0;
  if (std::find(costs.begin(), costs.end(), kUnreachable) != costs.end())
    verdicts.raise_exit_costs(costs);
  cost_to_go.sweep(last);
}

LoopCosts::LoopCosts(CostToGo& cost_to_go)
    : cost_to_go_(&cost_to_go),
      costs_(static_cast<std::size_t>(cost_to_go.lattice().slots(0)), 0.0),
      begins_(costs_.size(), 0) {
  if (costs_.empty()) return;
  begins_.front() = 1;
  sweep_run_of(0);
}

void LoopCosts::sweep_run_of(int slot) {
  int first = slot, last = slot + 1;
  while (begins_[static_cast<std::size_t>(first)] == 0) --first;
  while (last < static_cast<int>(begins_.size()) && begins_[static_cast<std::size_t>(last)] == 0)
    ++last;
  if (swept_.first == first && swept_.last == last) return;
  swept_ = {first, last};
  sweep_to(swept_, *cost_to_go_);
  take_values();
}

void LoopCosts::take_values() {
  for (int slot = swept_.first; slot < swept_.last; ++slot) {
    double& cost = costs_[static_cast<std::size_t>(slot)];
    cost = std::max(cost, cost_to_go_->at(0, slot));
  }
}

SlotPath LoopCosts::loop_from(int slot, std::int64_t& expansions) {
  const double known = at(slot);
  for (;;) {
    cost_to_go_->budget().poll();
    sweep_run_of(slot);
    if (at(slot) > known) return {};
    SlotPath path = best_path_from(slot, *cost_to_go_, expansions);
    const int end = path.back();
    if (end == slot) return path;
    const int middle = std::min(slot, end) + (std::abs(end - slot) + 1) / 2;
    begins_[static_cast<std::size_t>(middle)] = 1;
  }
}

}  // namespace swivel
