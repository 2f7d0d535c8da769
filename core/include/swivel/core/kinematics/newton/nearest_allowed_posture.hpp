// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>

#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// Returns an allowed posture near q (rad) on the self-motion at its tool pose: q itself if it is
/// allowed, else the first that is found on either side, in growing steps, until `farthest` (rad,
/// Euclidean length in joint space) has been passed. Returns none if none is allowed or q is
/// singular.
[[nodiscard]] std::optional<Config> nearest_allowed_posture(
    const Chain& chain, const Config& q, double farthest,
    const std::function<bool(const Config&)>& allowed);

}  // namespace swivel
