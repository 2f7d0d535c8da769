// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <exception>
#include <span>

#include "search/pairs/remembered_validity.hpp"
#include "search/path_validator.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// One of two arms with what is known of it by itself.
class SearchedArm {
 public:
  /// `arm` must outlive the object, `options` too.
  SearchedArm(const PairArm& arm, const PathFirstOptions& options);

  [[nodiscard]] CostToGo& cost_to_go() { return *cost_to_go_; }
  [[nodiscard]] const Lattice& lattice() const { return cost_to_go_->lattice(); }
  [[nodiscard]] RememberedValidity& validity() { return validity_; }
  [[nodiscard]] const RememberedValidity& validity() const { return validity_; }

  /// Sweeps and returns the arm's answer by itself, as path_first() does. Throws Stopped.
  [[nodiscard]] SearchOutcome answer_alone();
  /// Returns the cheapest valid path, the smallest slots first among equals; an empty one where
  /// there is none. Goes on where answer_alone() ended, and must follow it. Throws Stopped.
  [[nodiscard]] SearchOutcome cheapest() { return search(FirstPath::kCheapest); }
  /// Returns the cheapest valid path as cheapest() does, of those that keep away from this arm's
  /// sides of regions. `arm` is the arm's number. Throws Stopped.
  [[nodiscard]] SearchOutcome cheapest(std::span<const ConflictRegion* const> regions, int arm);
  /// Returns what a valid path costs that a search has found.
  [[nodiscard]] double cost(const SlotPath& path);

 private:
  void begin_again();
  void remove(const ConflictRegion& region, int arm);
  [[nodiscard]] SearchOutcome search(FirstPath first);

  CostToGo* cost_to_go_;
  RememberedValidity validity_;
  const PathFirstOptions* options_;
};

/// Calls body(arm) for both arms, on two threads where work is shared. Throws what the body threw
/// for the first arm that threw.
template <class Body>
void for_both_arms(const ParallelFor& work, const Body& body) {
  std::array<std::exception_ptr, 2> failures;
  work.for_each(2, [&](int arm, int) {
    try {
      body(arm);
    } catch (...) {
      failures[static_cast<std::size_t>(arm)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace swivel
