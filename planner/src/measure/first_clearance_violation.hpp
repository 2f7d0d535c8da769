// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// A pair of bodies that comes too near, and where.
struct ClearanceViolation {
  std::size_t row = 0;
  BodyPair pair;
  bool between = false;  ///< on the way from the row before to `row`
};

/// Returns the first of these rows at which a pair comes too near (RequiredClearance::node), or on
/// the way to which a pair does (RequiredClearance::motion, with `edges: continuous`; joints move
/// straight from row to row); none if there is none. Distance proofs answer if they can, and for
/// many rows at once: all rows from one to another are free if the middle one is clear by as much
/// as the bodies move from there. `rule` and `limits` are those of the world. Throws Stopped.
[[nodiscard]] std::optional<ClearanceViolation> first_clearance_violation(
    const World& world, const EdgeRule& rule, const Limits& limits, const std::vector<Config>& rows,
    const Budget& budget);

}  // namespace swivel
