// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "placed_shape.hpp"

namespace swivel::detail {

/// A point of a and one of b, base frame, as far apart as the bodies: |p - q| within 0.1 mm of `clearance`, which is PairTest's,
/// and each within 0.1 mm of its body. None where they touch, and where FCL's points fail that test.
[[nodiscard]] std::optional<std::array<Vector3d, 2>> nearest_points(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                                                    double clearance);

}  // namespace swivel::detail
