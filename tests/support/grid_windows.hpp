// SPDX-License-Identifier: BSD-3-Clause
// Says by the definition (docs/model.md) which nodes of a grid at knots may be joined.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::test {

/// Says which nodes of neighbouring layers may be joined, in words of its own: cells on circles.
class JoinableOnGrid {
 public:
  explicit JoinableOnGrid(const PathProblem& problem) : problem_(problem) {}

  bool operator()(const KnotGrid& lattice, int layer, int a, int b) const {
    return branches_may_follow(lattice, layer, a, b) &&
           arm_angles_may_follow(lattice, layer, a, b) && rolls_may_follow(lattice, layer, a, b);
  }

 private:
  static double way_of(const KnotGrid& lattice, int layer) {
    const ToolPath& path = lattice.path_of_rows();
    return path.layer(lattice.layer_of_rows(layer + 1)).travel -
           path.layer(lattice.layer_of_rows(layer)).travel;
  }
  // The sign of the shoulder or of the wrist may change near the singular pose of its joint.
  static bool branches_may_follow(const KnotGrid& lattice, int layer, int a, int b) {
    const int changed = lattice.branch(layer, a) ^ lattice.branch(layer + 1, b);
    if (changed == 0) return true;
    if (changed != kShoulderBit && changed != kWristBit) return false;
    const auto from = lattice.node(layer, a), to = lattice.node(layer + 1, b);
    if (!from || !to) return false;
    const auto near = [&](const Config& q) {
      const SrsArm& arm = lattice.at_roll(0).arm();
      const double angle = changed == kShoulderBit ? arm.shoulder_angle(q) : arm.wrist_angle(q);
      return std::abs(std::remainder(angle, kPi)) < 0.5;
    };
    return near(*from) && near(*to);
  }
  // As far as the steps between may take the arm angle together.
  bool arm_angles_may_follow(const KnotGrid& lattice, int layer, int a, int b) const {
    const Resolution& resolution = problem_.resolution;
    const double phi_cell = kTwoPi / std::ceil(kTwoPi / resolution.dphi - 1e-9);
    const double of_step = std::max(
        1.0, std::floor(problem_.limits.arm_slope * resolution.ds / resolution.dphi + 1e-9));
    const double most =
        of_step * (lattice.layer_of_rows(layer + 1) - lattice.layer_of_rows(layer)) * phi_cell;
    const auto grid = [&](int at, int slot) {  // moved cells count by their own grid angle
      return at == 0 && problem_.start
                 ? lattice.phi(0, slot)
                 : -kPi + phi_cell * lattice.at_roll(0).angle_of(lattice.inner(at, slot));
    };
    return !(std::abs(wrap_angle(grid(layer + 1, b) - grid(layer, a))) >
             std::min(most, kPi) + 1e-9);
  }
  bool rolls_may_follow(const KnotGrid& lattice, int layer, int a, int b) const {
    if (!lattice.chain().free_roll) return true;
    const double change = lattice.roll(layer + 1, b) - lattice.roll(layer, a),
                 reach = problem_.limits.roll_slope * way_of(lattice, layer);
    const bool circle = problem_.roll->upper - problem_.roll->lower >= kTwoPi - 1e-9;
    const bool to_end = layer + 2 == lattice.layers() && lattice.is_given(layer + 1);
    if (problem_.waypoints[0].roll || to_end)  // the rolls themselves
      return std::abs(circle ? std::remainder(change, kTwoPi) : change) <= reach + 1e-9;
    // By how many values the rolls are apart, in order.
    std::vector<double> values;
    for (int rank = 0; rank < lattice.rolls(); ++rank)
      values.push_back(lattice.roll_of_rank(layer, rank));
    std::sort(values.begin(), values.end());
    const auto place = [&](int at, int slot) {
      return static_cast<int>(std::find(values.begin(), values.end(), lattice.roll(at, slot)) -
                              values.begin());
    };
    int apart = std::abs(place(layer, a) - place(layer + 1, b));
    const int n = static_cast<int>(values.size());
    if (circle) apart = std::min(apart, n - apart);
    const double cells = std::floor(reach / problem_.resolution.droll + 1e-9);
    return apart <= std::min(cells, circle ? (n - 1) / 2 : n - 1.0);
  }

  const PathProblem& problem_;
};

}  // namespace swivel::test
