// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "swivel/collision/world.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/lattice.hpp"
#include "swivel/graph/validity.hpp"
#include "swivel/parallel/executor.hpp"

namespace swivel {

/// The costly predicates of docs/model.md, asked of the collision world on the executor's threads.
/// Nodes are asked in lanes: a batch is cut into that many runs of consecutive questions, and what a lane keeps from one posture to
/// the next (World::Query::next_below) depends on its own questions alone. So counters are the same at any number of threads.
class CollisionValidity final : public Validity {
 public:
  using Progress = std::function<void(const std::string&)>;
  CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule, Certificates certificates, Executor& executor,
                    int lanes, const Budget& budget, const Progress& progress);

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override;

  [[nodiscard]] std::int64_t nodes_checked() const { return nodes_checked_; }
  [[nodiscard]] std::int64_t edges_checked() const { return edges_checked_; }
  /// Of all workers.
  [[nodiscard]] CollisionCounters counters() const;

 private:
  void report() const;
  [[nodiscard]] NodeAnswer node(const NodeQuestion& question, World::Query& query) const;

  const Lattice* lattice_;
  const World* world_;
  EdgeRule rule_;
  Executor* executor_;
  Budget budget_;
  Progress progress_;
  std::vector<World::Query> queries_;  // one per worker
  std::vector<World::Query> lanes_;    // for nodes; empty: each node is shared out for itself
  std::int64_t nodes_checked_ = 0, edges_checked_ = 0;
};

/// Whether the failure of a pair, which the query has just named at q, is one of every node at which its bodies stand alike.
struct Sharing {
  bool shared = false;
  unsigned groups = 0;  ///< of NodeAnswer
};
[[nodiscard]] Sharing sharing_of(const Lattice& lattice, const World& world, World::Query& query, const Config& q,
                                 const BodyPair& pair);

}  // namespace swivel
