// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "search/pairs/known_between.hpp"
#include "search/pairs/searched_arm.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// Searches for the first pair of paths without conflict by dividing the set of all pairs: a region
/// of conflict leaves the pairs in which arm 0 keeps away from its side, and those in which arm 1
/// does. Sets are taken in the order of their first pair, so that the first that has no conflict is
/// the answer.
class RegionBranching {
 public:
  /// All arguments must outlive the object.
  RegionBranching(std::array<SearchedArm, 2>& arms, KnownBetween& between,
                  const PairSearchOptions& options, PairOutcome& outcome)
      : arms_(arms), between_(between), options_(options), outcome_(outcome) {}
  RegionBranching(const RegionBranching&) = delete;
  RegionBranching& operator=(const RegionBranching&) = delete;

  /// Begins with the set of all pairs, whose best paths are `best`. Throws Stopped.
  void begin(std::array<SearchOutcome, 2> best);
  /// Divides sets until there have been `most_rounds` rounds in all, without end if negative.
  /// Returns true once the search is decided: `outcome` then has the answer. Throws Stopped.
  [[nodiscard]] bool run(std::int64_t most_rounds);

 private:
  /// A set of pairs of paths.
  struct Set {
    int branch = 0;                                  ///< index in PairOutcome::tree
    std::array<SearchOutcome, 2> best;               ///< of each arm
    double cost = 0;                                 ///< of both
    std::optional<KnownBetween::Conflict> conflict;  ///< of the best paths
  };
  struct Later {
    const std::vector<Set>* sets;
    bool operator()(std::size_t a, std::size_t b) const;
  };
  void add(Set set);
  /// Divides a set by a region of the conflict of its first pair, and adds the sets that are left
  /// of it but for those that have no pair.
  void divide(const Set& set);
  [[nodiscard]] std::vector<const ConflictRegion*> regions_of(int branch, int arm) const;

  std::array<SearchedArm, 2>& arms_;
  KnownBetween& between_;
  const PairSearchOptions& options_;
  PairOutcome& outcome_;
  std::vector<Set> sets_;
  std::priority_queue<std::size_t, std::vector<std::size_t>, Later> queue_{Later{&sets_}};
};

}  // namespace swivel
