// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/collision/world/world.hpp"

namespace swivel::test {

/// Applies the rule of motions by asking every midpoint, one after the other: edge_blocked must
/// agree with it. Returns the pair of bodies of the first midpoint that fails, or nothing.
[[nodiscard]] inline std::optional<BodyPair> edge_blocked_plain(World::Query& query,
                                                                const EdgeRule& rule,
                                                                const Config& q0,
                                                                const Config& q1) {
  const Config delta = q1 - q0;
  const auto midpoint = [&](std::int64_t m, std::int64_t leaves) -> Config {
    return q0 + (static_cast<double>(m) + 0.5) / static_cast<double>(leaves) * delta;
  };
  const std::int64_t leaves = rule.midpoints(q0, q1);
  for (std::int64_t m = 0; m < leaves; ++m)
    if (const auto pair = query.find_violating_pair(midpoint(m, leaves), ClearanceRule::kMidpoint))
      return pair;
  for (const EdgeRule::Near& near : rule.near) {
    const std::int64_t own = rule.midpoints(q0, q1, near.h);
    for (std::int64_t m = 0; m < own; ++m)
      if (query.pair_violates(midpoint(m, own), near.pair, near.d_edge + near.h)) return near.pair;
  }
  return std::nullopt;
}

}  // namespace swivel::test
