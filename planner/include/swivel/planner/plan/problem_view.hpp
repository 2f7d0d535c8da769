// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "swivel/planner/plan/plan_view.hpp"

namespace swivel {

/// Where two arms bar each other: nodes of a layer of either arm, of which no two keep clear; or,
/// of motions, the nodes from which and to which they lead.
struct RegionOfConflict {
  int layer = 0;
  std::array<std::vector<int>, 2> slots;  ///< of either arm's lattice, in the layer
  std::array<std::vector<int>, 2> next;   ///< of motions: in the next layer; else empty
};

/// What the plan of a problem found out about its runs, for those who draw or measure it. Valid
/// while what was prepared for the plan lives (PreparedRobot, PreparedWorkcell); copies share what
/// they refer to.
struct ProblemView {
  /// The views of the runs in the order of ArmAnswer::runs; of two arms, of both. The path of each
  /// is that of the answer. Where there is none, a run without a path by itself has the view of its
  /// own plan; another run of strokes has an empty path, and an arm of two that of the arm by
  /// itself. Empty if the plan was stopped before there was an answer or a verdict.
  std::vector<PlanView> runs;
  /// Of two arms: the cheapest path of each by itself, slots of its lattice; empty where it has
  /// none.
  std::array<std::vector<int>, 2> alone;
  /// Of two arms: where these paths have a conflict, the first region by which pairs of paths were
  /// divided.
  std::optional<RegionOfConflict> region;
  std::shared_ptr<const void> owner;  ///< of what the runs refer to, but what was prepared
};

}  // namespace swivel
