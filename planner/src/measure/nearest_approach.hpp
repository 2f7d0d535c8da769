// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// How near bodies come to each other in a trajectory's rows, exact as FCL.
struct NearestApproach {
  World::Query::Clearance clearance;  ///< of the row with the least margin, the first that has it
  int row = 0;
  double least = 0;  ///< of all pairs and rows, m; of kMargin not known
};
/// Whether the least clearance is sought besides the least margin.
enum class Seek { kMargin, kMarginAndLeast };
/// Of these rows and of `so_far`, which is of the same rows and of other pairs. None where there are no pairs or no rows. Rows that
/// are proved to be further than the nearest so far are not measured: most, after the first few. Throws Stopped.
/// `proved`, of kMargin: by row, what its margin is known to be at least, which spares it the proof; raised where it is proved.
[[nodiscard]] std::optional<NearestApproach> nearest_approach(const World& world, const std::vector<TrajectoryRow>& rows, Seek seek,
                                                              const Budget& budget,
                                                              const std::optional<NearestApproach>& so_far = std::nullopt,
                                                              std::vector<double>* proved = nullptr);

}  // namespace swivel
