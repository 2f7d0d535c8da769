// SPDX-License-Identifier: BSD-3-Clause
#include "validity/asked_hooks.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel {

namespace {

/// Calls the hook, and first waits until no other plan calls it, unless it is concurrent. Throws
/// Stopped.
template <class Call>
void in_turn(Hook& hook, const Budget& budget, const Call& call) {
  budget.poll();
  std::unique_lock turn(hook.turn(), std::defer_lock);
  if (!hook.concurrent())
    while (!turn.try_lock_for(std::chrono::milliseconds(1))) budget.poll();
  call();
}

}  // namespace

template <class Ask>
std::span<const bool> AskedCheck::ask(std::size_t count, const Ask& ask) {
  if (count > capacity_) {
    allowed_ = std::make_unique<bool[]>(count);
    capacity_ = count;
  }
  const std::span<bool> allowed(allowed_.get(), count);
  std::fill(allowed.begin(), allowed.end(), check_ == nullptr);
  if (check_ && count > 0) in_turn(*check_, budget_, [&] { ask(allowed); });
  return allowed;
}

std::span<const bool> AskedCheck::states(std::span<const Config> states) {
  return ask(states.size(), [&](std::span<bool> allowed) { check_->states(states, allowed); });
}

std::span<const bool> AskedCheck::motions(std::span<const StateCheck::Motion> motions) {
  return ask(motions.size(), [&](std::span<bool> allowed) { check_->motions(motions, allowed); });
}

void AskedCost::costs(std::span<const Config> states, std::span<double> costs) {
  if (states.empty()) return;
  // so that a missing value is detected
  std::fill(costs.begin(), costs.end(), std::numeric_limits<double>::quiet_NaN());
  in_turn(*cost_, budget_, [&] { cost_->costs(states, costs); });
  const double most = 1000 * lattice_->cost_unit();
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (costs[k] >= 0 && costs[k] <= most) {
      costs[k] = lattice_->rounded_cost(costs[k]);
      continue;
    }
    const std::string text = formatted(
        "': costs[%zu] is %g: allowed is a number from 0 to %g; the state is", k, costs[k], most);
    std::string message = "state cost '" + cost_->name() + text;
    for (const double q :
         states[k].head(static_cast<Eigen::Index>(lattice_->chain().coordinates())))
      message += formatted(" %.9g", q);
    throw InvalidArgument(message);
  }
}

}  // namespace swivel
