// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/cause.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

/// Single things that remove nodes or edges of a lattice, numbered as they are met: of each it can be asked whether it removes a
/// node or an edge, whatever else does.
class Witnesses {
 public:
  Witnesses(const Lattice& lattice, const World& world, const EdgeRule& rule, Certificates certificates,
            const std::shared_ptr<StateCheck>& check, const Budget& budget);

  /// In the order of their numbers, without values.
  [[nodiscard]] const std::vector<Cause>& all() const { return causes_; }
  /// Takes one that a file names. False where it is none of this problem: unknown joints or bodies, another kind.
  [[nodiscard]] bool add(const Cause& cause);

  /// Whether one of them removes a node, or an edge from slot a of `layer` to slot b of the next, whose joint steps are allowed.
  [[nodiscard]] bool removes_node(int witness, int layer, int slot);
  [[nodiscard]] bool removes_edge(int witness, int layer, int a, int b);
  /// One that does; `likely`, where it does (-1: none is). -1: none was found.
  [[nodiscard]] int of_node(int layer, int slot, int likely);
  [[nodiscard]] int of_edge(int layer, int a, int b, int likely);

 private:
  struct About {
    int joint = -1;
    std::vector<BodyPair> pairs;  // links may have several bodies of a name
  };
  [[nodiscard]] int number(const Cause& cause);
  [[nodiscard]] int number(const BodyPair& pair);
  [[nodiscard]] std::optional<About> about(const Cause& cause) const;
  [[nodiscard]] Cause::Side side_of(const Config& q, int joint) const;
  [[nodiscard]] bool removes_missing(const Cause& cause, const About& about, int layer, int slot) const;
  [[nodiscard]] std::optional<Cause> of_missing(int layer, int slot) const;
  struct Move {
    Config from, to;
  };
  [[nodiscard]] std::optional<Move> move(int layer, int a, int b) const;
  [[nodiscard]] bool removes_move(const Cause& cause, const About& about, int layer, int a, int b, const Move& move);
  // Of lattices with layers between theirs.
  [[nodiscard]] std::optional<Cause> of_fault(const Lattice::Between& between) const;
  [[nodiscard]] bool removes_layers(const Cause& cause, const About& about, int layer, int a, int b, const Move& move);
  [[nodiscard]] int of_layers(int layer, int a, int b, const Move& move, int likely);
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
