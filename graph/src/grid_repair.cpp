// SPDX-License-Identifier: BSD-3-Clause
// What remains of the lattice after removals: values made exact again, and how far layer 0 still reaches.
#include <algorithm>

#include "grid_parts.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

double& GridCostToGo::cell_value(int layer, int slot) {
  const int j = lattice_->angle_of(slot);
  std::uint32_t& cell = cell_[cell_index(layer, lattice_->label_of(slot), j / kChunk)];
  if (cell == 0) {
    cell = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back().fill(kUnreachable);
  }
  return cells_[cell][static_cast<std::size_t>(j % kChunk)];
}

/// Calls visit(b, rest, delta) for the nodes b of the next layer that lie in the window of a node and whose cost-to-go `rest` is
/// worth a look when its turn comes.
template <class Worth, class Visit>
void GridCostToGo::each_in_window(int layer, int slot, const Config& q, const Worth& worth, const Visit& visit) {
  const int n = lattice_->angles();
  const SrsLattice::Run run = lattice_->run_after(layer, slot);
  for (int family = 0; family < SrsLattice::kFamilies; ++family) {
    Nodes next;
    for (int label = 0; label < lattice_->labels(); ++label)
      for (int k = 0; lattice_->family_of(label) == family && k < run.count; ++k) {
        const int b = label * n + (run.first + k) % n;
        const double rest = at(layer + 1, b);
        if (!worth(rest)) continue;
        if (!next.nodes) {
          next = nodes(layer + 1, family, run.first, run.count, window_scratch_);
          solved_ = {layer + 1, family, run, next};
        }
        visit(b, rest, lattice_->delta(q, next.nodes->config(label, next.shift + k)));
      }
  }
}

double GridCostToGo::relax_one(int layer, int slot) {
  const int label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->family_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || verdicts_.node(layer, slot) == Verdict::kRemoved) return kUnreachable;
  double best = kUnreachable;
  each_in_window(
      layer, slot, here.nodes->config(label, here.shift), [&](double rest) { return rest < best; },
      [&](int b, double rest, const Config& delta) {
        ++edges_;
        const double value = lattice_->edge_cost(delta) + rest;
        if (value < best && lattice_->step_allowed(layer, delta) && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          best = value;
      });
  return verdicts_.cost(layer, slot) + best;
}

void GridCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const int n = lattice_->angles(), label = lattice_->label_of(slot);
  const int offset = (lattice_->angle_of(slot) - solved_.run.first + n) % n;
  const bool known = solved_.layer == layer && solved_.family == lattice_->family_of(label) && offset < solved_.run.count;
  const Config q = known ? solved_.nodes.nodes->config(label, solved_.nodes.shift + offset) : config(layer, slot);
  const double own = verdicts_.cost(layer, slot);
  out.clear();
  each_in_window(
      layer, slot, q, [&](double rest) { return rest != kUnreachable && rest <= bound; },
      [&](int b, double rest, const Config& delta) {
        if (!lattice_->step_allowed(layer, delta)) return;
        const double cost = lattice_->edge_cost(delta);
        if (own + (cost + rest) <= bound && verdicts_.edge(layer, slot, b) != Verdict::kRemoved) out.push_back({b, own + cost});
      });
}

void GridCostToGo::relax_removed(Block& block) {
  const auto* removed = verdicts_.removed_edges(block.layer);
  if (!removed) return;
  for (const auto& [a, edges] : removed->tails) {
    if (!block.find(lattice_->label_of(a), lattice_->angle_of(a) / kChunk)) continue;
    double& value = block.row[static_cast<std::size_t>(a)];
    const double own = verdicts_.cost(block.layer, a);
    const auto gives_value = [&](const Verdicts::HalfEdge& edge) {
      return own + (edge.cost + at(block.layer + 1, edge.other)) == value;
    };
    if (value != kUnreachable && std::any_of(edges.begin(), edges.end(), gives_value)) value = relax_one(block.layer, a);
  }
}

// --- removals and costs

void GridCostToGo::add_costs(Block& block) const {
  const double* own = verdicts_.costs(block.layer);
  if (!own) return;
  const int n = lattice_->angles();
  for (const Part& part : block.parts)
    for (int slot = part.label * n + part.begin(); slot < part.label * n + part.end(n); ++slot)
      block.row[static_cast<std::size_t>(slot)] += own[slot];
}

void GridCostToGo::compute_removals() {
  // Where one repair is needed more follow, so joints are worth keeping, for lattices that leave room for 40 bytes a node.
  constexpr std::int64_t kMostKept = 1'000'000;
  if (lattice_->nodes() <= kMostKept) cache_.resize(static_cast<std::size_t>(lattice_->layers()));
  repair_once();
  make_exact();
}

GridCostToGo::Marks GridCostToGo::widened(const Marks& columns) const {
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

void GridCostToGo::repair_once() {
  const Span span("repair");
  const int n = lattice_->angles();
  Marks changed(static_cast<std::size_t>(chunks()), 0), here_changed(changed.size());  // columns, of any label
  bool any = false;
  Block* next = block_[0].get();
  Block* here = block_[1].get();
  while (!verdicts_.pending.empty() && verdicts_.pending.rbegin()->first > goal_)
    verdicts_.pending.erase(std::prev(verdicts_.pending.end()));
  for (int layer = verdicts_.pending.empty() ? -1 : verdicts_.pending.rbegin()->first; layer >= 0; --layer) {
    std::fill(here_changed.begin(), here_changed.end(), std::uint8_t{0});
    bool here_any = false;
    const auto set = [&](int slot, double value) {
      double& cell = cell_value(layer, slot);
      if (cell == value) return;
      cell = value;
      here_changed[static_cast<std::size_t>(lattice_->angle_of(slot) / kChunk)] = 1;
      here_any = true;
    };
    const auto pending = verdicts_.pending.find(layer);
    // Nodes now cost what they cost first, with the layer after as it was; where that changed, too, they are relaxed next.
    if (pending != verdicts_.pending.end())
      for (const int slot : pending->second.raised)
        if (const double value = at(layer, slot); value != kUnreachable) set(slot, verdicts_.cost(layer, slot) + value);
    if (any && layer == 0 && lattice_->has_start()) {
      if (at(0, lattice_->start_slot()) != kUnreachable) set(lattice_->start_slot(), relax_one(0, lattice_->start_slot()));
    } else if (any) {
      const Marks dependent = widened(changed);
      load(layer + 1, widened(dependent), *next);
      load(layer, dependent, *here);
      relax(layer, *here, *next);
      bar(*here);
      add_costs(*here);
      relax_removed(*here);
      cut(*here);
      for (const Part& part : here->parts)
        for (int slot = part.label * n + part.begin(); slot < part.label * n + part.end(n); ++slot)
          set(slot, here->row[static_cast<std::size_t>(slot)]);
    }
    std::swap(here, next);  // its joints serve once more
    if (pending != verdicts_.pending.end()) {
      for (const int slot : pending->second.nodes)
        if (at(layer, slot) != kUnreachable) set(slot, kUnreachable);
      for (const int slot : pending->second.tails) {
        budget_.poll();
        if (layer < goal_ && at(layer, slot) != kUnreachable) set(slot, relax_one(layer, slot));
      }
      verdicts_.pending.erase(pending);
    }
    changed.swap(here_changed);
    any = here_any;
    if (!any) {
      if (verdicts_.pending.empty()) break;
      layer = verdicts_.pending.rbegin()->first + 1;  // nothing to do until there
    }
  }
}

// --- reach

double GridCostToGo::relax_one_forward(int layer, int slot, const Block& before) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->family_of(label), lattice_->angle_of(slot), 1, scratch_);
  if (!here.nodes->valid(label, here.shift) || verdicts_.node(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const SrsLattice::Run run = lattice_->run_before(layer - 1, slot);
  double best = kUnreachable;
  for (const int other : before.labels)
    for (int k = 0; k < run.count; ++k) {
      const int j = (run.first + k) % n, a = other * n + j;
      const double done = before.value[static_cast<std::size_t>(other * length + lattice_->window() + j)];
      if (done >= best) continue;
      const Config delta = lattice_->delta(config(layer - 1, a), q);
      const double value = lattice_->edge_cost(delta) + done;
      if (value < best && lattice_->step_allowed(layer - 1, delta) && verdicts_.edge(layer - 1, a, slot) != Verdict::kRemoved)
        best = value;
    }
  return best;
}

int GridCostToGo::deepest_reachable() {
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
      want(*here->joints, lattice_->family_of(part.label), part.chunk, part.chunk + 1);
      row[lattice_->angle_of(slot)] = relax_one_forward(layer, slot, *before);
    };
    const auto reaches = [&](const Verdicts::HalfEdge& edge, double value) {
      const int n_padded = n + 2 * lattice_->window(), label = lattice_->label_of(edge.other);
      const int place = label * n_padded + lattice_->window() + lattice_->angle_of(edge.other);
      return edge.cost + before->value[static_cast<std::size_t>(place)] == value;
    };
    if (layer == 1 && lattice_->has_start()) {
      const SrsLattice::Run run = lattice_->run_after(0, lattice_->start_slot());
      for (int label = 0; label < lattice_->labels(); ++label)
        for (int k = 0; k < run.count; ++k) step_one(label * n + (run.first + k) % n);
    } else {
      mark_reach(layer - 1, *before, *here);
      relax(layer - 1, *here, *before);
      bar(*here);
      if (const auto* removed = verdicts_.removed_edges(layer - 1))
        for (const auto& [b, edges] : removed->heads)
          if (here->find(lattice_->label_of(b), lattice_->angle_of(b) / kChunk) &&
              std::any_of(edges.begin(), edges.end(),
                          [&](const Verdicts::HalfEdge& edge) { return reaches(edge, here->row[static_cast<std::size_t>(b)]); }))
            step_one(b);
    }
    settle(*here);
    if (here->labels.empty()) break;
    std::swap(before, here);
  }
  return layer - 1;
}

}  // namespace swivel
