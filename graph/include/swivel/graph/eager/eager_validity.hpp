// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// Answers questions from what it asked another validity beforehand: about every node of a lattice
/// and, if it shall, about every edge between valid ones. A search that asks it is the eager
/// baseline of the same search that asks the other validity: its answer is the same. Memory: a byte
/// a node and 8 a valid edge.
class EagerValidity final : public Validity {
 public:
  /// Asks `first` about all nodes, and with `edges` about all edges; without, edges are asked when
  /// the search asks about them. Both references must outlive it. Throws Stopped.
  EagerValidity(const Lattice& lattice, Validity& first, bool edges, const Budget& budget);

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override { return first_->asks_edges(); }
  void costs(std::span<const NodeQuestion> questions, std::span<double> costs) override {
    first_->costs(questions, costs);
  }
  [[nodiscard]] bool asks_costs() const override { return first_->asks_costs(); }

 private:
  /// Returns an edge as one number, by its slots.
  [[nodiscard]] static std::uint64_t key(int a, int b) {
    return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b);
  }
  Validity* first_;
  std::vector<std::vector<std::uint8_t>> valid_;   // [layer][slot]
  std::vector<std::vector<std::uint64_t>> edges_;  // [layer] keys of valid ones, ascending
};

}  // namespace swivel
