// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>

#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// The posture nearest to q, along its self-motion at the pose of its tool, that is allowed: tried on both sides, ever further, up
/// to `farthest` (rad, Euclidean length in the joints). None where there is none, or where q is singular.
[[nodiscard]] std::optional<Config> posture_beside(const Chain& chain, const Config& q, double farthest,
                                                   const std::function<bool(const Config&)>& allowed);

}  // namespace swivel
