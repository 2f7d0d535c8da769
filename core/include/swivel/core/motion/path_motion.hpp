// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Joints at a travel of the tool between two rows of a trajectory.
struct BetweenRow {
  double travel = 0;
  Config q = Config::Zero();
};

/// The joints of an arm as a function of the tool's travel along its path, through the rows of a
/// trajectory. The tool is exactly on the path, and joints are as smooth as the tool path and cubic
/// splines are: twice continuously differentiable. Derived classes decide how the arm's redundancy
/// is interpolated between rows, see make_path_motion().
class PathMotion {
 public:
  virtual ~PathMotion() = default;
  PathMotion(const PathMotion&) = delete;
  PathMotion& operator=(const PathMotion&) = delete;

  /// Returns the arm's chain.
  [[nodiscard]] const Chain& chain() const { return *chain_; }
  /// Returns the path that the tool follows.
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  /// Returns the travel of the whole path, m.
  [[nodiscard]] double length() const { return path_->layer(path_->size() - 1).travel; }
  /// Returns the travel of the rows that the motion leads through, m.
  [[nodiscard]] const std::vector<double>& knots() const { return travel_; }
  /// Returns the joints at a travel (m), rad, without jumps of whole turns along the path; none
  /// where the arm has no solution.
  [[nodiscard]] virtual std::optional<Config> joints(double travel) const = 0;
  /// Returns the trajectory row of joints q at a travel (m): with its s, arm angle and branch.
  [[nodiscard]] virtual TrajectoryRow row(double travel, const Config& q) const = 0;
  /// Returns the places where the joints jump.
  [[nodiscard]] const std::vector<NoMotion>& jumps() const { return jumps_; }
  /// Which part of the arm is near a singular pose, "shoulder", "elbow" or "wrist", and how near.
  struct Singular {
    const char* where = "";
    double angle = 0;  ///< rad
  };
  /// Returns the part of the arm nearest to a singular pose at joints q, the first from the base of
  /// equally near ones; none where the arm has no such part.
  [[nodiscard]] virtual std::optional<Singular> nearest_singular(const Config& q) const = 0;

 protected:
  PathMotion(const Chain& chain, const ToolPath& path, const std::vector<TrajectoryRow>& rows,
             double apart, const std::vector<BetweenRow>& between);
  /// Returns the path's tool pose at a row.
  [[nodiscard]] Pose pose_of(std::size_t row) const;
  /// A place between two rows: row `from` and the next, and the share t, 0 to 1, of the way between
  /// them.
  struct Between {
    std::size_t from = 0;
    double t = 0;
  };
  /// Returns the rows around a travel (m).
  [[nodiscard]] Between between(double travel) const;
  /// A place on the path: its s (m), the step of the path that it is on, and the share t of that
  /// step.
  struct Place {
    double s = 0, t = 0;
    int step = 0;
  };
  /// Returns the place on the path of a travel (m).
  [[nodiscard]] Place place(double travel) const;

  const Chain* chain_;
  const ToolPath* path_;
  std::vector<TrajectoryRow> rows_;
  std::vector<int> layer_;      // layer of each row; -1: between layers
  std::vector<double> travel_;  // of rows
  std::vector<NoMotion> jumps_;
};

/// Returns the motion of an arm of a class through the rows of a trajectory, of which there must be
/// one for each layer of the path, or for some layers in order, the first and the last among them.
/// Labels and whole turns of joints are those of the rows. Rows need not be exactly at the poses of
/// the path: only the redundancy coordinate is taken from them. Rows less than `apart` (m of
/// travel) after the one before are left out, except the last: where rows are dense, the digits in
/// which they disagree would bend the joints. The motion leads through the postures `between` as
/// well. Throws InputError where a row is at no layer. Refers to chain, arm and path, which must
/// outlive it.
///
/// For S-R-S arms the arm angle is a spline through those of the rows, and joints follow in closed
/// form. The angle is measured from a direction that stands still, of several the one that the line
/// from shoulder to wrist keeps clearest of: the carried arm angle has kinks at layers, from the
/// area that its reference direction runs round.
///
/// For other arms, and through rows of an S-R-S arm that change the branch, as it may at a
/// singular pose of the shoulder or the wrist, a spline through the joints of the rows is moved
/// onto the pose by Newton steps of least norm, so that along the self-motion the joints are
/// those of the spline. Places that no continuous motion leads over are jumps. Rows with a
/// joint nearer to its limit than `off_limits` (rad) are moved along the self-motion until it
/// is as far, except the first and the last: nodes of arcs stand on limits, and a spline
/// through them would leave these.
[[nodiscard]] std::unique_ptr<PathMotion> make_path_motion(
    const Chain& chain, const ArmClass& arm, const ToolPath& path,
    const std::vector<TrajectoryRow>& rows, double apart = 0, double off_limits = 0,
    const std::vector<BetweenRow>& between = {});

}  // namespace swivel
