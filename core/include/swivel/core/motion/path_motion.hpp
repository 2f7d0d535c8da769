// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/motion/timed_path.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Joints at a travel of the tool, m, between two rows of a trajectory.
struct BetweenRow {
  double travel = 0;
  Config q = Config::Zero();
};

/// The joints of an arm as a function of the tool's travel along its path, through the rows of a trajectory: the tool is exactly on
/// the path, and joints are as smooth as tool path and cubic splines are, twice continuously differentiable. How the coordinate
/// that the arm has to spare goes on between rows is the business of the classes derived from it (make_path_motion).
class PathMotion {
 public:
  virtual ~PathMotion() = default;
  PathMotion(const PathMotion&) = delete;
  PathMotion& operator=(const PathMotion&) = delete;

  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  /// m of travel.
  [[nodiscard]] double length() const { return path_->layer(path_->size() - 1).travel; }
  /// Where rows are, m of travel.
  [[nodiscard]] const std::vector<double>& knots() const { return travel_; }
  /// Joints, unwrapped along the path; none where the arm has no solution.
  [[nodiscard]] virtual std::optional<Config> joints(double travel) const = 0;
  /// s, arm angle and branch of joints at a travel.
  [[nodiscard]] virtual TrajectoryRow row(double travel, const Config& q) const = 0;
  /// Where the joints jump.
  [[nodiscard]] const std::vector<NoMotion>& jumps() const { return jumps_; }
  /// How near joints are to a singular pose of a part of the arm: "shoulder", "elbow" or "wrist".
  struct Singular {
    const char* where = "";
    double angle = 0;  ///< rad
  };
  /// Of the parts that have one; of several equally near ones the first from the base.
  [[nodiscard]] virtual std::optional<Singular> nearest_singular(const Config& q) const = 0;

 protected:
  PathMotion(const Chain& chain, const ToolPath& path, const std::vector<TrajectoryRow>& rows, double apart,
             const std::vector<BetweenRow>& between);
  /// The path's pose at a row.
  [[nodiscard]] Pose pose_of(std::size_t row) const;
  /// The rows around a travel, by number, and how far between them it is: 0 to 1.
  struct Between {
    std::size_t from = 0;
    double t = 0;
  };
  [[nodiscard]] Between between(double travel) const;
  /// s at a travel, on step i of the path and by a share t of it.
  struct Place {
    double s = 0, t = 0;
    int step = 0;
  };
  [[nodiscard]] Place place(double travel) const;

  const Chain* chain_;
  const ToolPath* path_;
  std::vector<TrajectoryRow> rows_;
  std::vector<int> layer_;      // of rows; -1: between layers
  std::vector<double> travel_;  // of rows
  std::vector<NoMotion> jumps_;
};

/// The motion of an arm of this class. One row for each layer of the path, or for some of them, in order, the first and the last
/// among them; labels and joint images are those of the rows. Rows need not be at the poses of the path exactly: the coordinate to
/// spare counts. Throws InputError where a row is at no layer. Refers to chain, arm and path. Rows less than `apart` after the one
/// before, m of travel, are left out, the last aside: where rows are dense the digits that they do not agree in would bend the
/// joints. The motion leads through the postures `between` as well, wherever on the path they stand.
///
/// S-R-S arms: a spline through the arm angles of the rows, in closed form. The angle is measured from a direction that stands
/// still, the one of 26 that shoulder and wrist keep clearest of: the carried arm angle has kinks at layers, from the area that its
/// reference direction runs round. Steps from one branch to another are jumps.
///
/// Other arms: a spline through the joints of the rows, moved onto the pose by Newton steps of least norm. So along the
/// self-motion the joints are those of the spline. Jumps are where no continuous motion leads over. Rows with a joint nearer to
/// its limit than `off_limits`, rad, are moved along the self-motion until it is as far, save the first and the last: nodes of arcs
/// stand on limits, and a spline through them would leave these.
[[nodiscard]] std::unique_ptr<PathMotion> make_path_motion(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                                           const std::vector<TrajectoryRow>& rows, double apart = 0,
                                                           double off_limits = 0, const std::vector<BetweenRow>& between = {});

}  // namespace swivel
