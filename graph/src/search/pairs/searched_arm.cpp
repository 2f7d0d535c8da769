// SPDX-License-Identifier: BSD-3-Clause
#include "search/pairs/searched_arm.hpp"

#include "swivel/core/base/timeline.hpp"

namespace swivel {

SearchedArm::SearchedArm(const PairArm& arm, const PathFirstOptions& options)
    : cost_to_go_(arm.cost_to_go),
      validity_(arm.cost_to_go->lattice(), *arm.validity),
      options_(&options) {
  validity_.take(cost_to_go_->verdicts());
}

SearchOutcome SearchedArm::search(FirstPath first) {
  PathValidator validator(*cost_to_go_, validity_, *options_);
  PathCache earlier;
  SearchCounters counters;
  return first_valid_path(*cost_to_go_, validity_, validator, earlier, counters, first);
}

SearchOutcome SearchedArm::answer_alone() {
  const TraceSpan span("arm alone");
  cost_to_go_->sweep(lattice().layers() - 1);
  return search(FirstPath::kInOrderOfAnswers);
}

void SearchedArm::begin_again() {
  const Budget budget = cost_to_go_->budget();
  if (!cost_to_go_->restart(budget)) cost_to_go_->sweep(lattice().layers() - 1);
  RememberedValidity::Written nothing;
  validity_.write(*cost_to_go_, nothing);
}

void SearchedArm::remove(const ConflictRegion& region, int arm) {
  const auto side = static_cast<std::size_t>(arm);
  const Verdicts& verdicts = cost_to_go_->verdicts();
  cost_to_go_->verdicts().remove_nodes(region.layer, region.slots[side]);
  for (const SlotMove& move : region.moves[side]) {
    const auto from = cost_to_go_->node(region.layer, move.from),
               to = cost_to_go_->node(region.layer + 1, move.to);
    if (from && to && lattice().in_window(region.layer, move.from, move.to) &&
        lattice().step_allowed(region.layer, lattice().delta(*from, *to)) &&
        verdicts.edge(region.layer, move.from, move.to) != Verdict::kRemoved)
      cost_to_go_->remove_edge(region.layer, move.from, move.to);
  }
}

SearchOutcome SearchedArm::cheapest(std::span<const ConflictRegion* const> regions, int arm) {
  const TraceSpan span("arm beside regions");
  begin_again();
  for (const ConflictRegion* region : regions) remove(*region, arm);
  if (!cost_to_go_->verdicts().pending.empty()) cost_to_go_->repair();
  return search(FirstPath::kCheapest);
}

double SearchedArm::cost(const SlotPath& path) {
  double cost = 0;
  for (int layer = 0; layer < lattice().layers(); ++layer) {
    const int slot = path[static_cast<std::size_t>(layer)];
    const Config q = cost_to_go_->config(layer, slot);
    double own = lattice().has_node_costs() ? lattice().node_cost(layer, slot) : 0;
    if (validity_.asks_costs()) {
      const NodeQuestion question{layer, slot, q};
      validity_.costs({&question, 1}, {&own, 1});
    }
    cost += own;
    if (layer == 0) continue;
    const Config before = cost_to_go_->config(layer - 1, path[static_cast<std::size_t>(layer) - 1]);
    cost += lattice().edge_cost(lattice().delta(before, q));
  }
  return cost;
}

}  // namespace swivel
