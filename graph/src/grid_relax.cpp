// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "grid_parts.hpp"
#include "kernels/relax.hpp"

namespace swivel {

void GridCostToGo::clear(int layer, Block& block) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window();
  for (const int label : block.labels) {
    const auto row = block.value.begin() + static_cast<std::ptrdiff_t>(label) * length;
    std::fill(row, row + length, kUnreachable);
  }
  block.labels.clear();
  block.layer = layer;
  block.joints = &joints(layer, block);
  block.parts.clear();
  for (Marks& reached : block.reached) reached.assign(static_cast<std::size_t>(chunks()), 0);
}

void GridCostToGo::mark_reach(int step_layer, const Block& to, Block& from) {
  for (int family = 0; family < SrsLattice::kFamilies; ++family) {
    const int first_label = family * lattice_->labels() / 2;
    if (!from.nodes().alive(first_label)) continue;  // all of a family's labels, or none
    const std::array<bool, 2> reaches{lattice_->families_may_connect(step_layer, from.layer, family, to.layer, 0),
                                      lattice_->families_may_connect(step_layer, from.layer, family, to.layer, 1)};
    columns_.clear();
    for (int chunk = 0; chunk < chunks(); ++chunk) {
      const auto c = static_cast<std::size_t>(chunk);
      if ((reaches[0] && to.reached[0][c]) || (reaches[1] && to.reached[1][c])) columns_.push_back(chunk);
    }
    for (std::size_t k = 0, next = 0; k < columns_.size(); k = next) {
      for (next = k + 1; next < columns_.size() && columns_[next] == columns_[next - 1] + 1;) ++next;
      want(*from.joints, family, columns_[k], columns_[next - 1] + 1);
    }
    for (int label = first_label; label < first_label + lattice_->labels() / 2; ++label)
      for (const int chunk : columns_) from.parts.push_back({label, chunk});
  }
}

bool GridCostToGo::may_meet(int step_layer, const Middles& a, const Middles& b) const {
  const Config& bound = lattice_->step_bound(step_layer);
  for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) {
    const int joint = Middles::kJoints[m];
    if (!lattice_->continuous()[static_cast<std::size_t>(joint)] && a.joint[m].gap(b.joint[m]) > bound[joint]) return false;
  }
  return true;
}

bool GridCostToGo::may_connect(int step_layer, const Block& from, int label, int chunk, const Block& to, int other) const {
  const Middles& own_middles = from.joints->of_chunk[mark(label, chunk)];
  if (!may_meet(step_layer, own_middles, to.joints->of_layer[static_cast<std::size_t>(other)])) return false;
  const Block::Near& near = to.near[mark(other, chunk)];
  const double* const value = to.value.data() + static_cast<std::ptrdiff_t>(other) * (lattice_->angles() + 2 * lattice_->window());
  const auto theirs = [&](int joint) { return Interval(to.nodes().q(other, joint), value, near.first, near.last + 1); };
  if (near.middles.joint[0].empty())
    for (std::size_t m = 0; m < Middles::kJoints.size(); ++m) near.middles.joint[m] = theirs(Middles::kJoints[m]);
  if (!may_meet(step_layer, own_middles, near.middles)) return false;
  // Near a singular pose the outer joints of the triple must meet as well. Joints of several turns tell windings apart. Continuous
  // joints have no plain interval.
  const int begin = lattice_->window() + chunk * kChunk, count = std::min(kChunk, lattice_->angles() - chunk * kChunk);
  const bool one_family = lattice_->family_of(label) == lattice_->family_of(other);
  for (const int joint : SrsLattice::kOuterJoints) {
    const bool shared = one_family && from.nodes().q(label, joint) == from.nodes().q(other, joint);  // tells nothing apart
    if (shared || lattice_->continuous()[static_cast<std::size_t>(joint)]) continue;
    const Interval own(from.nodes().q(label, joint) + begin, count);
    if (own.gap(theirs(joint)) > lattice_->step_bound(step_layer)[joint]) return false;
  }
  return true;
}

void GridCostToGo::relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other,
                             double* best) {
  const int window = lattice_->window(), length = lattice_->angles() + 2 * window;
  RelaxTask<double> task;
  task.n = count;
  task.offsets = 2 * window + 1;
  task.metric = lattice_->cost().metric == CostMetric::kL2 ? RelaxMetric::kL2 : RelaxMetric::kMax;
  task.wraps = false;
  const Config& bound = lattice_->step_bound(step_layer);
  for (int j = 0; j < kDof; ++j) {
    const bool turns = lattice_->continuous()[static_cast<std::size_t>(j)];
    task.wraps |= turns;
    task.turn[j] = turns ? kTwoPi : 0;
    task.scale[j] = lattice_->cost_scale()[static_cast<std::size_t>(j)];
    task.bound[j] = bound[j];
    task.from[j] = from.nodes().q(label, j) + window + first;
    task.to[j] = to.nodes().q(other, j) + first;
  }
  task.unit = lattice_->cost_unit();
  task.best = best;
  task.value = to.value.data() + static_cast<std::ptrdiff_t>(other) * length + first;
  edges_ += static_cast<std::int64_t>(count) * task.offsets;
  relax_kernels().relax(task);
}

void GridCostToGo::relax(int step_layer, Block& from, const Block& to) {
  const int n = lattice_->angles();
  for (const Part& part : from.parts) {
    double* const row = from.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    std::fill(row + part.begin(), row + part.end(n), kUnreachable);
  }
  for (std::size_t first = 0, last = 0; first < from.parts.size(); first = last) {
    budget_.poll();
    const int label = from.parts[first].label;
    while (last < from.parts.size() && from.parts[last].label == label) ++last;
    for (const int other : to.labels) {
      if (label != other && (!lattice_->families_may_connect(step_layer, from.layer, lattice_->family_of(label), to.layer,
                                                             lattice_->family_of(other)) ||
                             !may_meet(step_layer, from.joints->of_layer[static_cast<std::size_t>(label)],
                                       to.joints->of_layer[static_cast<std::size_t>(other)])))
        continue;
      int begin = 0, end = 0;  // a run of chunks
      const auto relax_chunks = [&] {
        if (begin == end) return;
        const int stop = std::min(n, end * kChunk), start = std::max(0, std::min(begin * kChunk, stop - kChunk));  // whole vectors
        relax_run(step_layer, from, label, start, stop - start, to, other, from.row.data() + label * n + start);
      };
      for (std::size_t k = first; k < last; ++k) {
        Part& part = from.parts[k];
        if (to.near[mark(other, part.chunk)].last < 0 ||
            (label != other && !may_connect(step_layer, from, label, part.chunk, to, other)))
          continue;
        part.live = true;
        if (part.chunk != end) {
          relax_chunks();
          begin = part.chunk;
        }
        end = part.chunk + 1;
      }
      relax_chunks();
    }
  }
}

void GridCostToGo::settle(Block& block) {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window;
  std::size_t kept = 0;
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const double* row = block.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    double* value = block.value.data() + static_cast<std::ptrdiff_t>(part.label) * length;
    Block::Near* near = block.near.data() + mark(part.label, 0);
    Marks& reached = block.reached[static_cast<std::size_t>(lattice_->family_of(part.label))];
    int first = part.begin(), last = part.end(n) - 1;
    while (first <= last && row[first] == kUnreachable) ++first;
    while (first <= last && row[last] == kUnreachable) --last;
    if (first > last) continue;
    block.parts[kept++] = part;
    if (block.labels.empty() || block.labels.back() != part.label) {
      std::fill(near, near + chunks(), Block::Near{length, -1, {}});
      block.labels.push_back(part.label);
    }
    std::copy(row + first, row + last + 1, value + window + first);
    for (const int turn : {0, n, -n}) {
      const int low = std::max(0, window + first + turn), high = std::min(length - 1, window + last + turn);
      if (low > high) continue;
      if (turn != 0) std::copy(row + low - window - turn, row + high - window - turn + 1, value + low);
      // The window of chunk c is at the padded positions c * kChunk ... c * kChunk + kChunk - 1 + 2 * window.
      const int begin = std::max(0, low - 2 * window) / kChunk, end = std::min(chunks() - 1, high / kChunk);
      for (int c = begin; c <= end; ++c) {
        near[c].first = std::min(near[c].first, std::max(low, c * kChunk));
        near[c].last = std::max(near[c].last, std::min(high, c * kChunk + kChunk - 1 + 2 * window));
        reached[static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  block.parts.resize(kept);
}

}  // namespace swivel
