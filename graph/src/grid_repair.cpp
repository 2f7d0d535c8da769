// SPDX-License-Identifier: BSD-3-Clause
// What remains of the lattice after removals: values made exact again, and how far layer 0 still reaches.
#include <algorithm>
#include <cmath>
#include <limits>

#include "grid_tiles.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

double& GridCostToGo::value_at(int layer, int slot) {
  const int j = lattice_->angle_of(slot);
  return tiles_.hold(tile_index(layer, lattice_->sheet_of(slot), j / kTileWidth))[static_cast<std::size_t>(j % kTileWidth)];
}

/// Calls visit(b, rest, delta) for the nodes b of the next layer that lie in the window of a node and whose cost-to-go `rest` is
/// worth a look when its turn comes.
template <class Worth, class Visit>
void GridCostToGo::each_in_window(int layer, int slot, const Config& q, const Worth& worth, const Visit& visit) {
  const int n = lattice_->angles(), half = lattice_->sheets() / 2;
  const SrsLattice::Run run = lattice_->run_after(layer, slot);
  for (int family = 0; family < SrsLattice::kFamilies; ++family) {
    bool known = false;
    for (int sheet = family * half; sheet < (family + 1) * half; ++sheet)
      for (int k = 0, next = 0; k < run.count; k = next) {
        const int angle = (run.first + k) % n, column = angle / kTileWidth;
        next = std::min(run.count, k + std::min(n, (column + 1) * kTileWidth) - angle);
        const std::size_t tile = tile_index(layer + 1, sheet, column);
        if (!tiles_.holds(tile)) continue;
        const double* rest = tiles_[tile].data() + angle % kTileWidth;
        for (int j = k; j < next; ++j, ++rest) {
          if (!worth(*rest)) continue;
          if (!known) solve_window(layer + 1, family, run);
          known = true;
          visit(sheet * n + (run.first + j) % n, *rest, lattice_->delta(q, window_.nodes.config(sheet, j)));
        }
      }
  }
}

void GridCostToGo::solve_window(int layer, int family, const SrsLattice::Run& run) {
  int count = run.count;
  if (lattice_->angles() >= kTileWidth) count = (count + kTileWidth - 1) / kTileWidth * kTileWidth;  // whole vectors are quicker
  window_.layer = layer;
  window_.family = family;
  window_.run = run;
  ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->sheets() / 2;
  lattice_->lay_out(layer, run.first, count, window_.nodes);
  lattice_->solve_part(family, 0, count, window_.nodes);
}

double GridCostToGo::relax_one(int layer, int slot) {
  const OneNode here = one_node(layer, slot);
  if (!here.valid() || verdicts_.node(layer, slot) == Verdict::kRemoved) return kUnreachable;
  double best = kUnreachable;
  each_in_window(
      layer, slot, here.config(), [&](double rest) { return rest < best; },
      [&](int b, double rest, const Config& delta) {
        ++edges_;
        const double value = lattice_->edge_cost(delta) + rest;
        if (value < best && lattice_->step_allowed(layer, delta) && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          best = value;
      });
  return verdicts_.cost(layer, slot) + best;
}

void GridCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const int n = lattice_->angles(), sheet = lattice_->sheet_of(slot);
  const int offset = (lattice_->angle_of(slot) - window_.run.first + n) % n;
  const bool known = window_.layer == layer && window_.family == lattice_->family_of(sheet) && offset < window_.run.count;
  const Config q = known ? window_.nodes.config(sheet, offset) : config(layer, slot);
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

void GridCostToGo::relax_removed(Workspace& workspace) {
  const auto* removed = verdicts_.removed_edges(workspace.layer);
  if (!removed) return;
  for (const auto& [a, edges] : removed->tails) {
    if (!workspace.find(lattice_->sheet_of(a), lattice_->angle_of(a) / kTileWidth)) continue;
    double& value = workspace.row[static_cast<std::size_t>(a)];
    const double own = verdicts_.cost(workspace.layer, a);
    const auto gives_value = [&](const Verdicts::HalfEdge& edge) {
      return own + (edge.cost + at(workspace.layer + 1, edge.other)) == value;
    };
    if (value != kUnreachable && std::any_of(edges.begin(), edges.end(), gives_value)) value = relax_one(workspace.layer, a);
  }
}

// --- removals and costs

void GridCostToGo::add_node_costs(Workspace& workspace) const {
  const double* own = verdicts_.costs(workspace.layer);
  if (!own) return;
  const int n = lattice_->angles();
  for (const Tile& tile : workspace.tiles)
    for (int slot = tile.sheet * n + tile.begin(); slot < tile.sheet * n + tile.end(n); ++slot)
      workspace.row[static_cast<std::size_t>(slot)] += own[slot];
}

void GridCostToGo::compute_removals() {
  propagate_removals();
  raise_limit_until_exact();
}

GridCostToGo::ColumnSet GridCostToGo::widened(const ColumnSet& columns) const {
  const int n = lattice_->angles(), window = lattice_->window();
  ColumnSet result(columns.size(), 0);
  for (int c = 0; c < tile_columns(); ++c) {
    if (!columns[static_cast<std::size_t>(c)]) continue;
    const int first = c * kTileWidth - window, last = std::min(n, (c + 1) * kTileWidth) - 1 + window;
    if (last - first + 1 >= n) return ColumnSet(columns.size(), 1);
    for (int j = first, next = 0; j <= last; j += next) {
      const int angle = j < 0 ? j + n : j >= n ? j - n : j, column = angle / kTileWidth;
      result[static_cast<std::size_t>(column)] = 1;
      next = std::min(n, (column + 1) * kTileWidth) - angle;
    }
  }
  return result;
}

void GridCostToGo::propagate_removals() {
  const TraceSpan span("repair");
  forget_joints();
  const int n = lattice_->angles();
  ColumnSet changed(static_cast<std::size_t>(tile_columns()), 0), here_changed(changed.size());  // columns, of any sheet
  bool any = false;
  Workspace* next = workspace_[0].get();
  Workspace* here = workspace_[1].get();
  while (!verdicts_.pending.empty() && verdicts_.pending.rbegin()->first > goal_)
    verdicts_.pending.erase(std::prev(verdicts_.pending.end()));
  for (int layer = verdicts_.pending.empty() ? -1 : verdicts_.pending.rbegin()->first; layer >= 0; --layer) {
    std::fill(here_changed.begin(), here_changed.end(), std::uint8_t{0});
    bool here_any = false;
    const auto set = [&](int slot, double value) {
      if (at(layer, slot) == value) return;
      value_at(layer, slot) = value;
      here_changed[static_cast<std::size_t>(lattice_->angle_of(slot) / kTileWidth)] = 1;
      here_any = true;
    };
    const auto pending = verdicts_.pending.find(layer);
    // NodeRun now cost what they cost first, with the layer after as it was; where that changed, too, they are relaxed next.
    if (pending != verdicts_.pending.end())
      for (const int slot : pending->second.raised)
        if (const double value = at(layer, slot); value != kUnreachable) set(slot, verdicts_.cost(layer, slot) + value);
    if (any && layer == 0 && lattice_->has_start()) {
      if (at(0, lattice_->start_slot()) != kUnreachable) set(lattice_->start_slot(), relax_one(0, lattice_->start_slot()));
    } else if (any) {
      const ColumnSet dependent = widened(changed);
      load_tiles(layer + 1, widened(dependent), *next);
      publish_values(*next);
      load_tiles(layer, dependent, *here);
      relax(layer, *here, *next);
      apply_masks(*here);
      add_node_costs(*here);
      relax_removed(*here);
      prune_above_limit(*here);
      for (const Tile& tile : here->tiles) {
        const double* const values = here->row.data() + static_cast<std::ptrdiff_t>(tile.sheet) * n + tile.begin();
        TileTable::Costs& known = tiles_.hold(tile_index(layer, tile.sheet, tile.column));
        const auto count = static_cast<std::size_t>(tile.end(n) - tile.begin());
        if (std::equal(values, values + count, known.begin())) continue;
        std::copy_n(values, count, known.begin());
        here_changed[static_cast<std::size_t>(tile.column)] = 1;
        here_any = true;
      }
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

double GridCostToGo::relax_one_forward(int layer, int slot, const Workspace& before) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window();
  const OneNode here = one_node(layer, slot);
  if (!here.valid() || verdicts_.node(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.config();
  const SrsLattice::Run run = lattice_->run_before(layer - 1, slot);
  double best = kUnreachable;
  for (const int other : before.sheets)
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

void GridCostToGo::keep_reach(int layer, const Workspace& workspace) {
  constexpr double kMost = 1e30;  // that a float holds
  const int n = lattice_->angles();
  const auto width = static_cast<std::size_t>(lattice_->width());
  const auto row = static_cast<std::size_t>((layer + Reach::kStride - 1) / Reach::kStride);
  reach_.rows.resize(row * width);
  reach_.rows.resize((row + 1) * width, std::numeric_limits<float>::infinity());
  reach_.best = kUnreachable;
  for (const Tile& tile : workspace.tiles)
    for (int slot = tile.sheet * n + tile.begin(); slot < tile.sheet * n + tile.end(n); ++slot) {
      const double cost = workspace.row[static_cast<std::size_t>(slot)];
      reach_.best = std::min(reach_.best, cost);
      reach_.rows[row * width + static_cast<std::size_t>(slot)] = std::nextafter(static_cast<float>(std::min(cost, kMost)), 0.0F);
    }
}

int GridCostToGo::deepest_reachable() {
  if (knows_reach()) return reach_.deepest;
  const TraceSpan span("reach");
  reach_.known = false;
  const int n = lattice_->angles();
  Workspace* before = workspace_[0].get();
  Workspace* here = workspace_[1].get();
  begin_with_all(0, *before);
  publish_values(*before);
  if (before->sheets.empty()) return -1;
  int layer = 1;
  for (; layer < lattice_->layers(); ++layer) {
    budget_.poll();
    if ((layer - 1) % Reach::kStride == 0) keep_reach(layer - 1, *before);
    solve_ahead(layer, 1, *before);
    begin_layer(layer, *here);
    const auto step_one = [&](int slot) {
      const Tile tile{lattice_->sheet_of(slot), lattice_->angle_of(slot) / kTileWidth, true};
      double* row = here->row.data() + tile.sheet * n;
      const auto place = std::lower_bound(here->tiles.begin(), here->tiles.end(), tile);
      if (place == here->tiles.end() || *place != tile) {
        std::fill(row + tile.begin(), row + tile.end(n), kUnreachable);
        here->tiles.insert(place, tile);
      }
      solve_columns(*here->joints, lattice_->family_of(tile.sheet), tile.column, tile.column + 1);
      row[lattice_->angle_of(slot)] = relax_one_forward(layer, slot, *before);
    };
    const auto reaches = [&](const Verdicts::HalfEdge& edge, double value) {
      const int n_padded = n + 2 * lattice_->window(), sheet = lattice_->sheet_of(edge.other);
      const int place = sheet * n_padded + lattice_->window() + lattice_->angle_of(edge.other);
      return edge.cost + before->value[static_cast<std::size_t>(place)] == value;
    };
    if (layer == 1 && lattice_->has_start()) {
      const SrsLattice::Run run = lattice_->run_after(0, lattice_->start_slot());
      for (int sheet = 0; sheet < lattice_->sheets(); ++sheet)
        for (int k = 0; k < run.count; ++k) step_one(sheet * n + (run.first + k) % n);
    } else {
      reach_back(layer - 1, *before, *here);
      relax(layer - 1, *here, *before);
      apply_masks(*here);
      if (const auto* removed = verdicts_.removed_edges(layer - 1))
        for (const auto& [b, edges] : removed->heads)
          if (here->find(lattice_->sheet_of(b), lattice_->angle_of(b) / kTileWidth) &&
              std::any_of(edges.begin(), edges.end(),
                          [&](const Verdicts::HalfEdge& edge) { return reaches(edge, here->row[static_cast<std::size_t>(b)]); }))
            step_one(b);
    }
    publish_values(*here);
    if (here->sheets.empty()) break;
    std::swap(before, here);
  }
  keep_reach(layer - 1, *before);
  reach_.known = true;
  reach_.removed = verdicts_.removed();
  return reach_.deepest = layer - 1;
}

}  // namespace swivel
