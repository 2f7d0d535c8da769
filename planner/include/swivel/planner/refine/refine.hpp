// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/core/answer/refined.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

class PreparedRobot;
struct PathProblem;

/// What rows must keep besides the problem's own rules, layer by layer.
class LayerCheck {
 public:
  virtual ~LayerCheck() = default;
  /// Returns whether the arm may be at joints q (rad) at a layer, with so much more clearance than
  /// must be kept (m).
  [[nodiscard]] virtual bool node(int layer, const Config& q, double extra) = 0;
  /// Returns whether it may move from joints at a layer to others at the next, straight in joint
  /// space.
  [[nodiscard]] virtual bool edge(int layer, const Config& from, const Config& to) = 0;
};

/// Options of refine().
struct RefineOptions {
  /// Also refine a path of a lattice that is coarse along the path and fine in the arm angle, and
  /// keep the cheaper result.
  bool second_seed = true;
  /// With `second_seed` and an S-R-S arm: also refine paths through other basins of the cost, in
  /// any branch, and keep the cheapest result.
  bool other_basins = true;
  /// Clearance at layers in addition to what each pair must keep, m, except where the given path
  /// itself lacks it. Optima lie on the bound, and the motion between layers comes a little nearer.
  double extra_clearance = 0.1e-3;
  /// Whether the first row, and the last, stay as they are given. Those of a closed path do anyway.
  bool keeps_begin = false, keeps_end = false;
  /// The caller's own rule for states at layers and the motions between them, or null.
  std::shared_ptr<StateCheck> check = nullptr;  // shared: with the plan and its caller
  /// What else rows must keep, or null. The given rows keep it.
  LayerCheck* by_layer = nullptr;
};

/// Returns a cheaper and smoother path near a valid path of the lattice: the arm angles of its
/// layers leave the grid, while its branches and joint windings stay, unless a second seed or
/// another basin turns out cheaper (RefineOptions); for arms without an arm angle, the coordinate
/// is the length along the self-motion from the given joints. Minimises sum |W dq| + l^3 sum h
/// |q''|^2, where q'' is the second divided difference over the travel and l =
/// Refinement::smoothing; |r| is the norm of the metric, (sum |r_j|^16)^(1/16) for those of the
/// largest move. Uses Newton's method (smooth_path.hpp). Only the optimum's nodes and motions are
/// validated, as the planners do: if one fails, the intervals of its layers shrink towards the
/// given path, which is valid, and the optimum is sought again.
///
/// The result is valid and never dearer by the problem's metric; otherwise it is the given path,
/// with the reason. A given start and a given end stay. `rows` is a trajectory of this problem that
/// plan() found. Throws InputError and InvalidArgument as plan() does, and Stopped.
[[nodiscard]] Refined refine(const PreparedRobot& robot, const PathProblem& problem,
                             const std::vector<TrajectoryRow>& rows,
                             const RefineOptions& options = {}, const Budget& budget = {});

}  // namespace swivel
