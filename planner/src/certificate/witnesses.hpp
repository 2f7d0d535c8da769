// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/cause.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

/// Returns a number that is not negative as an index of a container.
constexpr std::size_t index(int k) {
  return static_cast<std::size_t>(k);
}

/// Witnesses of a certificate: single causes that remove nodes or edges of a lattice, numbered in
/// the order in which they are met. Tests whether one of them removes a node or an edge, regardless
/// of the others.
class Witnesses {
 public:
  /// Creates an empty list of witnesses for a lattice in a world, whose collision queries use
  /// `distance_proofs`. `lattice`, `world` and `budget` must outlive it; `check` may be null.
  Witnesses(const Lattice& lattice, const World& world, const EdgeRule& rule,
            DistanceProofs distance_proofs, const std::shared_ptr<StateCheck>& check,
            const Budget& budget);

  /// Returns the witnesses in the order of their numbers, without values.
  [[nodiscard]] const std::vector<Cause>& all() const { return causes_; }
  /// Adds a witness that a file names. Returns false if this problem has none such: unknown joints
  /// or bodies, or a kind that is no witness.
  [[nodiscard]] bool add(const Cause& cause);

  /// Returns true if the witness removes the node at a slot of a layer. Throws Stopped.
  [[nodiscard]] bool removes_node(int witness, int layer, int slot);
  /// Returns true if the witness removes the edge from slot a of `layer` to slot b of the next
  /// layer, whose joint step is allowed. Throws Stopped.
  [[nodiscard]] bool removes_edge(int witness, int layer, int a, int b);
  /// Returns the number of a witness that removes the node; -1 if none was found. `suspected` is a
  /// witness to try early, or -1. Throws Stopped.
  [[nodiscard]] int of_node(int layer, int slot, int suspected);
  /// Returns the number of a witness that removes the edge from slot a of `layer` to slot b of the
  /// next layer; -1 if none was found. `suspected` is a witness to try early, or -1. Throws
  /// Stopped.
  [[nodiscard]] int of_edge(int layer, int a, int b, int suspected);

 private:
  struct About {
    int joint = -1;
    std::vector<BodyPair> pairs;  // links may have several bodies of a name
  };
  [[nodiscard]] int number(const Cause& cause);
  [[nodiscard]] int number(const BodyPair& pair);
  [[nodiscard]] std::optional<About> about(const Cause& cause) const;
  [[nodiscard]] Cause::Side side_of(const Config& q, int joint) const;
  [[nodiscard]] bool removes_missing(const Cause& cause, const About& about, int layer,
                                     int slot) const;
  [[nodiscard]] std::optional<Cause> of_missing(int layer, int slot) const;
  struct Move {
    Config from, to;
  };
  [[nodiscard]] std::optional<Move> move(int layer, int a, int b) const;
  [[nodiscard]] bool removes_move(const Cause& cause, const About& about, int layer, int a, int b,
                                  const Move& move);
  // For lattices that have path layers between their own (Lattice::has_layers_between).
  [[nodiscard]] std::optional<Cause> of_fault(const Lattice::InterpolatedEdge& interpolated) const;
  [[nodiscard]] bool removes_layers(const Cause& cause, const About& about, int layer, int a, int b,
                                    const Move& move);
  [[nodiscard]] int of_layers(int layer, int a, int b, const Move& move, int suspected);
  [[nodiscard]] Cause limit_of(int joint, Cause::Side side) const;

  const Lattice& lattice_;
  const World& world_;
  EdgeRule rule_;
  AskedCheck check_;
  World::Query query_;
  const Budget& budget_;
  std::vector<Cause> causes_;
  std::vector<About> about_;  // of each
};

}  // namespace swivel
