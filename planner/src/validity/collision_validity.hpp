// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"
#include "swivel/parallel/executor.hpp"
#include "validity/clearance_memory.hpp"
#include "validity/row_margin.hpp"

namespace swivel {

/// The costly predicates of docs/model.md, asked of the collision world on the executor's threads.
/// A batch is asked in partitions, so many runs of consecutive questions, and what a partition keeps from one
/// posture to the next (World::Query::next_below) depends on its own questions alone. So counters are the same at any number of
/// threads.
class CollisionValidity final : public Validity {
 public:
  /// `partitions` 0: each question is shared out for itself. `memory`: what is known of the same lattice, robot and limits, and of
  /// `changed`, the pairs with objects that moved since (null: none did); null for none.
  CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule, EdgeMode edge_mode, Certificates certificates,
                    Executor& executor, int partitions, const Budget& budget, ClearanceMemory* memory = nullptr,
                    const World* changed = nullptr);

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void nodes_beside(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                    const std::function<void()>& work) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override;

  /// Of those that were not known.
  [[nodiscard]] std::int64_t nodes_checked() const { return nodes_checked_; }
  [[nodiscard]] std::int64_t edges_checked() const { return edges_checked_; }
  /// Of all workers.
  [[nodiscard]] CollisionCounters counters() const;

 private:
  struct Queries {
    World::Query whole;
    std::optional<World::Query> changed;
  };
  /// A question that the memory does not answer in full.
  struct Open {
    std::size_t index = 0;
    bool only_changed = false;
    BodyPair pair = ClearanceMemory::kNoPair;  ///< of the failure; before: the likely
    double spare = -1;                         ///< of ClearanceMemory::Finding
  };
  [[nodiscard]] Queries make_queries() const;
  /// ask(open, worker, queries) for what is open, on the executor's threads; beside `work`, unless it is null.
  template <class Ask>
  void ask_open(const Ask& ask, const std::function<void()>* work = nullptr);
  void ask_nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers, const std::function<void()>* work);
  [[nodiscard]] NodeAnswer node(const NodeQuestion& question, Open& open, int worker, Queries& queries);
  /// Whether the pair is too near in the node's row, wherever that is.
  [[nodiscard]] bool fails_before_row(const NodeQuestion& question, const BodyPair& pair, World::Query& query) const;
  [[nodiscard]] bool edge(const EdgeQuestion& question, Open& open, int worker, Queries& queries);
  [[nodiscard]] bool edge_of_layers(const EdgeQuestion& question, const Config& qa, const Config& qb, Open& open,
                                    World::Query& query);
  /// Lattice::row, remembered by each worker for a while: a path's nodes are asked about, and then its edges.
  [[nodiscard]] std::optional<Config> row(int layer, int slot, const Config& q, int worker);

  const Lattice* lattice_;
  const World* world_;
  RowMargin row_margin_;
  EdgeRule rule_;
  EdgeRule changed_rule_;  // of the changed objects' pairs, of which none is the robot's own
  EdgeMode edge_mode_;
  Certificates certificates_;
  Executor* executor_;
  Budget budget_;
  ClearanceMemory* memory_;
  const World* changed_;
  std::vector<Queries> workers_;  // one each
  std::vector<Queries> partitions_;
  std::vector<Open> open_;
  struct Row {
    int layer = -1, slot = -1;
    std::optional<Config> q;
  };
  std::vector<std::vector<Row>> rows_;  // [worker], at a place that layer and slot give; empty where nodes are their own rows
  std::int64_t nodes_checked_ = 0, edges_checked_ = 0;
};

/// The groups of a pair's bodies, as NodeAnswer has them.
[[nodiscard]] unsigned groups_of(const World& world, const BodyPair& pair);
/// Whether the failure of a pair, which the query has just named at the row of a node of the layer, is one of every node at which
/// its bodies stand alike.
[[nodiscard]] bool is_shared(const Lattice& lattice, const World& world, const RowMargin& row_margin, World::Query& query,
                             int layer, const Config& node, const Config& row, const BodyPair& pair);

}  // namespace swivel
