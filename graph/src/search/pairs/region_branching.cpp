// SPDX-License-Identifier: BSD-3-Clause
#include "search/pairs/region_branching.hpp"

#include <algorithm>
#include <utility>

namespace swivel {

bool RegionBranching::Later::operator()(std::size_t a, std::size_t b) const {
  const Set &x = (*sets)[a], &y = (*sets)[b];
  if (x.cost != y.cost) return x.cost > y.cost;
  for (std::size_t layer = 0; layer < x.best[0].path.size(); ++layer)
    for (std::size_t arm = 0; arm < 2; ++arm)
      if (const int p = x.best[arm].path[layer], q = y.best[arm].path[layer]; p != q) return p > q;
  return a > b;
}

void RegionBranching::begin(std::array<SearchOutcome, 2> best) {
  outcome_.tree.emplace_back();
  add({.branch = 0, .best = std::move(best)});
}

void RegionBranching::add(Set set) {
  set.cost = set.best[0].cost + set.best[1].cost;
  const std::array<SlotPath, 2> paths{set.best[0].path, set.best[1].path};
  set.conflict = between_.conflict(arms_, paths);
  if (!set.conflict && set.cost < outcome_.cost) {
    outcome_.paths = paths;
    outcome_.cost = set.cost;
    outcome_.costs = {set.best[0].cost, set.best[1].cost};
  }
  sets_.push_back(std::move(set));
  queue_.push(sets_.size() - 1);
}

bool RegionBranching::run(std::int64_t most_rounds) {
  while (!queue_.empty()) {
    if (most_rounds >= 0 && outcome_.rounds >= most_rounds) return false;
    arms_[0].cost_to_go().budget().poll();
    const std::size_t next = queue_.top();
    outcome_.bound = std::max(outcome_.bound, sets_[next].cost);
    if (!sets_[next].conflict) {
      const Set& set = sets_[next];
      outcome_.paths = {set.best[0].path, set.best[1].path};
      outcome_.cost = set.cost;
      outcome_.costs = {set.best[0].cost, set.best[1].cost};
      outcome_.decided_by = PairSearcher::kRegions;
      return true;
    }
    queue_.pop();
    const Set set = std::exchange(sets_[next], {});
    ++outcome_.rounds;
    divide(set);
  }
  outcome_.bound = kUnreachable;
  outcome_.decided_by = PairSearcher::kRegions;
  return true;
}

std::vector<const ConflictRegion*> RegionBranching::regions_of(int branch, int arm) const {
  std::vector<const ConflictRegion*> regions;
  const auto at = [&](int k) -> const RegionBranch& {
    return outcome_.tree[static_cast<std::size_t>(k)];
  };
  for (; at(branch).parent >= 0; branch = at(branch).parent)
    if (at(branch).arm == arm) regions.push_back(&*at(at(branch).parent).region);
  std::reverse(regions.begin(), regions.end());
  return regions;
}

void RegionBranching::divide(const Set& set) {
  const ConflictRegion region =
      between_.region(arms_, {set.best[0].path, set.best[1].path}, *set.conflict,
                      outcome_.rounds > options_.quick_rounds);
  std::array<SearchOutcome, 2> found;
  for_both_arms(options_.work, [&](int arm) {
    std::vector<const ConflictRegion*> regions = regions_of(set.branch, arm);
    regions.push_back(&region);
    const auto k = static_cast<std::size_t>(arm);
    found[k] = arms_[k].cheapest(regions, arm);
  });
  outcome_.solves += 2;
  outcome_.tree[static_cast<std::size_t>(set.branch)].region = region;
  for (int arm = 0; arm < 2; ++arm) {
    const auto k = static_cast<std::size_t>(arm);
    const int branch = static_cast<int>(outcome_.tree.size());
    outcome_.tree.push_back({.parent = set.branch, .arm = arm});
    if (found[k].path.empty()) {
      outcome_.tree.back().arm_without_path = arm;
      continue;
    }
    Set child{.branch = branch, .best = set.best};
    child.best[k] = std::move(found[k]);
    add(std::move(child));
  }
}

}  // namespace swivel
