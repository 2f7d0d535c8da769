// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/search/job_search.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

/// Returns what a straight move in joint space costs in the metric of a lattice. The roll of a
/// six-joint arm is no joint and costs nothing.
[[nodiscard]] double transition_distance(const Lattice& metric, const Config& from,
                                         const Config& to);

/// Returns a lower bound of transition_distance(metric, from, to) for all `to` with
/// lower <= to <= upper.
[[nodiscard]] double least_transition_distance(const Lattice& metric, const Config& from,
                                               const Config& lower, const Config& upper);

/// Finds transitions in a world: the straight move in joint space, else the cheapest of the ways
/// around obstacles that were found for this transition before, with other ends; else, where a
/// thorough search is asked for, one by rrt_connect(). Joints that the lattice treats as circles
/// move the short way round; the caller sees to their limits.
class JobTransitions final : public Transitions {
 public:
  /// `metric` says what moves cost; `check`: the caller's own rule on states, or null, beside which
  /// `executor` must have one thread. All references must outlive it.
  JobTransitions(const PreparedRobot& robot, const World& world, const Limits& limits,
                 const Lattice& metric, DistanceProofs proofs, Executor& executor,
                 std::shared_ptr<StateCheck> check, const Budget& budget);

  [[nodiscard]] double distance(const Config& from, const Config& to) const override {
    return transition_distance(*metric_, from, to);
  }
  [[nodiscard]] double least_distance(const Config& from, const Config& lower,
                                      const Config& upper) const override {
    return least_transition_distance(*metric_, from, lower, upper);
  }
  void find_barred(std::span<const Config> configurations, std::span<std::uint8_t> barred) override;
  void find(std::span<const TransitionQuestion> questions,
            std::span<TransitionAnswer> answers) override;

  /// Returns the corners of the way that was found for a pair, both ends included. The pair must
  /// have been answered as valid.
  [[nodiscard]] std::vector<Config> way(int transition, const Config& from, const Config& to) const;
  /// Returns the bodies that come nearer to each other at a configuration than motions may; none
  /// where none do.
  [[nodiscard]] std::optional<std::array<std::string, 2>> barred(const Config& q);
  /// Returns the bodies that bar the straight move; none where it is free.
  [[nodiscard]] std::optional<std::array<std::string, 2>> barred(const Config& from,
                                                                 const Config& to);
  /// Returns whether the caller's own rule allows the straight move from a configuration to
  /// another: states along it, at most 0.05 rad (or m) of each joint apart, both ends among them;
  /// and the moves from each of these states to the next, if the rule is asked about motions.
  [[nodiscard]] bool allows(const Config& from, const Config& to);
  [[nodiscard]] CollisionCounters counters() const;

 private:
  /// Corners between the ends of a way around obstacles, and what the moves between them cost.
  struct Chain {
    std::vector<Config> corners;
    double cost = 0;
  };
  /// A way: straight, or by a chain.
  struct Way {
    double cost = 0;
    const Chain* chain = nullptr;
  };
  using Key = std::pair<int, std::array<double, 2 * kDof>>;
  static Key key(int transition, const Config& from, const Config& to);
  /// Calls body(k, query) for k from 0 to count - 1, shared among threads.
  template <class Body>
  void for_each(std::size_t count, const Body& body);
  /// Returns whether the move from a configuration to another, which it reaches as it is, is free.
  [[nodiscard]] bool is_free(World::Query& query, const Config& from, const Config& to);
  /// Returns whether the move from a configuration to another, the short way round, is free.
  [[nodiscard]] bool free(World::Query& query, const Config& from, const Config& to) {
    return is_free(query, from, from + metric_->delta(from, to));
  }
  /// Returns the straight move, or else the cheapest known chain, if one is free.
  [[nodiscard]] std::optional<Way> known_way(World::Query& query,
                                             const TransitionQuestion& question);
  [[nodiscard]] std::optional<Chain> search(World::Query& query,
                                            const TransitionQuestion& question);
  [[nodiscard]] double cost_through(const Chain& chain, const TransitionQuestion& question) const;

  const World* world_;
  const Limits* limits_;
  const Lattice* metric_;
  Executor* executor_;
  Budget budget_;
  AskedCheck check_;
  EdgeRule rule_;
  /// Of parts of a batch, whose number does not depend on the threads, so that counters do not.
  std::vector<World::Query> queries_;
  std::map<int, std::deque<Chain>> chains_;  // by transition
  std::map<Key, const Chain*> ways_;         // of valid pairs; null: straight
};

}  // namespace swivel
