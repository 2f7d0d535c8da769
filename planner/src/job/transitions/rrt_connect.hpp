// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"

namespace swivel {

/// The joint space that rrt_connect() searches.
struct SearchBox {
  Config lower = Config::Zero(), upper = Config::Zero();  ///< rad; joints with lower = upper rest
  /// By what the move of each joint is multiplied where distances are compared, > 0.
  Config scale = Config::Ones();
};

/// Returns true if the straight move between two configurations is free.
using MotionCheck = std::function<bool(const Config& from, const Config& to)>;

/// Searches for a way around obstacles by RRT-Connect (Kuffner & LaValle 2000): two trees of free
/// moves, one from each end, are grown alternately towards a random configuration of the box, and
/// the other tree then towards the new node. The way found is shortened by straight moves between
/// random places of it and by leaving out corners. Returns the corners between `from` and `to`,
/// none of the two included; nothing after `most_samples` random configurations. Deterministic for
/// a seed. Throws Stopped.
[[nodiscard]] std::optional<std::vector<Config>> rrt_connect(
    const Config& from, const Config& to, const SearchBox& box, const MotionCheck& free,
    std::uint64_t seed, const Budget& budget, int most_samples = 2000);

}  // namespace swivel
