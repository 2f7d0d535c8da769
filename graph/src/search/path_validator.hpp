// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// Orders layers by how worthwhile it is to ask about them: where failures were found lately first,
/// then along the path.
class FailFirst {
 public:
  explicit FailFirst(int layers) : score_(static_cast<std::size_t>(layers), 0.0) {}
  void failed(int layer) {
    // An obstacle blocks a stretch of layers, so the same place in neighbouring layers is asked
    // about too.
    for (int i = std::max(0, layer - 2);
         i <= std::min(static_cast<int>(score_.size()) - 1, layer + 2); ++i)
      score_[static_cast<std::size_t>(i)] += i == layer ? 1.0 : 0.5;
  }
  void next_round() {
    for (double& score : score_) score *= 0.8;
  }
  void order(std::vector<int>& layers) const {
    const auto score = [&](int layer) { return score_[static_cast<std::size_t>(layer)]; };
    // Most layers never failed.
    const auto others = std::stable_partition(layers.begin(), layers.end(),
                                              [&](int layer) { return score(layer) > 0; });
    std::stable_sort(layers.begin(), others, [&](int a, int b) { return score(a) > score(b); });
  }

 private:
  std::vector<double> score_;
};

/// Validates candidate paths of one lattice, one after the other: asks a Validity about their nodes
/// and edges, and removes from the cost-to-go what fails and the failing region around it. Values
/// follow at CostToGo::repair(), which the caller calls.
class PathValidator {
 public:
  PathValidator(CostToGo& cost_to_go, Validity& validity, const PathFirstOptions& options)
      : cost_to_go_(cost_to_go),
        verdicts_(cost_to_go.verdicts()),
        lattice_(cost_to_go.lattice()),
        validity_(validity),
        options_(options),
        fail_first_(lattice_.layers()) {}
  /// Asks about nodes and edges that failed in an earlier search, and removes those that fail
  /// again.
  void ask_again(const PriorFailures& failures) {
    ask(std::span<const NodeQuestion>(failures.nodes));
    if (!options_.knots) ask(std::span<const EdgeQuestion>(failures.edges));
  }
  /// Asks about nodes before the first sweep and removes those that fail. Ends where fewer than
  /// half of some fail.
  void check_failure_hints(std::span<const FailureHint> failure_hints);
  /// Notes the value of the cost-to-go when the first candidate is taken. Later calls do nothing.
  void begin() {
    if (first_cost_ == kUnreachable) first_cost_ = cost_to_go_.best();
  }
  /// Returns whether the search ends before paths of a cost (KnotSearch::patience, most).
  [[nodiscard]] bool ends_at(double cost) const {
    const KnotSearch* const knots = options_.knots;
    return knots && (cost >= knots->most || knots->idle >= knots->patience);
  }
  /// Asks what the path's nodes cost, where that is not known, and notes it. Returns true where a
  /// node costs more than was known. A node's neighbours often cost as much, and each round in
  /// which a path turns out to cost more asks about twice as many of them as the one before: so
  /// rounds are few where every node costs something, and questions are few where hardly any does.
  bool costs_more(const SlotPath& path);
  /// Asks what is not known of the path, where failures were found first, and removes what fails.
  /// Returns true if the path is valid.
  bool valid(const SlotPath& path);
  /// Returns true if all nodes fail in one of the layers at which the path failed; the first layers
  /// come first, since less is left to reach before them. A layer is asked about only where no path
  /// within the limit of the sweep has a node left in it: questions about its other nodes take less
  /// than a sweep with a higher limit, and end at the first node that is valid.
  bool bars_a_layer();

 private:
  /// Returns what a node costs as far as it is known, without its exit cost.
  [[nodiscard]] double own_cost(const NodeQuestion& x) const {
    const bool last = x.layer + 1 == lattice_.layers();
    return verdicts_.cost(x.layer, x.slot) - (last ? verdicts_.exit_cost(x.slot) : 0);
  }
  struct Failure {
    int layer, slot;
    FailureId failure;
  };
  static std::int64_t key(int layer, int slot) { return (std::int64_t{layer} << 32) + slot; }
  /// Asks about a path's nodes or edges, from layers 0 ... count - 1, and the regions around those
  /// that fail. Where some fail, the others are asked about all the same as long as that costs less
  /// than the next round will: many rounds would each find one of them. Returns true if all asked
  /// are valid.
  template <class Question, class Unknown, class Make>
  bool all_valid(int count, int layers, const Unknown& unknown, const Make& question);
  /// Returns whether edges of a step are asked about only on paths that are valid otherwise.
  [[nodiscard]] bool is_long(int step) const { return options_.knots && lattice_.can_halve(step); }
  /// Asks about all long edges of a path that is valid otherwise, and notes at which steps some are
  /// not valid (PathFirstOptions::knots). Returns true if all are valid. `joints` returns those of
  /// the path's node in a layer.
  template <class Joints>
  bool long_edges_valid(const SlotPath& path, const Joints& joints);
  [[nodiscard]] bool any_left(int layer, int& slots_left) const;
  /// Returns true if all nodes of a layer fail as this one did. A few that lie apart are asked
  /// about first, then the others in order, since questions about neighbours take less.
  bool all_fail(const Failure& like);
  /// Asks about the region of failing nodes around those just found, breadth first along the path
  /// and the coordinate: an obstacle blocks many neighbours, and each found now saves a round. It
  /// is asked only whether the scene blocks them: proving them valid involves the robot's own
  /// pairs, too, which take long since they are near by design, and few of these nodes come to lie
  /// on a path.
  void expand_failed_region(const std::vector<Failure>& failed);
  /// Continues regions that ended at nodes which no path reached at the cost of that time, and
  /// which paths reach by now.
  void expand_reached_regions();
  /// Neighbours of a region that are asked about at once.
  struct Wave {
    std::vector<NodeQuestion> questions;
    std::vector<NodeAnswer> answers;
    std::vector<std::int64_t> keys;  // of the questions
    void clear() {
      questions.clear();
      answers.clear();
      keys.clear();
    }
    [[nodiscard]] bool has(std::int64_t key) const {
      return std::find(keys.begin(), keys.end(), key) != keys.end();
    }
  };
  /// Adds the neighbours of a failing node that are not known to the frontier of its region.
  void add_neighbours(const Failure& x, std::deque<Failure>& frontier) const;
  /// Returns how many neighbours the next wave has at most. While one wave is asked about, the next
  /// is made: a wave takes about half of the frontier, so that there mostly is another.
  [[nodiscard]] std::size_t most_in_wave(const std::deque<Failure>& frontier) const;
  /// Takes neighbours from the frontier into a wave, but for those that are known, or in the wave
  /// `asked`. Defers those that no path reaches.
  void fill(Wave& wave, const Wave& asked, std::deque<Failure>& frontier);
  /// Notes the answers to a wave and clears it. The frontier grows around the nodes that failed.
  void take_wave(Wave& wave, std::deque<Failure>& frontier);
  void expand_failed_region(const std::vector<Failure>& failed, std::deque<Failure>& frontier);
  /// Asks about the region of failing edges around those just found: neighbours of a failing edge,
  /// and its continuations along the path, often fail as it does.
  void expand_failed_region(const std::vector<EdgeQuestion>& failed);
  [[nodiscard]] int most_region_questions() const;
  /// Notes the answers to questions about nodes. Returns the nodes that failed.
  std::vector<Failure> take(std::span<const NodeQuestion> questions,
                            std::span<const NodeAnswer> answers);
  /// Asks about nodes and notes the answers. Returns the nodes that failed.
  std::vector<Failure> ask(std::span<const NodeQuestion> questions);
  std::vector<EdgeQuestion> ask(std::span<const EdgeQuestion> questions);
  [[nodiscard]] std::size_t batch() const { return static_cast<std::size_t>(options_.batch); }
  CostToGo& cost_to_go_;
  Verdicts& verdicts_;
  const Lattice& lattice_;
  Validity& validity_;
  PathFirstOptions options_;
  static constexpr int kMostReach = 1 << 20;
  int cost_reach_ = 0;                   // neighbours on either side that costs_more() asks about
  std::int64_t asked_ = 0;               // questions in this round
  std::vector<Failure> failed_on_path_;  // in this round
  int region_questions_left_ = 0;        // questions about neighbours left in this round
  static constexpr std::size_t kRegionQuestionsAtOnce = 32;
  // The failure that expand_failed_region() asked about last, by key(), for nodes that the scene
  // did not block.
  std::unordered_map<std::int64_t, FailureId> clear_of_scene_;
  static constexpr double kMuchDearer = 1.2;
  double first_cost_ = kUnreachable;  // cost of the first path
  std::vector<Failure> deferred_;     // nodes at which regions ended
  FailFirst fail_first_;
  std::vector<NodeAnswer> answers_;
  std::vector<std::uint8_t> edge_answers_;
  std::vector<int> same_poses_;
};

/// Which path is the first: that of the order of answers (docs/model.md); or the cheapest, and of
/// equal ones that with the smallest slots.
enum class FirstPath { kInOrderOfAnswers, kCheapest };

/// Returns the first valid path of a swept cost-to-go, as path_first() does; an empty one when none
/// is left. `earlier` remembers paths of this cost-to-go. Throws Stopped.
[[nodiscard]] SearchOutcome first_valid_path(CostToGo& cost_to_go, const Validity& validity,
                                             PathValidator& validator, PathCache& earlier,
                                             SearchCounters& counters,
                                             FirstPath first = FirstPath::kInOrderOfAnswers);

}  // namespace swivel
