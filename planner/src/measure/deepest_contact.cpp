// SPDX-License-Identifier: BSD-3-Clause
#include "measure/deepest_contact.hpp"

#include <algorithm>

namespace swivel {

std::optional<DeepestContact> deepest_contact(const World& world, const std::vector<Config>& rows,
                                              const Budget& budget) {
  constexpr double kTouching = 1e-6;  // m
  constexpr double kKnown = 0.5e-3;   // m, a bound that is further from what was found is left out
  World::Query query(world, DistanceProofs::kOn);
  std::optional<DeepestContact> deepest;
  double found = kTouching, at_most = 0;
  for (const AllowedPair& allowed : world.allowed())
    for (std::size_t k = 0; k < rows.size(); ++k) {
      budget.poll(Stage::kMeasuring, static_cast<std::int64_t>(k),
                  static_cast<std::int64_t>(rows.size()));
      const Depth depth = query.depth(rows[k], allowed.pair, found);
      at_most = std::max(at_most, depth.at_most);
      if (depth.at_least <= found) continue;
      found = depth.at_least;
      deepest = {found, std::nullopt, world.names(allowed.pair), allowed.depth,
                 static_cast<int>(k)};
    }
  if (deepest && at_most <= found + kKnown) deepest->at_most = at_most;
  return deepest;
}

}  // namespace swivel
