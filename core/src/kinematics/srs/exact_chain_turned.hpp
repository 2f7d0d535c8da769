// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Refines joints to the exact chain (solve_exact_chain()) for the tool turned about its z axis as
/// the seed's joints turn it. `plane` and `tool` belong to the tool that is not turned; phi (rad)
/// counts from the plane carried to the turned tool.
[[nodiscard]] std::optional<Config> solve_exact_chain_turned(const Chain& chain, const SrsArm& arm,
                                                             const ArmPlane& plane,
                                                             const Pose& tool, double phi,
                                                             const Config& seed);

}  // namespace swivel
