// SPDX-License-Identifier: BSD-3-Clause
#include "grid_cost_to_go.hpp"

#include <algorithm>
#include <cstring>

#include "grid_parts.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

/// f(0) ... f(count - 1), count <= whole; a loop of known length is unrolled into vectors.
template <int whole, class F>
void each(int count, const F& f) {
  if (count == whole)
    for (int k = 0; k < whole; ++k) f(k);
  else
    for (int k = 0; k < count; ++k) f(k);
}

}  // namespace

GridCostToGo::GridCostToGo(const SrsLattice& lattice, Extent extent, const Budget& budget, GridCostToGo* retired)
    : CostToGo(lattice, budget), lattice_(&lattice), bounded_(extent == Extent::kBounded) {
  if (retired) {
    cell_ = std::move(retired->cell_);
    cells_ = std::move(retired->cells_);
    cells_.clear();
    spares_ = std::move(retired->spares_);
    for (auto& joints : retired->cache_)
      if (joints) spares_.push_back(std::move(joints));
  }
  cell_.assign(static_cast<std::size_t>(lattice.layers()) * static_cast<std::size_t>(lattice.labels() * chunks()), 0);
  cells_.emplace_back().fill(kUnreachable);
  const std::size_t marks = mark(lattice.labels(), 0);
  for (auto& block : block_) {
    block = std::make_unique<Block>();
    block->row.resize(static_cast<std::size_t>(lattice.width()));
    block->near.resize(marks);
    block->value.assign(static_cast<std::size_t>(lattice.labels() * (lattice.angles() + 2 * lattice.window())), kUnreachable);
  }
}

void GridCostToGo::bar(Block& block) const {
  const int n = lattice_->angles(), window = lattice_->window();
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const int slot = part.label * n + part.begin(), at = window + part.begin(), count = part.end(n) - part.begin();
    double* const values = block.row.data() + slot;
    const double* one = block.nodes().bar(part.label, 0) + at;
    const double* other = block.nodes().bar(part.label, 1) + at;
    each<kChunk>(count, [&](int k) { values[k] += one[k] + other[k]; });
    const Verdict* verdict = verdicts_.nodes(block.layer, slot);
    if (std::memchr(verdict, static_cast<int>(Verdict::kRemoved), static_cast<std::size_t>(count)))
      each<kChunk>(count, [&](int k) {
        if (verdict[k] == Verdict::kRemoved) values[k] = kUnreachable;
      });
  }
}

void GridCostToGo::cut(Block& block) const {
  if (limit_ == kUnreachable) return;
  const int n = lattice_->angles();
  const float* bound = chords_->row(block.layer);
  for (const Part& part : block.parts) {
    if (!part.live) continue;
    const int slot = part.label * n + part.begin(), count = part.end(n) - part.begin();
    double* const values = block.row.data() + slot;
    if (const float* before = bound ? bound + slot : nullptr)
      each<kChunk>(count, [&](int k) { values[k] = values[k] + before[k] > limit_ ? kUnreachable : values[k]; });
    else
      each<kChunk>(count, [&](int k) { values[k] = values[k] > limit_ ? kUnreachable : values[k]; });
  }
}

void GridCostToGo::store(const Block& block) {
  const int n = lattice_->angles();
  for (const Part& part : block.parts) {
    cell_[cell_index(block.layer, part.label, part.chunk)] = static_cast<std::uint32_t>(cells_.size());
    Cell& cell = cells_.emplace_back();
    const double* row = block.row.data() + static_cast<std::ptrdiff_t>(part.label) * n;
    std::fill(std::copy(row + part.begin(), row + part.end(n), cell.begin()), cell.end(), kUnreachable);
  }
}

void GridCostToGo::load(int layer, const Marks& columns, Block& block) {
  clear(layer, block);
  const int n = lattice_->angles();
  for (int label = 0; label < lattice_->labels(); ++label)
    for (int chunk = 0; chunk < chunks(); ++chunk) {
      const std::uint32_t cell = columns[static_cast<std::size_t>(chunk)] ? cell_[cell_index(layer, label, chunk)] : 0;
      if (cell == 0) continue;
      want(*block.joints, lattice_->family_of(label), chunk, chunk + 1);
      const Part& part = block.parts.emplace_back(Part{label, chunk, true});
      std::copy_n(cells_[cell].begin(), part.end(n) - part.begin(),
                  block.row.begin() + static_cast<std::ptrdiff_t>(label) * n + part.begin());
    }
  settle(block);
}

GridCostToGo::~GridCostToGo() = default;

void GridCostToGo::save() {
  saved_ = {goal_, limit_, cell_, cells_};
}

void GridCostToGo::restore() {
  goal_ = saved_.goal;
  limit_ = saved_.limit;
  cell_ = saved_.cell;
  cells_ = saved_.cells;
}

void GridCostToGo::compute(int goal_layer) {
  limit_ = kUnreachable;
  bool hopeless = false;
  for (int layer = 0; layer <= goal_ && !hopeless; ++layer) hopeless = !lattice_->alive(layer);
  if (!hopeless && bounded_ && goal_layer == lattice_->layers() - 1) {
    if (!chords_) {
      chords_ = std::make_unique<ChordBound>(*lattice_, budget_);
      ik_nodes_ += chords_->ik_nodes();
    }
    hopeless = chords_->best() == kUnreachable;
    if (!hopeless) raise_limit();
  }
  if (hopeless) return forget();
  sweep_once();
  make_exact();
}

void GridCostToGo::raise_limit() {
  if (chords_->row(0)) {
    const double least = chords_->best(), found = limit_ == kUnreachable ? kUnreachable : best();
    const double passed = limit_ == kUnreachable ? -1 : limit_;
    for (const double share : {0.01, 0.2, 1.5}) {  // most problems stop at the first: 1 to 5 % of the lattice
      limit_ = least * (1 + share);
      if (limit_ > passed && (found == kUnreachable || found <= limit_)) return;
    }
  }
  limit_ = kUnreachable;
}

void GridCostToGo::make_exact() {
  while (limit_ != kUnreachable && !(best() <= limit_)) {
    raise_limit();
    sweep_once();
  }
}

void GridCostToGo::start_from(int layer, Block& block) {
  clear(layer, block);
  std::fill(block.row.begin(), block.row.end(), 0.0);
  for (int label = 0; label < lattice_->labels(); ++label) {
    if (!block.nodes().alive(label)) continue;
    want(*block.joints, lattice_->family_of(label), 0, chunks());
    for (int chunk = 0; chunk < chunks(); ++chunk) block.parts.push_back({label, chunk, true});
  }
  bar(block);
}

void GridCostToGo::forget() {
  verdicts_.pending.clear();
  std::fill(cell_.begin(), cell_.end(), 0U);
  cells_.resize(1);
}

void GridCostToGo::sweep_once() {
  const Span span("sweep");
  forget();
  Block* next = block_[0].get();
  Block* here = block_[1].get();
  start_from(goal_, *next);
  add_costs(*next);
  cut(*next);
  settle(*next);
  store(*next);
  for (int layer = goal_ - 1; layer >= 0 && !next->labels.empty(); --layer) {
    if (layer == 0 && lattice_->has_start()) {
      const double value = relax_one(0, lattice_->start_slot());
      if (value <= limit_) cell_value(0, lattice_->start_slot()) = value;
      break;
    }
    budget_.tell(Stage::kSweep, goal_ - layer, goal_);
    clear(layer, *here);
    mark_reach(layer, *next, *here);
    relax(layer, *here, *next);
    bar(*here);
    add_costs(*here);
    relax_removed(*here);
    cut(*here);
    settle(*here);
    store(*here);
    std::swap(here, next);
  }
}

double GridCostToGo::best() const {
  double best = kUnreachable;
  for (std::size_t k = 0; k < mark(lattice_->labels(), 0); ++k)
    if (cell_[k] != 0)
      for (const double value : cells_[cell_[k]]) best = std::min(best, value);
  return best;
}

}  // namespace swivel
