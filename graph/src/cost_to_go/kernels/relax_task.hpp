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

/// Joints of nodes, rad, [joint][node].
using NodeJoints = std::array<std::vector<double>, kDof>;
/// Where nodes lie, by blocks: RelaxTask::block_middle and block_radius, rad, by joint.
struct RelaxBlocks {
  NodeJoints middle, radius;
};
/// Returns the blocks of nodes with these joints.
inline RelaxBlocks relax_blocks(const Lattice& lattice, const NodeJoints& joints) {
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

/// Lowers `best`, one number for each node with joints `from`, to the least cost of a move that the
/// task allows to a node with joints `to`, and its `value`. `blocks`: relax_blocks() of `to`, or
/// null. `least_of_blocks` is scratch.
inline void relax_all_pairs(RelaxTask<double> task, const NodeJoints& from, const NodeJoints& to,
                            const RelaxBlocks* blocks, const std::vector<double>& value,
                            std::vector<double>& least_of_blocks, std::vector<double>& best) {
  if (value.empty() || from[0].empty()) return;
  task.n = static_cast<int>(from[0].size());
  task.offsets = static_cast<int>(value.size());
  for (std::size_t k = 0; k < kDof; ++k) {
    task.from[k] = from[k].data();
    task.to[k] = to[k].data();
    task.block_middle[k] = blocks ? blocks->middle[k].data() : nullptr;
    task.block_radius[k] = blocks ? blocks->radius[k].data() : nullptr;
  }
  if (blocks) {
    constexpr std::ptrdiff_t kBlock = RelaxTask<double>::kBlock;
    least_of_blocks.clear();
    for (auto first = value.begin(); first != value.end();) {
      const auto last = first + std::min(kBlock, value.end() - first);
      least_of_blocks.push_back(*std::min_element(first, last));
      first = last;
    }
    task.block_value = least_of_blocks.data();
  }
  task.value = value.data();
  task.best = best.data();
  relax_kernels().relax_all(task);
}

}  // namespace swivel
