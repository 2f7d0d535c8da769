// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/knots.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "swivel/core/lattice/places_near.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

namespace {

constexpr double kTurnOfKnots = 0.2;  // rad: how far the path may turn from a knot to the next
constexpr double kBend = 0.35;        // rad between two directions of the path
constexpr double kOnTheSpot = 1e-9;   // m: a shorter step only turns the tool, by however little

/// Returns whether the path bends at a layer, neither the first nor the last: its direction
/// changes, that of a turn on the spot being its axis, or such a turn begins or ends.
bool bends_at(const ToolPath& path, int layer) {
  const auto stands = [&](int i) {
    const PathLayer& step = path.layer(i);
    return step.step_length < kOnTheSpot || turns_on_the_spot(step);
  };
  if (stands(layer - 1) != stands(layer)) return true;
  const auto way = [&](int i) -> Vector3d {
    return stands(i) ? path.layer(i).step_rotation
                     : path.layer(i + 1).tool.translation() - path.layer(i).tool.translation();
  };
  const Vector3d before = way(layer - 1), after = way(layer);
  return std::atan2(before.cross(after).norm(), before.dot(after)) > kBend;
}

}  // namespace

std::vector<int> knots_along(const ToolPath& path, double length) {
  const int last = path.size() - 1;
  std::vector<int> knots{0};
  if (length <= 0) {
    knots.resize(static_cast<std::size_t>(path.size()));
    std::iota(knots.begin(), knots.end(), 0);
    return knots;
  }
  for (int begin = 0; begin < last;) {
    // How far the layers of a stretch are, in steps from knot to knot.
    std::vector<double> way{0};
    int end = begin;
    do {
      way.push_back(way.back() + std::max(path.layer(end).step_length / length,
                                          path.layer(end).step_angle / kTurnOfKnots));
      ++end;
    } while (end < last && !bends_at(path, end));
    const double steps = std::max(1.0, std::ceil(way.back() - 1e-9)), step = way.back() / steps;
    for (double goal = 1; knots.back() < end; ++goal) {
      const auto reached = static_cast<int>(
          std::upper_bound(way.begin(), way.end(), goal * step + 1e-9) - way.begin() - 1);
      if (begin + reached > knots.back()) knots.push_back(begin + reached);
    }
    begin = end;
  }
  return knots;
}

int middle_layer(const ToolPath& path, int first, int last) {
  const double middle = (path.layer(first).travel + path.layer(last).travel) / 2;
  int nearest = first + 1;
  for (int i = first + 2; i < last; ++i)
    if (std::abs(path.layer(i).travel - middle) < std::abs(path.layer(nearest).travel - middle))
      nearest = i;
  return nearest;
}

Knots::Knots(const ToolPath& whole, std::vector<int> layers)
    : whole_(&whole),
      layers_(std::move(layers)),
      path_(std::make_shared<const ToolPath>(whole.with_layers(layers_))) {}

std::optional<Knots> Knots::halved(const std::set<int>& steps) const {
  std::vector<int> finer;
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    finer.push_back(layers_[k]);
    if (steps.count(static_cast<int>(k)) > 0 && k + 1 < layers_.size() &&
        layers_[k + 1] - layers_[k] > 1)
      finer.push_back(middle_layer(*whole_, layers_[k], layers_[k + 1]));
  }
  if (finer.size() == layers_.size()) return std::nullopt;
  Knots knots(*whole_, std::move(finer));
  knots.halvings_ = halvings_;
  knots.halvings_.push_back(steps);
  return knots;
}

std::vector<Config> Knots::bounds_between(const std::vector<Config>& of_steps) const {
  std::vector<Config> bounds(layers_.size() - 1, Config::Zero());
  for (std::size_t k = 0; k < bounds.size(); ++k)
    for (int i = layers_[k]; i < layers_[k + 1]; ++i)
      bounds[k] += of_steps[of_steps.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  return bounds;
}

}  // namespace swivel
