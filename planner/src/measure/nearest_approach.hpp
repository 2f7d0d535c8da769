// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// The nearest approach of bodies in a trajectory's rows, as exact as FCL.
struct NearestApproach {
  World::Query::Clearance clearance;  ///< at the first row with the least margin
  int row = 0;
  double least = 0;  ///< clearance of all pairs and rows, m; not known with Seek::kMargin
};
/// What is sought: the least margin alone, or the least clearance of all pairs too.
enum class Seek { kMargin, kMarginAndLeast };
/// Returns the nearest approach of these rows and of `so_far`, which is that of the same rows for
/// other pairs. None if there are no pairs or no rows. Rows that are proved to be further than the
/// nearest so far, which are most after the first few, are not measured. `proved`, for
/// Seek::kMargin only, holds by row a lower bound of its margin, m, which saves the proof; it is
/// raised by what is proved. Throws Stopped.
[[nodiscard]] std::optional<NearestApproach> nearest_approach(
    const World& world, const std::vector<TrajectoryRow>& rows, Seek seek, const Budget& budget,
    const std::optional<NearestApproach>& so_far = std::nullopt,
    std::vector<double>* proved = nullptr);

}  // namespace swivel
