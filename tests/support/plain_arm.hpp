// SPDX-License-Identifier: BSD-3-Clause
// One arm of a workcell for plain programs, which look at all of its nodes.
#pragma once
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "plain_edge_rule.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::test {

inline constexpr double kNone = std::numeric_limits<double>::infinity();

/// One arm for the plain program, with nodes at every layer: the nodes of each layer that its own
/// world allows, and which of its edges that world allows, asked when they are needed. The world is
/// asked about the exact joints of nodes (Lattice::exact_config()).
class PlainArm {
 public:
  PlainArm(const PathProblem& problem, const PreparedRobot& robot)
      : path_(problem_path(problem, robot.arm().chain)),
        lattice_(make_lattice(robot.arm().chain, robot.arm_class(), path_,
                              on_all_layers(problem, robot.arm_class()))),
        world_(robot.world(), problem),
        rule_(world_.edge_rule(robot.radii())),
        query_(world_, DistanceProofs::kOff) {
    layers_.resize(static_cast<std::size_t>(lattice_->layers()));
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      std::vector<Lattice::Node> nodes;
      lattice_->layer_nodes(static_cast<int>(i), nodes);
      auto& exact = exact_.emplace_back();
      for (const Lattice::Node& node : nodes) {
        const auto q = lattice_->exact_config(static_cast<int>(i), node.slot, node.q);
        if (!q || query_.find_violating_pair(*q, ClearanceRule::kNode)) continue;
        layers_[i].push_back(node);
        exact.push_back(*q);
      }
    }
  }
  [[nodiscard]] std::size_t layers() const { return layers_.size(); }
  [[nodiscard]] const std::vector<Lattice::Node>& nodes(std::size_t layer) const {
    return layers_[layer];
  }
  /// Returns the exact joints of node k of a layer, rad.
  [[nodiscard]] const Config& exact(std::size_t layer, std::size_t k) const {
    return exact_[layer][k];
  }
  struct Edge {
    std::size_t to = 0;
    double cost = 0;
  };
  /// Returns the edges that are not known to be invalid from node a of a layer.
  [[nodiscard]] std::vector<Edge> edges(std::size_t layer, std::size_t a) const {
    std::vector<Edge> edges;
    const Lattice::Node& from = layers_[layer][a];
    for (std::size_t b = 0; b < layers_[layer + 1].size(); ++b) {
      const Lattice::Node& to = layers_[layer + 1][b];
      const int i = static_cast<int>(layer);
      const Config delta = lattice_->delta(from.q, to.q);
      if (lattice_->in_window(i, from.slot, to.slot) && lattice_->step_allowed(i, delta) &&
          !invalid_.contains({layer, a, b}))
        edges.push_back({b, lattice_->edge_cost(delta)});
    }
    return edges;
  }
  /// Returns whether an edge is valid; if not, edges() leaves it out from now on.
  bool valid(std::size_t layer, std::size_t a, std::size_t b) {
    const Config &from = exact(layer, a), &to = exact(layer + 1, b);
    const int i = static_cast<int>(layer);
    const bool valid =
        (!lattice_->is_approximate() || lattice_->row_step_allowed(i, lattice_->delta(from, to))) &&
        lattice_->follows_path(i, layers_[layer][a].slot, from, layers_[layer + 1][b].slot, to) &&
        !edge_blocked_plain(query_, rule_, from, to);
    if (!valid) invalid_.insert({layer, a, b});
    return valid;
  }

 private:
  ToolPath path_;
  std::unique_ptr<Lattice> lattice_;
  World world_;
  EdgeRule rule_;
  World::Query query_;
  std::vector<std::vector<Lattice::Node>> layers_;
  std::vector<std::vector<Config>> exact_;
  std::set<std::tuple<std::size_t, std::size_t, std::size_t>> invalid_;
};

inline PlanOptions lazily() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.check = true;
  return options;
}

/// Expects the same number of rows with the same joints, bit for bit.
inline void expect_equal_rows(const std::vector<TrajectoryRow>& one,
                              const std::vector<TrajectoryRow>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t row = 0; row < one.size(); ++row) EXPECT_EQ(one[row].q, other[row].q);
}

}  // namespace swivel::test
