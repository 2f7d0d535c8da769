// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "swivel/core/study/placement.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// A placement to be planned.
struct PlacementCell {
  std::uint64_t cell = 0;
  Offset offset{};
};

/// The plan of a placement that has one.
struct PlacedPlan {
  PlacementCell cell;
  std::vector<SceneObject> scene;  ///< as it stands then
  std::vector<TrajectoryRow> trajectory;
};

/// Plans placements of one thing, each by one thread with a planner that remembers those before. A row hangs on its placement
/// alone: on no other cell, and not on the number of threads.
class PlacementPlanner {
 public:
  /// `options`: threads are cells planned at once; evidence, hooks and progress are ignored; the time-out is that of all calls
  /// together, from now on. Throws as the Planner of a prepared robot does, and InvalidArgument for an unknown object.
  PlacementPlanner(std::shared_ptr<const PreparedRobot> robot, Problem problem, Movable thing, PlanOptions options);
  ~PlacementPlanner();

  /// Rows in the order of `cells`, without those that were not answered in time. An internal error of a cell is its row, of status
  /// kError. `done` is called from the planning threads, one call at a time, as rows come. Throws InputError, which names the cell,
  /// where a placed problem makes no sense.
  std::vector<PlacementRow> plan(const std::vector<PlacementCell>& cells,
                                 const std::function<void(const PlacementRow&)>& done = {});
  /// The trajectories behind rows, which do not hold them: planned once more, in the order of `cells`, without those that have no
  /// path or were not answered in time.
  [[nodiscard]] std::vector<PlacedPlan> trajectories(const std::vector<PlacementCell>& cells);
  /// Whether the time was up, or work was cancelled: rows may be missing.
  [[nodiscard]] bool stopped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
