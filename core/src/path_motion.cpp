// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/path_motion.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/angle.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/srs_lattice.hpp"

namespace swivel {

namespace {

/// Of the directions to the corners, edges and faces of a cube the one that lies furthest from all u and -u.
Vector3d clearest_direction(const std::vector<ArmPlane>& planes) {
  Vector3d best = Vector3d::UnitZ();
  double most = -1;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = 0; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vector3d direction = Vector3d(x, y, z).normalized();
        double least = 1;
        for (const ArmPlane& plane : planes) least = std::min(least, plane.u.cross(direction).norm());
        if (least > most + 1e-9) best = direction, most = least;
      }
  return best;
}

}  // namespace

PathMotion::PathMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path, const std::vector<TrajectoryRow>& rows,
                       double apart)
    : chain_(&chain), arm_(&arm), path_(&path) {
  constexpr double kSame = 1e-9;  // m
  planes_ = carried_planes(arm, path);
  still_ = clearest_direction(planes_);
  int layer = 0;
  std::vector<double> angles;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    // Where the path only turns s repeats: a row of each layer is then asked for.
    const bool each = rows.size() == static_cast<std::size_t>(path.size());
    if (each)
      layer = static_cast<int>(k);
    else if (k > 0)
      for (++layer; layer < path.size() && path.layer(layer).s < rows[k].s - kSame;) ++layer;
    if (layer >= path.size() || std::abs(path.layer(layer).s - rows[k].s) > kSame)
      throw InputError("row " + std::to_string(k) + " (s = " + std::to_string(rows[k].s) +
                       "): is at no layer of the path: allowed are rows at layers, of the resolution that they were planned with");
    const PathLayer& at = path.layer(layer);
    const double angle = still_plane(at.tool).angle_of(arm.elbow_axis(rows[k].q));
    constexpr double kRounding = 1e-9;  // m
    if (k == 0 || k + 1 == rows.size() || at.travel - travel_.back() >= apart - kRounding) {
      if (k + 1 == rows.size() && rows_.size() > 1 && at.travel - travel_.back() < apart / 2) {
        travel_.pop_back();
        angles.pop_back();
        rows_.pop_back();
      }
      travel_.push_back(at.travel);
      angles.push_back(k == 0 ? angle : angles.back() + wrap_angle(angle - angles.back()));
      rows_.push_back(rows[k]);
    }
    if (k > 0 && rows[k].branch != rows[k - 1].branch)
      jumps_.push_back({at.s, "the solution changes from branch " + std::to_string(rows[k - 1].branch) + " to " +
                                  std::to_string(rows[k].branch)});
  }
  if (rows.size() < 2 || layer + 1 != path.size())
    throw InputError("the rows end before the path: allowed are rows from its first layer to its last");
  angle_.emplace(travel_, std::move(angles));
}

ArmPlane PathMotion::still_plane(const Pose& tool) const {
  ArmPlane plane;
  const Vector3d sw = wrist_centre(*arm_, tool) - arm_->S;
  plane.reach = sw.norm();
  plane.u = sw / plane.reach;
  plane.r = plane.u.cross(still_).normalized();
  return plane;
}

std::optional<Config> PathMotion::joints(double travel) const {
  const Pose tool = path_->at_travel(travel);
  const ArmPlane plane = still_plane(tool);
  if (reach_status(*arm_, plane.reach) != ReachStatus::kReachable) return std::nullopt;
  const auto after = std::upper_bound(travel_.begin() + 1, travel_.end() - 1, travel);
  const auto k = static_cast<std::size_t>(after - travel_.begin()) - 1;
  const double t = (travel - travel_[k]) / (travel_[k + 1] - travel_[k]);
  const TrajectoryRow &from = rows_[k], &to = rows_[k + 1];
  const double angle = angle_->at(travel);
  std::optional<Config> q = srs_ik(*arm_, elbow_circles(*arm_, plane, tool), angle, t < 0.5 ? from.branch : to.branch);
  if (!arm_->exact) q = polish(*chain_, *arm_, plane, tool, angle, *q);
  if (!q) return std::nullopt;
  const Config expected = from.q + t * (to.q - from.q);
  for (Eigen::Index j = 0; j < kDof; ++j) (*q)[j] = expected[j] + wrap_angle((*q)[j] - expected[j]);
  return q;
}

TrajectoryRow PathMotion::row(double travel, const Config& q) const {
  const int i = path_->step_at(travel);
  const PathLayer &from = path_->layer(i), &to = path_->layer(i + 1);
  const double t = std::clamp((travel - from.travel) / (to.travel - from.travel), 0.0, 1.0);
  TrajectoryRow row;
  row.s = t == 1 ? to.s : from.s + t * (to.s - from.s);
  const Pose tool = path_->at_travel(travel);
  row.phi = (t == 1 ? planes_[static_cast<std::size_t>(i) + 1] : carry_plane(*arm_, planes_[static_cast<std::size_t>(i)], tool))
                .angle_of(arm_->elbow_axis(q));
  row.branch = arm_->branch(q);
  row.q = q;
  return row;
}

}  // namespace swivel
