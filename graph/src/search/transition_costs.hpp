// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/job_search.hpp"

namespace swivel {

/// A node at which a run may end or begin: its slot in the last or first layer, and the joints of
/// its row (Lattice::exact_config()), rad.
struct EndNode {
  int slot = 0;
  Config q = Config::Zero();
};

/// What is known of the costs of one transition of a job, from each end node of a run to each begin
/// node of the next: the joint distance, until a way was found that costs more. Costs only rise.
/// Nodes are named by their indices in the lists of end and begin nodes.
class TransitionCosts {
 public:
  TransitionCosts(const Transitions& transitions, std::vector<EndNode> ends,
                  std::vector<EndNode> begins);

  [[nodiscard]] const std::vector<EndNode>& ends() const { return ends_; }
  [[nodiscard]] const std::vector<EndNode>& begins() const { return begins_; }
  /// Returns the cost from an end node to a begin node; kUnreachable where there is no way.
  [[nodiscard]] double at(std::size_t end, std::size_t begin) const {
    if (raised_ends_[end]) {
      const auto found = raised_.find(key(end, begin));
      if (found != raised_.end()) return found->second;
    }
    return transitions_->distance(ends_[end].q, begins_[begin].q);
  }
  void raise(std::size_t end, std::size_t begin, double cost) {
    raised_ends_[end] = true;
    raised_[key(end, begin)] = cost;
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

  /// The cheapest way on from an end node.
  struct Onward {
    std::size_t begin = 0;
    double cost = kUnreachable;  ///< of the transition and of the rest of the job
  };
  /// Returns the cheapest way on from an end node, where going on from each begin node costs
  /// `rest`: the least rest among equals, then the smallest index. `order` lists the begin nodes by
  /// ascending rest (by_rest()).
  [[nodiscard]] Onward onward(std::size_t end, const std::vector<double>& rest,
                              const std::vector<std::size_t>& order) const;
  /// Returns the indices of begin nodes that have a rest, by ascending rest, then by index.
  [[nodiscard]] static std::vector<std::size_t> by_rest(const std::vector<double>& rest);

 private:
  [[nodiscard]] std::uint64_t key(std::size_t end, std::size_t begin) const {
    return static_cast<std::uint64_t>(end) * begins_.size() + begin;
  }

  const Transitions* transitions_;
  std::vector<EndNode> ends_, begins_;
  std::vector<bool> raised_ends_;  // ends of which a pair is raised
  std::unordered_map<std::uint64_t, double> raised_;
  std::unordered_map<std::uint64_t, Asked> asked_;
};

}  // namespace swivel
