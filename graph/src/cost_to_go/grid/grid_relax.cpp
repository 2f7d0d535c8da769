// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cost_to_go/grid/grid_tiles.hpp"
#include "cost_to_go/kernels/relax_task.hpp"

namespace swivel {

void GridCostToGo::begin(int side, int layer, Workspace& workspace) const {
  const int length = lattice_->angles() + 2 * lattice_->window();
  Workspace::Half& half = workspace.half(side);
  half.layer = layer;
  half.joints = nullptr;
  for (const int solution : half.solutions) {
    const auto row = workspace.value.begin() + static_cast<std::ptrdiff_t>(solution) * length;
    std::fill(row, row + length, kUnreachable);
  }
  half.solutions.clear();
  half.tiles.clear();
  half.reached.assign(static_cast<std::size_t>(tile_columns()), 0);
}

void GridCostToGo::begin_with_all(int side, int layer, Workspace& workspace) {
  begin(side, layer, workspace);
  if (!lattice_->alive(layer, side)) return;
  const int width = lattice_->width() / 2;
  std::fill_n(workspace.row.begin() + side * width, width, 0.0);
  solve_columns(workspace, side, 0, tile_columns());
  Workspace::Half& half = workspace.half(side);
  for (int solution = first_solution(side); solution < first_solution(side) + half_solutions();
       ++solution)
    for (int column = 0; column < tile_columns() && half.joints->nodes.alive(solution); ++column)
      half.tiles.push_back({solution, column, true});
  apply_masks(side, workspace);
}

void GridCostToGo::reach_back(int side, int step_layer, const Workspace& to, Workspace& from) {
  Workspace::Half& half = from.half(side);
  if (!lattice_->alive(half.layer, side)) return;
  std::vector<int>& columns = half.columns;
  columns.clear();
  const Workspace::Half& own = to.half(side);
  const Workspace::Half* other =
      lattice_->may_change_elbow_side(step_layer, half.layer, side, own.layer, 1 - side)
          ? &to.half(1 - side)
          : nullptr;
  for (int column = 0; column < tile_columns(); ++column) {
    const auto c = static_cast<std::size_t>(column);
    if (own.reached[c] || (other && other->reached[c])) columns.push_back(column);
  }
  for (std::size_t k = 0, next = 0; k < columns.size(); k = next) {
    for (next = k + 1; next < columns.size() && columns[next] == columns[next - 1] + 1;) ++next;
    solve_columns(from, side, columns[k], columns[next - 1] + 1);
  }
  for (int solution = first_solution(side); solution < first_solution(side) + half_solutions();
       ++solution)
    for (const int column : columns) half.tiles.push_back({solution, column});
}

bool GridCostToGo::out_of_step(int step_layer, int joint, const JointRange& a,
                               const JointRange& b) const {
  return !lattice_->continuous()[static_cast<std::size_t>(joint)] &&
         a.gap(b) > lattice_->step_bound(step_layer)[joint];
}

bool GridCostToGo::may_meet(int step_layer, const MiddleRanges& a, const MiddleRanges& b) const {
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m)
    if (out_of_step(step_layer, MiddleRanges::kJoints[m], a.joint[m], b.joint[m])) return false;
  return true;
}

bool GridCostToGo::may_connect(int step_layer, const Workspace& from, int solution, int column,
                               const Workspace& to, int other) const {
  const LayerJoints &own_joints = *from.half(lattice_->elbow_side_of(solution)).joints,
                    &other_joints = *to.half(lattice_->elbow_side_of(other)).joints;
  const MiddleRanges& own_ranges = own_joints.of_tile[tile_of_layer(solution, column)];
  if (!may_meet(step_layer, own_ranges, other_joints.of_layer[static_cast<std::size_t>(other)]))
    return false;
  const Workspace::Window& windows = to.windows[tile_of_layer(other, column)];
  const double* const value = to.value.data() + static_cast<std::ptrdiff_t>(other) *
                                                    (lattice_->angles() + 2 * lattice_->window());
  const auto theirs = [&](int joint) {
    return JointRange(other_joints.nodes.q(other, joint), value, windows.first, windows.last + 1);
  };
  MiddleRanges& ranges =
      windows.ranges[static_cast<std::size_t>(lattice_->elbow_side_of(solution))];
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m) {
    JointRange& range = ranges.joint[m];
    if (range.empty()) range = theirs(MiddleRanges::kJoints[m]);
    if (out_of_step(step_layer, MiddleRanges::kJoints[m], own_ranges.joint[m], range)) return false;
  }
  // Near a singular pose the outer joints of the triple must meet as well. Joints of several turns
  // tell windings apart.
  const int begin = lattice_->window() + column * kTileWidth,
            count = std::min(kTileWidth, lattice_->angles() - column * kTileWidth);
  const bool one_elbow_side = lattice_->elbow_side_of(solution) == lattice_->elbow_side_of(other);
  for (const int joint : SrsLattice::kOuterJoints) {
    const double* q = own_joints.nodes.q(solution, joint);
    // shared, so it tells nothing apart
    const bool shared = one_elbow_side && q == own_joints.nodes.q(other, joint);
    if (shared || lattice_->continuous()[static_cast<std::size_t>(joint)]) continue;
    const JointRange own(q + begin, count);
    if (out_of_step(step_layer, joint, own, theirs(joint))) return false;
  }
  return true;
}

void GridCostToGo::relax_run(int step_layer, Workspace& from, int solution, int first, int count,
                             const Workspace& to, int other, double* best) {
  const int window = lattice_->window(), length = lattice_->angles() + 2 * window;
  Workspace::Half& half = from.half(lattice_->elbow_side_of(solution));
  const LayerNodes& other_nodes = to.half(lattice_->elbow_side_of(other)).joints->nodes;
  RelaxTask<double> task = relax_task(*lattice_, step_layer);
  task.n = count;
  task.offsets = 2 * window + 1;
  for (int j = 0; j < kDof; ++j) {
    task.from[j] = half.joints->nodes.q(solution, j) + window + first;
    task.to[j] = other_nodes.q(other, j) + first;
  }
  task.best = best;
  task.value = to.value.data() + static_cast<std::ptrdiff_t>(other) * length + first;
  half.edges += static_cast<std::int64_t>(count) * task.offsets;
  relax_kernels().relax(task);
}

void GridCostToGo::relax(int side, int step_layer, Workspace& from, const Workspace& to) {
  const int n = lattice_->angles();
  const Workspace::Half& here = from.half(side);
  std::vector<Tile>& tiles = from.half(side).tiles;
  for (const Tile& tile : tiles) {
    double* const row = from.row.data() + static_cast<std::ptrdiff_t>(tile.solution) * n;
    std::fill(row + tile.begin(), row + tile.end(n), kUnreachable);
  }
  if (!here.joints) return;  // no column is reached
  std::array<bool, SrsLattice::kElbowSides> meets;
  for (int other = 0; other < SrsLattice::kElbowSides; ++other)
    meets[static_cast<std::size_t>(other)] =
        lattice_->may_change_elbow_side(step_layer, here.layer, side, to.half(side).layer, other);
  for (std::size_t first = 0, last = 0; first < tiles.size(); first = last) {
    budget_.poll();
    const int solution = tiles[first].solution;
    while (last < tiles.size() && tiles[last].solution == solution) ++last;
    const auto relax_with = [&](int other, const LayerJoints& joints) {
      if (solution != other &&
          !may_meet(step_layer, here.joints->of_layer[static_cast<std::size_t>(solution)],
                    joints.of_layer[static_cast<std::size_t>(other)]))
        return;
      int begin = 0, end = 0;  // a run of columns
      const auto relax_columns = [&] {
        if (begin == end) return;
        const int stop = std::min(n, end * kTileWidth),
                  // whole vectors
            start = std::max(0, std::min(begin * kTileWidth, stop - kTileWidth));
        relax_run(step_layer, from, solution, start, stop - start, to, other,
                  from.row.data() + solution * n + start);
      };
      for (std::size_t k = first; k < last; ++k) {
        Tile& tile = tiles[k];
        if (to.windows[tile_of_layer(other, tile.column)].last < 0 ||
            (solution != other && !may_connect(step_layer, from, solution, tile.column, to, other)))
          continue;
        tile.live = true;
        if (tile.column != end) {
          relax_columns();
          begin = tile.column;
        }
        end = tile.column + 1;
      }
      relax_columns();
    };
    for (int others = 0; others < SrsLattice::kElbowSides; ++others)
      if (meets[static_cast<std::size_t>(others)])
        for (const int other : to.half(others).solutions)
          relax_with(other, *to.half(others).joints);
  }
}

void GridCostToGo::publish_values(int side, Workspace& workspace) const {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window;
  Workspace::Half& half = workspace.half(side);
  std::size_t kept = 0;
  for (const Tile& tile : half.tiles) {
    if (!tile.live) continue;
    const double* row = workspace.row.data() + static_cast<std::ptrdiff_t>(tile.solution) * n;
    double* value = workspace.value.data() + static_cast<std::ptrdiff_t>(tile.solution) * length;
    Workspace::Window* windows = workspace.windows.data() + tile_of_layer(tile.solution, 0);
    int first = tile.begin(), last = tile.end(n) - 1;
    while (first <= last && row[first] == kUnreachable) ++first;
    while (first <= last && row[last] == kUnreachable) --last;
    if (first > last) continue;
    half.tiles[kept++] = tile;
    if (half.solutions.empty() || half.solutions.back() != tile.solution) {
      std::fill(windows, windows + tile_columns(), Workspace::Window{length, -1, {}});
      half.solutions.push_back(tile.solution);
    }
    std::copy(row + first, row + last + 1, value + window + first);
    for (const int turn : {0, n, -n}) {
      const int low = std::max(0, window + first + turn),
                high = std::min(length - 1, window + last + turn);
      if (low > high) continue;
      if (turn != 0)
        std::copy(row + low - window - turn, row + high - window - turn + 1, value + low);
      // The window of column c is at the padded positions c * kTileWidth ... c * kTileWidth +
      // kTileWidth - 1 + 2 * window.
      const int begin = std::max(0, low - 2 * window) / kTileWidth,
                end = std::min(tile_columns() - 1, high / kTileWidth);
      for (int c = begin; c <= end; ++c) {
        windows[c].first = std::min(windows[c].first, std::max(low, c * kTileWidth));
        windows[c].last =
            std::max(windows[c].last, std::min(high, c * kTileWidth + kTileWidth - 1 + 2 * window));
        half.reached[static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  half.tiles.resize(kept);
}

}  // namespace swivel
