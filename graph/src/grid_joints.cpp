// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "grid_tiles.hpp"

namespace swivel {

GridCostToGo::LayerJoints& GridCostToGo::joints(int layer) {
  LayerJoints* joints = &passing_[static_cast<std::size_t>(layer) % passing_.size()];
  if (joints->layer != layer) {
    const int n = lattice_->angles(), window = lattice_->window();
    joints->layer = layer;
    lattice_->lay_out(layer, (n - window % n) % n, n + 2 * window, joints->nodes);
    for (auto& solved : joints->solved) solved.assign(static_cast<std::size_t>(tile_columns()), 0);
    joints->of_tile.resize(tile_of_layer(lattice_->sheets(), 0));
    joints->of_layer.assign(static_cast<std::size_t>(lattice_->sheets()), {});
  }
  return *joints;
}

/// Each counts once it is wanted, whether it was solved ahead or not.
void GridCostToGo::solve_columns(LayerJoints& joints, int family, int first, int last) {
  ColumnSet& solved = joints.solved[static_cast<std::size_t>(family)];
  const int n = lattice_->angles();
  for (int column = first; column < last; ++column)
    if (solved[static_cast<std::size_t>(column)] != LayerJoints::kWanted)
      ik_nodes_ += static_cast<std::int64_t>(std::min(n, (column + 1) * kTileWidth) - column * kTileWidth) * lattice_->sheets() / 2;
  solve_open(joints, family, first, last);
  std::fill(solved.begin() + first, solved.begin() + last, LayerJoints::kWanted);
}

void GridCostToGo::solve_open(LayerJoints& joints, int family, int first, int last) const {
  ColumnSet& solved = joints.solved[static_cast<std::size_t>(family)];
  const int n = lattice_->angles(), window = lattice_->window();
  for (int column = first, next = first; column < last; column = next) {
    next = column + 1;
    if (solved[static_cast<std::size_t>(column)] != LayerJoints::kOpen) continue;
    while (next < last && solved[static_cast<std::size_t>(next)] == LayerJoints::kOpen) ++next;
    std::fill(solved.begin() + column, solved.begin() + next, LayerJoints::kAhead);
    const int begin = column * kTileWidth, end = std::min(n, next * kTileWidth);
    lattice_->solve_part(family, window + begin, window + end, joints.nodes);
    for (int done = column; done < next; ++done) find_ranges(joints, family, done);
    // The window reaches around the circle.
    if (begin < window) joints.nodes.repeat(window + begin, window + begin + n, std::min(end, window) - begin);
    if (end > n - window) {
      const int from = std::max(begin, n - window);
      joints.nodes.repeat(window + from, window + from - n, end - from);
    }
  }
}

/// Layers beside each other reach much the same columns: threads solve them for the layers to come, a few at a time.
void GridCostToGo::solve_ahead(int layer, int by, const Workspace& reached) {
  const int left = by < 0 ? layer + 1 : lattice_->layers() - layer, count = std::min(kLayersAhead, left);
  if (work_.threads == 1 || layer % kLayersAhead != 0) return;
  std::array<LayerJoints*, kLayersAhead> ahead;
  for (int k = 0; k < count; ++k) ahead[static_cast<std::size_t>(k)] = &joints(layer + by * k);
  work_.for_each(count, [&](int k, int) {
    for (int family = 0; family < SrsLattice::kFamilies; ++family) {
      LayerJoints& joints = *ahead[static_cast<std::size_t>(k)];
      const ColumnSet& columns = reached.reached[static_cast<std::size_t>(family)];
      if (!joints.nodes.alive(family * lattice_->sheets() / 2)) continue;
      for (int column = 0, next = 0; column < tile_columns(); column = next) {
        next = column + 1;
        if (!columns[static_cast<std::size_t>(column)]) continue;
        while (next < tile_columns() && columns[static_cast<std::size_t>(next)]) ++next;
        solve_open(joints, family, column, next);
      }
    }
  });
}

void GridCostToGo::find_ranges(LayerJoints& joints, int family, int column) const {
  const int half = lattice_->sheets() / 2, begin = lattice_->window() + column * kTileWidth;
  const int count = std::min(kTileWidth, lattice_->angles() - column * kTileWidth);
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m) {
    std::array<const double*, 2> known{};  // sheets share arrays: two for each sign of a triple
    std::array<JointRange, 2> found;
    for (int sheet = family * half; sheet < (family + 1) * half; ++sheet) {
      const double* q = joints.nodes.q(sheet, MiddleRanges::kJoints[m]) + begin;
      if (q != known[0]) {
        std::swap(known[0], known[1]);
        std::swap(found[0], found[1]);
      }
      if (q != known[0]) {
        known[0] = q;
        found[0] = JointRange(q, count);
      }
      joints.of_tile[tile_of_layer(sheet, column)].joint[m] = found[0];
      joints.of_layer[static_cast<std::size_t>(sheet)].joint[m].add(found[0]);
    }
  }
}

void GridCostToGo::forget_joints() {
  passing_.resize(work_.threads > 1 ? kLayersAhead + 1 : 2);
  for (LayerJoints& joints : passing_) joints.layer = -1;
}

GridCostToGo::OneNode GridCostToGo::one_node(int layer, int slot) {
  constexpr std::int64_t kLayersApart = 67;  // neighbours along the path and along the coordinate must not share a place
  const int sheet = lattice_->sheet_of(slot), family = lattice_->family_of(sheet), angle = lattice_->angle_of(slot);
  const int column = angle / kTileWidth, count = std::min(kTileWidth, lattice_->angles());
  if (neighbours_.empty()) neighbours_.resize(kNeighbourhoods);
  const std::int64_t in_layer = family * tile_columns() + column;
  Neighbours& found = neighbours_[static_cast<std::size_t>(layer * kLayersApart + in_layer) % kNeighbourhoods];
  if (const std::int64_t of = layer * std::int64_t{2} * tile_columns() + in_layer; found.of != of) {
    found.of = of;
    ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->sheets() / 2;
    lattice_->lay_out(layer, column * kTileWidth, count, found.nodes);
    lattice_->solve_part(family, 0, count, found.nodes);
  }
  return {&found.nodes, sheet, angle - column * kTileWidth};
}

Config GridCostToGo::config(int layer, int slot) {
  return one_node(layer, slot).config();
}

std::optional<Config> GridCostToGo::node(int layer, int slot) {
  const OneNode node = one_node(layer, slot);
  return node.valid() ? std::optional(node.config()) : std::nullopt;
}

}  // namespace swivel
