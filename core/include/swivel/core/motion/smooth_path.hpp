// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/motion/layer_solver.hpp"

namespace swivel {

/// The objective of smooth_minimum(): sum |W dq_i|_p + sum roll_i |rho_i| + bending sum h_i
/// |q''_i|^2 + 1e3 sum max(0, |dx_i| - most_change)^2, where |r|_p = (sum |r_j|^p)^(1/p), rho_i is
/// the last joint or the coordinate in (-pi, pi], q'' the second divided difference of the joints
/// over the travel, h the mean of the steps on both sides, x the coordinates.
struct SmoothObjective {
  /// the diagonal of W, by joint
  std::array<double, kDof> weights{};
  /// p: 1, or even; a large one approximates the largest |r_j|
  int power = 2;
  double bending = 0;      ///< m^3
  double most_change = 0;  ///< most change of the coordinate from a layer to the next, rad
  /// Layers from which the joints jump to the next: bends across such a step do not count.
  std::vector<int> jumps = {};
  std::vector<double> roll = {};  ///< cost of the roll per rad, by layer; empty: none
  /// true: the roll is the coordinate; false: it is the last joint
  bool roll_is_coordinate = false;
};
/// Returns the objective at coordinates x, infinite where a layer has no joints.
[[nodiscard]] double smooth_cost(const LayerSolver& solver, const SmoothObjective& objective,
                                 const std::vector<double>& x);

/// The range of one layer's coordinate, rad.
struct CoordinateBox {
  double low = 0, high = 0;
};
/// Returns coordinates, within their boxes, of a local minimum of the objective that is sought from
/// x on; it is never worse than x, brought into the boxes. Newton's method with derivatives by
/// central differences, a pentadiagonal Hessian, Levenberg's shift where it is not positive
/// definite, and bounds by a primal-dual active set (Hintermueller, Ito and Kunisch 2002). With
/// p = 1 the magnitudes |r_j| are rounded off, sqrt(r_j^2 + tip^2), by tips that shrink from 3e-2
/// to 3e-4 of the joints' mean move; each minimum is where the next one is sought from.
/// Deterministic. Throws Stopped.
[[nodiscard]] std::vector<double> smooth_minimum(const LayerSolver& solver,
                                                 const SmoothObjective& objective,
                                                 const std::vector<CoordinateBox>& boxes,
                                                 std::vector<double> x, const Budget& budget = {});

}  // namespace swivel
