// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "swivel/planner/plan/plan_view.hpp"

namespace swivel {

/// A region in which two arms bar each other: nodes of a layer of either arm, of which no two keep
/// clear; where it is one of motions, the nodes from which and to which they lead.
struct RegionOfConflict {
  int layer = 0;
  std::array<std::vector<int>, 2> slots;  ///< of either arm's lattice, in the layer
  std::array<std::vector<int>, 2> next;   ///< nodes to which motions lead, in the next layer
};

/// What the plan of a problem found out about its runs, for those who draw or measure it. Valid
/// while what was prepared for the plan lives (PreparedRobot, PreparedWorkcell); copies share what
/// they refer to.
struct ProblemView {
  /// The views of the runs in the order of ArmAnswer::runs, and those of both arms where there are
  /// two. The path of each is that of the answer. Where there is none, a run without a path by
  /// itself has the view of its own plan; another run of strokes has an empty path, and an arm of
  /// two that of the arm by itself. Empty if the plan was stopped before there was an answer or a
  /// verdict.
  std::vector<PlanView> runs;
  /// The cheapest path of each of two arms by itself, as slots of its lattice; empty where it has
  /// none.
  std::array<std::vector<int>, 2> alone;
  /// The first region by which pairs of paths of two arms were divided, where these paths have a
  /// conflict.
  std::optional<RegionOfConflict> region;
  std::shared_ptr<const void> owner;  ///< of what the runs refer to, but what was prepared
};

}  // namespace swivel
