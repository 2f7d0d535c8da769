// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Returns the unit vector x, perpendicular to the unit vector z, after the smallest turn that
/// takes z to the unit vector `to`. For vectors z and `to` that are opposite to 1e-6, where that
/// turn has no axis, returns the direction of the part of x perpendicular to `to`.
[[nodiscard]] Vector3d carried_x(const Vector3d& x, const Vector3d& z, const Vector3d& to);

/// Replaces the orientations of waypoints by frames with the same z axes that are carried along the
/// path: from waypoint to waypoint they turn by the smallest turn that takes one z axis to the
/// next. At the first waypoint from which the path leads to another place across its z axis (by a
/// tenth of the way at least) x points along that way; where the path leads nowhere across its
/// axis, x at the first waypoint is what of the x axis of the waypoints' frame is perpendicular to
/// z, or of its y axis where z lies within 26 deg of x. So frames depend on positions and z axes
/// alone.
void carry_frames(std::vector<Waypoint>& waypoints);

}  // namespace swivel
