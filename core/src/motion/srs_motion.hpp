// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/cubic_spline.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/motion/path_motion.hpp"

namespace swivel {

/// The motion of an S-R-S arm (make_path_motion()): a spline of the arm angle.
class SrsMotion final : public PathMotion {
 public:
  SrsMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path,
            const std::vector<TrajectoryRow>& rows, double apart,
            const std::vector<BetweenRow>& between);
  [[nodiscard]] std::optional<Config> joints(double travel) const override;
  [[nodiscard]] TrajectoryRow row(double travel, const Config& q) const override;
  [[nodiscard]] std::optional<Singular> nearest_singular(const Config& q) const override;

 private:
  [[nodiscard]] ArmPlane still_plane(const Pose& tool) const;

  const SrsArm* arm_;
  std::vector<ArmPlane> planes_;      // carried from layer to layer, for a tool that is not turned
  Vector3d still_;                    // the direction that stands still
  std::optional<CubicSpline> angle_;  // from the direction that stands still
};

}  // namespace swivel
