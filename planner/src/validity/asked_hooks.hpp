// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

/// A user's check as one plan calls it: while no other plan does, unless it is concurrent, and no
/// longer than the budget allows. Without a check everything is allowed. Throws Stopped, and what
/// the check throws.
class AskedCheck {
 public:
  AskedCheck(std::shared_ptr<StateCheck> check, const Budget& budget)
      : check_(std::move(check)), budget_(budget) {}

  /// Returns true if there is a check.
  [[nodiscard]] explicit operator bool() const { return check_ != nullptr; }
  /// Returns true if there is a check that tests motions as well as states.
  [[nodiscard]] bool checks_motions() const { return check_ && check_->checks_motions(); }
  /// Returns the name of the check, which must exist.
  [[nodiscard]] std::string name() const { return check_->name(); }

  /// Returns by state whether it is allowed, by one call of the check for all states, or none for
  /// an empty span. Valid until the next call.
  [[nodiscard]] std::span<const bool> states(std::span<const Config> states);
  /// Returns by motion whether it is allowed, by one call of the check for all motions, or none for
  /// an empty span. Valid until the next call.
  [[nodiscard]] std::span<const bool> motions(std::span<const StateCheck::Motion> motions);

 private:
  template <class Ask>
  std::span<const bool> ask(std::size_t count, const Ask& ask);

  std::shared_ptr<StateCheck> check_;
  Budget budget_;
  std::unique_ptr<bool[]> allowed_;
  std::size_t capacity_ = 0;
};

/// A user's cost of states as one plan calls it: while no other plan does, unless it is concurrent,
/// and no longer than the budget allows. Throws Stopped, what the cost throws, and InvalidArgument
/// for a value outside 0 to 1000 cost units.
class AskedCost {
 public:
  AskedCost(std::shared_ptr<StateCost> cost, const Lattice& lattice, const Budget& budget)
      : cost_(std::move(cost)), lattice_(&lattice), budget_(budget) {}

  [[nodiscard]] explicit operator bool() const { return cost_ != nullptr; }
  /// Fills in the cost of each state, rounded by Lattice::rounded_cost(). The spans have equal
  /// size.
  void costs(std::span<const Config> states, std::span<double> costs);

 private:
  std::shared_ptr<StateCost> cost_;
  const Lattice* lattice_;
  Budget budget_;
};

}  // namespace swivel
