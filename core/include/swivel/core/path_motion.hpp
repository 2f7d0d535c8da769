// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/cubic_spline.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/core/srs.hpp"
#include "swivel/core/tool_path.hpp"

namespace swivel {

/// Where no posture follows from the rows of a trajectory.
struct NoMotion {
  double s = 0;  ///< m along the path
  std::string reason;
  bool too_near = false;  ///< bodies come too near: other joints might do
};

/// The joints of an S-R-S arm as a function of the tool's travel along its path: the tool is exactly on the path, and the arm angle
/// is a cubic spline through that of the rows of a trajectory. So the joints are as smooth as tool path and spline are, twice
/// continuously differentiable.
///
/// The angle that is interpolated is measured from a direction that stands still, the one of 26 that shoulder and wrist keep
/// clearest of: the carried arm angle has kinks at layers, from the area that its reference direction runs round.
class PathMotion {
 public:
  /// One row for each layer of the path, or for some of them, in order, the first and the last among them; labels and joint
  /// images are those of the rows. Rows need not be at the poses of the path exactly: their arm angle counts. Throws InputError
  /// where a row is at no layer. Refers to chain, arm and path. Rows less than `apart` after the one before, m of travel, are left
  /// out, the last aside: where rows are dense the digits that they do not agree in would bend the joints.
  PathMotion(const Chain& chain, const SrsArm& arm, const ToolPath& path, const std::vector<TrajectoryRow>& rows, double apart = 0);

  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const SrsArm& arm() const { return *arm_; }
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  /// m of travel.
  [[nodiscard]] double length() const { return path_->layer(path_->size() - 1).travel; }
  /// Where rows are, m of travel.
  [[nodiscard]] const std::vector<double>& knots() const { return travel_; }
  /// Joints, unwrapped along the path; none where there is no closed form.
  [[nodiscard]] std::optional<Config> joints(double travel) const;
  /// s, carried arm angle and branch of joints at a travel.
  [[nodiscard]] TrajectoryRow row(double travel, const Config& q) const;
  /// Steps of rows from one branch to another: the joints jump there.
  [[nodiscard]] const std::vector<NoMotion>& jumps() const { return jumps_; }

 private:
  [[nodiscard]] ArmPlane still_plane(const Pose& tool) const;

  const Chain* chain_;
  const SrsArm* arm_;
  const ToolPath* path_;
  std::vector<ArmPlane> planes_;  // carried, of layers
  Vector3d still_;                // the direction that stands still
  std::vector<double> travel_;    // of rows
  std::vector<TrajectoryRow> rows_;
  std::optional<CubicSpline> angle_;  // from the direction that stands still
  std::vector<NoMotion> jumps_;
};

}  // namespace swivel
