// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"

namespace swivel {

/// Returns the first pair of configurations, one of each list of joints, at which two arms are
/// apart, by their indices; nothing if there is none. `pair`: the bodies that are meant, as
/// find_pair_always_near() returns them, or nothing for all. Throws Stopped.
[[nodiscard]] std::optional<std::array<std::size_t, 2>> find_pair_apart(
    InterArmWorld::Query& query, const std::array<std::vector<Config>, 2>& q,
    const std::optional<BodyPair>& pair, const Budget& budget);

/// Returns a pair of bodies that is too near at all pairs of configurations, one of each list of
/// joints; nothing if no single pair is. Throws Stopped.
[[nodiscard]] std::optional<BodyPair> find_pair_always_near(
    const InterArmWorld& world, InterArmWorld::Query& query,
    const std::array<std::vector<Config>, 2>& q, const Budget& budget);

}  // namespace swivel
