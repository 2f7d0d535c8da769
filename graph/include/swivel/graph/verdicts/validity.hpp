// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// What a node fails by, numbered as the Validity likes: a hint for questions about nodes nearby, which often fail by the same.
using FailureId = std::int64_t;
inline constexpr FailureId kNoFailure = -1;

struct NodeQuestion {
  int layer = 0, slot = 0;
  Config q;
  FailureId likely = kNoFailure;
  /// Nothing is asked but whether the node fails by `likely` or by what stands around the robot, as far as that is soon seen. An
  /// answer of valid says nothing.
  bool only_scene = false;
};
struct EdgeQuestion {
  int layer = 0;  ///< of a; b lies in the next layer
  int a = 0, b = 0;
  Config qa, qb;
};

struct NodeAnswer {
  bool valid = false;
  /// Of a failure: true where it is one of every node of the layer at which the bodies of `groups` stand as they do here, see
  /// Lattice::alike. So one failure may remove many nodes.
  bool shared = false;
  unsigned groups = 0;             ///< bit g: the bodies that move with joint g of 1..7
  FailureId failure = kNoFailure;  ///< of a failure
};

/// The costly predicates of nodes and edges, asked in batches; a search asks about each node and edge at most once. A batch throws
/// Stopped where the budget of the caller is spent.
/// Nodes: that they have a row (Lattice::row), its manipulability, clearance and a user's check. Edges (joint steps of the nodes
/// allowed): joint steps of the rows, tool-path error, clearance of the motion, a user's check. Questions give joints of nodes.
class Validity {
 public:
  virtual ~Validity() = default;
  /// Spans of equal size.
  virtual void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) = 0;
  /// The same on other threads, where there are any, while the caller does `work`; `work` first, where there are none. It asks
  /// nothing and touches neither span. Where it throws, so does this, and the answers may be missing.
  virtual void nodes_beside(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                            const std::function<void()>& work) {
    work();
    nodes(questions, answers);
  }
  /// answers[k] = 1 where questions[k] is valid.
  virtual void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) = 0;
  /// False when every edge is valid as it stands, so that none need be asked.
  [[nodiscard]] virtual bool asks_edges() const = 0;
  /// What nodes themselves cost, valid or not: >= 0, rounded by Lattice::rounded_cost. Asked only where asks_costs(). Spans of
  /// equal size.
  virtual void costs(std::span<const NodeQuestion> questions, std::span<double> costs) {
    static_cast<void>(questions), static_cast<void>(costs);
  }
  /// False when no node costs anything.
  [[nodiscard]] virtual bool asks_costs() const { return false; }
};

}  // namespace swivel
