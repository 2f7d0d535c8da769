// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// The cause by which a node fails, numbered as a Validity likes. It serves as a hint for questions
/// about nodes nearby, which often fail by the same cause.
using FailureId = std::int64_t;
/// No hint.
inline constexpr FailureId kNoFailure = -1;

/// A question whether a node is valid.
struct NodeQuestion {
  int layer = 0, slot = 0;
  Config q;
  FailureId suspected = kNoFailure;
  /// True: the answer only has to find whether the node fails by `suspected`, or by a collision
  /// with the scene that is cheap to find. The answer "valid" then proves nothing.
  bool only_scene = false;
};
/// A question whether an edge is valid.
struct EdgeQuestion {
  int layer = 0;  ///< layer of node a; b lies in the next layer
  /// slots
  int a = 0, b = 0;
  /// joints of the two nodes, rad
  Config qa, qb;
};

/// The answer to a NodeQuestion.
struct NodeAnswer {
  bool valid = false;
  /// Of a failure: true if every node of the layer fails at which the bodies of `groups` stand as
  /// they do at this one, see Lattice::slots_with_same_body_poses(). So one failure may remove many
  /// nodes.
  bool shared = false;
  unsigned groups = 0;             ///< bit g: the bodies that move with joint g of 1..7
  FailureId failure = kNoFailure;  ///< the cause of a failure
};

/// Answers the costly questions about nodes and edges, in batches; a search asks about each node
/// and edge at most once. A node is valid if it has a row (Lattice::exact_config()) that keeps
/// manipulability, clearance and a user's check. An edge, whose nodes' joint steps are allowed, is
/// valid if its rows' joint steps, tool-path error, clearance of the motion and a user's check
/// allow it. Questions give the joints of nodes. Every batch throws Stopped once the caller's
/// budget is spent.
class Validity {
 public:
  virtual ~Validity() = default;
  /// Sets answers[k] to the answer to questions[k]. Both spans have equal size.
  virtual void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) = 0;
  /// Answers like nodes(), on other threads if there are any while the caller does `work`; without
  /// threads `work` comes first. `work` must ask nothing and touch neither span. If it throws, this
  /// function throws the same, and answers may be missing.
  virtual void nodes_overlapped(std::span<const NodeQuestion> questions,
                                std::span<NodeAnswer> answers, const std::function<void()>& work) {
    work();
    nodes(questions, answers);
  }
  /// Sets answers[k] to 1 if questions[k] is valid, else to 0. Both spans have equal size.
  virtual void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) = 0;
  /// Returns false if every edge is valid as it is, so that edges() need not be asked.
  [[nodiscard]] virtual bool asks_edges() const = 0;
  /// Sets costs[k] to what the node of questions[k] itself costs, valid or not: >= 0, rounded by
  /// Lattice::rounded_cost(). Asked only where asks_costs(). Both spans have equal size.
  virtual void costs(std::span<const NodeQuestion> questions, std::span<double> costs) {
    static_cast<void>(questions), static_cast<void>(costs);
  }
  /// Returns false if no node costs anything.
  [[nodiscard]] virtual bool asks_costs() const { return false; }
};

}  // namespace swivel
