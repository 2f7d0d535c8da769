// SPDX-License-Identifier: BSD-3-Clause
// What remains of the lattice after removals: values made exact again, and how far layer 0 still reaches.
#include <algorithm>

#include "layer_parts.hpp"
#include "swivel/core/timeline.hpp"
#include "swivel/graph/validity.hpp"

namespace swivel {

double& CostToGo::cell_value(int layer, int slot) {
  const int j = lattice_->angle_of(slot);
  std::uint32_t& cell = cell_[cell_index(layer, lattice_->label_of(slot), j / kChunk)];
  if (cell == 0) {
    cell = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back().fill(kUnreachable);
  }
  return cells_[cell][static_cast<std::size_t>(j % kChunk)];
}

double CostToGo::relax_one(int layer, int slot) {
  const int n = lattice_->angles(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->elbow_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->successors(layer, slot);
  double best = kUnreachable;
  for (int elbow = 0; elbow < 2; ++elbow) {
    Nodes next;
    for (int other = 0; other < lattice_->labels(); ++other)
      for (int k = 0; lattice_->elbow_of(other) == elbow && k < run.count; ++k) {
        const int b = other * n + (run.first + k) % n;
        const double rest = at(layer + 1, b);
        if (rest >= best) continue;
        if (!next.nodes) next = nodes(layer + 1, elbow, run.first, run.count, scratch_);
        const Config delta = lattice_->delta(q, next.nodes->config(other, next.shift + k));
        ++edges_;
        const double value = lattice_->edge_cost(delta) + rest;
        if (value < best && lattice_->step_allowed(layer, delta) && edge_verdict(layer, slot, b) != Verdict::kRemoved) best = value;
      }
  }
  return best;
}

void CostToGo::relax_removed(Block& block) {
  const auto removed = removed_edges_.find(block.layer);
  if (removed == removed_edges_.end()) return;
  for (const auto& [a, edges] : removed->second.tails) {
    if (!block.find(lattice_->label_of(a), lattice_->angle_of(a) / kChunk)) continue;
    double& value = block.row[static_cast<std::size_t>(a)];
    const auto gives_value = [&](const HalfEdge& edge) { return edge.cost + at(block.layer + 1, edge.other) == value; };
    if (value != kUnreachable && std::any_of(edges.begin(), edges.end(), gives_value)) value = relax_one(block.layer, a);
  }
}

// --- removals

void CostToGo::remove_node(int layer, int slot) {
  verdict_[index(layer, slot)] = Verdict::kRemoved;
  ++removed_;
  pending_[layer].nodes.push_back(slot);
}

void CostToGo::remove_alike(int layer, int slot, std::uint8_t depends) {
  for_each_alike(*lattice_, slot, depends, [&](int other) {
    if (node_verdict(layer, other) != Verdict::kRemoved) remove_node(layer, other);
  });
}

Verdict CostToGo::edge_verdict(int layer, int a, int b) const {
  if (edge_verdict_.empty()) return Verdict::kUnknown;
  const auto found = edge_verdict_.find({static_cast<std::int64_t>(index(layer, a)), b});
  return found == edge_verdict_.end() ? Verdict::kUnknown : found->second;
}

void CostToGo::keep_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kValid;
}

void CostToGo::remove_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kRemoved;
  ++removed_;
  const double cost = lattice_->edge_cost(lattice_->delta(config(layer, a), config(layer + 1, b)));
  removed_edges_[layer].tails[a].push_back({b, cost});
  removed_edges_[layer].heads[b].push_back({a, cost});
  pending_[layer].tails.push_back(a);
}

void CostToGo::repair() {
  // Where one repair is needed more follow, so joints are worth keeping, for lattices that leave room for 40 bytes a node.
  constexpr std::int64_t kMostKept = 1'000'000;
  if (lattice_->nodes() <= kMostKept) cache_.resize(static_cast<std::size_t>(lattice_->layers()));
  repair_once();
  make_exact();
}

CostToGo::Marks CostToGo::widened(const Marks& columns) const {
  const int n = lattice_->angles(), window = lattice_->window();
  Marks result(columns.size(), 0);
  for (int c = 0; c < chunks(); ++c) {
    if (!columns[static_cast<std::size_t>(c)]) continue;
    const int first = c * kChunk - window, last = std::min(n, (c + 1) * kChunk) - 1 + window;
    if (last - first + 1 >= n) return Marks(columns.size(), 1);
    for (int j = first, next = 0; j <= last; j += next) {
      const int angle = j < 0 ? j + n : j >= n ? j - n : j, column = angle / kChunk;
      result[static_cast<std::size_t>(column)] = 1;
      next = std::min(n, (column + 1) * kChunk) - angle;
    }
  }
  return result;
}

void CostToGo::repair_once() {
  const Span span("repair");
  const int n = lattice_->angles();
  Marks changed(static_cast<std::size_t>(chunks()), 0), here_changed(changed.size());  // columns, of any label
  bool any = false;
  Block* next = block_[0].get();
  Block* here = block_[1].get();
  while (!pending_.empty() && pending_.rbegin()->first > goal_) pending_.erase(std::prev(pending_.end()));
  for (int layer = pending_.empty() ? -1 : pending_.rbegin()->first; layer >= 0; --layer) {
    std::fill(here_changed.begin(), here_changed.end(), std::uint8_t{0});
    bool here_any = false;
    const auto set = [&](int slot, double value) {
      double& cell = cell_value(layer, slot);
      if (cell == value) return;
      cell = value;
      here_changed[static_cast<std::size_t>(lattice_->angle_of(slot) / kChunk)] = 1;
      here_any = true;
    };
    if (any && layer == 0 && lattice_->has_start()) {
      if (at(0, lattice_->start_slot()) != kUnreachable) set(lattice_->start_slot(), relax_one(0, lattice_->start_slot()));
    } else if (any) {
      const Marks dependent = widened(changed);
      load(layer + 1, widened(dependent), *next);
      load(layer, dependent, *here);
      relax(layer, *here, *next);
      bar(*here);
      relax_removed(*here);
      cut(*here);
      for (const Part& part : here->parts)
        for (int slot = part.label * n + part.begin(); slot < part.label * n + part.end(n); ++slot)
          set(slot, here->row[static_cast<std::size_t>(slot)]);
    }
    std::swap(here, next);  // its joints serve once more
    const auto pending = pending_.find(layer);
    if (pending != pending_.end()) {
      for (const int slot : pending->second.nodes)
        if (at(layer, slot) != kUnreachable) set(slot, kUnreachable);
      for (const int slot : pending->second.tails) {
        budget_.poll();
        if (layer < goal_ && at(layer, slot) != kUnreachable) set(slot, relax_one(layer, slot));
      }
      pending_.erase(pending);
    }
    changed.swap(here_changed);
    any = here_any;
    if (!any) {
      if (pending_.empty()) break;
      layer = pending_.rbegin()->first + 1;  // nothing to do until there
    }
  }
}

// --- reach

double CostToGo::relax_one_forward(int layer, int slot, const Block& before) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->elbow_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->predecessors(layer - 1, slot);
  double best = kUnreachable;
  for (const int other : before.labels)
    for (int k = 0; k < run.count; ++k) {
      const int j = (run.first + k) % n, a = other * n + j;
      const double done = before.value[static_cast<std::size_t>(other * length + lattice_->window() + j)];
      if (done >= best) continue;
      const Config delta = lattice_->delta(config(layer - 1, a), q);
      const double value = lattice_->edge_cost(delta) + done;
      if (value < best && lattice_->step_allowed(layer - 1, delta) && edge_verdict(layer - 1, a, slot) != Verdict::kRemoved)
        best = value;
    }
  return best;
}

int CostToGo::deepest_reachable() {
  const Span span("reach");
  const int n = lattice_->angles();
  Block* before = block_[0].get();
  Block* here = block_[1].get();
  start_from(0, *before);
  settle(*before);
  if (before->labels.empty()) return -1;
  int layer = 1;
  for (; layer < lattice_->layers(); ++layer) {
    clear(layer, *here);
    const auto step_one = [&](int slot) {
      const Part part{lattice_->label_of(slot), lattice_->angle_of(slot) / kChunk, true};
      double* row = here->row.data() + part.label * n;
      const auto place = std::lower_bound(here->parts.begin(), here->parts.end(), part);
      if (place == here->parts.end() || *place != part) {
        std::fill(row + part.begin(), row + part.end(n), kUnreachable);
        here->parts.insert(place, part);
      }
      want(*here->joints, lattice_->elbow_of(part.label), part.chunk, part.chunk + 1);
      row[lattice_->angle_of(slot)] = relax_one_forward(layer, slot, *before);
    };
    const auto reaches = [&](const HalfEdge& edge, double value) {
      const int n_padded = n + 2 * lattice_->window(), label = lattice_->label_of(edge.other);
      const int place = label * n_padded + lattice_->window() + lattice_->angle_of(edge.other);
      return edge.cost + before->value[static_cast<std::size_t>(place)] == value;
    };
    if (layer == 1 && lattice_->has_start()) {
      const Lattice::Run run = lattice_->successors(0, lattice_->start_slot());
      for (int label = 0; label < lattice_->labels(); ++label)
        for (int k = 0; k < run.count; ++k) step_one(label * n + (run.first + k) % n);
    } else {
      mark_reach(layer - 1, *before, *here);
      relax(layer - 1, *here, *before);
      bar(*here);
      const auto removed = removed_edges_.find(layer - 1);
      if (removed != removed_edges_.end())
        for (const auto& [b, edges] : removed->second.heads)
          if (here->find(lattice_->label_of(b), lattice_->angle_of(b) / kChunk) &&
              std::any_of(edges.begin(), edges.end(),
                          [&](const HalfEdge& edge) { return reaches(edge, here->row[static_cast<std::size_t>(b)]); }))
            step_one(b);
    }
    settle(*here);
    if (here->labels.empty()) break;
    std::swap(before, here);
  }
  return layer - 1;
}

}  // namespace swivel
