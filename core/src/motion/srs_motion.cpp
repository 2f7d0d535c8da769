// SPDX-License-Identifier: BSD-3-Clause
#include "motion/srs_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {

namespace {

/// Returns the direction, of those to the corners, edges and faces of a cube, that is furthest from
/// all u and -u.
Vector3d clearest_direction(const std::vector<ArmPlane>& planes) {
  Vector3d best = Vector3d::UnitZ();
  double most = -1;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = 0; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vector3d direction = Vector3d(x, y, z).normalized();
        double least = 1;
        for (const ArmPlane& plane : planes)
          least = std::min(least, plane.u.cross(direction).norm());
        if (least > most + 1e-9) best = direction, most = least;
      }
  return best;
}

std::optional<PathMotion::Singular> nearest_of(const SrsArm& arm, const Config& q) {
  const std::pair<const char*, double> angles[] = {{"shoulder", arm.shoulder_angle(q)},
                                                   {"elbow", arm.elbow_angle(q)},
                                                   {"wrist", arm.wrist_angle(q)}};
  std::optional<PathMotion::Singular> nearest;
  for (const auto& [where, angle] : angles) {
    const double away = std::abs(std::asin(std::clamp(std::sin(angle), -1.0, 1.0)));
    if (!nearest || away < nearest->angle) nearest = {where, away};
  }
  return nearest;
}

}  // namespace

CarriedArmAngles::CarriedArmAngles(const SrsArm& arm, const ToolPath& path)
    : arm_(&arm),
      path_(&path),
      planes_(carried_planes(arm, path.unturned() ? *path.unturned() : path)) {}

double CarriedArmAngles::at(double travel, int step, double t, const Config& q) const {
  const auto layer = static_cast<std::size_t>(step);
  const ToolPath& unturned = path_->unturned() ? *path_->unturned() : *path_;
  // Planes of a closed path are not carried into the last one, which is the first.
  constexpr double kRounding = 1e-9;  // m
  const bool ends = t == 1 || (path_->closed() && step + 2 == path_->size() &&
                               path_->layer(step + 1).travel - travel <= kRounding);
  ArmPlane plane =
      ends ? planes_[layer + 1] : carry_plane(*arm_, planes_[layer], unturned.at_travel(travel));
  if (path_->unturned()) plane = carry_plane(*arm_, plane, path_->at_travel(travel));
  return plane.angle_of(arm_->elbow_axis(q));
}

SrsMotion::SrsMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, double apart,
                     const std::vector<BetweenRow>& between)
    : PathMotion(chain, path, rows, apart, between),
      arm_(&arm),
      carried_(arm, path),
      still_(clearest_direction(carried_planes(arm, path))) {
  std::vector<double> angles;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const double angle = still_plane(pose_of(k)).angle_of(arm.elbow_axis(rows_[k].q));
    angles.push_back(k == 0 ? angle : angles.back() + wrap_angle(angle - angles.back()));
  }
  angle_.emplace(travel_, std::move(angles));
}

ArmPlane SrsMotion::still_plane(const Pose& tool) const {
  ArmPlane plane;
  const Vector3d sw = wrist_centre(*arm_, tool) - arm_->S;
  plane.reach = sw.norm();
  plane.u = sw / plane.reach;
  plane.r = plane.u.cross(still_).normalized();
  return plane;
}

std::optional<Config> SrsMotion::joints(double travel) const {
  const Pose tool = path_->at_travel(travel);
  const ArmPlane plane = still_plane(tool);
  if (reach_status(*arm_, plane.reach) != ReachStatus::kReachable) return std::nullopt;
  const auto [k, t] = between(travel);
  const TrajectoryRow &from = rows_[k], &to = rows_[k + 1];
  const double angle = angle_->at(travel);
  std::optional<Config> q =
      srs_ik(*arm_, elbow_circles(*arm_, plane, tool), angle, t < 0.5 ? from.branch : to.branch);
  if (!arm_->exact) q = solve_exact_chain(*chain_, *arm_, plane, tool, angle, *q);
  if (!q) return std::nullopt;
  const Config expected = from.q + t * (to.q - from.q);
  for (Eigen::Index j = 0; j < kDof; ++j) (*q)[j] = expected[j] + wrap_angle((*q)[j] - expected[j]);
  return q;
}

TrajectoryRow SrsMotion::row(double travel, const Config& q) const {
  const auto [s, t, i] = place(travel);
  return counted_from_waypoints(
      *chain_, *path_, travel,
      {s, carried_.at(travel, i, t, q), arm_->branch(q), q, path_->roll_at(travel)});
}

std::optional<PathMotion::Singular> SrsMotion::nearest_singular(const Config& q) const {
  return nearest_of(*arm_, q);
}

SrsArcMotion::SrsArcMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                           const std::vector<TrajectoryRow>& rows, double apart, double off_limits,
                           const std::vector<BetweenRow>& between)
    : ArcMotion(chain, {}, path, rows, apart, off_limits, between),
      arm_(&arm),
      carried_(arm, path) {}

TrajectoryRow SrsArcMotion::row(double travel, const Config& q) const {
  const auto [s, t, i] = place(travel);
  return counted_from_waypoints(
      *chain_, *path_, travel,
      {s, carried_.at(travel, i, t, q), arm_->branch(q), q, path_->roll_at(travel)});
}

std::optional<PathMotion::Singular> SrsArcMotion::nearest_singular(const Config& q) const {
  return nearest_of(*arm_, q);
}

}  // namespace swivel
