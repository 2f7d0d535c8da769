// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <span>

#include "swivel/core/types.hpp"

namespace swivel {

struct NodeQuestion {
  int layer = 0, slot = 0;
  Config q;
};
struct EdgeQuestion {
  int layer = 0;  ///< of a; b lies in the next layer
  int a = 0, b = 0;
  Config qa, qb;
};

/// The costly predicates of nodes and edges, asked in batches; a search asks about each node and edge at most once.
/// Nodes: manipulability, clearance. Edges (both ends valid, joint steps allowed): tool-path error, clearance of the motion.
class Validity {
 public:
  virtual ~Validity() = default;
  /// answers[k] = 1 where questions[k] is valid. Spans of equal size.
  virtual void nodes(std::span<const NodeQuestion> questions, std::span<std::uint8_t> answers) = 0;
  virtual void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) = 0;
  /// False when every edge is valid as it stands, so that none need be asked.
  [[nodiscard]] virtual bool asks_edges() const = 0;
  /// True once the caller's deadline has passed or it was cancelled; polled between batches.
  [[nodiscard]] virtual bool stopped() const = 0;
};

}  // namespace swivel
