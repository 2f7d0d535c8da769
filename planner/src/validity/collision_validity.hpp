// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"
#include "swivel/parallel/executor.hpp"
#include "validity/clearance_error.hpp"
#include "validity/clearance_memory.hpp"

namespace swivel {

/// Validates nodes and edges by the costly predicates of docs/model.md, with collision queries on
/// the executor's threads. A batch is cut into a fixed number of contiguous chunks, each with
/// its own query cache (World::Query::find_violating_pair_incremental()). What a chunk caches
/// depends on its own questions alone, so that counters do not depend on the number of threads.
class CollisionValidity final : public Validity {
 public:
  /// Creates a validity for a lattice in a world. If `chunks` is 0, each question is shared out
  /// by itself, with a cache for each worker. `memory`, or null, holds what earlier plans found
  /// about the same lattice, robot and limits; `changed` is then the world of only those pairs
  /// whose objects have moved since (null: none has). References and pointers must outlive it.
  CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule,
                    EdgeMode edge_mode, DistanceProofs distance_proofs, Executor& executor,
                    int chunks, const Budget& budget, ClearanceMemory* memory = nullptr,
                    const World* changed = nullptr);

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void nodes_overlapped(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                        const std::function<void()>& work) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override;

  /// Returns how many nodes were tested, because the memory did not answer for them.
  [[nodiscard]] std::int64_t nodes_checked() const { return nodes_checked_; }
  /// Returns how many edges were tested, because the memory did not answer for them.
  [[nodiscard]] std::int64_t edges_checked() const { return edges_checked_; }
  /// Returns the collision counters of all workers and chunks.
  [[nodiscard]] CollisionCounters counters() const;

 private:
  struct Queries {
    World::Query whole;
    std::optional<World::Query> changed;
  };
  /// A question that the memory does not answer, or answers only for the pairs whose objects have
  /// not changed.
  struct Open {
    std::size_t index = 0;
    bool only_changed = false;
    /// on entry the pair to test first; then the pair that fails
    BodyPair pair = ClearanceMemory::kNoPair;
    double slack = -1;           ///< see ClearanceMemory::Finding
    ClearanceMemory::Rows rows;  ///< ClearanceMemory::EdgeFinding::rows, where they are known
  };
  [[nodiscard]] Queries make_queries() const;
  /// Calls ask(open, worker, queries) for each open question on the executor's threads; beside
  /// `work`, unless it is null.
  template <class Ask>
  void ask_open(const Ask& ask, const std::function<void()>* work = nullptr);
  void ask_nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                 const std::function<void()>* work);
  [[nodiscard]] NodeAnswer node(const NodeQuestion& question, Open& open, int worker,
                                Queries& queries);
  /// Returns true if the pair is proved to be too near at the node's exact configuration, without
  /// computing that.
  [[nodiscard]] bool fails_before_exact_config(const NodeQuestion& question, const BodyPair& pair,
                                               World::Query& query) const;
  [[nodiscard]] bool edge(const EdgeQuestion& question, Open& open, int worker, Queries& queries);
  [[nodiscard]] bool edge_of_layers(const EdgeQuestion& question, const Config& qa,
                                    const Config& qb, Open& open, Queries& queries);
  /// Returns the exact configuration of a node (Lattice::exact_config). Each worker caches recent
  /// ones, since a path's nodes are tested first and then its edges.
  [[nodiscard]] std::optional<Config> exact_config(int layer, int slot, const Config& q,
                                                   int worker);

  const Lattice* lattice_;
  const World* world_;
  ClearanceError clearance_error_;
  EdgeRule rule_;
  EdgeRule changed_rule_;  // for the pairs with changed objects, none of them a robot pair
  EdgeMode edge_mode_;
  DistanceProofs distance_proofs_;
  Executor* executor_;
  Budget budget_;
  ClearanceMemory* memory_;
  const World* changed_;
  std::vector<Queries> workers_;  // one each
  std::vector<Queries> chunks_;
  std::vector<Open> open_;
  struct Row {
    int layer = -1, slot = -1;
    std::optional<Config> q;
  };
  // [worker], at a place given by layer and slot; empty if nodes are exact configurations
  // themselves
  std::vector<std::vector<Row>> rows_;
  std::int64_t nodes_checked_ = 0, edges_checked_ = 0;
};

/// Returns the bits of the joint groups that move a pair's bodies, as NodeAnswer::groups has them.
[[nodiscard]] unsigned groups_of(const World& world, const BodyPair& pair);
/// Returns true if the failure of a pair at a node applies to every node of the layer at which its
/// bodies have the same poses (Lattice::shares_body_poses). `node` holds the node's joints, `row`
/// its exact configuration, at which `query` has just named the pair.
[[nodiscard]] bool is_shared(const Lattice& lattice, const World& world,
                             const ClearanceError& clearance_error, World::Query& query, int layer,
                             const Config& node, const Config& row, const BodyPair& pair);

}  // namespace swivel
