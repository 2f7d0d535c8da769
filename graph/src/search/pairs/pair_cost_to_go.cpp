// SPDX-License-Identifier: BSD-3-Clause
#include "search/pairs/pair_cost_to_go.hpp"

#include <algorithm>
#include <limits>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

std::size_t index_of(const std::vector<int>& slots, int slot) {
  return static_cast<std::size_t>(std::lower_bound(slots.begin(), slots.end(), slot) -
                                  slots.begin());
}

}  // namespace

std::vector<int> PairCostToGo::live_slots(const CostToGo& arm, int layer) {
  std::vector<int> slots;
  for (int slot = 0; slot < arm.lattice().slots(layer); ++slot)
    if (arm.at(layer, slot) != kUnreachable) slots.push_back(slot);
  return slots;
}

std::int64_t PairCostToGo::pairs(const std::array<CostToGo*, 2>& arms) {
  std::int64_t pairs = 0;
  for (int layer = 0; layer < arms[0]->lattice().layers(); ++layer)
    pairs += static_cast<std::int64_t>(live_slots(*arms[0], layer).size() *
                                       live_slots(*arms[1], layer).size());
  return pairs;
}

PairCostToGo::PairCostToGo(const std::array<CostToGo*, 2>& arms, Between& between,
                           const Budget& budget)
    : layers_(static_cast<std::size_t>(arms[0]->lattice().layers())) {
  const TraceSpan span("cost-to-go of pairs");
  for (std::size_t layer = layers_.size(); layer-- > 0;) {
    budget.poll();
    Layer& here = layers_[layer];
    for (std::size_t k = 0; k < 2; ++k)
      here.slots[k] = live_slots(*arms[k], static_cast<int>(layer));
    here.cost.assign(here.slots[0].size() * here.slots[1].size(), kUnreachable);
    relax(layer, arms, budget);
    bar(layer, arms, between);
  }
}

PairCostToGo::Edges PairCostToGo::edges(CostToGo& arm, int layer, const std::vector<int>& from,
                                        const std::vector<int>& to) {
  Edges edges;
  std::vector<CostToGo::Step> steps;
  for (const int slot : from) {
    arm.steps(layer, slot, std::numeric_limits<double>::max(), steps);
    auto& of_slot = edges.emplace_back();
    for (const CostToGo::Step& step : steps)
      of_slot.push_back({index_of(to, step.slot), step.cost});
  }
  return edges;
}

void PairCostToGo::relax(std::size_t layer, const std::array<CostToGo*, 2>& arms,
                         const Budget& budget) {
  Layer& here = layers_[layer];
  const int number = static_cast<int>(layer);
  const std::size_t rows = here.slots[0].size(), columns = here.slots[1].size();
  if (layer + 1 == layers_.size()) {
    for (std::size_t a = 0; a < rows; ++a)
      for (std::size_t b = 0; b < columns; ++b)
        here.cost[a * columns + b] =
            arms[0]->at(number, here.slots[0][a]) + arms[1]->at(number, here.slots[1][b]);
    return;
  }
  const Layer& next = layers_[layer + 1];
  const std::size_t width = next.slots[1].size();
  const Edges first = edges(*arms[0], number, here.slots[0], next.slots[0]),
              second = edges(*arms[1], number, here.slots[1], next.slots[1]);
  std::vector<double> after_first(width);  // arm 0 has taken its step, arm 1 has not
  for (std::size_t a = 0; a < rows; ++a) {
    budget.poll();
    std::fill(after_first.begin(), after_first.end(), kUnreachable);
    for (const Edge& edge : first[a])
      for (std::size_t b = 0; b < width; ++b)
        after_first[b] = std::min(after_first[b], edge.cost + next.cost[edge.to * width + b]);
    for (std::size_t b = 0; b < columns; ++b)
      for (const Edge& edge : second[b]) {
        double& cost = here.cost[a * columns + b];
        cost = std::min(cost, edge.cost + after_first[edge.to]);
      }
  }
}

void PairCostToGo::bar(std::size_t layer, const std::array<CostToGo*, 2>& arms, Between& between) {
  Layer& here = layers_[layer];
  std::array<std::vector<Config>, 2> joints;
  for (std::size_t k = 0; k < 2; ++k)
    for (const int slot : here.slots[k])
      joints[k].push_back(arms[k]->config(static_cast<int>(layer), slot));
  std::vector<std::uint8_t> barred(here.cost.size());
  for (std::size_t k = 0; k < barred.size(); ++k) barred[k] = here.cost[k] == kUnreachable;
  between.find_barred(static_cast<int>(layer), here.slots, joints, barred);
  for (std::size_t k = 0; k < barred.size(); ++k)
    if (barred[k]) here.cost[k] = kUnreachable;
}

double PairCostToGo::at(int layer, const std::array<int, 2>& slots) const {
  const Layer& here = layers_[static_cast<std::size_t>(layer)];
  std::array<std::size_t, 2> at{};
  for (std::size_t k = 0; k < 2; ++k) {
    at[k] = index_of(here.slots[k], slots[k]);
    if (at[k] == here.slots[k].size() || here.slots[k][at[k]] != slots[k]) return kUnreachable;
  }
  return here.cost[at[0] * here.slots[1].size() + at[1]];
}

}  // namespace swivel
