// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "shapes/placed_shape.hpp"

namespace swivel::detail {

/// A point of a and one of b, base frame, as far apart as the bodies: |p - q| within 0.1 mm of `clearance`, which is PairTest's,
/// and each within 0.1 mm of its body. None where they touch, and where FCL's points fail that test.
[[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                                                    double clearance);

/// A point of both, base frame: within 0.1 mm of each, or inside. None where they are further apart than that, and where none is
/// found soon.
[[nodiscard]] std::optional<Vector3d> common_point(const PlacedShapeRef& a, const PlacedShapeRef& b);

}  // namespace swivel::detail
