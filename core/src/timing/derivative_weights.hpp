// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// Returns the weights of values at five places for the value and first three derivatives at x.
/// Source: Fornberg 1988.
inline Eigen::Matrix<double, 5, 4> derivative_weights(const double* places, double x) {
  Eigen::Matrix<double, 5, 4> c = Eigen::Matrix<double, 5, 4>::Zero();
  double c1 = 1, c4 = places[0] - x;
  c(0, 0) = 1;
  for (int i = 1; i < 5; ++i) {
    const int orders = std::min(i, 3);
    double c2 = 1;
    const double c5 = c4;
    c4 = places[i] - x;
    for (int j = 0; j < i; ++j) {
      const double c3 = places[i] - places[j];
      c2 *= c3;
      if (j == i - 1) {
        for (int k = orders; k >= 1; --k)
          c(i, k) = c1 * (k * c(i - 1, k - 1) - c5 * c(i - 1, k)) / c2;
        c(i, 0) = -c1 * c5 * c(i - 1, 0) / c2;
      }
      for (int k = orders; k >= 1; --k) c(j, k) = (c4 * c(j, k) - k * c(j, k - 1)) / c3;
      c(j, 0) = c4 * c(j, 0) / c3;
    }
    c1 = c2;
  }
  return c;
}

}  // namespace swivel
