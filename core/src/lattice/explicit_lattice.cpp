// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/explicit_lattice.hpp"

#include <numeric>
#include <stdexcept>
#include <utility>

#include "swivel/core/messages/input_error.hpp"

namespace swivel {

ExplicitLattice::ExplicitLattice(const Chain& chain, const ToolPath& path,
                                 const PathProblem& problem, std::vector<std::vector<Point>> layers,
                                 const std::array<bool, kDof>& circles)
    : ExplicitLattice(chain, Knots(path), problem, shared(std::move(layers)), circles) {}

ExplicitLattice::Layers ExplicitLattice::shared(std::vector<std::vector<Point>> layers) {
  Layers all;
  all.reserve(layers.size());
  for (std::vector<Point>& layer : layers)
    all.push_back(std::make_shared<const std::vector<Point>>(std::move(layer)));
  return all;
}

ExplicitLattice::ExplicitLattice(const Chain& chain, Knots knots, const PathProblem& problem,
                                 Layers layers, const std::array<bool, kDof>& circles)
    : Lattice(chain, std::move(knots), problem), points_(std::move(layers)) {
  if (static_cast<int>(points_.size()) != this->layers())
    throw std::invalid_argument("explicit lattice: " + std::to_string(points_.size()) +
                                " layers of nodes: allowed are as many as the path has, " +
                                std::to_string(this->layers()));
  if (limits_.step_error)
    throw InputError(problem.source,
                     "limits.step_error: needs the closed form of an S-R-S arm: allowed is null");
  treat_as_circles(circles);
  for (const auto& layer : points_) nodes_ += static_cast<std::int64_t>(layer->size());
}

void ExplicitLattice::layer_nodes(int layer, std::vector<Node>& out) const {
  out.clear();
  for (int slot = 0; slot < slots(layer); ++slot) out.push_back({slot, point(layer, slot).q});
}

void ExplicitLattice::slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                                 std::vector<int>& out) const {
  if (!shares_body_poses(groups)) return out.assign(1, slot);
  out.resize(static_cast<std::size_t>(slots(layer)));
  std::iota(out.begin(), out.end(), 0);
}

}  // namespace swivel
