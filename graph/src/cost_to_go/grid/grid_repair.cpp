// SPDX-License-Identifier: BSD-3-Clause
// Repairs values after removals, and finds how far layer 0 still reaches.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "cost_to_go/grid/grid_tiles.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

double& GridCostToGo::value_at(int layer, int slot) {
  const int solution = lattice_->solution_of(slot), j = lattice_->angle_of(slot);
  return tiles_of(solution).hold(
      tile_index(layer, solution, j / kTileWidth))[static_cast<std::size_t>(j % kTileWidth)];
}

/// Calls visit(b, rest, delta) for the nodes b of the next layer that lie in the window of a node
/// and whose cost-to-go `rest` passes worth() when they are looked at.
template <class Worth, class Visit>
void GridCostToGo::each_in_window(int layer, int slot, const Config& q, const Worth& worth,
                                  const Visit& visit) {
  const int n = lattice_->angles();
  const SrsLattice::Run run = lattice_->run_after(layer, slot);
  for (int solution = 0; solution < lattice_->solutions(); ++solution)
    for (int k = 0, next = 0; k < run.count; k = next) {
      const int angle = (run.first + k) % n, column = angle / kTileWidth,
                in_tile = angle % kTileWidth;
      next = std::min(run.count, k + std::min(n, (column + 1) * kTileWidth) - angle);
      const std::size_t tile = tile_index(layer + 1, solution, column);
      const TileTable& tiles = tiles_of(solution);
      if (!tiles.holds(tile)) continue;
      const double* rest = tiles[tile].data() + in_tile;
      const LayerNodes* nodes = nullptr;
      for (int j = 0; j < next - k; ++j) {
        if (!worth(rest[j])) continue;
        if (!nodes) nodes = &neighbours(layer + 1, lattice_->elbow_side_of(solution), column);
        visit(solution * n + angle + j, rest[j],
              lattice_->delta(q, nodes->config(solution, in_tile + j)));
      }
    }
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
        if (value < best && lattice_->step_allowed(layer, delta) &&
            verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          best = value;
      });
  return verdicts_.cost(layer, slot) + best;
}

void GridCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const Config q = config(layer, slot);
  const double own = verdicts_.cost(layer, slot);
  out.clear();
  each_in_window(
      layer, slot, q, [&](double rest) { return rest != kUnreachable && rest <= bound; },
      [&](int b, double rest, const Config& delta) {
        if (!lattice_->step_allowed(layer, delta)) return;
        const double cost = lattice_->edge_cost(delta);
        if (own + (cost + rest) <= bound && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          out.push_back({b, own + cost});
      });
}

void GridCostToGo::relax_removed(int layer) {
  const auto* removed = verdicts_.removed_edges(layer);
  if (!removed) return;
  Workspace& here = workspace(layer);
  for (const auto& [a, edges] : removed->tails) {
    if (!here.find(*lattice_, a)) continue;
    double& value = here.row[static_cast<std::size_t>(a)];
    const double own = verdicts_.cost(layer, a);
    const auto gives_value = [&](const Verdicts::HalfEdge& edge) {
      return own + (edge.cost + at(layer + 1, edge.other)) == value;
    };
    if (value != kUnreachable && std::any_of(edges.begin(), edges.end(), gives_value))
      value = relax_one(layer, a);
  }
}

// --- removals and costs

void GridCostToGo::add_node_costs(int side, Workspace& workspace) const {
  const double* own = verdicts_.costs(workspace.half(side).layer);
  if (!own) return;
  const int n = lattice_->angles();
  for (const Tile& tile : workspace.half(side).tiles)
    for (int slot = tile.solution * n + tile.begin(); slot < tile.solution * n + tile.end(n);
         ++slot)
      workspace.row[static_cast<std::size_t>(slot)] += own[slot];
}

void GridCostToGo::compute_removals() {
  propagate_removals();
  raise_limit_until_exact();
}

void GridCostToGo::widen(const AngleSet& angles, AngleSet& result) const {
  static_assert(kTileWidth == 8);
  const int n = lattice_->angles(), window = lattice_->window();
  result.assign(angles.size(), 0);
  const auto add = [&](int first, int last) {
    for (int column = first / kTileWidth; column <= last / kTileWidth; ++column) {
      const int low = std::max(0, first - column * kTileWidth),
                high = std::min(kTileWidth - 1, last - column * kTileWidth);
      result[static_cast<std::size_t>(column)] |=
          static_cast<std::uint8_t>((0xff << low) & (0xff >> (kTileWidth - 1 - high)));
    }
  };
  for (int column = 0; column < tile_columns(); ++column) {
    const std::uint8_t bits = angles[static_cast<std::size_t>(column)];
    if (bits == 0) continue;
    const int first = column * kTileWidth + std::countr_zero(bits) - window;
    const int last = column * kTileWidth + std::bit_width(bits) - 1 + window;
    if (last - first + 1 >= n) {
      add(0, n - 1);
      break;
    }
    if (first < 0) add(first + n, n - 1);
    add(std::max(0, first), std::min(n - 1, last));
    if (last >= n) add(0, last - n);
  }
}

/// What has changed of one elbow side's values on the way down: angles of the layer after, of any
/// of its solutions, and of this layer.
struct alignas(64) GridCostToGo::ChangedAngles {
  AngleSet after, here;
  AngleSet dependent, needed;  // angles here that may change, and those after that decide
  bool any_after = false, any_here = false;
  void next_layer() {
    after.swap(here);
    any_after = any_here;
    std::fill(here.begin(), here.end(), std::uint8_t{0});
    any_here = false;
  }
  void add(const ChangedAngles& other) {
    any_after = any_after || other.any_after;
    for (std::size_t c = 0; c < after.size(); ++c) after[c] |= other.after[c];
  }
};

/// Goes down the layers from the last one with something pending, and repairs the values that
/// depend on removed nodes and edges and on raised costs.
class GridCostToGo::RemovalSweep {
 public:
  explicit RemovalSweep(GridCostToGo& of)
      : of_(of), lattice_(*of.lattice_), verdicts_(of.verdicts_), pending_(of.verdicts_.pending) {
    for (ChangedAngles& changed : changes_)
      changed.after = changed.here = AngleSet(static_cast<std::size_t>(of.tile_columns()), 0);
  }

  void run() {
    for (int layer = last_pending(); layer >= 0;) {
      int end = layer;  // end of the layers that elbow sides go through alone
      while (end >= 0 && layer - end < kMostAlone && goes_alone(end)) --end;
      if (end < layer) {
        repair_sides_alone(layer, end);
      } else {
        --end;
        repair_sides_together(layer);
      }
      const bool goes_on = changes_[0].any_after || changes_[1].any_after;
      layer = goes_on ? end : last_pending();  // nothing changes until there
    }
  }

 private:
  [[nodiscard]] int last_pending() const {
    return pending_.empty() ? -1 : pending_.rbegin()->first;
  }
  [[nodiscard]] ChangedAngles& changes(int side) {
    return changes_[static_cast<std::size_t>(side)];
  }
  [[nodiscard]] int side_of(int slot) const {
    return lattice_.elbow_side_of(lattice_.solution_of(slot));
  }

  /// Returns true if each elbow side can go through a layer by itself.
  [[nodiscard]] bool goes_alone(int layer) const {
    const auto now = pending_.find(layer);
    return (layer > 0 || !lattice_.has_start()) &&
           (now == pending_.end() || now->second.tails.empty()) &&
           (layer == of_.goal_ || of_.elbow_sides_part(layer));
  }

  /// Sets the value of a node and notes that it has changed.
  void set(int layer, int slot, double value) {
    if (of_.at(layer, slot) == value) return;
    of_.value_at(layer, slot) = value;
    ChangedAngles& changed = changes(side_of(slot));
    const int angle = lattice_.angle_of(slot);
    changed.here[static_cast<std::size_t>(angle / kTileWidth)] |=
        static_cast<std::uint8_t>(1 << angle % kTileWidth);
    changed.any_here = true;
  }

  /// Adds their costs to nodes that cost more now. They are first computed with the layer after as
  /// it was; where that changed too, they are relaxed next.
  void raise(int side, int layer, const Verdicts::Pending& now) {
    for (const auto& [slot, by] : now.raised)
      if (side_of(slot) == side)
        if (const double value = of_.at(layer, slot); value != kUnreachable)
          set(layer, slot, value + by);
  }
  void remove(int side, int layer, const Verdicts::Pending& now) {
    for (const int slot : now.nodes)
      if (side_of(slot) == side && of_.at(layer, slot) != kUnreachable)
        set(layer, slot, kUnreachable);
  }

  /// Finds what depends on the changes of the layer after, and loads what of that layer it depends
  /// on.
  void load_after(int side, int layer) {
    ChangedAngles& changed = changes(side);
    Workspace& after = of_.workspace(layer + 1);
    of_.widen(changed.after, changed.dependent);
    of_.widen(changed.dependent, changed.needed);
    of_.load_tiles(side, layer + 1, changed.needed, after);
    of_.publish_values(side, after);
  }
  void relax_loaded(int side, int layer) {
    Workspace& here = of_.workspace(layer);
    of_.relax(side, layer, here, of_.workspace(layer + 1));
    of_.apply_masks(side, here);
    of_.add_node_costs(side, here);
  }
  /// Stores the values of what was loaded and notes which of them have changed.
  void settle(int side, int layer) {
    ChangedAngles& changed = changes(side);
    of_.prune_above_limit(side, of_.workspace(layer));
    if (of_.renew_tiles(side, of_.workspace(layer), changed.dependent, changed.here))
      changed.any_here = true;
  }

  /// Repairs the layers from `layer` down to before `end`, each elbow side by itself.
  void repair_sides_alone(int layer, int end) {
    of_.budget_.poll();
    of_.by_elbow_side([&](int side) {
      ChangedAngles& changed = changes(side);
      for (int here = layer; here > end; --here) {
        const auto now = pending_.find(here);
        if (now != pending_.end()) raise(side, here, now->second);
        if (changed.any_after) {
          load_after(side, here);
          of_.load_tiles(side, here, changed.dependent, of_.workspace(here),
                         &of_.workspace(here + 1).half(side).reached);
          relax_loaded(side, here);
          settle(side, here);
        }
        if (now != pending_.end()) remove(side, here, now->second);
        changed.next_layer();
      }
    });
    pending_.erase(pending_.upper_bound(end), pending_.end());
  }

  /// Repairs a layer from which edges may lead to the other elbow side.
  void repair_sides_together(int layer) {
    changes_[0].add(changes_[1]);
    changes_[1].add(changes_[0]);
    const auto now = pending_.find(layer);
    for (int side = 0; side < SrsLattice::kElbowSides && now != pending_.end(); ++side)
      raise(side, layer, now->second);
    if (changes_[0].any_after) relax_together(layer);
    if (now != pending_.end()) {
      for (int side = 0; side < SrsLattice::kElbowSides; ++side) remove(side, layer, now->second);
      for (const int slot : now->second.tails) {
        of_.budget_.poll();
        if (layer < of_.goal_ && of_.at(layer, slot) != kUnreachable)
          set(layer, slot, of_.relax_one(layer, slot));
      }
      pending_.erase(now);
    }
    for (ChangedAngles& changed : changes_) changed.next_layer();
  }
  void relax_together(int layer) {
    if (layer == 0 && lattice_.has_start()) {
      const int slot = lattice_.start_slot();
      if (of_.at(0, slot) != kUnreachable) set(0, slot, of_.relax_one(0, slot));
      return;
    }
    of_.by_elbow_side([&](int side) {
      load_after(side, layer);
      of_.load_tiles(side, layer, changes(side).dependent, of_.workspace(layer));
    });
    of_.by_elbow_side([&](int side) { relax_loaded(side, layer); });
    of_.relax_removed(layer);
    for (int side = 0; side < SrsLattice::kElbowSides; ++side) settle(side, layer);
  }

  GridCostToGo& of_;
  const SrsLattice& lattice_;
  Verdicts& verdicts_;
  decltype(Verdicts::pending)& pending_;
  std::array<ChangedAngles, SrsLattice::kElbowSides> changes_;
};

void GridCostToGo::propagate_removals() {
  const TraceSpan span("repair");
  forget_joints();
  auto& pending = verdicts_.pending;
  while (!pending.empty() && pending.rbegin()->first > goal_)
    pending.erase(std::prev(pending.end()));
  RemovalSweep(*this).run();
}

// --- reach

double GridCostToGo::relax_one_forward(int layer, int slot, const Workspace& before) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window();
  const OneNode here = one_node(layer, slot);
  if (!here.valid() || verdicts_.node(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.config();
  const SrsLattice::Run run = lattice_->run_before(layer - 1, slot);
  double best = kUnreachable;
  for (const Workspace::Half& half : before.halves)
    for (const int other : half.solutions)
      for (int k = 0; k < run.count; ++k) {
        const int j = (run.first + k) % n, a = other * n + j;
        const double done =
            before.value[static_cast<std::size_t>(other * length + lattice_->window() + j)];
        if (done >= best) continue;
        const Config delta = lattice_->delta(config(layer - 1, a), q);
        const double value = lattice_->edge_cost(delta) + done;
        if (value < best && lattice_->step_allowed(layer - 1, delta) &&
            verdicts_.edge(layer - 1, a, slot) != Verdict::kRemoved)
          best = value;
      }
  return best;
}

/// Makes as many rows of costs as `layers` layers need, and one more.
void GridCostToGo::begin_reach_rows(int layers) {
  const auto rows = static_cast<std::size_t>((layers + Reach::kStride - 1) / Reach::kStride) + 1;
  reach_.rows.resize(rows * static_cast<std::size_t>(lattice_->width()),
                     std::numeric_limits<float>::infinity());
}

/// Keeps the costs of one elbow side's nodes, rounded down; `kept` has all slots.
void GridCostToGo::keep_reach(int side, int layer, float* kept) {
  constexpr double kMost = 1e30;  // that a float can hold
  const int n = lattice_->angles(), width = lattice_->width() / 2;
  std::fill_n(kept + side * width, width, std::numeric_limits<float>::infinity());
  const Workspace& here = workspace(layer);
  if (here.half(side).layer != layer) return;  // this elbow side does not come here
  for (const Tile& tile : here.half(side).tiles)
    for (int slot = tile.solution * n + tile.begin(); slot < tile.solution * n + tile.end(n);
         ++slot)
      kept[slot] = std::nextafter(
          static_cast<float>(std::min(here.row[static_cast<std::size_t>(slot)], kMost)), 0.0F);
}

/// Goes up the layers from layer 0, whose nodes are in its workspace, as far as paths reach, and
/// keeps what nodes cost from there.
class GridCostToGo::ReachSweep {
 public:
  explicit ReachSweep(GridCostToGo& of)
      : of_(of), lattice_(*of.lattice_), ended_(static_cast<std::size_t>(of.lattice_->width())) {}

  void run() {
    of_.begin_reach_rows(0);
    for (int layer = 1, end = 0;
         layer < lattice_.layers() && of_.workspace(layer - 1).reaches_any(); layer = end) {
      of_.budget_.poll();
      end = layer + 1;
      const bool alone = goes_alone(layer);
      while (alone && end < lattice_.layers() && end - layer < kMostAlone && goes_alone(end)) ++end;
      of_.begin_reach_rows(end - 1);
      const auto* removed = of_.verdicts_.removed_edges(layer - 1);
      const bool from_start = layer == 1 && lattice_.has_start();
      of_.by_elbow_side([&](int side) {
        for (int at = layer; at < end; ++at) {
          if ((at - 1) % Reach::kStride == 0) of_.keep_reach(side, at - 1, row_of(at - 1));
          if (!from_start) step(side, at);
          if (alone) finish(side, at);
        }
      });
      if (alone) continue;
      if (from_start)
        step_from_start();
      else if (removed)
        step_again(layer, *removed);
      for (int side = 0; side < SrsLattice::kElbowSides; ++side) finish(side, layer);
      of_.collect_counts();
    }
  }

  /// Returns the deepest layer that paths reach.
  [[nodiscard]] int deepest() const { return std::max(deepest_[0], deepest_[1]); }

  /// Keeps what the nodes of the deepest layer cost, and returns the least of that.
  double keep_deepest() {
    const int layer = deepest();
    const bool to_the_end = layer == lattice_.layers() - 1;
    float* const row = row_of(layer);
    for (int side = 0; side < SrsLattice::kElbowSides; ++side) {
      const int first = of_.first_solution(side) * lattice_.angles(), width = lattice_.width() / 2;
      if (to_the_end || deepest_[static_cast<std::size_t>(side)] < layer)
        of_.keep_reach(side, layer, row);
      else
        std::copy_n(ended_.begin() + first, width, row + first);
    }
    return *std::min_element(row, row + lattice_.width());
  }

 private:
  [[nodiscard]] float* row_of(int layer) {
    const int row = (layer + Reach::kStride - 1) / Reach::kStride;
    return of_.reach_.rows.data() + static_cast<std::ptrdiff_t>(row) * lattice_.width();
  }

  /// Returns true if each elbow side can step to a layer by itself.
  [[nodiscard]] bool goes_alone(int layer) const {
    return (layer > 1 || !lattice_.has_start()) && of_.elbow_sides_part(layer - 1);
  }

  /// Computes the costs of one elbow side's nodes from those of the layer before.
  void step(int side, int layer) {
    Workspace &here = of_.workspace(layer), &before = of_.workspace(layer - 1);
    of_.begin(side, layer, here);
    of_.reach_back(side, layer - 1, before, here);
    of_.relax(side, layer - 1, here, before);
    of_.apply_masks(side, here);
  }

  /// Recomputes the cost of a node where the step that it came by is removed, or where the layer
  /// before is the start alone.
  void step_one(int layer, int slot) {
    const int n = lattice_.angles();
    Workspace& here = of_.workspace(layer);
    const Tile tile{lattice_.solution_of(slot), lattice_.angle_of(slot) / kTileWidth, true};
    const int side = lattice_.elbow_side_of(tile.solution);
    std::vector<Tile>& tiles = here.half(side).tiles;
    double* row = here.row.data() + tile.solution * n;
    const auto place = std::lower_bound(tiles.begin(), tiles.end(), tile);
    if (place == tiles.end() || *place != tile) {
      std::fill(row + tile.begin(), row + tile.end(n), kUnreachable);
      tiles.insert(place, tile);
    }
    of_.solve_columns(here, side, tile.column, tile.column + 1);
    row[lattice_.angle_of(slot)] = of_.relax_one_forward(layer, slot, of_.workspace(layer - 1));
  }

  /// Computes the costs of layer 1 where layer 0 is the start alone.
  void step_from_start() {
    const int n = lattice_.angles();
    const SrsLattice::Run run = lattice_.run_after(0, lattice_.start_slot());
    for (int side = 0; side < SrsLattice::kElbowSides; ++side) of_.begin(side, 1, of_.workspace(1));
    for (int solution = 0; solution < lattice_.solutions(); ++solution)
      for (int k = 0; k < run.count; ++k) step_one(1, solution * n + (run.first + k) % n);
  }

  /// Recomputes the costs of the nodes of a layer that came by edges which are removed.
  void step_again(int layer, const Verdicts::RemovedEdges& removed) {
    const Workspace& before = of_.workspace(layer - 1);
    const auto gives_value = [&](const Verdicts::HalfEdge& edge, double value) {
      const int n_padded = lattice_.angles() + 2 * lattice_.window(),
                solution = lattice_.solution_of(edge.other);
      const int place = solution * n_padded + lattice_.window() + lattice_.angle_of(edge.other);
      return edge.cost + before.value[static_cast<std::size_t>(place)] == value;
    };
    for (const auto& [b, edges] : removed.heads)
      if (of_.workspace(layer).find(lattice_, b) &&
          std::any_of(edges.begin(), edges.end(), [&](const Verdicts::HalfEdge& edge) {
            return gives_value(edge, of_.workspace(layer).row[static_cast<std::size_t>(b)]);
          }))
        step_one(layer, b);
  }

  /// Makes a layer's costs those that the next layer reads. Keeps the costs of the layer before
  /// where an elbow side ends there.
  void finish(int side, int layer) {
    of_.publish_values(side, of_.workspace(layer));
    int& last = deepest_[static_cast<std::size_t>(side)];
    if (!of_.workspace(layer).half(side).solutions.empty())
      last = layer;
    else if (last == layer - 1)
      of_.keep_reach(side, last, ended_.data());
  }

  GridCostToGo& of_;
  const SrsLattice& lattice_;
  std::array<int, SrsLattice::kElbowSides> deepest_{0, 0};
  std::vector<float> ended_;  // costs of the nodes of the layer at which each elbow side ends
};

int GridCostToGo::deepest_reachable() {
  if (knows_reach()) return reach_.deepest;
  const TraceSpan span("reach");
  save_unremoved();
  reach_.known = false;
  reach_.rows.clear();
  forget_joints();
  by_elbow_side([&](int side) {
    begin_with_all(side, 0, workspace(0));
    publish_values(side, workspace(0));
  });
  if (!workspace(0).reaches_any()) return -1;
  ReachSweep sweep(*this);
  sweep.run();
  reach_.deepest = sweep.deepest();
  reach_.best = sweep.keep_deepest();
  reach_.known = true;
  reach_.removed = verdicts_.removed();
  return reach_.deepest;
}

}  // namespace swivel
