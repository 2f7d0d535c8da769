// SPDX-License-Identifier: BSD-3-Clause
#include "search/transition_costs.hpp"

#include <tuple>
#include <utility>

namespace swivel {

namespace {

std::vector<Config> joints_of(const std::vector<EndNode>& nodes) {
  std::vector<Config> joints;
  joints.reserve(nodes.size());
  for (const EndNode& node : nodes) joints.push_back(node.q);
  return joints;
}

}  // namespace

TransitionCosts::TransitionCosts(const Transitions& transitions, std::vector<EndNode> ends,
                                 std::vector<EndNode> begins)
    : transitions_(&transitions),
      nodes_{std::move(ends), std::move(begins)},
      tree_(joints_of(nodes(Side::kBegin))),
      raised_ends_(nodes(Side::kEnd).size()) {
  for (const Side side : {Side::kEnd, Side::kBegin})
    barred_[index(side)].resize(nodes(side).size());
  set_rest(std::vector<double>(nodes(Side::kBegin).size()));
}

void TransitionCosts::set_rest(std::vector<double> rest) {
  rest_ = std::move(rest);
  tree_.set_rest(rest_);
}

TransitionCosts::Onward TransitionCosts::onward(std::size_t end) const {
  Onward best;
  if (is_barred(Side::kEnd, end)) return best;
  const Config& from = nodes(Side::kEnd)[end].q;
  const auto rank = [&](const Onward& x) { return std::tuple(x.cost, rest_[x.begin], x.begin); };
  tree_.search(
      [&](const Config& lower, const Config& upper) {
        return transitions_->least_distance(from, lower, upper);
      },
      [&](std::size_t begin) {
        if (rest_[begin] == kUnreachable || rest_[begin] > best.cost) return best.cost;
        const Onward way{begin, at(end, begin) + rest_[begin]};
        if (way.cost != kUnreachable && (best.cost == kUnreachable || rank(way) < rank(best)))
          best = way;
        return best.cost;
      });
  return best;
}

}  // namespace swivel
