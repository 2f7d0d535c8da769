// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "motion/arc_motion.hpp"
#include "swivel/core/base/cubic_spline.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/motion/path_motion.hpp"

namespace swivel {

/// The arm angles of an S-R-S arm along a path, measured as rows of its trajectories have them:
/// from planes that are carried from layer to layer, for a tool that is not turned.
class CarriedArmAngles {
 public:
  /// `arm` and `path` must outlive it.
  CarriedArmAngles(const SrsArm& arm, const ToolPath& path);
  /// Returns the arm angle of joints q at a travel (m), which is the share t of a step of the path,
  /// rad.
  [[nodiscard]] double at(double travel, int step, double t, const Config& q) const;

 private:
  const SrsArm* arm_;
  const ToolPath* path_;
  std::vector<ArmPlane> planes_;
};

/// The motion of an S-R-S arm that keeps its branch (make_path_motion()): a spline of the arm
/// angle.
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
  CarriedArmAngles carried_;
  Vector3d still_;                    // the direction that stands still
  std::optional<CubicSpline> angle_;  // from the direction that stands still
};

/// The motion of an S-R-S arm that changes its branch (make_path_motion()), as it may at a singular
/// pose of the shoulder or the wrist: a spline of the joints, whose rows have branches and arm
/// angles.
class SrsArcMotion final : public ArcMotion {
 public:
  SrsArcMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path,
               const std::vector<TrajectoryRow>& rows, double apart, double off_limits,
               const std::vector<BetweenRow>& between);
  [[nodiscard]] TrajectoryRow row(double travel, const Config& q) const override;
  [[nodiscard]] std::optional<Singular> nearest_singular(const Config& q) const override;

 private:
  const SrsArm* arm_;
  CarriedArmAngles carried_;
};

}  // namespace swivel
