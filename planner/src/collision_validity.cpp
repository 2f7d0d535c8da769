// SPDX-License-Identifier: BSD-3-Clause
#include "collision_validity.hpp"

namespace swivel {

EdgeRule edge_rule(const Limits& limits, const std::array<double, kDof>& radii) {
  EdgeRule rule;
  rule.radii = radii;
  rule.d_edge = limits.d_edge();
  rule.h = limits.edge_tolerance;
  return rule;
}

CollisionValidity::CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule, Executor& executor, const Stop& stop)
    : lattice_(&lattice), world_(&world), rule_(rule), executor_(&executor), stop_(&stop) {
  queries_.reserve(static_cast<std::size_t>(executor.threads()));
  for (int worker = 0; worker < executor.threads(); ++worker) queries_.emplace_back(world);
}

void CollisionValidity::nodes(std::span<const NodeQuestion> questions, std::span<std::uint8_t> answers) {
  nodes_checked_ += static_cast<std::int64_t>(questions.size());
  executor_->for_each(static_cast<int>(questions.size()), [&](int index, int worker) {
    const Config& q = questions[static_cast<std::size_t>(index)].q;
    answers[static_cast<std::size_t>(index)] =
        lattice_->manipulable(q) && !queries_[static_cast<std::size_t>(worker)].first_below(q, lattice_->limits().clearance);
  });
}

void CollisionValidity::edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) {
  edges_checked_ += static_cast<std::int64_t>(questions.size());
  executor_->for_each(static_cast<int>(questions.size()), [&](int index, int worker) {
    const EdgeQuestion& x = questions[static_cast<std::size_t>(index)];
    const Config unwrapped = x.qa + lattice_->delta(x.qa, x.qb);
    answers[static_cast<std::size_t>(index)] =
        lattice_->follows_path(x.layer, x.a, x.qa, x.b, x.qb) &&
        (lattice_->limits().edges == EdgeMode::kNodes || !edge_blocked(queries_[static_cast<std::size_t>(worker)], rule_, x.qa, unwrapped));
  });
}

bool CollisionValidity::asks_edges() const {
  return lattice_->asks_path_error() || (lattice_->limits().edges == EdgeMode::kContinuous && !world_->pairs().empty());
}

bool CollisionValidity::stopped() const { return stop_->reason() != Stop::Reason::kNone; }

std::int64_t CollisionValidity::fcl_calls() const {
  std::int64_t calls = 0;
  for (const World::Query& query : queries_) calls += query.counters().fcl_calls;
  return calls;
}

}  // namespace swivel
