// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "grid_tiles.hpp"
#include "relax_task.hpp"

namespace swivel {

void GridCostToGo::begin_layer(int layer, Workspace& workspace) {
  const int n = lattice_->angles(), length = n + 2 * lattice_->window();
  for (const int sheet : workspace.sheets) {
    const auto row = workspace.value.begin() + static_cast<std::ptrdiff_t>(sheet) * length;
    std::fill(row, row + length, kUnreachable);
  }
  workspace.sheets.clear();
  workspace.layer = layer;
  workspace.joints = &joints(layer);
  workspace.tiles.clear();
  for (ColumnSet& reached : workspace.reached) reached.assign(static_cast<std::size_t>(tile_columns()), 0);
}

void GridCostToGo::reach_back(int step_layer, const Workspace& to, Workspace& from) {
  for (int family = 0; family < SrsLattice::kFamilies; ++family) {
    const int first_sheet = family * lattice_->sheets() / 2;
    if (!from.nodes().alive(first_sheet)) continue;  // all of a family's sheets, or none
    const std::array<bool, 2> reaches{lattice_->families_may_connect(step_layer, from.layer, family, to.layer, 0),
                                      lattice_->families_may_connect(step_layer, from.layer, family, to.layer, 1)};
    columns_.clear();
    for (int column = 0; column < tile_columns(); ++column) {
      const auto c = static_cast<std::size_t>(column);
      if ((reaches[0] && to.reached[0][c]) || (reaches[1] && to.reached[1][c])) columns_.push_back(column);
    }
    for (std::size_t k = 0, next = 0; k < columns_.size(); k = next) {
      for (next = k + 1; next < columns_.size() && columns_[next] == columns_[next - 1] + 1;) ++next;
      solve_columns(*from.joints, family, columns_[k], columns_[next - 1] + 1);
    }
    for (int sheet = first_sheet; sheet < first_sheet + lattice_->sheets() / 2; ++sheet)
      for (const int column : columns_) from.tiles.push_back({sheet, column});
  }
}

bool GridCostToGo::out_of_step(int step_layer, int joint, const JointRange& a, const JointRange& b) const {
  return !lattice_->continuous()[static_cast<std::size_t>(joint)] && a.gap(b) > lattice_->step_bound(step_layer)[joint];
}

bool GridCostToGo::may_meet(int step_layer, const MiddleRanges& a, const MiddleRanges& b) const {
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m)
    if (out_of_step(step_layer, MiddleRanges::kJoints[m], a.joint[m], b.joint[m])) return false;
  return true;
}

bool GridCostToGo::may_connect(int step_layer, const Workspace& from, int sheet, int column, const Workspace& to, int other) const {
  const MiddleRanges& own_ranges = from.joints->of_tile[tile_of_layer(sheet, column)];
  if (!may_meet(step_layer, own_ranges, to.joints->of_layer[static_cast<std::size_t>(other)])) return false;
  const Workspace::Window& windows = to.windows[tile_of_layer(other, column)];
  const double* const value = to.value.data() + static_cast<std::ptrdiff_t>(other) * (lattice_->angles() + 2 * lattice_->window());
  const auto theirs = [&](int joint) { return JointRange(to.nodes().q(other, joint), value, windows.first, windows.last + 1); };
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m) {
    JointRange& range = windows.ranges.joint[m];
    if (range.empty()) range = theirs(MiddleRanges::kJoints[m]);
    if (out_of_step(step_layer, MiddleRanges::kJoints[m], own_ranges.joint[m], range)) return false;
  }
  // Near a singular pose the outer joints of the triple must meet as well. Joints of several turns tell windings apart.
  const int begin = lattice_->window() + column * kTileWidth,
            count = std::min(kTileWidth, lattice_->angles() - column * kTileWidth);
  const bool one_family = lattice_->family_of(sheet) == lattice_->family_of(other);
  for (const int joint : SrsLattice::kOuterJoints) {
    const bool shared = one_family && from.nodes().q(sheet, joint) == from.nodes().q(other, joint);  // tells nothing apart
    if (shared || lattice_->continuous()[static_cast<std::size_t>(joint)]) continue;
    const JointRange own(from.nodes().q(sheet, joint) + begin, count);
    if (out_of_step(step_layer, joint, own, theirs(joint))) return false;
  }
  return true;
}

void GridCostToGo::relax_run(int step_layer, const Workspace& from, int sheet, int first, int count, const Workspace& to, int other,
                             double* best) {
  const int window = lattice_->window(), length = lattice_->angles() + 2 * window;
  RelaxTask<double> task = relax_task(*lattice_, step_layer);
  task.n = count;
  task.offsets = 2 * window + 1;
  for (int j = 0; j < kDof; ++j) {
    task.from[j] = from.nodes().q(sheet, j) + window + first;
    task.to[j] = to.nodes().q(other, j) + first;
  }
  task.best = best;
  task.value = to.value.data() + static_cast<std::ptrdiff_t>(other) * length + first;
  edges_ += static_cast<std::int64_t>(count) * task.offsets;
  relax_kernels().relax(task);
}

void GridCostToGo::relax(int step_layer, Workspace& from, const Workspace& to) {
  const int n = lattice_->angles();
  for (const Tile& tile : from.tiles) {
    double* const row = from.row.data() + static_cast<std::ptrdiff_t>(tile.sheet) * n;
    std::fill(row + tile.begin(), row + tile.end(n), kUnreachable);
  }
  for (std::size_t first = 0, last = 0; first < from.tiles.size(); first = last) {
    budget_.poll();
    const int sheet = from.tiles[first].sheet;
    while (last < from.tiles.size() && from.tiles[last].sheet == sheet) ++last;
    for (const int other : to.sheets) {
      if (sheet != other && (!lattice_->families_may_connect(step_layer, from.layer, lattice_->family_of(sheet), to.layer,
                                                             lattice_->family_of(other)) ||
                             !may_meet(step_layer, from.joints->of_layer[static_cast<std::size_t>(sheet)],
                                       to.joints->of_layer[static_cast<std::size_t>(other)])))
        continue;
      int begin = 0, end = 0;  // a run of columns
      const auto relax_columns = [&] {
        if (begin == end) return;
        const int stop = std::min(n, end * kTileWidth),
                  start = std::max(0, std::min(begin * kTileWidth, stop - kTileWidth));  // whole vectors
        relax_run(step_layer, from, sheet, start, stop - start, to, other, from.row.data() + sheet * n + start);
      };
      for (std::size_t k = first; k < last; ++k) {
        Tile& tile = from.tiles[k];
        if (to.windows[tile_of_layer(other, tile.column)].last < 0 ||
            (sheet != other && !may_connect(step_layer, from, sheet, tile.column, to, other)))
          continue;
        tile.live = true;
        if (tile.column != end) {
          relax_columns();
          begin = tile.column;
        }
        end = tile.column + 1;
      }
      relax_columns();
    }
  }
}

void GridCostToGo::publish_values(Workspace& workspace) {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window;
  std::size_t kept = 0;
  for (const Tile& tile : workspace.tiles) {
    if (!tile.live) continue;
    const double* row = workspace.row.data() + static_cast<std::ptrdiff_t>(tile.sheet) * n;
    double* value = workspace.value.data() + static_cast<std::ptrdiff_t>(tile.sheet) * length;
    Workspace::Window* windows = workspace.windows.data() + tile_of_layer(tile.sheet, 0);
    ColumnSet& reached = workspace.reached[static_cast<std::size_t>(lattice_->family_of(tile.sheet))];
    int first = tile.begin(), last = tile.end(n) - 1;
    while (first <= last && row[first] == kUnreachable) ++first;
    while (first <= last && row[last] == kUnreachable) --last;
    if (first > last) continue;
    workspace.tiles[kept++] = tile;
    if (workspace.sheets.empty() || workspace.sheets.back() != tile.sheet) {
      std::fill(windows, windows + tile_columns(), Workspace::Window{length, -1, {}});
      workspace.sheets.push_back(tile.sheet);
    }
    std::copy(row + first, row + last + 1, value + window + first);
    for (const int turn : {0, n, -n}) {
      const int low = std::max(0, window + first + turn), high = std::min(length - 1, window + last + turn);
      if (low > high) continue;
      if (turn != 0) std::copy(row + low - window - turn, row + high - window - turn + 1, value + low);
      // The window of column c is at the padded positions c * kTileWidth ... c * kTileWidth + kTileWidth - 1 + 2 * window.
      const int begin = std::max(0, low - 2 * window) / kTileWidth, end = std::min(tile_columns() - 1, high / kTileWidth);
      for (int c = begin; c <= end; ++c) {
        windows[c].first = std::min(windows[c].first, std::max(low, c * kTileWidth));
        windows[c].last = std::max(windows[c].last, std::min(high, c * kTileWidth + kTileWidth - 1 + 2 * window));
        reached[static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  workspace.tiles.resize(kept);
}

}  // namespace swivel
