// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// The deepest contact of the world's allowed pairs at these postures and on the straight joint motions from each to the next; none
/// where no pair was found to touch. What is between postures is searched until no contact there can be deeper than the one found
/// by more than 0.5 mm, nor deeper than its pair may be, unless what was found is within 0.05 mm of that. Of two meshes the
/// postures alone are looked at. Throws Stopped.
[[nodiscard]] std::optional<DeepestContact> deepest_contact(const World& world, const EdgeRule& rule,
                                                            const std::vector<Config>& rows, const Budget& budget);

}  // namespace swivel
