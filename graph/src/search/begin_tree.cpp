// SPDX-License-Identifier: BSD-3-Clause
#include "search/begin_tree.hpp"

#include <algorithm>
#include <numeric>

namespace swivel {

BeginTree::BeginTree(std::span<const Config> configurations) : order_(configurations.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!order_.empty()) divide(configurations, 0, order_.size());
}

void BeginTree::divide(std::span<const Config> configurations, std::size_t begin, std::size_t end) {
  const std::size_t index = boxes_.size();
  Box box;
  box.begin = begin;
  box.end = end;
  box.lower = box.upper = configurations[order_[begin]];
  for (std::size_t k = begin; k < end; ++k) {
    box.lower = box.lower.cwiseMin(configurations[order_[k]]);
    box.upper = box.upper.cwiseMax(configurations[order_[k]]);
  }
  boxes_.push_back(box);
  if (end - begin <= kLeaf) return;
  Eigen::Index widest = 0;
  (box.upper - box.lower).maxCoeff(&widest);
  const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
    const double x = configurations[a][widest], y = configurations[b][widest];
    return x < y || (x == y && a < b);
  });
  divide(configurations, begin, middle);
  boxes_[index].second = boxes_.size();
  divide(configurations, middle, end);
}

void BeginTree::set_rest(std::span<const double> rest) {
  for (std::size_t k = boxes_.size(); k-- > 0;) {
    Box& box = boxes_[k];
    box.least_rest = kNever;
    if (box.second != 0)
      box.least_rest = std::min(boxes_[k + 1].least_rest, boxes_[box.second].least_rest);
    else
      for (std::size_t n = box.begin; n < box.end; ++n)
        box.least_rest = std::min(box.least_rest, rest[order_[n]]);
  }
}

}  // namespace swivel
