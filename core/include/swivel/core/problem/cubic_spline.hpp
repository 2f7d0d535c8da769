// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

namespace swivel {

/// The natural cubic spline through values at ascending places: twice continuously differentiable, straight beyond its ends.
class CubicSpline {
 public:
  /// At least two places, strictly ascending.
  CubicSpline(std::vector<double> x, std::vector<double> y);
  [[nodiscard]] double at(double x) const;

 private:
  std::vector<double> x_, y_, bend_;  // bend: second derivatives
};

}  // namespace swivel
