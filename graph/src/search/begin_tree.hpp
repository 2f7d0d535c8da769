// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// Configurations, each with a cost of its own, in boxes of boxes (a k-d tree): finds the cheapest
/// of them to go to without asking about each.
class BeginTree {
 public:
  explicit BeginTree(std::span<const Config> configurations);

  /// Sets what going on from each configuration costs, >= 0 or infinite.
  void set_rest(std::span<const double> rest);

  /// Calls visit(index) for the configurations of which the cheapest may be one. `bound(lower,
  /// upper)` returns a lower bound of what it costs to go to any configuration in a box; visit()
  /// returns the least cost, going and rest together, of the configurations visited so far. A
  /// configuration that costs as much as the cheapest is visited as well.
  template <class Bound, class Visit>
  void search(const Bound& bound, const Visit& visit) const {
    if (boxes_.empty()) return;
    struct Open {
      std::size_t box = 0;
      double cost = 0;
    };
    std::array<Open, kMostOpen> open;
    std::size_t count = 0;
    double best = kNever;
    const auto cost_of = [&](std::size_t box) {
      const Box& b = boxes_[box];
      return b.least_rest == kNever ? kNever : bound(b.lower, b.upper) + b.least_rest;
    };
    const auto push = [&](const Open& next) {
      if (next.cost != kNever && next.cost <= best) open[count++] = next;
    };
    push({0, cost_of(0)});
    while (count > 0) {
      const Open next = open[--count];
      if (next.cost > best) continue;
      const Box& box = boxes_[next.box];
      if (box.second == 0) {
        for (std::size_t k = box.begin; k < box.end; ++k) best = visit(order_[k]);
        continue;
      }
      const Open first{next.box + 1, cost_of(next.box + 1)},
          second{box.second, cost_of(box.second)};
      push(first.cost <= second.cost ? second : first);
      push(first.cost <= second.cost ? first : second);
    }
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr std::size_t kLeaf = 8, kMostOpen = 128;
  /// A box of configurations: order_[begin] to order_[end - 1]. Its first half follows it in
  /// boxes_.
  struct Box {
    Config lower, upper;
    std::size_t begin = 0, end = 0;
    std::size_t second = 0;  ///< index of its second half; 0: not halved
    double least_rest = kNever;
  };
  void divide(std::span<const Config> configurations, std::size_t begin, std::size_t end);

  std::vector<std::size_t> order_;
  std::vector<Box> boxes_;
};

}  // namespace swivel
