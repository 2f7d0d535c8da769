// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <vector>

#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Finds the places on a path at which a tool is. A place is a layer's number plus the fraction of
/// the step from it, as for pose_at().
class PlacesOnPath {
 public:
  /// A tool this near to the path, m and rad, is on it.
  static constexpr double kOnPath = 1e-6;

  /// Builds the search tree of a path, which must outlive it. `curved`: the corners of the path are
  /// rounded, by at most `rounding`, m, from its polyline. `any_turn`: the turn of the tool about
  /// its own z axis does not matter.
  PlacesOnPath(const ToolPath& path, bool curved, double rounding, bool any_turn);

  /// Returns all places at which the path has the tool's pose, ascending; if s, m, is given, only
  /// those within 1e-9 m of it.
  [[nodiscard]] std::vector<double> fits(const Pose& tool,
                                         double s = std::numeric_limits<double>::quiet_NaN()) const;
  /// Returns the place between `from` and `to` that comes nearest to the tool; metres and radians
  /// count alike.
  [[nodiscard]] double nearest(const Pose& tool, double from, double to) const;
  /// Returns true if the path has the tool's pose at the place.
  [[nodiscard]] bool fits_at(const Pose& tool, double place) const;
  /// Returns the distance along the path at a place, m.
  [[nodiscard]] double s_at(double place) const;
  /// Returns the place at distance s, m, along the path; the first one if the path turns on the
  /// spot there.
  [[nodiscard]] double place_at(double s) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  struct Box {
    Vector3d low, high;
    /// Returns the distance of a point from the box, m.
    [[nodiscard]] double distance(const Vector3d& point) const {
      return (point - point.cwiseMax(low).cwiseMin(high)).norm();
    }
  };
  [[nodiscard]] Vector6 off(const Pose& there, const Pose& tool) const;
  [[nodiscard]] double share_of(int step, const Pose& tool, double low, double high) const;
  [[nodiscard]] double aside_of(int step) const;
  [[nodiscard]] double least_distance(int step, const Vector3d& point) const;
  template <class Reaches, class Visit>
  void search(std::size_t node, const Vector3d& point, const Reaches& reaches,
              const Visit& visit) const;

  const ToolPath* path_;
  bool curved_, any_turn_;
  double aside_;            // m, how far the path may be from the chord of a step
  std::size_t leaves_ = 1;  // a power of two
  // a binary tree of runs of steps: 1 is the root, 2k and 2k + 1 are below k
  std::vector<Box> boxes_;
};

}  // namespace swivel
