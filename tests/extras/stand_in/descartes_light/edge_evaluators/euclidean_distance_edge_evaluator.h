// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <descartes_light/core/solver.h>

namespace descartes_light {

/// The square of the distance of two states, as the library has it.
template <typename FloatT>
struct EuclideanDistanceEdgeEvaluator : EdgeEvaluator<FloatT> {
  std::pair<bool, FloatT> evaluate(const State<FloatT>& from,
                                   const State<FloatT>& to) const override {
    return {true, (to.values - from.values).squaredNorm()};
  }
};

}  // namespace descartes_light
