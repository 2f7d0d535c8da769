// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/search/turned_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <stdexcept>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "search/path_validator.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// By how many turns each joint's value differs from that of the node, by joint.
using Turns = std::array<std::int8_t, kDof>;

/// A node with the turns of its circles.
struct Turned {
  int layer = 0, slot = 0;
  Turns turns{};
  auto operator<=>(const Turned&) const = default;
};
struct HashOfTurned {
  std::size_t operator()(const Turned& x) const {
    std::size_t hash =
        static_cast<std::size_t>(x.layer) * 0x9e3779b97f4a7c15U + static_cast<std::size_t>(x.slot);
    for (const std::int8_t turn : x.turns)
      hash = hash * 0x100000001b3U + static_cast<std::size_t>(turn + 128);
    return hash ^ hash >> 29;
  }
};

/// A label: the least cost to a turned node, and the labels before it on all ways of that cost.
struct Label {
  Turned at;
  double cost = kUnreachable;
  std::vector<int> before;
  bool expanded = false;
};

/// A* over turned nodes, from the only node of layer 0 to the goal layer.
class LabelSearch {
 public:
  LabelSearch(CostToGo& cost_to_go, const std::vector<CircleRange>& ranges, int& labels_left)
      : cost_to_go_(cost_to_go), ranges_(ranges), left_(labels_left) {}

  struct Found {
    SlotPath path;
    double cost = 0;
  };
  /// Returns the cheapest path within the ranges, the first of several in the order of slots, then
  /// turns; nothing if there is none, or no label is left to expand.
  std::optional<Found> find(int first_slot) {
    const TraceSpan span("turned path");
    reach({0, first_slot, {}}, 0, -1);
    double least = kUnreachable;
    while (!queue_.empty() && queue_.top().estimate <= least) {
      const int k = queue_.top().label;
      queue_.pop();
      Label& label = labels_[static_cast<std::size_t>(k)];
      if (std::exchange(label.expanded, true)) continue;
      if (label.at.layer == cost_to_go_.goal_layer()) {
        least = label.cost;
        goals_.push_back(k);
        continue;
      }
      if (left_-- <= 0) return std::nullopt;
      if (left_ % 64 == 0) cost_to_go_.budget().poll();
      expand(k);
    }
    if (goals_.empty()) return std::nullopt;
    return Found{first_of_paths(), least};
  }

 private:
  struct Queued {
    double estimate;
    int depth;  // layers to the goal: deep ones first
    int label;
    bool operator<(const Queued& other) const {  // the queue's top is the greatest
      return std::tie(other.estimate, other.depth, other.label) < std::tie(estimate, depth, label);
    }
  };
  void expand(int k) {
    const Turned from = labels_[static_cast<std::size_t>(k)].at;
    const double cost = labels_[static_cast<std::size_t>(k)].cost;
    const Config q = cost_to_go_.config(from.layer, from.slot);
    cost_to_go_.steps(from.layer, from.slot, std::numeric_limits<double>::max(), steps_);
    const std::vector<CostToGo::Step> steps = steps_;
    for (const CostToGo::Step& step : steps)
      if (const auto to = turned(from, q, step.slot)) reach(*to, cost + step.cost, k);
  }
  /// Returns the node of a slot of the next layer in the turns to which a step leads; nothing where
  /// a circle leaves its range.
  std::optional<Turned> turned(const Turned& from, const Config& q, int slot) {
    Turned to{from.layer + 1, slot, from.turns};
    const Config next = cost_to_go_.config(to.layer, slot);
    for (const CircleRange& range : ranges_) {
      const auto j = static_cast<std::size_t>(range.joint);
      const double step = next[range.joint] - q[range.joint];
      const int turns =
          from.turns[j] - static_cast<int>(std::lround((step - wrap_angle(step)) / kTwoPi));
      const double value = next[range.joint] + kTwoPi * turns;
      if (value < range.lower || value > range.upper) return std::nullopt;
      to.turns[j] = static_cast<std::int8_t>(turns);
    }
    const bool given =
        to.layer + 1 == cost_to_go_.lattice().layers() && cost_to_go_.lattice().is_given(to.layer);
    if (given && to.turns != Turns{}) return std::nullopt;
    return to;
  }
  void reach(const Turned& at, double cost, int from) {
    const auto [known, fresh] = numbers_.try_emplace(at, static_cast<int>(labels_.size()));
    if (fresh) labels_.emplace_back().at = at;
    Label& label = labels_[static_cast<std::size_t>(known->second)];
    if (cost > label.cost) return;
    if (cost == label.cost) {
      label.before.push_back(from);
      return;
    }
    label.cost = cost;
    label.expanded = false;  // the cost-to-go may be less than what is left after removals
    label.before.clear();
    if (from >= 0) label.before.push_back(from);
    queue_.push({cost + cost_to_go_.at(at.layer, at.slot), cost_to_go_.goal_layer() - at.layer,
                 known->second});
  }
  /// Returns the first path, in the order of slots, then turns, of those that reach a goal at its
  /// cost.
  SlotPath first_of_paths() const {
    std::vector<std::vector<int>> layers(static_cast<std::size_t>(cost_to_go_.goal_layer()) + 1);
    std::unordered_map<int, std::vector<int>> after;
    layers.back() = goals_;
    for (std::size_t layer = layers.size() - 1; layer > 0; --layer)
      for (const int k : layers[layer])
        for (const int before : labels_[static_cast<std::size_t>(k)].before) {
          if (!after.contains(before)) layers[layer - 1].push_back(before);
          after[before].push_back(k);
        }
    SlotPath path{labels_.front().at.slot};
    for (int k = 0; static_cast<int>(path.size()) <= cost_to_go_.goal_layer();) {
      const std::vector<int>& next = after.at(k);
      k = *std::min_element(next.begin(), next.end(), [this](int a, int b) {
        return labels_[static_cast<std::size_t>(a)].at < labels_[static_cast<std::size_t>(b)].at;
      });
      path.push_back(labels_[static_cast<std::size_t>(k)].at.slot);
    }
    return path;
  }

  CostToGo& cost_to_go_;
  const std::vector<CircleRange>& ranges_;
  int& left_;
  std::vector<Label> labels_;
  std::unordered_map<Turned, int, HashOfTurned> numbers_;
  std::priority_queue<Queued> queue_;
  std::vector<int> goals_;
  std::vector<CostToGo::Step> steps_;
};

}  // namespace

std::optional<SearchOutcome> path_first_within(CostToGo& cost_to_go, Validity& validity,
                                               const std::vector<CircleRange>& ranges,
                                               const PathFirstOptions& options, int most_labels,
                                               SearchCounters& counters) {
  PathValidator validator(cost_to_go, validity, options);
  for (;;) {
    cost_to_go.budget().poll();
    const int slot = cost_to_go.first_slot();
    if (slot < 0) return std::nullopt;
    const int before = most_labels;
    const auto found = LabelSearch(cost_to_go, ranges, most_labels).find(slot);
    counters.expansions += before - most_labels;
    if (!found) return std::nullopt;
    validator.begin();
    counters.candidate = found->path;
    ++counters.iterations;
    const std::int64_t removed = cost_to_go.verdicts().removed();
    if (validator.valid(found->path)) return SearchOutcome{found->path, found->cost};
    if (validator.bars_a_layer()) return std::nullopt;
    if (cost_to_go.verdicts().removed() == removed)
      throw std::logic_error("a round of the search removed nothing: it would never end");
    cost_to_go.repair();
  }
}

}  // namespace swivel
