// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <descartes_light/core/solver.h>

namespace descartes_light {

/// Adds up the costs of its evaluators in their order, until one refuses.
template <typename FloatT>
struct CompoundEdgeEvaluator : EdgeEvaluator<FloatT> {
  std::pair<bool, FloatT> evaluate(const State<FloatT>& from,
                                   const State<FloatT>& to) const override {
    FloatT sum{0};
    for (const auto& evaluator : evaluators) {
      const auto [valid, cost] = evaluator->evaluate(from, to);
      if (!valid) return {false, sum};
      sum += cost;
    }
    return {true, sum};
  }
  std::vector<typename EdgeEvaluator<FloatT>::ConstPtr> evaluators;
};

}  // namespace descartes_light
