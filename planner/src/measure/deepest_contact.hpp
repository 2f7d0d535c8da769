// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// Returns the deepest contact of the world's allowed pairs at these postures and on the straight
/// joint motions from each to the next; none if no pair was found to touch. Motions are searched
/// until no contact on them can be deeper than the one found by more than 0.5 mm, nor deeper than
/// its pair may be, unless the one found is within 0.05 mm of that. For two meshes only the
/// postures are searched. Throws Stopped.
[[nodiscard]] std::optional<DeepestContact> deepest_contact(const World& world,
                                                            const EdgeRule& rule,
                                                            const std::vector<Config>& rows,
                                                            const Budget& budget);

}  // namespace swivel
