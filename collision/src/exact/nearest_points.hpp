// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "shapes/placed_shape.hpp"

namespace swivel::detail {

/// Returns a point of a and a point of b, base frame, whose distance is within 0.1 mm of
/// `clearance`, m, as PairTest::clearance() returned it. Each lies within 0.1 mm of its body.
/// Returns none if the bodies touch, or if the points that FCL names fail this test.
[[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(const PlacedShapeRef& a,
                                                                    const PlacedShapeRef& b,
                                                                    double clearance);

/// Returns a point, base frame, that lies inside or within 0.1 mm of both bodies. Returns none if
/// there is no such point or the search finds none within 4000 evaluations.
[[nodiscard]] std::optional<Vector3d> common_point(const PlacedShapeRef& a,
                                                   const PlacedShapeRef& b);

}  // namespace swivel::detail
