// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "cost_to_go/grid/grid_tiles.hpp"

namespace swivel {

GridCostToGo::LayerJoints& GridCostToGo::joints(int side, int layer) {
  LayerJoints* joints = &passing_[static_cast<std::size_t>(2 * side + layer % 2)];
  if (joints->layer != layer) {
    const int n = lattice_->angles(), window = lattice_->window();
    joints->layer = layer;
    lattice_->lay_out(layer, (n - window % n) % n, n + 2 * window, joints->nodes);
    joints->solved.assign(static_cast<std::size_t>(tile_columns()), 0);
    joints->of_tile.resize(tile_of_layer(lattice_->solutions(), 0));
    joints->of_layer.assign(static_cast<std::size_t>(lattice_->solutions()), {});
  }
  return *joints;
}

void GridCostToGo::solve_columns(Workspace& workspace, int side, int first, int last) {
  Workspace::Half& half = workspace.half(side);
  if (!half.joints) half.joints = &joints(side, half.layer);
  LayerJoints& joints = *half.joints;
  const int n = lattice_->angles(), window = lattice_->window();
  for (int column = first, next = first; column < last; column = next) {
    next = column + 1;
    if (joints.solved[static_cast<std::size_t>(column)]) continue;
    while (next < last && !joints.solved[static_cast<std::size_t>(next)]) ++next;
    std::fill(joints.solved.begin() + column, joints.solved.begin() + next, std::uint8_t{1});
    const int begin = column * kTileWidth, end = std::min(n, next * kTileWidth);
    half.ik_nodes += static_cast<std::int64_t>(end - begin) * half_solutions();
    lattice_->solve_part(side, window + begin, window + end, joints.nodes);
    for (int done = column; done < next; ++done) find_ranges(joints, side, done);
    // The window reaches around the circle.
    if (begin < window)
      joints.nodes.repeat(side, window + begin, window + begin + n, std::min(end, window) - begin);
    if (end > n - window) {
      const int from = std::max(begin, n - window);
      joints.nodes.repeat(side, window + from, window + from - n, end - from);
    }
  }
}

void GridCostToGo::find_ranges(LayerJoints& joints, int side, int column) const {
  const int half = lattice_->solutions() / 2, begin = lattice_->window() + column * kTileWidth;
  const int count = std::min(kTileWidth, lattice_->angles() - column * kTileWidth);
  for (std::size_t m = 0; m < MiddleRanges::kJoints.size(); ++m) {
    std::array<const double*, 2> known{};  // solutions share arrays: two for each sign of a triple
    std::array<JointRange, 2> found;
    for (int solution = side * half; solution < (side + 1) * half; ++solution) {
      const double* q = joints.nodes.q(solution, MiddleRanges::kJoints[m]) + begin;
      if (q != known[0]) {
        std::swap(known[0], known[1]);
        std::swap(found[0], found[1]);
      }
      if (q != known[0]) {
        known[0] = q;
        found[0] = JointRange(q, count);
      }
      joints.of_tile[tile_of_layer(solution, column)].joint[m] = found[0];
      joints.of_layer[static_cast<std::size_t>(solution)].joint[m].add(found[0]);
    }
  }
}

void GridCostToGo::collect_counts() {
  for (auto& workspace : workspace_)
    for (Workspace::Half& half : workspace->halves) {
      ik_nodes_ += std::exchange(half.ik_nodes, 0);
      edges_ += std::exchange(half.edges, 0);
    }
}

void GridCostToGo::forget_joints() {
  passing_.resize(4);
  for (LayerJoints& joints : passing_) joints.layer = -1;
}

const LayerNodes& GridCostToGo::neighbours(int layer, int side, int column) {
  // so that neighbours along path and coordinate share no place
  constexpr std::int64_t kLayersApart = 67;
  if (neighbours_.empty()) neighbours_.resize(kNeighbourhoods);
  const std::int64_t in_layer = side * tile_columns() + column;
  Neighbours& found =
      neighbours_[static_cast<std::size_t>(layer * kLayersApart + in_layer) % kNeighbourhoods];
  if (const std::int64_t of = layer * std::int64_t{2} * tile_columns() + in_layer; found.of != of) {
    const int count = std::min(kTileWidth, lattice_->angles());
    found.of = of;
    ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->solutions() / 2;
    lattice_->lay_out(layer, column * kTileWidth, count, found.nodes);
    lattice_->solve_part(side, 0, count, found.nodes);
  }
  return found.nodes;
}

GridCostToGo::OneNode GridCostToGo::one_node(int layer, int slot) {
  const int solution = lattice_->solution_of(slot), angle = lattice_->angle_of(slot),
            column = angle / kTileWidth;
  return {&neighbours(layer, lattice_->elbow_side_of(solution), column), solution,
          angle - column * kTileWidth};
}

Config GridCostToGo::config(int layer, int slot) {
  return one_node(layer, slot).config();
}

std::optional<Config> GridCostToGo::node(int layer, int slot) {
  const OneNode node = one_node(layer, slot);
  return node.valid() ? std::optional(node.config()) : std::nullopt;
}

}  // namespace swivel
