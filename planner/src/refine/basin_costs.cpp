// SPDX-License-Identifier: BSD-3-Clause
#include "refine/basin_costs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swivel {

namespace {

constexpr float kNoWay = std::numeric_limits<float>::infinity();

/// Adds the move b[j] - a[j] of a joint to sum[j], the short way round a circle of `period` unless
/// that is 0: its square with the metric l2, its magnitude with l1; with max raises sum[j] to it.
template <CostMetric metric>
void add_moves(const float* a, const float* b, float period, int n, float* sum) {
  const auto add = [sum](int j, float move) {
    sum[j] = metric == CostMetric::kL2   ? sum[j] + move * move
             : metric == CostMetric::kL1 ? sum[j] + std::abs(move)
                                         : std::max(sum[j], std::abs(move));
  };
  if (period == 0) {
    for (int j = 0; j < n; ++j) add(j, b[j] - a[j]);
    return;
  }
  const float half = period / 2;
  for (int j = 0; j < n; ++j) {
    float move = b[j] - a[j];
    move = move > half ? move - period : move;
    move = move < -half ? move + period : move;
    add(j, move);
  }
}

/// Sets cost[j] to that of the edge from index j + o of a column to index j + window of the next.
template <CostMetric metric>
void edge_costs_by(const BasinColumn& from, int o, const BasinColumn& to, int window, int angles,
                   const std::array<float, kDof>& period, float* cost) {
  std::fill_n(cost, angles, 0.0F);
  for (std::size_t k = 0; k < kDof; ++k) {
    const float *a = from.q[k].data() + o, *b = to.q[k].data() + window;
    add_moves<metric>(a, b, period[k], angles, cost);
  }
  const float *before = from.mask.data() + o, *after = to.mask.data() + window;
  for (int j = 0; j < angles; ++j)
    cost[j] = (metric == CostMetric::kL2 ? std::sqrt(cost[j]) : cost[j]) + before[j] + after[j];
}

void edge_costs(const BasinColumn& from, int o, const BasinColumn& to, int window, int angles,
                const BasinMetric& by, float* cost) {
  switch (by.metric) {
    case CostMetric::kL2:
      return edge_costs_by<CostMetric::kL2>(from, o, to, window, angles, by.period, cost);
    case CostMetric::kL1:
      return edge_costs_by<CostMetric::kL1>(from, o, to, window, angles, by.period, cost);
    case CostMetric::kMax:
    case CostMetric::kTime:
      return edge_costs_by<CostMetric::kMax>(from, o, to, window, angles, by.period, cost);
  }
}

}  // namespace

BasinCosts::BasinCosts(int layers, int angles, int window)
    : layers_(layers),
      angles_(angles),
      window_(window),
      offsets_(2 * window + 1),
      forward_(at(layers, 0)),
      backward_(at(layers, 0)),
      cost_(at(layers * offsets_, 0)),
      padded_(static_cast<std::size_t>(angles + 2 * window)) {}

bool BasinCosts::compute(const std::vector<BasinColumn>& columns, const BasinMetric& metric,
                         const Budget& budget) {
  std::copy_n(columns[0].mask.data() + window_, angles_, forward_.data());
  for (int k = 1; k < layers_; ++k) {
    budget.poll();
    const auto layer = static_cast<std::size_t>(k);
    for (int j = 0; j < angles_ + 2 * window_; ++j)
      padded_[static_cast<std::size_t>(j)] = forward_[at(k - 1, around(j - window_))];
    float* best = forward_.data() + at(k, 0);
    std::fill_n(best, angles_, kNoWay);
    for (int o = 0; o < offsets_; ++o) {
      float* cost = cost_.data() + at(k * offsets_ + o, 0);
      edge_costs(columns[layer - 1], o, columns[layer], window_, angles_, metric, cost);
      const float* before = padded_.data() + o;
      for (int j = 0; j < angles_; ++j) best[j] = std::min(best[j], before[j] + cost[j]);
    }
  }
  float* last = backward_.data() + at(layers_ - 1, 0);
  std::fill_n(last, angles_, 0.0F);
  for (int k = layers_ - 1; k > 0; --k) sweep_back(k);
  const float* end = forward_.data() + at(layers_ - 1, 0);
  return *std::min_element(end, end + angles_) < kNoWay;
}

/// Computes the costs from layer k - 1 to the end from those of layer k.
void BasinCosts::sweep_back(int k) {
  std::fill(padded_.begin(), padded_.end(), kNoWay);
  const float* after = backward_.data() + at(k, 0);
  for (int o = 0; o < offsets_; ++o) {
    const float* cost = costs(k, o);
    float* before = padded_.data() + o;
    for (int j = 0; j < angles_; ++j) before[j] = std::min(before[j], after[j] + cost[j]);
  }
  std::fill_n(backward_.data() + at(k - 1, 0), angles_, kNoWay);
  for (int j = 0; j < angles_ + 2 * window_; ++j) {
    float& best = backward_[at(k - 1, around(j - window_))];
    best = std::min(best, padded_[static_cast<std::size_t>(j)]);
  }
}

std::vector<int> BasinCosts::trace(int k, int j) const {
  std::vector<int> path(static_cast<std::size_t>(layers_), j);
  for (int i = k; i > 0; --i) {
    const int to = path[static_cast<std::size_t>(i)];
    float least = kNoWay;
    for (int o = 0; o < offsets_; ++o) {
      const int from = around(to + o - window_);
      const float cost = forward_[at(i - 1, from)] + costs(i, o)[to];
      if (cost < least) least = cost, path[static_cast<std::size_t>(i) - 1] = from;
    }
  }
  for (int i = k; i + 1 < layers_; ++i) {
    const int from = path[static_cast<std::size_t>(i)];
    float least = kNoWay;
    for (int o = 0; o < offsets_; ++o) {
      const int to = around(from - o + window_);
      const float cost = backward_[at(i + 1, to)] + costs(i + 1, o)[to];
      if (cost < least) least = cost, path[static_cast<std::size_t>(i) + 1] = to;
    }
  }
  return path;
}

}  // namespace swivel
