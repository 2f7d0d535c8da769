// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// Returns the deepest contact of the world's allowed pairs at these postures; none if no pair was
/// found to touch. Motions between them are not looked at: of a pair that keeps a depth, the edges
/// prove it. Throws Stopped.
[[nodiscard]] std::optional<DeepestContact> deepest_contact(const World& world,
                                                            const std::vector<Config>& rows,
                                                            const Budget& budget);

}  // namespace swivel
