// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// A distance of two poses, or a tolerance of it: m and rad. Infinite stands for no bound.
struct PoseDistance {
  double position = std::numeric_limits<double>::infinity();
  double angle = std::numeric_limits<double>::infinity();
};

/// The tool's motion during a joint-linear move, as poses so close together that straight motions
/// between them are within `error` of it.
struct ToolMotion {
  std::vector<Pose> poses;
  PoseDistance error;
};
/// Returns the tool's motion during a joint-linear move, cut so finely that the error stays below 1
/// % of the tolerance, or 1e-6 m and rad, with at most 2,048 parts. `ends` are the tool's poses at
/// both ends; there are `fewest` parts, or a multiple of it. At both ends `rolls`, rad, turn the
/// tool about its own z axis; they are interpolated in between and already contained in `ends`.
[[nodiscard]] ToolMotion tool_motion(const Chain& chain, const Config& from, const Config& to,
                                     const std::array<Pose, 2>& ends, const PoseDistance& tolerance,
                                     int fewest = 4, const std::array<double, 2>& rolls = {});

/// Returns the tool pose at a place on a path. A place is a layer's number plus the fraction of the
/// step from it: 3.5 is half way from layer 3 to layer 4.
[[nodiscard]] Pose pose_at(const ToolPath& path, double place);
/// Returns the travel, m, at a place on a path.
[[nodiscard]] double travel_at(const ToolPath& path, double place);

/// Returns for each of the places `ends` (ascending, none before `begin`) whether tool and path can
/// be traversed together, neither ever going back, from (first pose, begin) to (last pose, end),
/// always within `between` of each other, and within `waypoints` where the path passes a waypoint
/// on the way. That is whether their Frechet distance is that small: Alt & Godau 1995. Errors of
/// the motion and 1e-6 m and rad are forgiven.
[[nodiscard]] std::vector<bool> follows(const ToolMotion& motion, const ToolPath& path,
                                        double begin, std::span<const double> ends,
                                        const PoseDistance& between, const PoseDistance& waypoints);

/// Returns the largest distance of the motion's poses from the path between two places, and the
/// largest angle to the path. Among the places of the path that are as near to a pose as any
/// (core's places_near.hpp), the angle is taken at the one nearest in travel to what the motion
/// would have made by then at an even speed, as on steps of the lattice.
[[nodiscard]] PoseDistance largest_deviation(const ToolMotion& motion, const ToolPath& path,
                                             double begin, double end);

}  // namespace swivel
