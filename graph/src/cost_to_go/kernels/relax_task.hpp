// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "cost_to_go/kernels/relax.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// Returns the norm that a cost metric takes of weighted moves.
inline RelaxMetric relax_metric(CostMetric metric) {
  switch (metric) {
    case CostMetric::kL2:
      return RelaxMetric::kL2;
    case CostMetric::kL1:
      return RelaxMetric::kL1;
    case CostMetric::kMax:
    case CostMetric::kTime:
      break;
  }
  return RelaxMetric::kMax;
}

/// Returns a kernel's task with a lattice's metric and the joints' largest moves on a step; the
/// caller adds the runs of nodes.
inline RelaxTask<double> relax_task(const Lattice& lattice, int step) {
  RelaxTask<double> task;
  task.metric = relax_metric(lattice.cost().metric);
  task.wraps = false;
  const Config& bound = lattice.step_bound(step);
  for (int j = 0; j < kDof; ++j) {
    const bool turns = lattice.continuous()[static_cast<std::size_t>(j)];
    task.wraps |= turns;
    task.turn[j] = turns ? kTwoPi : 0;
    task.scale[j] = lattice.cost_scale()[static_cast<std::size_t>(j)];
    task.bound[j] = bound[j];
  }
  task.unit = lattice.cost_unit();
  return task;
}

}  // namespace swivel
