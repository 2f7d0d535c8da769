// SPDX-License-Identifier: BSD-3-Clause
#include "search/closing_slots.hpp"

#include <algorithm>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

constexpr std::size_t kMostWords = 16;

/// The slots of layer 0 that may close, in groups of neighbours, one for each bit of a set.
struct Groups {
  std::vector<int> of_slot;  // -1: the slot does not close
  std::size_t words = 0;     // of a set
};

Groups groups_of(const std::vector<std::uint8_t>& may_close) {
  Groups groups;
  const auto count = static_cast<std::size_t>(std::count(may_close.begin(), may_close.end(), 1));
  const std::size_t bits = std::min(count, 64 * kMostWords);
  groups.words = (bits + 63) / 64;
  std::size_t number = 0;
  for (const std::uint8_t may : may_close)
    groups.of_slot.push_back(may == 0 ? -1 : static_cast<int>(number++ * bits / count));
  return groups;
}

/// The sets of groups from which the nodes of one layer are reached.
class Reached {
 public:
  Reached(int slots, std::size_t words)
      : words_(words), sets_(static_cast<std::size_t>(slots) * words, 0) {}
  void add(int slot, int group) {
    set(slot)[static_cast<std::size_t>(group) / 64] |= std::uint64_t{1} << (group % 64);
  }
  void add(int slot, const std::uint64_t* others) {
    std::uint64_t* own = set(slot);
    for (std::size_t k = 0; k < words_; ++k) own[k] |= others[k];
  }
  [[nodiscard]] bool has(int slot, int group) const {
    return (of(slot)[static_cast<std::size_t>(group) / 64] >> (group % 64) & 1) != 0;
  }
  [[nodiscard]] bool any(int slot) const {
    return std::any_of(of(slot), of(slot) + words_, [](std::uint64_t word) { return word != 0; });
  }
  [[nodiscard]] const std::uint64_t* of(int slot) const {
    return sets_.data() + static_cast<std::size_t>(slot) * words_;
  }

 private:
  [[nodiscard]] std::uint64_t* set(int slot) {
    return sets_.data() + static_cast<std::size_t>(slot) * words_;
  }
  std::size_t words_;
  std::vector<std::uint64_t> sets_;
};

}  // namespace

void leave_out_open_slots(CostToGo& cost_to_go, std::vector<std::uint8_t>& may_close) {
  const TraceSpan span("slots that close");
  const Lattice& lattice = cost_to_go.lattice();
  const Groups groups = groups_of(may_close);
  if (groups.words == 0) return;
  Reached here(lattice.slots(0), groups.words);
  for (int slot = 0; slot < lattice.slots(0); ++slot)
    if (const int group = groups.of_slot[static_cast<std::size_t>(slot)]; group >= 0)
      here.add(slot, group);
  std::vector<CostToGo::Step> steps;
  for (int layer = 0; layer + 1 < lattice.layers(); ++layer) {
    cost_to_go.budget().poll();
    Reached next(lattice.slots(layer + 1), groups.words);
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      if (!here.any(slot) || cost_to_go.at(layer, slot) == kUnreachable) continue;
      cost_to_go.steps(layer, slot, kUnreachable, steps);
      for (const CostToGo::Step& step : steps) next.add(step.slot, here.of(slot));
    }
    here = std::move(next);
  }
  for (int slot = 0; slot < lattice.slots(0); ++slot) {
    const int group = groups.of_slot[static_cast<std::size_t>(slot)];
    if (group >= 0 && !here.has(slot, group)) may_close[static_cast<std::size_t>(slot)] = 0;
  }
}

}  // namespace swivel
