// SPDX-License-Identifier: BSD-3-Clause
// Verdicts of which chance decides, the same whenever they are asked for.
#pragma once
#include <cstdint>
#include <span>

#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel::test {

/// Returns a number in [0, 1) that the arguments alone decide.
inline double chance(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c = 0) {
  std::uint64_t x = seed;
  for (const std::uint64_t y : {a, b, c}) {
    x = (x ^ y) * 0x9e3779b97f4a7c15ull;
    x ^= x >> 29;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 32;
  }
  return static_cast<double>(x >> 11) * 0x1.0p-53;
}

/// A validity of which chance decides: shares of nodes and edges fail, and nodes may cost
/// something.
class ChanceValidity : public Validity {
 public:
  /// `cost`: the most that a node costs; 0: costs are not asked for.
  ChanceValidity(const Lattice& lattice, std::uint64_t seed, double nodes_fail, double edges_fail,
                 double cost)
      : lattice_(&lattice),
        seed_(seed),
        nodes_fail_(nodes_fail),
        edges_fail_(edges_fail),
        cost_(cost) {}
  [[nodiscard]] bool node(int layer, int slot) const {
    return chance(seed_, as(layer), as(slot)) >= nodes_fail_;
  }
  [[nodiscard]] bool edge(int layer, int a, int b) const {
    return chance(seed_ + 1, as(layer), as(a), as(b)) >= edges_fail_;
  }
  [[nodiscard]] double cost(int layer, int slot) const {
    return cost_ == 0 ? 0 : lattice_->rounded_cost(cost_ * chance(seed_ + 2, as(layer), as(slot)));
  }
  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k)
      answers[k].valid = node(questions[k].layer, questions[k].slot);
  }
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k)
      answers[k] = edge(questions[k].layer, questions[k].a, questions[k].b);
  }
  [[nodiscard]] bool asks_edges() const override { return edges_fail_ > 0; }
  void costs(std::span<const NodeQuestion> questions, std::span<double> costs) override {
    for (std::size_t k = 0; k < questions.size(); ++k)
      costs[k] = cost(questions[k].layer, questions[k].slot);
  }
  [[nodiscard]] bool asks_costs() const override { return cost_ > 0; }

 protected:
  [[nodiscard]] const Lattice& lattice() const { return *lattice_; }

 private:
  static std::uint64_t as(int x) { return static_cast<std::uint64_t>(x); }
  const Lattice* lattice_;
  std::uint64_t seed_;
  double nodes_fail_, edges_fail_, cost_;
};

}  // namespace swivel::test
