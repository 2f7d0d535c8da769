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

/// What the plan of a workcell found out about its arms, for those who draw or measure it. Valid
/// while the PreparedWorkcell of the plan lives; copies share what they refer to.
struct WorkcellView {
  /// The view of each arm with the path of the answer. Where there is no plan, the path is that of
  /// the arm by itself; an arm without one has the view of its own plan. Empty if the plan was
  /// stopped before there was an answer or a verdict.
  std::vector<PlanView> arms;
  /// The cheapest path of each arm by itself, slots of its lattice; empty where it has none.
  std::array<std::vector<int>, 2> alone;
  /// Where these paths have a conflict: the first region by which pairs of paths were divided.
  std::optional<RegionOfConflict> region;
  std::shared_ptr<const void> owner;  ///< of what the arms refer to, but the robots
};

}  // namespace swivel
