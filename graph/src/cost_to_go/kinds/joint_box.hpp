// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cost_to_go/kernels/relax.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/config.hpp"

namespace swivel {

/// Where the joints of some nodes lie, rad, each on the circle if it is continuous.
class JointBox {
 public:
  [[nodiscard]] bool empty() const { return empty_; }
  /// Makes room for joints that joint(k) returns, k = 0 ... 6. `turn`: 2 pi for continuous joints,
  /// else 0.
  template <class Joint>
  void add(const Joint& joint, const double (&turn)[kDof]) {
    constexpr double kRounding = 1e-9;  // rad: far above that of a few operations on angles
    for (std::size_t k = 0; k < kDof; ++k) {
      const double q = joint(static_cast<int>(k));
      if (empty_) {
        middle_[k] = q, radius_[k] = kRounding;
        continue;
      }
      const double step = between(middle_[k], q, turn[k]), out = std::abs(step) - radius_[k];
      if (out <= 0) continue;
      middle_[k] += step > 0 ? out / 2 : -out / 2;
      radius_[k] += out / 2 + kRounding;
    }
    empty_ = false;
  }
  /// Returns false where every move from joints in this box to joints in another costs at least
  /// `cost`, or takes a joint beyond its largest move.
  [[nodiscard]] bool may_cost_less(const JointBox& other, const RelaxTask<double>& task,
                                   double cost) const {
    const double room = cost * (1 + 1e-12) + 1e-11 * task.unit;  // costs are rounded
    const bool squares = task.metric == RelaxMetric::kL2,
               most_of_all = task.metric == RelaxMetric::kMax;
    const double most = squares ? room * room : room;
    double sum = 0;
    for (std::size_t k = kDof; k-- > 0;) {  // the last joints move most
      const double apart = std::abs(between(middle_[k], other.middle_[k], task.turn[k])) -
                           radius_[k] - other.radius_[k];
      if (apart <= 0) continue;
      const double x = task.scale[k] * apart;
      sum = most_of_all ? std::max(sum, x) : sum + (squares ? x * x : x);
      if (apart > task.bound[k] || sum > most) return false;
    }
    return true;
  }

 private:
  static double between(double from, double to, double turn) {
    const double step = to - from;
    return turn > 0 && std::abs(step) > kPi ? wrap_angle(step) : step;
  }
  std::array<double, kDof> middle_{}, radius_{};
  bool empty_ = true;
};

}  // namespace swivel
