// SPDX-License-Identifier: BSD-3-Clause
#include "measure/nearest_approach.hpp"

#include <algorithm>
#include <tuple>

namespace swivel {

std::optional<NearestApproach> nearest_approach(const World& world,
                                                const std::vector<TrajectoryRow>& rows, Seek seek,
                                                const Budget& budget,
                                                const std::optional<NearestApproach>& so_far,
                                                std::vector<double>* proved) {
  // Rows far apart come first, so that one of them is near the nearest.
  constexpr int kStride = 8;
  const int count = static_cast<int>(rows.size());
  World::Query query(world, DistanceProofs::kOn);
  std::optional<NearestApproach> nearest = so_far;
  const auto is_further = [&](int row, const Config& q) {
    if (!(nearest->clearance.distance > 0)) return false;
    const Threshold threshold(ClearanceRule::kNode, nearest->clearance.margin() + 2 * kVerdictBand);
    double* known = proved ? &(*proved)[static_cast<std::size_t>(row)] : nullptr;
    if (known && *known >= threshold.more) return true;
    if (query.find_violating_pair_incremental(q, threshold)) return false;
    if (known) *known = std::max(*known, threshold.more + std::max(0.0, query.slack(threshold)));
    return seek == Seek::kMargin ||
           !query.find_violating_pair_incremental(q, Threshold(nearest->least + 2 * kVerdictBand));
  };
  int looked_at = 0;
  const auto look_at = [&](int row) {
    budget.poll(Stage::kMeasuring, looked_at++, count);
    const Config& q = rows[static_cast<std::size_t>(row)].q;
    if (nearest && is_further(row, q)) return;
    std::optional<World::Query::Clearance> here;
    if (nearest && nearest->clearance.distance > 0) {
      World::Query::Clearance below = nearest->clearance;
      below.least = nearest->least;
      here = query.clearance_if_less(q, below);
    } else {
      here = query.clearance(q);
    }
    if (!here) return;
    const double least = nearest ? std::min(nearest->least, here->least) : here->least;
    if (!nearest ||
        std::tuple(here->margin(), row) <= std::tuple(nearest->clearance.margin(), nearest->row))
      nearest = {*here, row, least};
    else
      nearest->least = least;
  };
  for (int first = 0; first < kStride; ++first)
    for (int row = first; row < count; row += kStride) look_at(row);
  return nearest;
}

}  // namespace swivel
