// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "search/begin_tree.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/job_search.hpp"

namespace swivel {

/// A node at which a stroke may end or begin: the number of its run among those of the stroke, its
/// slot in that run's last or first layer, and the joints of its row (Lattice::exact_config()),
/// rad.
struct EndNode {
  std::size_t run = 0;
  int slot = 0;
  Config q = Config::Zero();
};

/// A side of a transition: the end nodes of the stroke before it, or the begin nodes of the stroke
/// after it.
enum class Side : std::uint8_t { kEnd, kBegin };

/// What is known of the costs of one transition of a job, from each end node of a stroke to each
/// begin node of the next: the joint distance, until a way was found that costs more. Costs only
/// rise. Nodes are named by their indices among the nodes of their side.
class TransitionCosts {
 public:
  TransitionCosts(const Transitions& transitions, std::vector<EndNode> ends,
                  std::vector<EndNode> begins);

  [[nodiscard]] const std::vector<EndNode>& nodes(Side side) const { return nodes_[index(side)]; }
  /// Returns the cost from an end node to a begin node; kUnreachable where there is no way.
  [[nodiscard]] double at(std::size_t end, std::size_t begin) const {
    if (is_barred(Side::kEnd, end) || is_barred(Side::kBegin, begin)) return kUnreachable;
    if (raised_ends_[end]) {
      const auto found = raised_.find(key(end, begin));
      if (found != raised_.end()) return found->second;
    }
    return transitions_->distance(nodes(Side::kEnd)[end].q, nodes(Side::kBegin)[begin].q);
  }
  void raise(std::size_t end, std::size_t begin, double cost) {
    raised_ends_[end] = true;
    raised_[key(end, begin)] = cost;
  }
  /// Makes all transitions from an end node, or to a begin node, unreachable.
  void bar(Side side, std::size_t node) { barred_[index(side)][node] = true; }
  [[nodiscard]] bool is_barred(Side side, std::size_t node) const {
    return barred_[index(side)][node];
  }

  /// What has been asked about a pair of nodes.
  enum class Asked : std::uint8_t { kNothing, kInPassing, kThoroughly };
  [[nodiscard]] Asked asked(std::size_t end, std::size_t begin) const {
    const auto found = asked_.find(key(end, begin));
    return found == asked_.end() ? Asked::kNothing : found->second;
  }
  void set_asked(std::size_t end, std::size_t begin, Asked asked) {
    asked_[key(end, begin)] = asked;
  }

  /// Sets what the rest of the job costs from each begin node.
  void set_rest(std::vector<double> rest);
  [[nodiscard]] double rest(std::size_t begin) const { return rest_[begin]; }
  /// The cheapest way on from an end node.
  struct Onward {
    std::size_t begin = 0;
    double cost = kUnreachable;  ///< of the transition and of the rest of the job
  };
  /// Returns the cheapest way on from an end node: of ways that cost the same the one with the
  /// least rest, then the one to the first begin node. May be called by several threads.
  [[nodiscard]] Onward onward(std::size_t end) const;

 private:
  [[nodiscard]] std::uint64_t key(std::size_t end, std::size_t begin) const {
    return static_cast<std::uint64_t>(end) * nodes(Side::kBegin).size() + begin;
  }
  static constexpr std::size_t index(Side side) { return static_cast<std::size_t>(side); }

  const Transitions* transitions_;
  std::array<std::vector<EndNode>, 2> nodes_;  // by side
  std::vector<double> rest_;                   // by begin node
  BeginTree tree_;
  std::vector<std::uint8_t> raised_ends_;            // ends of which a pair is raised
  std::array<std::vector<std::uint8_t>, 2> barred_;  // by side, then node
  std::unordered_map<std::uint64_t, double> raised_;
  std::unordered_map<std::uint64_t, Asked> asked_;
};

}  // namespace swivel
