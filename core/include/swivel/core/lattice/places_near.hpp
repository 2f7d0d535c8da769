// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// How much further from the tool than the nearest place of a path another place may be, m, and
/// still count as one of the nearest. Waypoints are written, measured and computed to micrometres:
/// the direction of a step that is hardly longer than that means nothing, and such a step is one
/// place with many orientations.
inline constexpr double kAsNear = 1e-5;

/// A range of the shares of a segment, from 0 at its start to 1 at its end.
struct Shares {
  double low = 0, high = 1;
};

/// Returns the places of the segment from `start` to `start` + `along` (m) that are as near to
/// `point` as one at the distance `least` is, to kAsNear. The segment must have such places. One
/// without length has them all.
[[nodiscard]] inline Shares places_near(const Vector3d& start, const Vector3d& along,
                                        const Vector3d& point, double least) {
  const double length2 = along.squaredNorm();
  if (length2 < 1e-18) return {};
  const Vector3d offset = point - start;
  const double foot = offset.dot(along) / length2, far = least + kAsNear,
               aside2 = (offset - foot * along).squaredNorm(),
               reach = std::sqrt(std::max(0.0, far * far - aside2) / length2);
  return {std::clamp(foot - reach, 0.0, 1.0), std::clamp(foot + reach, 0.0, 1.0)};
}

/// Returns true if the step from a layer turns on the spot but for the noise of its waypoints: it
/// turns by at least 0.01 rad on no more than kAsNear. A speed of the tool in m/s says nothing of
/// how long such a step takes.
[[nodiscard]] inline bool turns_on_the_spot(const PathLayer& step) {
  constexpr double kTurn = 0.01;  // rad
  return step.step_length <= kAsNear && step.step_angle >= kTurn;
}

}  // namespace swivel
