// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/layer_values.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// Returns true if removing one of these edges, to or from nodes with the values `others`, can have
/// changed a node's value.
bool gives(const std::vector<Verdicts::HalfEdge>& edges, const std::vector<double>& others,
           double value) {
  return std::any_of(edges.begin(), edges.end(), [&](const Verdicts::HalfEdge& edge) {
    return edge.cost + others[static_cast<std::size_t>(edge.other)] == value;
  });
}

/// What is removed in one of two plans alone.
struct Differences {
  std::size_t count = 0;
  bool ended = false;                        // some removals of the plan before are not repeated
  std::map<int, std::vector<int>> of_layer;  // slots of nodes, or of the tails of edges
};
int slot_of(int node) {
  return node;
}
int slot_of(const std::pair<int, int>& edge) {
  return edge.first;
}

template <class Removed>
Differences differences(const std::map<int, std::vector<Removed>>& before,
                        const std::map<int, std::vector<Removed>>& now) {
  Differences found;
  const auto compare = [&](int layer, const std::vector<Removed>& old,
                           const std::vector<Removed>& fresh) {
    std::vector<Removed> ended, begun;
    std::set_difference(old.begin(), old.end(), fresh.begin(), fresh.end(),
                        std::back_inserter(ended));
    std::set_difference(fresh.begin(), fresh.end(), old.begin(), old.end(),
                        std::back_inserter(begun));
    found.count += ended.size() + begun.size();
    found.ended |= !ended.empty();
    for (const auto* some : {&ended, &begun})
      for (const Removed& one : *some) found.of_layer[layer].push_back(slot_of(one));
  };
  const std::vector<Removed> none;
  for (const auto& [layer, old] : before) {
    const auto fresh = now.find(layer);
    compare(layer, old, fresh == now.end() ? none : fresh->second);
  }
  for (const auto& [layer, fresh] : now)
    if (!before.contains(layer)) compare(layer, none, fresh);
  return found;
}

}  // namespace

LayerValues::LayerValues(const Lattice& lattice, const Budget& budget, Pruning pruning)
    : CostToGo(lattice, budget),
      bounded_(pruning == Pruning::kByBound && lattice.is_given(0)),
      slack_(first_slack(lattice)) {
  for (int layer = 0; layer < lattice.layers(); ++layer)
    value_.emplace_back(static_cast<std::size_t>(lattice.slots(layer)), kUnreachable);
}

std::shared_ptr<const CostToGo::SavedValues> LayerValues::save() const {
  return std::make_shared<const Saved>(goal_, limit_, value_, before_);
}

void LayerValues::restore(const SavedValues& values) {
  const auto& saved = static_cast<const Saved&>(values);
  goal_ = saved.goal;
  limit_ = saved.limit;
  value_ = saved.value;
  before_ = saved.before;
  slack_ = first_slack(lattice());
  forward_.clear();
  exact_ = true;
}

void LayerValues::leave_out_removed(int layer, Values& values) const {
  for (int slot = 0; slot < static_cast<int>(values.size()); ++slot)
    if (removed(layer, slot)) values[static_cast<std::size_t>(slot)] = kUnreachable;
}

bool LayerValues::lost_best_edge(int layer, int slot, double value) const {
  const auto* edges = verdicts_.removed_edges(layer);
  if (edges == nullptr || value == kUnreachable) return false;
  const auto heads = edges->tails.find(slot);
  return heads != edges->tails.end() &&
         gives(heads->second, value_[static_cast<std::size_t>(layer) + 1], value);
}

void LayerValues::solve_layer(int layer, Values& out) {
  if (layer == goal_) {
    begin(layer, out);
    leave_out_removed(layer, out);
  } else {
    const Values& next = value_[static_cast<std::size_t>(layer) + 1];
    relax(layer, layer, layer + 1, next, out);
    leave_out_removed(layer, out);
    if (const auto* edges = verdicts_.removed_edges(layer))
      for (const auto& [a, heads] : edges->tails) {
        double& value = out[static_cast<std::size_t>(a)];
        if (value != kUnreachable && gives(heads, next, value)) value = relax_one(layer, a);
      }
  }
  if (const double* own = verdicts_.costs(layer))
    for (double& value : out) value += *own++;
}

void LayerValues::solve_within_limit(int layer, Values& out) {
  if (limit_ == kUnreachable) return solve_layer(layer, out);
  const Values& before = (by_coarser_ ? forward_ : before_.values)[static_cast<std::size_t>(layer)];
  const double* own = verdicts_.costs(layer);
  within_.clear();
  for (int slot = 0; slot < static_cast<int>(before.size()); ++slot)
    if (before[static_cast<std::size_t>(slot)] <= limit_ && !removed(layer, slot))
      within_.push_back(slot);
  out.assign(before.size(), kUnreachable);
  if (within_.empty()) return;
  if (layer == goal_)
    fresh_.assign(within_.size(), 0.0);
  else
    relax_some(layer, within_, fresh_);
  for (std::size_t k = 0; k < within_.size(); ++k) {
    const auto slot = static_cast<std::size_t>(within_[k]);
    const double value = fresh_[k] + (own ? own[slot] : 0.0);
    if (before[slot] + value <= limit_) out[slot] = value;
  }
}

bool LayerValues::set_limit() {
  if (deepest_reachable() < goal_) return false;
  const Values& ends = before_.values[static_cast<std::size_t>(goal_)];
  const double* own = verdicts_.costs(goal_);
  double best = kUnreachable;
  for (std::size_t slot = 0; slot < ends.size(); ++slot)
    best = std::min(best, ends[slot] + (own ? own[slot] : 0.0));
  limit_ = lattice().largest_of_same_coarse_cost((1 + slack_) * best);
  slack_ = next_slack(slack_);
  return true;
}

void LayerValues::go_forward(std::span<const Values> known, std::span<const int> layer_here) {
  const TraceSpan span("forward bounds");
  forward_.clear();
  std::size_t next = 0;
  for (int layer = 0; layer < lattice().layers(); ++layer) {
    budget_.poll();
    Values here;
    if (next < layer_here.size() && layer_here[next] == layer)
      here = known[next++];
    else if (layer == 0)
      begin(layer, here);
    else
      relax(layer - 1, layer, layer - 1, forward_.back(), here);
    leave_out_removed(layer, here);
    forward_.push_back(std::move(here));
  }
}

void LayerValues::bound_by_coarser(CostToGo& coarser, std::span<const int> layer_here) {
  auto* const other = dynamic_cast<LayerValues*>(&coarser);
  if (!other) return;
  share_nodes(*other, layer_here);
  if (lattice().has_node_costs() || lattice().is_closed() || more_knots_allow_more()) return;
  if (other->forward_.empty()) other->go_forward({}, {});
  go_forward(other->forward_, layer_here);
  by_coarser_ = true;
  bounded_ = false;
  expected_ = other->goal_layer() + 1 == other->lattice().layers() ? other->best() : 0;
  if (expected_ == kUnreachable) expected_ = 0;
}

bool LayerValues::set_limit_by_bounds() {
  constexpr double kWide = 0.3;
  const Values& ends = forward_[static_cast<std::size_t>(goal_)];
  double best = ends.empty() ? kUnreachable : *std::min_element(ends.begin(), ends.end());
  if (best == kUnreachable) return false;
  if (goal_ + 1 == lattice().layers()) best = std::max(best, expected_);
  limit_ =
      slack_ < kWide ? lattice().largest_of_same_coarse_cost((1 + slack_) * best) : kUnreachable;
  slack_ *= 4;
  return true;
}

void LayerValues::sweep_once() {
  const TraceSpan span("sweep");
  for (int layer = goal_; layer >= 0; --layer) {
    budget_.poll(Stage::kSweep, goal_ - layer, goal_);
    solve_within_limit(layer, value_[static_cast<std::size_t>(layer)]);
    if (layer < goal_) done_with(layer + 1);
  }
}

void LayerValues::compute(int goal_layer) {
  exact_ = lowers_ = last_.known = false;
  verdicts_.pending.clear();
  limit_ = kUnreachable;
  if (goal_layer + 1 == lattice().layers()) {
    if (before_.removed != 0 || verdicts_.removed() != 0) before_ = {};
    slack_ = first_slack(lattice());
  }
  if (by_coarser_)
    slack_ = kSlackOfHalves;
  else
    forward_.clear();
  const bool reached = by_coarser_ ? set_limit_by_bounds() : !bounded_ || set_limit();
  for (int layer = reached ? goal_layer + 1 : 0; layer < lattice().layers(); ++layer) {
    Values& values = value_[static_cast<std::size_t>(layer)];
    std::fill(values.begin(), values.end(), kUnreachable);
  }
  if (reached) sweep_once();
  while (by_coarser_ && beyond_limit() && set_limit_by_bounds()) sweep_once();
  exact_ = true;
}

void LayerValues::renew_layer(int layer, std::vector<Change>& changed) {
  Values& values = value_[static_cast<std::size_t>(layer)];
  const Values before = values;
  solve_within_limit(layer, values);
  for (std::size_t slot = 0; slot < values.size(); ++slot)
    note_change(static_cast<int>(slot), before[slot], values[slot], changed);
}

void LayerValues::note_change(int slot, double before, double now,
                              std::vector<Change>& changed) const {
  if (before != now) changed.push_back({slot, lowers_ ? std::min(before, now) : before});
}

void LayerValues::relax_some(int layer, const std::vector<int>& slots, Values& out) {
  out.clear();
  for (std::size_t k = 0; k < slots.size(); ++k) {
    if (k % 64 == 0) budget_.poll();
    out.push_back(relax_one(layer, slots[k]));
  }
}

void LayerValues::renew_nodes(int layer, std::vector<int>& stale, std::vector<Change>& changed) {
  Values& values = value_[static_cast<std::size_t>(layer)];
  const double* own = verdicts_.costs(layer);
  std::erase_if(stale, [&](int a) {
    return values[static_cast<std::size_t>(a)] == kUnreachable && (!lowers_ || removed(layer, a));
  });
  if (stale.empty()) return;
  if (layer == goal_)
    fresh_.assign(stale.size(), 0.0);
  else
    relax_some(layer, stale, fresh_);
  for (std::size_t k = 0; k < stale.size(); ++k) {
    const int slot = stale[k];
    double& value = values[static_cast<std::size_t>(slot)];
    double fresh = removed(layer, slot) ? kUnreachable : fresh_[k];
    if (own) fresh += own[slot];
    note_change(slot, value, fresh, changed);
    value = fresh;
  }
}

void LayerValues::keep_removals() {
  last_.known = exact_ && !bounded_ && !by_coarser_ && goal_ + 1 == lattice().layers() &&
                verdicts_.removed() > 0 && verdicts_.pending.empty() && !verdicts_.costs_changed();
  if (!last_.known) return;
  last_.removals = verdicts_.removals();
  last_.value.swap(value_);
}

void LayerValues::take_last_values() {
  if (!std::exchange(last_.known, false) || verdicts_.costs_changed()) return;
  const Verdicts::Removals now = verdicts_.removals();
  const Differences nodes = differences(last_.removals.nodes, now.nodes),
                    edges = differences(last_.removals.edges, now.edges);
  if (2 * (nodes.count + edges.count) > static_cast<std::size_t>(verdicts_.removed())) return;
  value_.swap(last_.value);
  lowers_ = nodes.ended || edges.ended;
  verdicts_.pending.clear();
  for (const auto& [layer, slots] : nodes.of_layer) verdicts_.pending[layer].nodes = slots;
  for (const auto& [layer, slots] : edges.of_layer) verdicts_.pending[layer].tails = slots;
}

void LayerValues::compute_removals() {
  const TraceSpan span("repair");
  exact_ = false;
  take_last_values();
  std::vector<Change> changed, ahead;  // in this layer, in the next one to repair
  std::vector<int> stale;
  for (int layer = goal_; layer >= 0 && (!ahead.empty() || !verdicts_.pending.empty()); --layer) {
    budget_.poll();
    stale.clear();
    changed.clear();
    if (const auto found = verdicts_.pending.find(layer); found != verdicts_.pending.end()) {
      for (const auto* slots : {&found->second.nodes, &found->second.tails})
        stale.insert(stale.end(), slots->begin(), slots->end());
      for (const auto& raise : found->second.raised) stale.push_back(raise.slot);
      verdicts_.pending.erase(found);
    }
    if (ahead.size() + stale.size() > many(layer)) {
      renew_layer(layer, changed);
    } else {
      find_stale(layer, ahead, stale);
      std::sort(stale.begin(), stale.end());
      stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
      renew_nodes(layer, stale, changed);
    }
    ahead.swap(changed);
  }
  // Beyond the limit values may be too high.
  while (beyond_limit()) {
    if (by_coarser_ ? set_limit_by_bounds() : set_limit()) {
      sweep_once();
      continue;
    }
    for (Values& values : value_) std::fill(values.begin(), values.end(), kUnreachable);
    limit_ = kUnreachable;
  }
  lowers_ = false;
  exact_ = true;
}

double LayerValues::best() const {
  const Values& first = value_.front();
  return first.empty() ? kUnreachable : *std::min_element(first.begin(), first.end());
}

int LayerValues::deepest_reachable() {
  if (before_.known && before_.removed == verdicts_.removed()) return before_.deepest;
  const TraceSpan span("reach");
  save_unremoved();
  before_ = {};
  Values before, here;
  for (int layer = 0; layer < lattice().layers(); ++layer) {
    budget_.poll();
    if (layer == 0) {
      begin(layer, here);
    } else {
      relax(layer - 1, layer, layer - 1, before, here);
      if (const auto* edges = verdicts_.removed_edges(layer - 1))
        for (const auto& [b, tails] : edges->heads) {
          double& value = here[static_cast<std::size_t>(b)];
          if (value != kUnreachable && gives(tails, before, value))
            value = relax_one_forward(layer, b, before);
        }
    }
    leave_out_removed(layer, here);
    if (std::all_of(here.begin(), here.end(), [](double value) { return value == kUnreachable; }))
      break;
    before_.deepest = layer;
    before.swap(here);
    if (!bounded_) continue;
    before_.values.push_back(before);
    if (const double* own = verdicts_.costs(layer))
      for (double& value : before) value += *own++;
  }
  before_.known = bounded_;
  before_.removed = verdicts_.removed();
  return before_.deepest;
}

}  // namespace swivel
