// SPDX-License-Identifier: BSD-3-Clause
#include "search/transition_costs.hpp"

#include <algorithm>
#include <utility>

namespace swivel {

TransitionCosts::TransitionCosts(const Transitions& transitions, std::vector<EndNode> ends,
                                 std::vector<EndNode> begins)
    : transitions_(&transitions), ends_(std::move(ends)), begins_(std::move(begins)) {
  constexpr std::size_t kMostKept = std::size_t{1} << 23;  // 64 MB
  if (ends_.size() * begins_.size() > kMostKept) return;
  distances_.reserve(ends_.size() * begins_.size());
  for (std::size_t end = 0; end < ends_.size(); ++end)
    for (std::size_t begin = 0; begin < begins_.size(); ++begin)
      distances_.push_back(distance(end, begin));
}

void TransitionCosts::raise(std::size_t end, std::size_t begin, double cost) {
  if (!distances_.empty())
    distances_[end * begins_.size() + begin] = cost;
  else
    raised_[key(end, begin)] = cost;
}

TransitionCosts::Onward TransitionCosts::onward(std::size_t end, const std::vector<double>& rest,
                                                const std::vector<std::size_t>& order) const {
  Onward best;
  for (const std::size_t begin : order) {
    if (rest[begin] >= best.cost) break;
    const double cost = at(end, begin) + rest[begin];
    if (cost < best.cost) best = {begin, cost};
  }
  return best;
}

std::vector<std::size_t> TransitionCosts::by_rest(const std::vector<double>& rest) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < rest.size(); ++k)
    if (rest[k] != kUnreachable) order.push_back(k);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rest[a] < rest[b]; });
  return order;
}

}  // namespace swivel
