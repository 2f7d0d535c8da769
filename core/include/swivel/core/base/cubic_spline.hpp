// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

namespace swivel {

/// A natural cubic spline: twice continuously differentiable, with no curvature at its ends, and
/// continued in a straight line beyond them.
class CubicSpline {
 public:
  /// Interpolates the values y at the places x, of which there must be at least two, strictly
  /// ascending.
  CubicSpline(std::vector<double> x, std::vector<double> y);
  /// Returns the spline's value at any place.
  [[nodiscard]] double at(double x) const;

 private:
  std::vector<double> x_, y_, bend_;  // bend_: second derivatives at x_
};

}  // namespace swivel
