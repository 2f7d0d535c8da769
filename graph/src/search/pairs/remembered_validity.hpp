// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/pair_search.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// A Validity that asks another one and remembers the answers, so that searches which begin again
/// ask nothing twice. What it knows can be written into the verdicts of a cost-to-go.
class RememberedValidity final : public Validity {
 public:
  /// Both arguments must outlive the object.
  RememberedValidity(const Lattice& lattice, Validity& validity)
      : lattice_(&lattice), validity_(&validity) {}

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void nodes_overlapped(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                        const std::function<void()>& work) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override { return validity_->asks_edges(); }
  void costs(std::span<const NodeQuestion> questions, std::span<double> costs) override;
  [[nodiscard]] bool asks_costs() const override { return validity_->asks_costs(); }

  /// Takes what verdicts say of nodes and removed edges for answers.
  void take(const Verdicts& verdicts);
  /// How much of what is known was written to a cost-to-go before.
  struct Written {
    std::size_t nodes = 0, edges = 0, costs = 0;
  };
  /// Writes what is known, but for what was written before, into the verdicts of a cost-to-go of
  /// the lattice. Values follow at the next CostToGo::repair().
  void write(CostToGo& cost_to_go, Written& written) const;
  /// Writes what is known of nodes into verdicts of the lattice that have none.
  void write(Verdicts& verdicts) const;

  /// Returns how many nodes were asked about.
  [[nodiscard]] std::int64_t nodes_asked() const { return nodes_asked_; }
  /// Returns how many edges were asked about.
  [[nodiscard]] std::int64_t edges_asked() const { return edges_asked_; }

 private:
  struct KnownNode {
    bool known = false;  // the answer to a question that is not only_scene
    NodeAnswer answer;
    FailureId clear_of = kNoFailure;  // asked about last with only_scene, and found clear
    bool clear = false;
  };
  struct Edge {
    int layer = 0, a = 0, b = 0;
    bool operator==(const Edge&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const Edge& edge) const;
  };
  struct Cost {
    int layer = 0, slot = 0;
    double cost = 0;
  };
  static std::int64_t key(int layer, int slot) { return (std::int64_t{layer} << 32) + slot; }
  /// Returns the answer to a question where it is known, else null.
  [[nodiscard]] const NodeAnswer* known(const NodeQuestion& question) const;
  void note(const NodeQuestion& question, const NodeAnswer& answer);
  void note(int layer, int slot, const NodeAnswer& answer);
  void note(const Edge& edge, bool valid);
  void note(const Cost& cost);
  template <class Ask>
  void ask_nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                 const Ask& ask);

  const Lattice* lattice_;
  Validity* validity_;
  std::unordered_map<std::int64_t, KnownNode> node_;
  std::unordered_map<Edge, bool, EdgeHash> edge_;
  std::unordered_map<std::int64_t, double> cost_;
  // what is known, in the order in which it became known
  std::vector<std::pair<int, int>> nodes_;  // layer, slot
  std::vector<Edge> edges_;
  std::vector<Cost> costs_;
  std::vector<int> same_poses_;
  std::int64_t nodes_asked_ = 0, edges_asked_ = 0;
};

}  // namespace swivel
