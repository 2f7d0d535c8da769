// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"

namespace swivel {

/// Why paths are not refined with a cost of the caller's own, which is not known off the lattice.
inline constexpr const char* kOwnCostReason = "the caller's own cost is not refined";

/// Returns what is said of rows that are not refined, for a reason.
[[nodiscard]] inline Refined not_refined(const std::vector<TrajectoryRow>& rows, double cost,
                                         const char* reason) {
  return {.rows = rows, .rows_before = rows, .reason = reason, .cost_before = cost, .cost = cost};
}

/// What was made of the rows of a path so far.
struct RefinedMotion {
  std::optional<Refined> refinement;   ///< set where asked for and done
  std::optional<MotionResult> motion;  ///< of the refined rows, where there are some
  double refine_ms = 0, time_ms = 0;
};

/// Refines the rows of a path with `refining`, and times them with `timing`, each if given. Where
/// bodies come too near to each other between refined rows, these are refined again with more
/// clearance at layers. Sets what is done in `found` as it goes. Throws as refine() and
/// time_trajectory() do, and Stopped.
void refine_until_timed(const PreparedRobot& robot, const PathProblem& problem,
                        const std::vector<TrajectoryRow>& rows,
                        std::optional<RefineOptions> refining,
                        const std::optional<TimingOptions>& timing, const Budget& budget,
                        RefinedMotion& found);

}  // namespace swivel
