// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/core/answer/refined.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

class PreparedRobot;
struct Problem;

struct RefineOptions {
  /// Try as well from a path of a lattice that is coarse along the path and fine in the arm angle, and keep the cheaper.
  bool second_seed = true;
  /// m, kept besides the clearance at layers, as far as the path given does: optima lie on the bound, and the motion between
  /// layers comes a little nearer.
  double extra_clearance = 0.1e-3;
  /// The caller's own rule, asked of layers and of the motions between them.
  std::shared_ptr<StateCheck> check = nullptr;  // shared: with the plan and its caller
};

/// Makes a valid path of the lattice cheaper and smoother: the arm angles of its layers, off the grid, branches and joint images
/// kept; of arms without one, the lengths along the self-motion from the joints given. Least is sum |W dq| + l^3 sum h |q''|^2, q''
/// the second divided difference over the travel and l = Refinement::smoothing; |r| is Euclid's, or (sum |r_j|^16)^(1/16) for
/// metrics of the largest move. By Newton's method (smooth_path.hpp). Nodes and motions are asked as the planners do, of the
/// optimum alone: where one fails, the layers' intervals shrink towards the path given, which is valid, and the optimum is sought
/// again.
///
/// The result is valid and never dearer by the problem's metric; else it is the path given, and the reason. A given start is kept.
/// `rows`: a trajectory of this problem that plan() found. Throws InputError and InvalidArgument as plan() does, and Stopped.
[[nodiscard]] Refined refine(const PreparedRobot& robot, const Problem& problem, const std::vector<TrajectoryRow>& rows,
                             const RefineOptions& options = {}, const Budget& budget = {});

}  // namespace swivel
