// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/cubic_spline.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace swivel {

CubicSpline::CubicSpline(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), bend_(x_.size(), 0) {
  // Continuity of the first derivative, h0 m0 + 2 (h0 + h1) m1 + h1 m2 = 6 (slope1 - slope0), by
  // elimination; m = 0 at both ends.
  std::vector<double> above(x_.size(), 0);
  for (std::size_t k = 1; k + 1 < x_.size(); ++k) {
    const double h0 = x_[k] - x_[k - 1], h1 = x_[k + 1] - x_[k];
    const double pivot = 2 * (h0 + h1) - h0 * above[k - 1];
    above[k] = h1 / pivot;
    bend_[k] =
        (6 * ((y_[k + 1] - y_[k]) / h1 - (y_[k] - y_[k - 1]) / h0) - h0 * bend_[k - 1]) / pivot;
  }
  for (std::size_t k = x_.size() - 1; k-- > 1;) bend_[k] -= above[k] * bend_[k + 1];
}

double CubicSpline::at(double x) const {
  const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto k = static_cast<std::size_t>(after - x_.begin()) - 1;
  const double h = x_[k + 1] - x_[k], u = x - x_[k], v = x_[k + 1] - x;
  const double slope = (y_[k + 1] - y_[k]) / h;
  if (u < 0) return y_[k] + u * (slope - h * bend_[k + 1] / 6);
  if (v < 0) return y_[k + 1] - v * (slope + h * bend_[k] / 6);
  return (y_[k] * v + y_[k + 1] * u) / h + bend_[k] / 6 * v * (v * v / h - h) +
         bend_[k + 1] / 6 * u * (u * u / h - h);
}

}  // namespace swivel
