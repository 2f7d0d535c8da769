// SPDX-License-Identifier: BSD-3-Clause
// A solver for descartes_light (0.4 or later) that asks dear edge evaluators, such as collision
// checks of motions, about few edges. One header; it needs descartes_light and TBB, and nothing
// else of Swivel.
#pragma once
#include <descartes_light/core/solver.h>
#include <descartes_light/edge_evaluators/compound_edge_evaluator.h>
#include <descartes_light/edge_evaluators/euclidean_distance_edge_evaluator.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

namespace swivel {

/// Marks an edge evaluator as cheap: LazyLadderSolver asks it about every edge. Derive from it
/// beside descartes_light::EdgeEvaluator. EuclideanDistanceEdgeEvaluator is cheap without it.
struct CheapEdge {
  virtual ~CheapEdge() = default;
};

/// Finds the cheapest path through a ladder of states, as descartes_light's LadderGraphSolver does,
/// for chains of any number of joints. Cheap evaluators of a CompoundEdgeEvaluator are asked about
/// all edges; the others about those of the cheapest path alone, again and again: what they refuse
/// or add is noted, costs to the end are repaired, and the next path is taken, until all edges of a
/// path are known. Where an evaluator has no cheap part, all its edges are asked.
///
/// The path is a cheapest one if evaluators return no cost below zero. It is the same at any number
/// of threads. Samplers and evaluators are called from several threads at once, as
/// LadderGraphSolver calls them.
template <typename FloatT>
class LazyLadderSolver : public descartes_light::Solver<FloatT> {
  using State = descartes_light::State<FloatT>;
  using Edge = descartes_light::EdgeEvaluator<FloatT>;
  using Sampler = descartes_light::WaypointSampler<FloatT>;
  using StateEvaluator = descartes_light::StateEvaluator<FloatT>;
  using Compound = descartes_light::CompoundEdgeEvaluator<FloatT>;
  using Euclidean = descartes_light::EuclideanDistanceEdgeEvaluator<FloatT>;

 public:
  /// What was asked.
  struct Counters {
    std::int64_t cheap_edges = 0;  ///< edges that cheap evaluators were asked about, repeats too
    std::int64_t dear_edges = 0;   ///< edges that the others were asked about
    std::int64_t paths = 0;        ///< paths taken
  };

  /// Makes a solver that uses so many threads.
  explicit LazyLadderSolver(int threads = tbb::task_arena::automatic) : arena_(threads) {}
  /// Sets a time, from the call of build() on, after which build() stops and search() throws.
  void set_deadline(std::optional<std::chrono::nanoseconds> deadline) { deadline_ = deadline; }
  /// Sets a flag that stops build() when it is true; search() throws then. Null: none.
  void set_cancel(const std::atomic<bool>* cancel) { cancel_ = cancel; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

  /// Returns the path that build() found. Throws std::runtime_error where there is none, and where
  /// build() was stopped.
  descartes_light::SearchResult<FloatT> search() override {
    if (stopped_) throw std::runtime_error("LazyLadderSolver was stopped before a path was found");
    if (path_.empty()) throw std::runtime_error("Failed to find path through the graph");
    descartes_light::SearchResult<FloatT> result;
    result.cost = FloatT(0);
    for (std::size_t i = 0; i < rungs_.size(); ++i) {
      const Node& node = rungs_[i].nodes[path_[i]];
      if (i > 0) result.cost += static_cast<FloatT>(asked_cost(i - 1, path_[i - 1], path_[i]));
      result.cost += node.cost;
      result.trajectory.push_back(node.state);
    }
    return result;
  }

 protected:
  descartes_light::BuildStatus buildImpl(
      const std::vector<typename Sampler::ConstPtr>& trajectory,
      const std::vector<typename Edge::ConstPtr>& edges,
      const std::vector<typename StateEvaluator::ConstPtr>& states) override {
    begin_ = std::chrono::steady_clock::now();
    stopped_ = false;
    counters_ = {};
    path_.clear();
    steps_.assign(edges.size(), {});
    for (std::size_t i = 0; i < edges.size(); ++i) take_apart(edges[i], steps_[i]);
    descartes_light::BuildStatus status;
    sample(trajectory, states, status);
    for (std::size_t i = rungs_.size(); i-- > 0 && !stop();) sweep(i);
    if (!stopped_) find_path();
    for (std::size_t i = 0; i + 1 < rungs_.size() && path_.empty() && !stopped_; ++i)
      if (!any_edge(i)) status.failed_edges.push_back(i);
    return status;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  static constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

  struct Node {
    typename State::ConstPtr state;
    FloatT cost = FloatT(0);
    double to_end = kNone;        // least known cost from here to the last rung, its own included
    std::size_t next = kNowhere;  // node of the next rung that it leads over
  };
  struct Rung {
    std::vector<Node> nodes;
  };
  /// The evaluators between two rungs, in the order in which their costs are added, and the edges
  /// whose whole cost is known: kNone for those that were refused.
  struct Step {
    std::vector<std::pair<const Edge*, bool>> parts;  // true: cheap
    bool all_cheap = false;
    typename Edge::ConstPtr owner;
    std::unordered_map<std::uint64_t, double> asked;
  };

  static std::uint64_t key(std::size_t from, std::size_t to) {
    return (static_cast<std::uint64_t>(from) << 32) | to;
  }
  /// Notes an evaluator's parts. Where none of them is cheap, all of them count as cheap.
  static void take_apart(const typename Edge::ConstPtr& edge, Step& step) {
    step.owner = edge;
    const auto add = [&](const Edge* part) {
      step.parts.emplace_back(part, dynamic_cast<const Euclidean*>(part) != nullptr ||
                                        dynamic_cast<const CheapEdge*>(part) != nullptr);
    };
    if (const auto* compound = dynamic_cast<const Compound*>(edge.get()))
      for (const auto& part : compound->evaluators) add(part.get());
    else
      add(edge.get());
    const auto cheap = std::count_if(step.parts.begin(), step.parts.end(),
                                     [](const auto& part) { return part.second; });
    step.all_cheap = cheap == 0 || static_cast<std::size_t>(cheap) == step.parts.size();
  }

  bool stop() {
    stopped_ = stopped_ || (cancel_ != nullptr && cancel_->load()) ||
               (deadline_ && std::chrono::steady_clock::now() - begin_ > *deadline_);
    return stopped_;
  }
  template <typename Body>
  void in_parallel(std::size_t count, const Body& body) {
    arena_.execute([&] { tbb::parallel_for(std::size_t{0}, count, body); });
  }

  /// Samples all rungs, and asks the state evaluators about their states.
  void sample(const std::vector<typename Sampler::ConstPtr>& trajectory,
              const std::vector<typename StateEvaluator::ConstPtr>& states,
              descartes_light::BuildStatus& status) {
    rungs_.assign(trajectory.size(), {});
    std::vector<char> empty(trajectory.size(), 0);
    in_parallel(trajectory.size(), [&](std::size_t i) {
      auto samples = trajectory[i]->sample();
      empty[i] = samples.empty();
      for (auto& sample : samples) {
        if (!states.empty()) {
          const auto [valid, cost] = states[i]->evaluate(*sample.state);
          if (!valid) continue;
          sample.cost += cost;
        }
        rungs_[i].nodes.push_back({sample.state, sample.cost});
      }
    });
    for (std::size_t i = 0; i < empty.size(); ++i)
      if (empty[i]) status.failed_vertices.push_back(i);
  }

  /// Returns the cost of an edge by the evaluators that `which` chooses, kNone where one refuses.
  template <typename Which>
  double evaluate(std::size_t i, std::size_t from, std::size_t to, const Which& which) const {
    FloatT cost = FloatT(0);
    for (const auto& [part, cheap] : steps_[i].parts) {
      if (!which(cheap)) continue;
      const auto [valid, more] =
          part->evaluate(*rungs_[i].nodes[from].state, *rungs_[i + 1].nodes[to].state);
      if (!valid) return kNone;
      cost += more;
    }
    return static_cast<double>(cost);
  }
  /// Returns the least that an edge can cost by what is known of it.
  double bound(std::size_t i, std::size_t from, std::size_t to) const {
    const Step& step = steps_[i];
    if (!step.asked.empty())
      if (const auto known = step.asked.find(key(from, to)); known != step.asked.end())
        return known->second;
    return evaluate(i, from, to, [&](bool cheap) { return cheap || step.all_cheap; });
  }
  /// Returns the whole cost of an edge that was asked about.
  double asked_cost(std::size_t i, std::size_t from, std::size_t to) const {
    const Step& step = steps_[i];
    return step.all_cheap ? bound(i, from, to) : step.asked.at(key(from, to));
  }

  /// Computes a node's cost to the end and its next node from those of the next rung.
  void relax(std::size_t i, std::size_t node) {
    Node& from = rungs_[i].nodes[node];
    from.to_end = kNone;
    from.next = kNowhere;
    const std::vector<Node>& next = rungs_[i + 1].nodes;
    for (std::size_t to = 0; to < next.size(); ++to) {
      if (!(next[to].to_end < from.to_end)) continue;  // costs of edges are not below zero
      const double cost = bound(i, node, to) + next[to].to_end;
      if (cost < from.to_end) {
        from.to_end = cost;
        from.next = to;
      }
    }
    from.to_end += static_cast<double>(from.cost);
  }
  void sweep(std::size_t i) {
    std::vector<Node>& nodes = rungs_[i].nodes;
    if (i + 1 == rungs_.size()) {
      for (Node& node : nodes) node.to_end = static_cast<double>(node.cost);
      return;
    }
    counters_.cheap_edges += static_cast<std::int64_t>(nodes.size() * rungs_[i + 1].nodes.size());
    in_parallel(nodes.size(), [&](std::size_t node) { relax(i, node); });
  }
  /// Computes again what edges that cost more than before have changed, from the last rung on which
  /// one begins back to the first. `raised` has the nodes where such edges begin, by rung.
  void repair(std::vector<std::vector<std::size_t>> raised) {
    std::vector<std::size_t> changed;  // nodes of rung i + 1 whose cost to the end has risen
    for (std::size_t i = rungs_.size() - 1; i-- > 0;) {
      std::vector<std::size_t> again = std::move(raised[i]);
      for (std::size_t node = 0; node < rungs_[i].nodes.size() && !changed.empty(); ++node)
        if (std::binary_search(changed.begin(), changed.end(), rungs_[i].nodes[node].next))
          again.push_back(node);
      std::sort(again.begin(), again.end());
      again.erase(std::unique(again.begin(), again.end()), again.end());
      std::vector<double> before;
      for (const std::size_t node : again) before.push_back(rungs_[i].nodes[node].to_end);
      counters_.cheap_edges += static_cast<std::int64_t>(again.size() * rungs_[i + 1].nodes.size());
      in_parallel(again.size(), [&](std::size_t k) { relax(i, again[k]); });
      changed.clear();
      for (std::size_t k = 0; k < again.size(); ++k)
        if (rungs_[i].nodes[again[k]].to_end != before[k]) changed.push_back(again[k]);
    }
  }

  /// Returns the cheapest path by what is known; empty where there is none.
  std::vector<std::size_t> best_path() const {
    std::vector<std::size_t> path;
    std::size_t at = kNowhere;
    double least = kNone;
    for (std::size_t k = 0; !rungs_.empty() && k < rungs_[0].nodes.size(); ++k)
      if (rungs_[0].nodes[k].to_end < least) least = rungs_[0].nodes[at = k].to_end;
    for (std::size_t i = 0; i < rungs_.size() && at != kNowhere; ++i) {
      path.push_back(at);
      at = rungs_[i].nodes[at].next;
    }
    return path;
  }
  /// Asks all evaluators about the edges of a path of which it is not known. Returns, by rung, the
  /// nodes at which an edge begins that costs more than was known.
  std::vector<std::vector<std::size_t>> ask(const std::vector<std::size_t>& path) {
    std::vector<std::size_t> unknown;
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      if (!steps_[i].all_cheap && steps_[i].asked.count(key(path[i], path[i + 1])) == 0)
        unknown.push_back(i);
    std::vector<double> known(unknown.size()), found(unknown.size());
    in_parallel(unknown.size(), [&](std::size_t k) {
      const std::size_t i = unknown[k];
      known[k] = bound(i, path[i], path[i + 1]);
      found[k] = evaluate(i, path[i], path[i + 1], [](bool) { return true; });
    });
    counters_.dear_edges += static_cast<std::int64_t>(unknown.size());
    std::vector<std::vector<std::size_t>> raised(rungs_.size());
    for (std::size_t k = 0; k < unknown.size(); ++k) {
      const std::size_t i = unknown[k];
      steps_[i].asked[key(path[i], path[i + 1])] = found[k];
      if (found[k] != known[k]) raised[i].push_back(path[i]);
    }
    return raised;
  }
  void find_path() {
    for (;;) {
      const std::vector<std::size_t> path = best_path();
      if (path.empty() || stop()) return;
      ++counters_.paths;
      auto raised = ask(path);
      if (std::all_of(raised.begin(), raised.end(), [](const auto& at) { return at.empty(); })) {
        path_ = path;
        return;
      }
      repair(std::move(raised));
    }
  }
  /// Returns true if an edge between two rungs is valid. Asks until one is.
  bool any_edge(std::size_t i) {
    for (std::size_t from = 0; from < rungs_[i].nodes.size(); ++from)
      for (std::size_t to = 0; to < rungs_[i + 1].nodes.size() && !stop(); ++to) {
        if (bound(i, from, to) == kNone) continue;
        if (steps_[i].all_cheap || steps_[i].asked.count(key(from, to)) != 0) return true;
        ++counters_.dear_edges;
        const double cost = evaluate(i, from, to, [](bool) { return true; });
        steps_[i].asked[key(from, to)] = cost;
        if (cost != kNone) return true;
      }
    return false;
  }

  tbb::task_arena arena_;
  std::optional<std::chrono::nanoseconds> deadline_;
  const std::atomic<bool>* cancel_ = nullptr;
  std::chrono::steady_clock::time_point begin_;
  bool stopped_ = false;
  Counters counters_;
  std::vector<Rung> rungs_;
  std::vector<Step> steps_;        // by rung, to the next
  std::vector<std::size_t> path_;  // node by rung; empty: none
};

}  // namespace swivel
