// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cost_to_go/kernels/relax.hpp"
#include "swivel/core/base/angle.hpp"
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

/// Where nodes lie, by blocks: RelaxTask::block_middle and block_radius, rad, by joint.
struct RelaxBlocks {
  std::array<std::vector<double>, kDof> middle, radius;
};
/// Returns the blocks of nodes with these joints.
inline RelaxBlocks relax_blocks(const Lattice& lattice,
                                const std::array<std::vector<double>, kDof>& joints) {
  constexpr std::size_t kBlock = RelaxTask<double>::kBlock;
  RelaxBlocks blocks;
  for (std::size_t k = 0; k < kDof; ++k) {
    const std::vector<double>& joint = joints[k];
    for (std::size_t first = 0; first < joint.size(); first += kBlock) {
      double low = 0, high = 0;
      for (std::size_t at = first; at < std::min(joint.size(), first + kBlock); ++at) {
        double step = joint[at] - joint[first];
        if (lattice.continuous()[k] && std::abs(step) > kPi) step = wrap_angle(step);
        low = std::min(low, step);
        high = std::max(high, step);
      }
      blocks.middle[k].push_back(joint[first] + (low + high) / 2);
      blocks.radius[k].push_back((high - low) / 2);
    }
  }
  return blocks;
}

}  // namespace swivel
