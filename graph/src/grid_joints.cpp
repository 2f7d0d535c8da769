// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "grid_parts.hpp"

namespace swivel {

GridCostToGo::Joints& GridCostToGo::joints(int layer, Block& block) {
  Joints* joints = &block.own;
  if (!cache_.empty()) {
    auto& kept = cache_[static_cast<std::size_t>(layer)];
    if (!kept && !spares_.empty()) {
      kept = std::move(spares_.back());
      kept->layer = -1;
      spares_.pop_back();
    }
    if (!kept) kept = std::make_unique<Joints>();
    joints = kept.get();
  }
  if (joints->layer != layer) {
    const int n = lattice_->angles(), window = lattice_->window();
    joints->layer = layer;
    lattice_->lay_out(layer, (n - window % n) % n, n + 2 * window, joints->nodes);
    for (auto& solved : joints->solved) solved.assign(static_cast<std::size_t>(chunks()), 0);
    joints->of_chunk.resize(mark(lattice_->labels(), 0));
    joints->of_layer.assign(static_cast<std::size_t>(lattice_->labels()), {});
  }
  return *joints;
}

void GridCostToGo::want(Joints& joints, int family, int first, int last) {
  Marks& solved = joints.solved[static_cast<std::size_t>(family)];
  const int n = lattice_->angles(), window = lattice_->window();
  for (int chunk = first, next = first; chunk < last; chunk = next) {
    next = chunk + 1;
    if (solved[static_cast<std::size_t>(chunk)]) continue;
    while (next < last && !solved[static_cast<std::size_t>(next)]) ++next;
    std::fill(solved.begin() + chunk, solved.begin() + next, std::uint8_t{1});
    const int begin = chunk * kChunk, end = std::min(n, next * kChunk);
    ik_nodes_ += static_cast<std::int64_t>(end - begin) * lattice_->labels() / 2;
    lattice_->solve_part(family, window + begin, window + end, joints.nodes);
    for (int done = chunk; done < next; ++done) range(joints, family, done);
    // The window reaches around the circle.
    if (begin < window) joints.nodes.repeat(window + begin, window + begin + n, std::min(end, window) - begin);
    if (end > n - window) {
      const int from = std::max(begin, n - window);
      joints.nodes.repeat(window + from, window + from - n, end - from);
    }
  }
}

void GridCostToGo::range(Joints& joints, int family, int chunk) const {
  const int half = lattice_->labels() / 2, begin = lattice_->window() + chunk * kChunk;
  const int count = std::min(kChunk, lattice_->angles() - chunk * kChunk);
  for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) {
    const double* known = nullptr;  // labels share arrays
    Interval found;
    for (int label = family * half; label < (family + 1) * half; ++label) {
      const double* q = joints.nodes.q(label, Middles::kJoints[m]) + begin;
      if (q != known) found = Interval(q, count);
      known = q;
      joints.of_chunk[mark(label, chunk)].joint[m] = found;
      joints.of_layer[static_cast<std::size_t>(label)].joint[m].add(found);
    }
  }
}

GridCostToGo::Nodes GridCostToGo::nodes(int layer, int family, int first, int count, LayerNodes& scratch) {
  const int n = lattice_->angles();
  if (cache_.empty()) {
    if (n >= kChunk) count = (count + kChunk - 1) / kChunk * kChunk;  // whole vectors are quicker
    ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->labels() / 2;
    lattice_->lay_out(layer, first, count, scratch);
    lattice_->solve_part(family, 0, count, scratch);
    return {&scratch, 0};
  }
  Joints& kept = joints(layer, *block_[0]);
  for (int k = 0; k < count; ++k) {
    const int chunk = (first + k) % n / kChunk;
    want(kept, family, chunk, chunk + 1);
  }
  return {&kept.nodes, (first + lattice_->window()) % n};
}

Config GridCostToGo::config(int layer, int slot) {
  const int label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->family_of(label), lattice_->angle_of(slot), 1, scratch_);
  return here.nodes->config(label, here.shift);
}

}  // namespace swivel
