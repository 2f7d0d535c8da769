// SPDX-License-Identifier: BSD-3-Clause
// Pairs of equal cost are taken in the order of their ways from layer 0, compared slot by slot, arm
// 0 before arm 1 in each layer. So the first pair that is reached in the last layer ends the first
// pair of paths in the order of answers (docs/theory.md).
#include "search/pairs/product_search.hpp"

#include <algorithm>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

std::int64_t key(int layer, int slot) {
  return (std::int64_t{layer} << 32) + slot;
}

}  // namespace

std::size_t ProductSearch::PairHash::operator()(const Pair& pair) const {
  auto h = static_cast<std::uint64_t>(pair.layer);
  for (const int slot : pair.slots) {
    h = (h ^ static_cast<std::uint64_t>(slot)) * 0x9e3779b97f4a7c15ull;
    h ^= h >> 29;
  }
  return h;
}

void ProductSearch::sort(std::vector<Step>& steps) {
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return a.rise < b.rise || (a.rise == b.rise && a.slot < b.slot);
  });
}

void ProductSearch::begin_turn() {
  const TraceSpan span("pairs begin");
  for_both_arms(options_.work, [&](int arm) {
    SearchedArm& searched = arms_[static_cast<std::size_t>(arm)];
    Side& side = sides_[static_cast<std::size_t>(arm)];
    const bool first = !side.values;
    if (first) {
      side.values =
          make_cost_to_go(searched.lattice(), Pruning::kNone, searched.cost_to_go().budget());
      side.values->set_single_use();
    }
    searched.validity().write(*side.values, side.written);
    if (first)
      side.values->sweep(searched.lattice().layers() - 1);
    else if (!side.values->verdicts().pending.empty())
      side.values->repair();
    side.places.clear();
    side.starts.clear();
    for (int slot = 0; slot < searched.lattice().slots(0); ++slot)
      if (const double rest = side.values->at(0, slot); rest != kUnreachable)
        side.starts.push_back({slot, rest, 0});
    sort(side.starts);
  });
  if (outcome_.turns > 1 && has_few_pairs())
    pair_cost_to_go_.emplace(values(), between_.between(), arms_[0].cost_to_go().budget());
  reached_.clear();
  reached_cost_.clear();
  done_.clear();
  queue_.clear();
}

ProductSearch::Place& ProductSearch::place(int arm, int layer, int slot) {
  Side& side = sides_[static_cast<std::size_t>(arm)];
  const auto [found, fresh] = side.places.try_emplace(key(layer, slot));
  if (fresh) found->second.q = side.values->config(layer, slot);
  return found->second;
}

const std::vector<ProductSearch::Step>& ProductSearch::steps(int arm, int before) {
  Side& side = sides_[static_cast<std::size_t>(arm)];
  if (before < 0) return side.starts;
  const Reached& pair = reached_[static_cast<std::size_t>(before)];
  const int slot = pair.slots[static_cast<std::size_t>(arm)];
  Place& here = place(arm, pair.layer, slot);
  if (here.steps) return *here.steps;
  here.steps.emplace();
  std::vector<CostToGo::Step> found;
  side.values->steps(pair.layer, slot, std::numeric_limits<double>::max(), found);
  const double rest = side.values->at(pair.layer, slot);
  for (const CostToGo::Step& step : found)
    here.steps->push_back(
        {step.slot, step.cost + side.values->at(pair.layer + 1, step.slot) - rest, step.cost});
  sort(*here.steps);
  return *here.steps;
}

bool ProductSearch::is_later(const Open& a, const Open& b) const {
  if (a.cost != b.cost) return a.cost > b.cost;
  std::array<int, 2> p = a.slots, q = b.slots;
  int before_p = a.before, before_q = b.before;
  const auto up = [&](int& before, std::array<int, 2>& slots) {
    slots = reached_[static_cast<std::size_t>(before)].slots;
    before = reached_[static_cast<std::size_t>(before)].before;
  };
  int depth_p = layer_of(a), depth_q = layer_of(b);
  for (; depth_p > depth_q; --depth_p) up(before_p, p);
  for (; depth_q > depth_p; --depth_q) up(before_q, q);
  while (before_p != before_q) {
    up(before_p, p);
    up(before_q, q);
  }
  return p > q;
}

void ProductSearch::push(const Open& open) {
  queue_.push_back(open);
  std::push_heap(queue_.begin(), queue_.end(),
                 [this](const Open& a, const Open& b) { return is_later(a, b); });
}

ProductSearch::Open ProductSearch::pop() {
  std::pop_heap(queue_.begin(), queue_.end(),
                [this](const Open& a, const Open& b) { return is_later(a, b); });
  const Open open = queue_.back();
  queue_.pop_back();
  return open;
}

void ProductSearch::push(int before, double cost, const std::array<int, 2>& ways) {
  Open open{.cost = cost, .before = before, .ways = ways};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<Step>& all = steps(static_cast<int>(k), before);
    const auto way = static_cast<std::size_t>(ways[k]);
    if (way >= all.size()) return;
    open.slots[k] = all[way].slot;
    open.cost += all[way].rise;
  }
  if (open.cost <= outcome_.cost) push(open);
}

void ProductSearch::expand(int before, double cost) {
  const int layer = before < 0 ? 0 : reached_[static_cast<std::size_t>(before)].layer + 1;
  const double spent =
      before < 0
          ? 0
          : reached_cost_[static_cast<std::size_t>(before)] -
                pair_cost_to_go_->at(layer - 1, reached_[static_cast<std::size_t>(before)].slots);
  double next = kUnreachable;  // the least cost of those that are left
  for (const Step& first : steps(0, before))
    for (const Step& second : steps(1, before)) {
      const std::array<int, 2> slots{first.slot, second.slot};
      const double through =
          spent + (first.cost + second.cost) + pair_cost_to_go_->at(layer, slots);
      if (through == cost)
        push({.cost = cost, .before = before, .slots = slots});
      else if (through > cost)
        next = std::min(next, through);
    }
  if (next == kUnreachable || next > outcome_.cost) return;
  Open rest{.cost = next, .expands = true, .ways = {before, 0}, .slots = {-1, -1}};
  if (before >= 0) {
    rest.before = reached_[static_cast<std::size_t>(before)].before;
    rest.slots = reached_[static_cast<std::size_t>(before)].slots;
  }
  push(rest);
}

void ProductSearch::push_beside(const Open& open, double before_cost, bool first_valid) {
  const auto [first, second] = open.ways;
  if (second == 0) push(open.before, before_cost, {first + 1, 0});
  if (first_valid) push(open.before, before_cost, {first, second + 1});
}

bool ProductSearch::is_valid(int arm, int layer, int slot) {
  Place& here = place(arm, layer, slot);
  if (here.valid) return *here.valid;
  RememberedValidity& validity = arms_[static_cast<std::size_t>(arm)].validity();
  const NodeQuestion question{layer, slot, here.q};
  NodeAnswer answer;
  validity.nodes({&question, 1}, {&answer, 1});
  if (answer.valid && validity.asks_costs()) {
    double cost = 0;
    validity.costs({&question, 1}, {&cost, 1});
    here.dearer = cost - sides_[static_cast<std::size_t>(arm)].values->verdicts().cost(layer, slot);
  }
  here.valid = answer.valid;
  return answer.valid;
}

bool ProductSearch::edge_is_valid(int arm, const Reached& from, int slot) {
  RememberedValidity& validity = arms_[static_cast<std::size_t>(arm)].validity();
  if (!validity.asks_edges()) return true;
  const int a = from.slots[static_cast<std::size_t>(arm)];
  const EdgeQuestion question{from.layer, a, slot, place(arm, from.layer, a).q,
                              place(arm, from.layer + 1, slot).q};
  std::uint8_t valid = 0;
  validity.edges({&question, 1}, {&valid, 1});
  return valid != 0;
}

bool ProductSearch::way_holds(const Open& open, int layer) {
  NodePair nodes{.layer = layer, .slots = open.slots};
  for (int arm = 0; arm < 2; ++arm)
    nodes.q[static_cast<std::size_t>(arm)] =
        place(arm, layer, open.slots[static_cast<std::size_t>(arm)]).q;
  if (!between_.apart(nodes)) return false;
  if (open.before < 0) return true;
  const Reached from = reached_[static_cast<std::size_t>(open.before)];
  for (int arm = 0; arm < 2; ++arm)
    if (!edge_is_valid(arm, from, open.slots[static_cast<std::size_t>(arm)])) return false;
  if (!between_.asks_moves()) return true;
  MovePair moves{.layer = from.layer, .to = nodes.q};
  for (int arm = 0; arm < 2; ++arm) {
    const auto k = static_cast<std::size_t>(arm);
    moves.moves[k] = {from.slots[k], open.slots[k]};
    moves.from[k] = place(arm, from.layer, from.slots[k]).q;
  }
  return between_.apart(moves);
}

bool ProductSearch::take(const Open& open) {
  const int layer = layer_of(open);
  const bool first_valid = is_valid(0, layer, open.slots[0]);
  const double before_cost =
      open.before < 0 ? 0 : reached_cost_[static_cast<std::size_t>(open.before)];
  if (!open.raised && !pair_cost_to_go_) push_beside(open, before_cost, first_valid);
  if (!first_valid || done_.contains({layer, open.slots}) || !is_valid(1, layer, open.slots[1]))
    return false;
  const double dearer =
      place(0, layer, open.slots[0]).dearer + place(1, layer, open.slots[1]).dearer;
  if (!open.raised && dearer > 0) {
    Open again = open;
    again.cost += dearer;
    again.raised = true;
    if (again.cost <= outcome_.cost) push(again);
    return false;
  }
  if (!way_holds(open, layer)) return false;
  done_.insert({layer, open.slots});
  reached_.push_back({open.before, layer, open.slots});
  reached_cost_.push_back(open.cost);
  return true;
}

void ProductSearch::find(int last) {
  for (SlotPath& path : outcome_.paths) path.clear();
  for (; last >= 0; last = reached_[static_cast<std::size_t>(last)].before)
    for (std::size_t k = 0; k < 2; ++k)
      outcome_.paths[k].push_back(reached_[static_cast<std::size_t>(last)].slots[k]);
  for (std::size_t k = 0; k < 2; ++k) {
    std::reverse(outcome_.paths[k].begin(), outcome_.paths[k].end());
    outcome_.costs[k] = arms_[k].cost(outcome_.paths[k]);
  }
  outcome_.cost = outcome_.costs[0] + outcome_.costs[1];
  outcome_.bound = outcome_.cost;
  outcome_.decided_by = PairSearcher::kProduct;
}

bool ProductSearch::run(std::int64_t most_pops) {
  const TraceSpan span("pairs of nodes");
  ++outcome_.turns;
  begin_turn();
  if (pair_cost_to_go_)
    expand(-1, -kUnreachable);
  else
    push(-1, 0, {0, 0});
  const Budget& budget = arms_[0].cost_to_go().budget();
  const int last_layer = arms_[0].lattice().layers() - 1;
  for (std::int64_t pops = 0; !queue_.empty(); ++pops) {
    if (pops == most_pops) return false;
    if (pops % 256 == 0) budget.poll();
    ++outcome_.pops;
    const Open open = pop();
    outcome_.bound = std::max(outcome_.bound, open.cost);
    if (open.expands) {
      expand(open.ways[0], open.cost);
      continue;
    }
    if (!take(open)) continue;
    const int index = static_cast<int>(reached_.size()) - 1;
    if (reached_.back().layer == last_layer) {
      find(index);
      return true;
    }
    if (pair_cost_to_go_)
      expand(index, open.cost);
    else
      push(index, open.cost, {0, 0});
  }
  outcome_.bound = kUnreachable;
  outcome_.decided_by = PairSearcher::kProduct;
  return true;
}

}  // namespace swivel
