// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// Answers the questions of search_pair() by the bodies of both arms, at the exact joints of nodes.
class BetweenArms final : public Between {
 public:
  /// `radii`: motion_radii() of either arm, m. `asks_moves`: whether motions must be clear as well
  /// as nodes. References must outlive it.
  BetweenArms(const InterArmWorld& world, const std::array<const Lattice*, 2>& lattices,
              const std::array<std::array<double, kDof>, 2>& radii, bool asks_moves,
              DistanceProofs distance_proofs, const Budget& budget)
      : lattices_(lattices),
        radii_(radii),
        asks_moves_(asks_moves),
        query_(world, distance_proofs),
        budget_(budget) {}

  void nodes(std::span<const NodePair> questions, std::span<std::uint8_t> apart) override;
  void moves(std::span<const MovePair> questions, std::span<std::uint8_t> apart) override;
  void find_barred(int layer, const std::array<std::vector<int>, 2>& slots,
                   const std::array<std::vector<Config>, 2>& q,
                   std::span<std::uint8_t> barred) override;
  [[nodiscard]] bool asks_moves() const override { return asks_moves_; }
  using Between::region;
  [[nodiscard]] std::array<std::vector<int>, 2> region(const NodePair& conflict,
                                                       bool thorough) override;
  /// Returns the bodies that bar a pair of nodes or moves; none where none do.
  [[nodiscard]] std::optional<BodyPair> barred(const NodePair& question);
  [[nodiscard]] std::optional<BodyPair> barred(const MovePair& question);
  [[nodiscard]] CollisionCounters counters() const { return query_.counters(); }

 private:
  /// Returns the exact joints of both nodes; nothing where one has none.
  [[nodiscard]] std::optional<std::array<Config, 2>> rows(int layer,
                                                          const std::array<int, 2>& slots,
                                                          const std::array<Config, 2>& q) const;

  std::array<const Lattice*, 2> lattices_;
  std::array<std::array<double, kDof>, 2> radii_;
  bool asks_moves_;
  InterArmWorld::Query query_;
  Budget budget_;
};

}  // namespace swivel
