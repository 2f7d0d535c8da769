// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>

#include "swivel/core/answer/cut.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

class PreparedRobot;
struct Problem;
struct PlanView;

/// Why a planner's problem has no path, as a certificate that check_cut() verifies: the fewest layers, as near to the path's end
/// as can be, that nothing leads through. `check`: the one that was planned with. Throws InvalidArgument where the last plan found
/// a path; Stopped.
[[nodiscard]] Cut find_cut(const PlanView& view, const Budget& budget = {}, const std::shared_ptr<StateCheck>& check = nullptr);

/// What a certificate proves, or what is wrong with it.
struct CutCheck {
  bool passed = false;
  std::string failure;                ///< one line: the first thing that is wrong, with layer and slot; empty where it passed
  std::array<double, 2> s{0, 0};      ///< m along the path: the layers that nothing leads through, first and last
  bool complete = true;               ///< all solutions of the arm are known; else the proof is about those that were found
  std::int64_t nodes = 0, edges = 0;  ///< witnesses asked
};

/// Verifies a certificate from the problem alone: makes the nodes of its layers again, asks every witness about every node and edge
/// that it is said to remove, by FCL without the planners' certificates, and that no other edge leads on. Knows nothing of
/// planners. Throws InputError where the problem is laid out otherwise (resolution, edges, layers); InvalidArgument as
/// check_trajectory(); Stopped.
[[nodiscard]] CutCheck check_cut(const PreparedRobot& robot, const Problem& problem, const Cut& cut, const Budget& budget = {},
                                 const std::shared_ptr<StateCheck>& check = nullptr);

}  // namespace swivel
