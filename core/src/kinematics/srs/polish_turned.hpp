// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// polish() for the tool turned about its z axis as the seed turns it. `plane` and `tool` are those of the tool that is not turned;
/// phi counts from the plane carried to the turned one.
[[nodiscard]] std::optional<Config> polish_turned(const Chain& chain, const SrsArm& arm, const ArmPlane& plane, const Pose& tool,
                                                  double phi, const Config& seed);

}  // namespace swivel
