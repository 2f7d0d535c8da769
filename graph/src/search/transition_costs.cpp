// SPDX-License-Identifier: BSD-3-Clause
#include "search/transition_costs.hpp"

#include <algorithm>
#include <utility>

namespace swivel {

TransitionCosts::TransitionCosts(const Transitions& transitions, std::vector<EndNode> ends,
                                 std::vector<EndNode> begins)
    : transitions_(&transitions),
      ends_(std::move(ends)),
      begins_(std::move(begins)),
      raised_ends_(ends_.size()) {}

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
