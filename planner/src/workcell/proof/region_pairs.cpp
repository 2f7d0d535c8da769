// SPDX-License-Identifier: BSD-3-Clause
#include "workcell/proof/region_pairs.hpp"

namespace swivel {

namespace {

/// The stances of both arms at the configurations of a region.
struct RegionStances {
  std::array<InterArmWorld::Stances, 2> of;
  RegionStances(InterArmWorld::Query& query, const std::array<std::vector<Config>, 2>& q,
                const std::optional<BodyPair>& pair)
      : of{query.stances(0, pair ? pair->a : -1, q[0]),
           query.stances(1, pair ? pair->b : -1, q[1])} {}
  [[nodiscard]] bool near(InterArmWorld::Query& query, const std::optional<BodyPair>& pair,
                          std::size_t i, std::size_t j) const {
    return pair ? query.violates(*pair, of[0], i, of[1], j)
                : query.any_violates(of[0], i, of[1], j);
  }
};

}  // namespace

std::optional<std::array<std::size_t, 2>> find_pair_apart(
    InterArmWorld::Query& query, const std::array<std::vector<Config>, 2>& q,
    const std::optional<BodyPair>& pair, const Budget& budget) {
  const RegionStances stances(query, q, pair);
  for (std::size_t i = 0; i < stances.of[0].count(); ++i)
    for (std::size_t j = 0; j < stances.of[1].count(); ++j) {
      budget.poll();
      if (stances.near(query, pair, i, j)) continue;
      for (std::size_t a = 0; a < q[0].size(); ++a)
        for (std::size_t b = 0; b < q[1].size(); ++b)
          if (stances.of[0].stance_of(a) == i && stances.of[1].stance_of(b) == j &&
              (pair || !query.find_violating_pair({q[0][a], q[1][b]}, ClearanceRule::kNode)))
            return std::array{a, b};
    }
  return std::nullopt;
}

std::optional<BodyPair> find_pair_always_near(const InterArmWorld& world,
                                              InterArmWorld::Query& query,
                                              const std::array<std::vector<Config>, 2>& q,
                                              const Budget& budget) {
  const std::array<std::vector<Config>, 2> first{std::vector{q[0].front()},
                                                 std::vector{q[1].front()}};
  for (const RobotPair& one : world.pairs()) {
    if (one.dropped) continue;
    const std::optional<BodyPair> pair = one.pair;
    if (!RegionStances(query, first, pair).near(query, pair, 0, 0)) continue;
    const RegionStances stances(query, q, pair);
    bool always = true;
    for (std::size_t i = 0; always && i < stances.of[0].count(); ++i)
      for (std::size_t j = 0; always && j < stances.of[1].count(); ++j) {
        budget.poll();
        always = stances.near(query, pair, i, j);
      }
    if (always) return pair;
  }
  return std::nullopt;
}

}  // namespace swivel
