// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/grid/grid_cost_to_go.hpp"

#include <algorithm>
#include <cstring>

#include "cost_to_go/grid/grid_tiles.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// Calls f(0) ... f(count - 1), count <= whole; a loop of known length is unrolled into vectors.
template <int whole, class F>
void each(int count, const F& f) {
  if (count == whole)
    for (int k = 0; k < whole; ++k) f(k);
  else
    for (int k = 0; k < count; ++k) f(k);
}

}  // namespace

GridCostToGo::GridCostToGo(const SrsLattice& lattice, Pruning pruning, const Budget& budget,
                           GridCostToGo* recycled)
    : CostToGo(lattice, budget), lattice_(&lattice), bounded_(pruning == Pruning::kByBound) {
  const std::size_t tiles = tile_of_layer(lattice.solutions(), 0);
  tiles_[0] = TileTable(static_cast<std::size_t>(lattice.layers()) * tiles,
                        recycled ? std::move(recycled->tiles_[0]) : TileTable());
  if (recycled) {
    passing_ = std::move(recycled->passing_);
    neighbours_ = std::move(recycled->neighbours_);
    for (Neighbours& neighbours : neighbours_) neighbours.of = -1;
  }
  for (auto& workspace : workspace_) {
    workspace = std::make_unique<Workspace>();
    workspace->row.resize(static_cast<std::size_t>(lattice.width()));
    workspace->windows.resize(tiles);
    workspace->value.assign(
        static_cast<std::size_t>(lattice.solutions() * (lattice.angles() + 2 * lattice.window())),
        kUnreachable);
  }
}

void GridCostToGo::apply_masks(int side, Workspace& workspace) const {
  const int n = lattice_->angles(), window = lattice_->window();
  const Workspace::Half& half = workspace.half(side);
  for (const Tile& tile : half.tiles) {
    if (!tile.live) continue;
    const int slot = tile.solution * n + tile.begin(), at = window + tile.begin(),
              count = tile.end(n) - tile.begin();
    double* const values = workspace.row.data() + slot;
    const double* one = half.joints->nodes.mask(tile.solution, 0) + at;
    const double* other = half.joints->nodes.mask(tile.solution, 1) + at;
    each<kTileWidth>(count, [&](int k) { values[k] += one[k] + other[k]; });
    const Verdict* verdict = verdicts_.nodes(half.layer, slot);
    if (std::memchr(verdict, static_cast<int>(Verdict::kRemoved), static_cast<std::size_t>(count)))
      each<kTileWidth>(count, [&](int k) {
        if (verdict[k] == Verdict::kRemoved) values[k] = kUnreachable;
      });
  }
}

void GridCostToGo::prune_above_limit(int side, Workspace& workspace) const {
  if (limit_ == kUnreachable) return;
  const int n = lattice_->angles();
  const float* bound = cost_before(workspace.half(side).layer);
  const bool on_circles = !by_reach_ && !on_circles_.empty();
  for (const Tile& tile : workspace.half(side).tiles) {
    if (!tile.live) continue;
    const int slot = tile.solution * n + tile.begin(), count = tile.end(n) - tile.begin();
    double* const values = workspace.row.data() + slot;
    const int row =
        on_circles ? on_circles_[static_cast<std::size_t>(tile.solution)] : tile.solution;
    if (const float* before = bound ? bound + row * n + tile.begin() : nullptr)
      each<kTileWidth>(count, [&](int k) {
        values[k] = values[k] + before[k] > limit_ ? kUnreachable : values[k];
      });
    else
      each<kTileWidth>(count,
                       [&](int k) { values[k] = values[k] > limit_ ? kUnreachable : values[k]; });
  }
}

void GridCostToGo::store_tiles(int side, const Workspace& workspace) {
  const int n = lattice_->angles();
  const Workspace::Half& half = workspace.half(side);
  for (const Tile& tile : half.tiles) {
    TileTable::Costs& costs =
        tiles_of(tile.solution).hold(tile_index(half.layer, tile.solution, tile.column));
    const double* row = workspace.row.data() + static_cast<std::ptrdiff_t>(tile.solution) * n;
    std::fill(std::copy(row + tile.begin(), row + tile.end(n), costs.begin()), costs.end(),
              kUnreachable);
  }
}

void GridCostToGo::load_tiles(int side, int layer, const ColumnSet& columns, Workspace& workspace,
                              const ColumnSet* reached) {
  begin(side, layer, workspace);
  const int n = lattice_->angles();
  for (int solution = first_solution(side); solution < first_solution(side) + half_solutions();
       ++solution)
    for (int column = 0; column < tile_columns(); ++column) {
      const std::size_t held = tile_index(layer, solution, column);
      if (!columns[static_cast<std::size_t>(column)] || !tiles_of(solution).holds(held)) continue;
      const TileTable::Costs& costs = tiles_of(solution)[held];
      if (*std::min_element(costs.begin(), costs.end()) == kUnreachable) continue;
      const bool live = !reached || (*reached)[static_cast<std::size_t>(column)];
      const Tile& tile = workspace.half(side).tiles.emplace_back(Tile{solution, column, live});
      if (!live) continue;
      solve_columns(workspace, side, column, column + 1);
      std::copy_n(costs.begin(), tile.end(n) - tile.begin(),
                  workspace.row.begin() + static_cast<std::ptrdiff_t>(solution) * n + tile.begin());
    }
}

bool GridCostToGo::renew_tiles(int side, const Workspace& workspace, const AngleSet& angles,
                               AngleSet& changed) {
  const int n = lattice_->angles();
  bool any = false;
  for (const Tile& tile : workspace.half(side).tiles) {
    const auto column = static_cast<std::size_t>(tile.column);
    const double* const values =
        workspace.row.data() + static_cast<std::ptrdiff_t>(tile.solution) * n + tile.begin();
    TileTable::Costs& known =
        tiles_of(tile.solution)
            .hold(tile_index(workspace.half(side).layer, tile.solution, tile.column));
    unsigned differ = 0;
    for (unsigned k = 0; k < static_cast<unsigned>(tile.end(n) - tile.begin()); ++k) {
      if (!(angles[column] >> k & 1) || values[k] == known[k]) continue;
      known[k] = values[k];
      differ |= 1u << k;
    }
    changed[column] = static_cast<std::uint8_t>(changed[column] | differ);
    any = any || differ != 0;
  }
  return any;
}

GridCostToGo::~GridCostToGo() = default;

std::shared_ptr<const CostToGo::SavedValues> GridCostToGo::save() const {
  auto saved = std::make_shared<Saved>();
  saved->goal = goal_;
  saved->limit = limit_;
  saved->apart = apart_;
  saved->by_reach = by_reach_;
  saved->reach = reach_;
  saved->tiles = {tiles_[0].held(), tiles_[1].held()};
  saved->chord_bound = chord_bound_;
  return saved;
}

void GridCostToGo::restore(const SavedValues& values) {
  const auto& saved = static_cast<const Saved&>(values);
  goal_ = saved.goal;
  limit_ = saved.limit;
  apart_ = saved.apart;
  by_reach_ = saved.by_reach;
  reach_ = saved.reach;
  tiles_[0].restore(saved.tiles[0]);
  if (apart_ && tiles_[1].tiles() == 0) tiles_[1] = TileTable(tiles_[0].tiles());
  if (apart_) tiles_[1].restore(saved.tiles[1]);
  chord_bound_ = saved.chord_bound;
}

void GridCostToGo::compute(int goal_layer) {
  limit_ = kUnreachable;
  by_reach_ = false;
  bool hopeless = false;
  for (int layer = 0; layer <= goal_ && !hopeless; ++layer) hopeless = !lattice_->alive(layer);
  if (goal_layer == lattice_->layers() - 1) {
    if (reach_.removed != 0 || verdicts_.removed() != 0) forget_reach();
    if (!hopeless && bounded_ && lattice_->has_start()) {
      // From one node, forward, it takes little to see what is left, or that turns run out.
      hopeless = deepest_reachable() < goal_;
      reach_.slack = first_slack(*lattice_);
      if (!hopeless) limit_by_reach();
    } else if (!hopeless && bounded_) {
      if (!chord_bound_) {
        chord_bound_ = std::make_shared<const ChordLowerBound>(*lattice_, budget_, work_);
        ik_nodes_ += chord_bound_->ik_nodes();
      }
      hopeless = chord_bound_->best() == kUnreachable || !raise_limit();
    }
  } else if (bounded_ && knows_reach() && reach_.deepest == goal_layer) {
    limit_by_reach();
  }
  if (hopeless) return clear_values();
  sweep_once();
  raise_limit_until_exact();
}

void GridCostToGo::bound_by(const CostToGo& circles) {
  const auto* grid = dynamic_cast<const GridCostToGo*>(&circles);
  if (!grid || !grid->chord_bound_) return;
  if (grid->on_circles_.empty() && !grid->lattice_->joints_with_windings().empty()) return;
  chord_bound_ = grid->chord_bound_;
  least_ = std::max(grid->best(), grid->least_);
  const int n = lattice_->angles();
  for (int solution = 0; solution < lattice_->solutions(); ++solution)
    on_circles_.push_back(lattice_->slot_on_circles(0, solution * n) / n);
}

const float* GridCostToGo::cost_before(int layer) const {
  if (!by_reach_) return chord_bound_ ? chord_bound_->row(layer) : nullptr;
  if (layer > reach_.deepest || (layer % Reach::kStride != 0 && layer != reach_.deepest))
    return nullptr;
  const int row = (layer + Reach::kStride - 1) / Reach::kStride;
  return reach_.rows.data() + static_cast<std::ptrdiff_t>(row) * lattice_->width();
}

/// Sets the limit of a goal that is reached: the best path to it costs what was found on the way
/// there.
void GridCostToGo::limit_by_reach() {
  limit_ = kUnreachable;
  by_reach_ = true;
  // The costs kept by reach_ leave out what nodes themselves cost.
  for (int layer = 0; layer <= goal_; ++layer) by_reach_ = by_reach_ && !verdicts_.costs(layer);
  if (!by_reach_) return;
  limit_ = lattice_->largest_of_same_coarse_cost((1 + reach_.slack) * reach_.best);
  reach_.slack = next_slack(reach_.slack);
}

bool GridCostToGo::raise_limit() {
  if (!by_reach_ && goal_ == lattice_->layers() - 1 && chord_bound_ && chord_bound_->row(0)) {
    const double least = std::max(chord_bound_->best(), least_),
                 found = limit_ == kUnreachable ? kUnreachable
                                                : lattice_->largest_of_same_coarse_cost(best());
    const double passed = limit_ == kUnreachable ? -1 : limit_;
    // most stop at the first: 2 to 10 % of the lattice
    for (const double share : {0.03, 0.25, 1.5}) {
      limit_ = lattice_->largest_of_same_coarse_cost(least * (1 + share));
      if (limit_ > passed && (found == kUnreachable || found <= limit_)) return true;
    }
  }
  if (deepest_reachable() < goal_) return false;
  limit_by_reach();
  return true;
}

void GridCostToGo::raise_limit_until_exact() {
  while (limit_ != kUnreachable && !(lattice_->largest_of_same_coarse_cost(best()) <= limit_)) {
    if (!raise_limit()) return clear_values();
    sweep_once();
  }
}

void GridCostToGo::clear_values() {
  verdicts_.pending.clear();
  for (TileTable& tiles : tiles_) tiles.clear();
  apart_ = work_.threads > 1;
  if (apart_ && tiles_[1].tiles() == 0)
    tiles_[1] = TileTable(static_cast<std::size_t>(lattice_->layers()) *
                          tile_of_layer(lattice_->solutions(), 0));
}

void GridCostToGo::sweep_once() {
  const TraceSpan span("sweep");
  clear_values();
  forget_joints();
  const auto settle = [&](int side, Workspace& here) {
    prune_above_limit(side, here);
    publish_values(side, here);
    store_tiles(side, here);
  };
  by_elbow_side([&](int side) {
    begin_with_all(side, goal_, workspace(goal_));
    add_node_costs(side, workspace(goal_));
    settle(side, workspace(goal_));
  });
  const int last = lattice_->has_start() ? 1 : 0;
  bool reached = workspace(goal_).reaches_any();
  for (int layer = goal_ - 1; layer >= last && reached;) {
    budget_.tell(Stage::kSweep, goal_ - layer, goal_);
    const bool some_removed = verdicts_.removed_edges(layer) != nullptr;
    int end = layer - 1;  // end of the layers that elbow sides go through alone
    if (elbow_sides_part(layer))
      while (end >= last && layer - end < kMostAlone && elbow_sides_part(end)) --end;
    by_elbow_side([&](int side) {
      for (int at = layer; at > end; --at) {
        Workspace &here = workspace(at), &next = workspace(at + 1);
        begin(side, at, here);
        reach_back(side, at, next, here);
        relax(side, at, here, next);
        apply_masks(side, here);
        add_node_costs(side, here);
        if (!some_removed) settle(side, here);
      }
    });
    if (some_removed) {
      relax_removed(layer);
      for (int side = 0; side < SrsLattice::kElbowSides; ++side) settle(side, workspace(layer));
    }
    reached = workspace(end + 1).reaches_any();
    layer = end;
  }
  if (reached && goal_ > 0 && lattice_->has_start()) {
    const double value = relax_one(0, lattice_->start_slot());
    if (value <= limit_) value_at(0, lattice_->start_slot()) = value;
  }
}

double GridCostToGo::best() const {
  double best = kUnreachable;
  for (int solution = 0; solution < lattice_->solutions(); ++solution)
    for (int column = 0; column < tile_columns(); ++column)
      for (const double value : tiles_of(solution)[tile_index(0, solution, column)])
        best = std::min(best, value);
  return best;
}

}  // namespace swivel
