// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// By which share a limit exceeds the cost of the best path known, so that removals seldom raise
/// that cost beyond it; and where turns are told apart, along a path that passed all obstacles but
/// for its turns.
inline constexpr double kSlack = 0.5, kSlackOfTurns = 0.05;
/// That share where steps are halved: each of many searches raises the cost by little.
inline constexpr double kSlackOfHalves = 0.03;

/// Returns the share for the first sweep of a lattice.
[[nodiscard]] inline double first_slack(const Lattice& lattice) {
  return lattice.joints_with_windings().empty() ? kSlack : kSlackOfTurns;
}

/// Returns the share after one that did not suffice.
[[nodiscard]] inline double next_slack(double slack) {
  return 2 * slack < kSlack ? kSlack : 2 * slack;
}

}  // namespace swivel
