// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/path_motion.hpp"

#include <algorithm>
#include <cmath>

#include "motion/arc_motion.hpp"
#include "motion/srs_motion.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

PathMotion::PathMotion(const Chain& chain, const ToolPath& path,
                       const std::vector<TrajectoryRow>& rows, double apart,
                       const std::vector<BetweenRow>& between)
    : chain_(&chain), path_(&path) {
  constexpr double kSame = 1e-9;  // m
  int layer = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    // Where the path only turns s repeats: a row of each layer is then asked for.
    const bool each = rows.size() == static_cast<std::size_t>(path.size());
    if (each)
      layer = static_cast<int>(k);
    else if (k > 0)
      for (++layer; layer < path.size() && path.layer(layer).s < rows[k].s - kSame;) ++layer;
    if (layer >= path.size() || std::abs(path.layer(layer).s - rows[k].s) > kSame)
      throw InputError("row " + std::to_string(k) + " (s = " + formatted("%.9g", rows[k].s) +
                       "): is at no layer of the path: allowed are rows at layers, of the "
                       "resolution that they were planned with");
    const double travel = path.layer(layer).travel;
    constexpr double kRounding = 1e-9;  // m
    if (k == 0 || k + 1 == rows.size() || travel - travel_.back() >= apart - kRounding) {
      if (k + 1 == rows.size() && rows_.size() > 1 && travel - travel_.back() < apart / 2) {
        travel_.pop_back();
        layer_.pop_back();
        rows_.pop_back();
      }
      travel_.push_back(travel);
      layer_.push_back(layer);
      rows_.push_back(counted_from_path(chain, path, travel, rows[k]));
    }
  }
  if (rows.size() < 2 || layer + 1 != path.size())
    throw InputError(
        "the rows end before the path: allowed are rows from its first layer to its last");
  for (const BetweenRow& one : between) {
    const auto after = std::upper_bound(travel_.begin(), travel_.end(), one.travel);
    if (after == travel_.begin() || after == travel_.end()) continue;
    const auto k = after - travel_.begin();
    TrajectoryRow row = rows_[static_cast<std::size_t>(k) - 1];
    row.s = place(one.travel).s;
    row.q = one.q;
    row = counted_from_path(chain, path, one.travel, row);
    travel_.insert(after, one.travel);
    layer_.insert(layer_.begin() + k, -1);
    rows_.insert(rows_.begin() + k, row);
  }
}

Pose PathMotion::pose_of(std::size_t row) const {
  return layer_[row] < 0 ? path_->at_travel(travel_[row]) : path_->layer(layer_[row]).tool;
}

PathMotion::Between PathMotion::between(double travel) const {
  const auto after = std::upper_bound(travel_.begin() + 1, travel_.end() - 1, travel);
  const auto k = static_cast<std::size_t>(after - travel_.begin()) - 1;
  return {k, (travel - travel_[k]) / (travel_[k + 1] - travel_[k])};
}

PathMotion::Place PathMotion::place(double travel) const {
  const int i = path_->step_at(travel);
  const PathLayer &from = path_->layer(i), &to = path_->layer(i + 1);
  const double t = std::clamp((travel - from.travel) / (to.travel - from.travel), 0.0, 1.0);
  return {t == 1 ? to.s : from.s + t * (to.s - from.s), t, i};
}

std::unique_ptr<PathMotion> make_path_motion(const Chain& chain, const ArmClass& arm,
                                             const ToolPath& path,
                                             const std::vector<TrajectoryRow>& rows, double apart,
                                             double off_limits,
                                             const std::vector<BetweenRow>& between) {
  const auto changes = [](const TrajectoryRow& a, const TrajectoryRow& b) {
    return a.branch != b.branch;
  };
  if (arm.kind == ArmKind::kSrs &&
      std::adjacent_find(rows.begin(), rows.end(), changes) != rows.end())
    return std::make_unique<SrsArcMotion>(chain, *arm.srs, path, rows, apart, off_limits, between);
  if (arm.kind == ArmKind::kSrs)
    return std::make_unique<SrsMotion>(chain, *arm.srs, path, rows, apart, between);
  return std::make_unique<ArcMotion>(chain, arm.lock, path, rows, apart, off_limits, between);
}

}  // namespace swivel
