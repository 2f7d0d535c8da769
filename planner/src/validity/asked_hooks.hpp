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

/// A check of the user's as one plan asks it: in turn with other plans, and no longer than the budget allows. Everything is allowed
/// where there is none. Throws Stopped, and what the check throws.
class AskedCheck {
 public:
  AskedCheck(std::shared_ptr<StateCheck> check, const Budget& budget) : check_(std::move(check)), budget_(budget) {}

  [[nodiscard]] explicit operator bool() const { return check_ != nullptr; }
  [[nodiscard]] bool checks_motions() const { return check_ && check_->checks_motions(); }
  [[nodiscard]] std::string name() const { return check_->name(); }

  /// Whether each is allowed: one call for all, and none for none. Valid until the next call.
  [[nodiscard]] std::span<const bool> states(std::span<const Config> states);
  [[nodiscard]] std::span<const bool> motions(std::span<const StateCheck::Motion> motions);

 private:
  template <class Ask>
  std::span<const bool> ask(std::size_t count, const Ask& ask);

  std::shared_ptr<StateCheck> check_;
  Budget budget_;
  std::unique_ptr<bool[]> allowed_;
  std::size_t capacity_ = 0;
};

/// The same of a cost. What is no cost is InvalidArgument.
class AskedCost {
 public:
  AskedCost(std::shared_ptr<StateCost> cost, const Lattice& lattice, const Budget& budget)
      : cost_(std::move(cost)), lattice_(&lattice), budget_(budget) {}

  [[nodiscard]] explicit operator bool() const { return cost_ != nullptr; }
  /// Fills in the rounded costs: spans of equal size.
  void costs(std::span<const Config> states, std::span<double> costs);

 private:
  std::shared_ptr<StateCost> cost_;
  const Lattice* lattice_;
  Budget budget_;
};

}  // namespace swivel
