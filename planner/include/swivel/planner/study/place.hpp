// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "swivel/core/study/placement.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// A placement to be planned: the cell's number in the grid, the offset of the thing that is
/// placed, and where joints are held, the same ones in all cells.
struct PlacementCell {
  std::uint64_t cell = 0;
  Offset offset{};
  HeldPositions hold = {};
};

/// The plan of a placement that has one.
struct PlacedPlan {
  PlacementCell cell;
  std::vector<SceneObject> scene;  ///< with the objects where they are in this placement
  std::vector<TrajectoryRow> trajectory;
  std::shared_ptr<const PreparedRobot> robot;  ///< with the joints held where they are in it
};

/// Plans placements of one thing, each on one thread by a planner that reuses what earlier
/// placements computed. A row depends on its placement alone, not on other cells or on the number
/// of threads: it is what a plan of placed_problem() has, after hold_joints(). Cells with joints at
/// other positions than in the cell before need a robot that is prepared anew.
class PlacementPlanner {
 public:
  /// Prepares to plan placements of `thing` in `problem`. options.threads is the number of cells
  /// planned at once; evidence, hooks and progress are ignored; the time-out covers all calls
  /// together, from now on. Throws as the Planner of a prepared robot does, and InvalidArgument for
  /// an unknown object.
  PlacementPlanner(std::shared_ptr<const PreparedRobot> robot, PathProblem problem, Movable thing,
                   PlanOptions options);
  /// Prepares to plan placements of `thing` in a problem of one arm. Strokes are planned in full
  /// for each placement, as plan_job() does with one thread; clearances, margins and speeds of rows
  /// are those of the strokes.
  PlacementPlanner(std::shared_ptr<const PreparedRobot> robot, Problem problem, Movable thing,
                   PlanOptions options);
  /// Prepares to plan placements of `thing` in a problem. Two arms are planned in full for each
  /// placement, as plan_workcell() does with one thread: costs of rows are of both paths together;
  /// clearances, margins and speeds are the least of both arms, clearances also of what is between
  /// them. A placement at which the given motion of an arm does not keep its limits is infeasible.
  PlacementPlanner(Problem problem, Movable thing, PlanOptions options);
  PlacementPlanner(PlacementPlanner&&) noexcept;
  PlacementPlanner& operator=(PlacementPlanner&&) noexcept;
  ~PlacementPlanner();

  /// Plans the cells and returns their rows in the order of `cells`, without those that were not
  /// answered in time. An internal error of a cell becomes its row, of status kError. `done` is
  /// called from the planning threads, one call at a time, as each row is finished. Throws
  /// InputError, which names the cell, if a placed problem is invalid or its joints cannot be held
  /// so.
  std::vector<PlacementRow> plan(const std::vector<PlacementCell>& cells,
                                 const std::function<void(const PlacementRow&)>& done = {});
  /// Plans the cells again and returns their trajectories, which rows do not hold, in the order of
  /// `cells`, without those that have no path or were not answered in time. Returns none for a job
  /// or a workcell, of which plan_job() of placed_problem() and plan_workcell() of placed_problem()
  /// give the rows of a cell.
  [[nodiscard]] std::vector<PlacedPlan> trajectories(const std::vector<PlacementCell>& cells);
  /// Plans the cells again and calls `found` after each that was answered, with its result and what
  /// the plan found out, both valid during the call. Does nothing for a job or a workcell.
  void plan_again(
      const std::vector<PlacementCell>& cells,
      const std::function<void(const PlacementCell&, const PlanResult&, const PlanView&)>& found);
  /// Returns true if the time ran out or work was cancelled; rows may then be missing.
  [[nodiscard]] bool stopped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
