// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "kinematics/newton/pose_newton.hpp"
#include "swivel/core/base/cubic_spline.hpp"
#include "swivel/core/kinematics/equations/alignment.hpp"
#include "swivel/core/motion/path_motion.hpp"

namespace swivel {

/// The motion of an arm along arcs of self-motion (make_path_motion()): a spline of the joints,
/// moved onto the path.
class ArcMotion : public PathMotion {
 public:
  ArcMotion(const Chain& chain, const LockMethod& lock, const ToolPath& path,
            const std::vector<TrajectoryRow>& rows, double apart, double off_limits,
            const std::vector<BetweenRow>& between);
  [[nodiscard]] std::optional<Config> joints(double travel) const override;
  [[nodiscard]] TrajectoryRow row(double travel, const Config& q) const override;
  [[nodiscard]] std::optional<Singular> nearest_singular(const Config& q) const override;

 private:
  void move_off_limits(double by);
  void find_jumps();
  [[nodiscard]] bool leads_over(double x0, const Config& q0, double x1, const Config& q1) const;

  LockMethod lock_;
  PoseNewton newton_;
  std::vector<Alignment> alignments_;  // of the arm's own joints
  std::vector<CubicSpline> spline_;    // by joint
};

}  // namespace swivel
