// SPDX-License-Identifier: BSD-3-Clause
// The search of a job joins the lattices of its runs to one graph: every end node of a run may be
// followed by every begin node of the next, at the cost of a transition. Its cost-to-go is that of
// the runs, each with the cheapest way on as the exit costs of its last layer, computed from the
// last run to the first. As with single paths, what turns out to be invalid is removed and what
// turns out to cost more is raised, so that the value of the best job left is always a lower bound.
// A closed run ends in the node in which it begins: its value at a node is what a loop from there
// costs at least (LoopCosts) and the exit cost of that node, and is made exact once the cheapest
// job left begins it there.
#include "swivel/graph/search/job_search.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "cost_to_go/best_start.hpp"
#include "search/loop_costs.hpp"
#include "search/path_validator.hpp"
#include "search/transition_costs.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/graph/search/closed_path.hpp"

namespace swivel {

namespace {

using Asked = TransitionCosts::Asked;

/// A run with what the search knows of it.
struct Run {
  Run(const SearchedRun& run, const PathFirstOptions& options)
      : cost_to_go(run.cost_to_go),
        validity(run.validity),
        validator(*run.cost_to_go, *run.validity, options) {}
  CostToGo* cost_to_go;
  Validity* validity;
  PathValidator validator;
  PathCache earlier;
  SearchCounters counters;
  std::vector<TransitionCosts::Onward> onward;  // from each end node of the transition behind it
  bool swept_with_exits = false;
  std::optional<LoopCosts> loops;  // of a closed run, once its transitions are laid out
  std::vector<double> exits;       // of a closed run, by slot; empty where all are 0
  SlotPath path;                   // of the candidate job
  bool valid = false;              // the last answer about `path`
};

/// Returns the least cost from a node of a run's first layer to the end of the job.
double rest_from(const Run& run, int slot) {
  if (!run.loops) return run.cost_to_go->at(0, slot);
  const double exit = run.exits.empty() ? 0 : run.exits[static_cast<std::size_t>(slot)];
  return run.loops->at(slot) + exit;
}

/// Returns the slot at which a job begins that comes from nowhere; -1 where there is none.
int first_slot(const Run& run) {
  if (!run.loops) return run.cost_to_go->first_slot();
  const Lattice& lattice = run.cost_to_go->lattice();
  const int slots = lattice.slots(0);
  double least = kUnreachable;
  for (int slot = 0; slot < slots; ++slot) least = std::min(least, rest_from(run, slot));
  return best_start(
      lattice, slots, least, [&](int slot) { return rest_from(run, slot); },
      [&](int slot) { return run.cost_to_go->config(0, slot); });
}

/// Finds the best path of a run by itself.
SearchOutcome best_alone(Run& run, const PathFirstOptions& options) {
  const Lattice& lattice = run.cost_to_go->lattice();
  run.cost_to_go->sweep(lattice.layers() - 1);
  SearchOutcome found =
      first_valid_path(*run.cost_to_go, *run.validity, run.validator, run.earlier, run.counters);
  if (!lattice.is_closed() || found.path.empty()) return found;
  return closed_path_first(*run.cost_to_go, *run.validity, options, run.counters);
}

/// A pair of nodes of one transition.
struct Pair {
  int transition = 0;
  std::size_t end = 0, begin = 0;
};

/// A job: a path through each run, and the pair of nodes of each transition.
struct Candidate {
  std::vector<SlotPath> paths;
  std::vector<Pair> pairs;
};

/// Returns the nodes of a layer that are not removed, with the joints of their rows.
std::vector<EndNode> nodes_of(CostToGo& cost_to_go, int layer) {
  const Lattice& lattice = cost_to_go.lattice();
  std::vector<EndNode> nodes;
  for (int slot = 0; slot < lattice.slots(layer); ++slot) {
    if (cost_to_go.verdicts().node(layer, slot) == Verdict::kRemoved) continue;
    const auto q = cost_to_go.node(layer, slot);
    if (const auto row = q ? lattice.exact_config(layer, slot, *q) : std::nullopt)
      nodes.push_back({slot, *row});
  }
  return nodes;
}

std::size_t index_of(const std::vector<EndNode>& nodes, int slot) {
  const auto found = std::lower_bound(nodes.begin(), nodes.end(), slot,
                                      [](const EndNode& n, int s) { return n.slot < s; });
  return static_cast<std::size_t>(found - nodes.begin());
}

class JobSearch {
 public:
  JobSearch(std::span<const SearchedRun> runs, Transitions& transitions,
            const std::optional<Config>& home, const JobSearchOptions& options, JobOutcome& outcome)
      : transitions_(transitions), home_(home), options_(options), outcome_(outcome) {
    runs_.reserve(runs.size());
    for (const SearchedRun& run : runs) runs_.emplace_back(run, options.paths);
  }

  void run() {
    if (!find_runs_alone()) return;
    begin_transitions();
    find_greedy_job();
    while (improve()) {
    }
    outcome_.decided = true;
  }

 private:
  [[nodiscard]] int last() const { return static_cast<int>(runs_.size()); }
  [[nodiscard]] Run& at(int k) { return runs_[static_cast<std::size_t>(k)]; }
  /// Returns the costs of transition k: to run k from the run before it or from home; 0 and last()
  /// exist only with a home.
  [[nodiscard]] TransitionCosts& costs(int k) { return *costs_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool exists(int transition) const {
    return home_ || (transition > 0 && transition < last());
  }

  /// Finds the best valid path of each run by itself. Returns false if one has none.
  bool find_runs_alone() {
    const TraceSpan span("runs alone");
    std::vector<SearchOutcome> found(runs_.size());
    options_.work.for_each(last(), [&](int k, int) {
      found[static_cast<std::size_t>(k)] = best_alone(at(k), options_.paths);
    });
    outcome_.least_costs.assign(runs_.size(), kUnreachable);
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      if (!found[k].path.empty())
        outcome_.least_costs[k] = found[k].cost;
      else if (!outcome_.run_without_path)
        outcome_.run_without_path = k;
    }
    outcome_.decided = outcome_.run_without_path.has_value();
    if (!outcome_.decided)
      for (const double cost : outcome_.least_costs) outcome_.bound_any = outcome_.bound += cost;
    return !outcome_.run_without_path;
  }

  void begin_transitions() {
    const TraceSpan span("distances");
    options_.work.for_each(last(), [&](int k, int) {
      if (at(k).cost_to_go->lattice().is_closed()) at(k).loops.emplace(*at(k).cost_to_go);
    });
    const std::vector<EndNode> home =
        home_ ? std::vector<EndNode>{{0, *home_}} : std::vector<EndNode>();
    costs_.resize(runs_.size() + 1);
    for (int k = 0; k <= last(); ++k) {
      if (!exists(k)) continue;
      costs_[static_cast<std::size_t>(k)].emplace(
          transitions_,
          k == 0 ? home
                 : nodes_of(*at(k - 1).cost_to_go, at(k - 1).cost_to_go->lattice().layers() - 1),
          k == last() ? home : nodes_of(*at(k).cost_to_go, 0));
    }
  }

  // --- the greedy job

  /// Finds the job that takes each run at the least cost after the one before, with straight
  /// transitions, before values say what the rest of the job costs. It is the first job found if
  /// its transitions are free; else ways around are sought only once the cheapest job needs them
  /// too. Where a transition cannot leave a run at all, or reach it, the job is found anew.
  void find_greedy_job() {
    const TraceSpan span("greedy job");
    for (;;) {
      greedy_ = {};
      greedy_costs_.clear();
      if (!lay_greedy_job()) {
        greedy_ = {};
        return;
      }
      const std::vector<TransitionAnswer> answers = ask(greedy_.pairs, false);
      if (!bar_ends(greedy_.pairs, answers)) {
        for (const TransitionAnswer& answer : answers)
          if (answer.verdict != Verdict::kValid) return;
        return take_greedy_job();
      }
      forbid_barred_ends();
    }
  }
  /// Chooses the paths and pairs of the greedy job. Returns false if a run cannot be reached or
  /// left.
  bool lay_greedy_job() {
    std::size_t end = 0;
    for (int k = 0; k < last(); ++k) {
      Run& run = at(k);
      TransitionCosts::Onward onward;
      int slot = 0;
      do {
        slot = exists(k) ? -1 : first_slot(run);
        if (exists(k)) {
          take_rest(k);
          onward = costs(k).onward(end);
          if (onward.cost == kUnreachable) return false;
          slot = costs(k).nodes(Side::kBegin)[onward.begin].slot;
        }
        if (slot < 0) return false;
      } while (!find_path(run, slot) || !validate(run));
      if (exists(k)) greedy_.pairs.push_back({k, end, onward.begin});
      greedy_.paths.push_back(run.path);
      greedy_costs_.push_back(run.cost_to_go->at(0, run.path.front()));
      if (exists(k + 1)) end = index_of(costs(k + 1).nodes(Side::kEnd), run.path.back());
    }
    if (exists(last())) greedy_.pairs.push_back({last(), end, 0});
    return true;
  }
  /// Makes paths of runs end where transitions can begin.
  void forbid_barred_ends() {
    for (int k = 0; k < last(); ++k) {
      if (!exists(k + 1)) continue;
      Run& run = at(k);
      const TransitionCosts& next = costs(k + 1);
      std::vector<double> exits(last_slots(run));
      for (std::size_t end = 0; end < next.nodes(Side::kEnd).size(); ++end)
        if (next.is_barred(Side::kEnd, end))
          exits[static_cast<std::size_t>(next.nodes(Side::kEnd)[end].slot)] = kUnreachable;
      raise_exit_costs(run, exits);
    }
  }
  void take_greedy_job() {
    take_job(greedy_, greedy_costs_);
    greedy_ = {};
  }
  /// Searches for ways around where the greedy job's transitions are barred, and takes the job if
  /// there are.
  void complete_greedy_job() {
    if (greedy_.paths.empty()) return;
    std::vector<Pair> open;
    for (const Pair& pair : greedy_.pairs) {
      if (is_barred(pair)) {
        greedy_ = {};
        return;
      }
      if (costs(pair.transition).asked(pair.end, pair.begin) != Asked::kThoroughly)
        open.push_back(pair);
    }
    ask(open, true);
    take_greedy_job();
  }

  /// Finds the best path of a run from a slot. Returns false if it costs more than was known.
  static bool find_path(Run& run, int slot) {
    if (run.loops)
      run.path = run.loops->loop_from(slot, run.counters.expansions);
    else
      run.path = best_path_from(slot, *run.cost_to_go, run.counters.expansions, &run.earlier);
    return !run.path.empty();
  }

  // --- questions

  /// Asks about the candidate path of a run and what its nodes cost. Returns true if it is valid
  /// and costs what was known; else values are made exact again.
  static bool validate(Run& run) {
    run.validator.begin();
    const std::int64_t removed = run.cost_to_go->verdicts().removed();
    ++run.counters.iterations;
    if (run.validity->asks_costs() && run.validator.costs_more(run.path)) {
      run.valid = false;
    } else {
      run.valid = run.validator.valid(run.path);
      if (!run.valid && run.cost_to_go->verdicts().removed() == removed)
        throw std::logic_error("a round of the search removed nothing: it would never end");
    }
    if (!run.cost_to_go->verdicts().pending.empty()) run.cost_to_go->repair();
    if (run.loops) run.loops->take_values();
    return run.valid;
  }

  /// Asks about pairs of transitions and notes the answers. They are raised once all runs of the
  /// cheapest job are valid: until then its value bounds the cost of any job.
  std::vector<TransitionAnswer> ask(const std::vector<Pair>& pairs, bool thorough) {
    std::vector<TransitionQuestion> questions;
    for (const auto& [k, end, begin] : pairs)
      questions.push_back(
          {k, costs(k).nodes(Side::kEnd)[end].q, costs(k).nodes(Side::kBegin)[begin].q, thorough});
    std::vector<TransitionAnswer> answers(pairs.size());
    transitions_.find(questions, answers);
    outcome_.pairs += static_cast<std::int64_t>(pairs.size());
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      const auto& [k, end, begin] = pairs[n];
      const bool known = answers[n].verdict != Verdict::kUnknown;
      if (answers[n].verdict == Verdict::kRemoved) {
        ++failed_searches_;
        last_failed_ = k;
      }
      if (thorough && !(known && answers[n].verdict == Verdict::kValid &&
                        answers[n].cost <= costs(k).at(end, begin)))
        ++outcome_.searches;
      costs(k).set_asked(end, begin, known ? Asked::kThoroughly : Asked::kInPassing);
      if (!known) continue;
      const double cost = answers[n].verdict == Verdict::kValid ? answers[n].cost : kUnreachable;
      if (cost == kUnreachable)
        without_way_.try_emplace(k, std::array{questions[n].from, questions[n].to});
      noted_.push_back({pairs[n], cost});
    }
    return answers;
  }
  [[nodiscard]] bool is_barred(const Pair& pair) {
    const TransitionCosts& known = costs(pair.transition);
    return known.is_barred(Side::kEnd, pair.end) || known.is_barred(Side::kBegin, pair.begin);
  }
  /// Finds out whether pairs without a known way are so since no transition can leave their end
  /// nodes or reach their begin nodes. Where one cannot, bars all such nodes beside it, so that
  /// they are not asked about pair by pair. Returns true if nodes were barred.
  bool bar_ends(const std::vector<Pair>& pairs, const std::vector<TransitionAnswer>& answers) {
    bool any = false;
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      if (answers[n].verdict == Verdict::kValid) continue;
      const auto& [k, end, begin] = pairs[n];
      any = bar(k, Side::kEnd, end) || any;
      any = bar(k, Side::kBegin, begin) || any;
    }
    return any;
  }
  bool bar(int transition, Side side, std::size_t suspect) {
    if (barred_at_.contains({transition, side})) return false;  // all of them are known
    TransitionCosts& known = costs(transition);
    const std::vector<EndNode>& nodes = known.nodes(side);
    std::vector<Config> asked{nodes[suspect].q};
    std::vector<std::uint8_t> barred(1);
    transitions_.find_barred(asked, barred);
    if (!barred.front()) return false;
    barred_at_.emplace(std::pair(transition, side), asked.front());
    asked.clear();
    for (const EndNode& node : nodes) asked.push_back(node.q);
    barred.assign(asked.size(), 0);
    transitions_.find_barred(asked, barred);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (barred[k]) known.bar(side, k);
    return true;
  }
  /// Raises the costs that were noted. Returns true if one of them rose.
  bool raise_noted() {
    bool any = false;
    for (const auto& [pair, cost] : noted_) {
      TransitionCosts& known = costs(pair.transition);
      if (!(cost > known.at(pair.end, pair.begin))) continue;
      known.raise(pair.end, pair.begin, cost);
      any = true;
    }
    noted_.clear();
    raised_ = raised_ || any;
    return any;
  }

  // --- rounds

  /// Tries the cheapest job that is left. Returns false once the cheapest job is known.
  bool improve() {
    ++outcome_.rounds;
    at(0).cost_to_go->budget().poll();
    update_values();
    Candidate job;
    const int slot = begin_cheapest_job(job);
    if (slot < 0) {
      if (outcome_.cost == kUnreachable) note_without_way(static_cast<int>(first_barred()));
      outcome_.bound = outcome_.cost;
      return false;
    }
    outcome_.bound = std::min(value_, outcome_.cost);
    if (!raised_) outcome_.bound_any = outcome_.bound;
    if (outcome_.cost <= value_ || value_ >= options_.most_cost) return false;
    if (!lay_paths(slot, job)) return true;
    if (!validate_runs() || raise_noted()) return true;
    return !take_if_transitions_hold(job);
  }

  /// Computes what the rest of the job costs from all begin nodes, from the last run to the first.
  void update_values() {
    const TraceSpan span("job values");
    for (int k = last() - 1; k >= 0; --k) {
      if (exists(k + 1)) raise_exits(k);
      if (exists(k)) take_rest(k);
    }
  }
  void raise_exits(int k) {
    Run& run = at(k);
    TransitionCosts& next = costs(k + 1);
    const std::size_t count = next.nodes(Side::kEnd).size();
    run.onward.resize(count);
    std::vector<double> exits(last_slots(run), kUnreachable);
    constexpr std::size_t kEach = 64;  // ends that one thread takes at a time
    options_.work.for_each(static_cast<int>((count + kEach - 1) / kEach), [&](int part, int) {
      run.cost_to_go->budget().poll();
      const std::size_t first = kEach * static_cast<std::size_t>(part);
      for (std::size_t end = first; end < std::min(count, first + kEach); ++end) {
        TransitionCosts::Onward& onward = run.onward[end];
        // costs only rise, so the way on stays the cheapest as long as it costs what it did
        if (onward.cost == kUnreachable ||
            next.at(end, onward.begin) + next.rest(onward.begin) != onward.cost)
          onward = next.onward(end);
        exits[static_cast<std::size_t>(next.nodes(Side::kEnd)[end].slot)] = onward.cost;
      }
    });
    raise_exit_costs(run, exits);
  }
  /// Sets what must be paid for going on from each slot of a run's last layer, and makes its values
  /// exact.
  static void raise_exit_costs(Run& run, const std::vector<double>& exits) {
    if (run.loops) {
      run.exits = exits;
      return;
    }
    Verdicts& verdicts = run.cost_to_go->verdicts();
    verdicts.raise_exit_costs(exits);
    if (!std::exchange(run.swept_with_exits, true))
      run.cost_to_go->sweep(run.cost_to_go->lattice().layers() - 1);
    else if (!verdicts.pending.empty())
      run.cost_to_go->repair();
  }
  static std::size_t last_slots(const Run& run) {
    const Lattice& lattice = run.cost_to_go->lattice();
    return static_cast<std::size_t>(lattice.slots(lattice.layers() - 1));
  }
  void take_rest(int k) {
    std::vector<double> rest;
    for (const EndNode& begin : costs(k).nodes(Side::kBegin))
      rest.push_back(rest_from(at(k), begin.slot));
    costs(k).set_rest(std::move(rest));
  }

  /// Begins the cheapest job by what is known, and sets value_ to its cost. Returns the slot at
  /// which its first run begins; -1 if no job is left.
  int begin_cheapest_job(Candidate& job) {
    value_ = kUnreachable;
    if (home_) {
      const auto onward = costs(0).onward(0);
      if (onward.cost == kUnreachable) return -1;
      value_ = onward.cost;
      job.pairs.push_back({0, 0, onward.begin});
      return costs(0).nodes(Side::kBegin)[onward.begin].slot;
    }
    const int slot = first_slot(at(0));
    if (slot >= 0) value_ = rest_from(at(0), slot);
    return slot;
  }
  /// Lays out the cheapest job from the slot at which its first run begins. Returns false if a run
  /// costs more than was known.
  bool lay_paths(int slot, Candidate& job) {
    for (int k = 0; k < last(); ++k) {
      Run& run = at(k);
      if (!find_path(run, slot)) return false;
      if (!run.loops) run.earlier.add(run.path, *run.cost_to_go);
      job.paths.push_back(run.path);
      if (!exists(k + 1)) continue;
      const std::size_t end = index_of(costs(k + 1).nodes(Side::kEnd), run.path.back());
      job.pairs.push_back({k + 1, end, run.onward[end].begin});
      if (k + 1 < last()) slot = costs(k + 1).nodes(Side::kBegin)[run.onward[end].begin].slot;
    }
    return true;
  }

  bool validate_runs() {
    const TraceSpan span("validate runs");
    options_.work.for_each(last(), [&](int k, int) { validate(at(k)); });
    return std::all_of(runs_.begin(), runs_.end(), [](const Run& run) { return run.valid; });
  }

  /// Asks about the transitions of a job whose runs are valid. Takes the job if a way was found for
  /// each. Returns true if nothing cheaper can be left.
  bool take_if_transitions_hold(const Candidate& job) {
    const TraceSpan span("transitions");
    std::vector<Pair> open;
    for (const Pair& pair : job.pairs)
      if (costs(pair.transition).asked(pair.end, pair.begin) != Asked::kThoroughly)
        open.push_back(pair);
    std::vector<double> run_costs;
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      const SlotPath& path = job.paths[k];
      run_costs.push_back(runs_[k].cost_to_go->at(0, path.front()) -
                          runs_[k].cost_to_go->verdicts().exit_cost(path.back()));
    }
    if (!open.empty() && is_spent()) return true;
    std::vector<TransitionAnswer> answers = ask(open, false);
    if (bar_ends(open, answers)) return false;
    find_ways(open, answers);
    std::vector<Pair> dearer;
    for (std::size_t n = 0; n < open.size(); ++n) {
      const double straight = costs(open[n].transition).at(open[n].end, open[n].begin);
      if (answers[n].verdict == Verdict::kValid && answers[n].cost <= straight) continue;
      dearer.push_back(open[n]);
    }
    raise_noted();
    take_job(job, run_costs);
    if (dearer.empty()) return true;
    for (const Pair& pair : dearer) ask_around(pair);
    raise_noted();
    return false;
  }

  /// Returns true if enough was searched for ways. Where there is no job then, the transition at
  /// which searches failed has no way that was found.
  bool is_spent() {
    const bool failed = failed_searches_ >= options_.most_failed_searches;
    if (!failed && outcome_.searches < options_.most_searches) return false;
    if (outcome_.cost == kUnreachable) note_without_way(last_failed_);
    return true;
  }
  void note_without_way(int transition) {
    outcome_.transition_without_way = static_cast<std::size_t>(transition);
    const auto pair = without_way_.find(transition);
    if (pair != without_way_.end()) outcome_.pair_without_way = pair->second;
    note_barred(transition, Side::kEnd, outcome_.barred_end);
    note_barred(transition, Side::kBegin, outcome_.barred_begin);
  }
  void note_barred(int transition, Side side, std::optional<Config>& noted) {
    const auto found = barred_at_.find({transition, side});
    if (found == barred_at_.end()) return;
    const TransitionCosts& known = costs(transition);
    for (std::size_t k = 0; k < known.nodes(side).size(); ++k)
      if (!known.is_barred(side, k)) return;
    noted = found->second;
  }

  /// Completes the answers about pairs of the cheapest job that were asked in passing: thoroughly
  /// where no way is known. Before the first thorough search the greedy job is completed.
  void find_ways(const std::vector<Pair>& pairs, std::vector<TransitionAnswer>& answers) {
    std::vector<Pair> barred;
    for (std::size_t n = 0; n < pairs.size(); ++n)
      if (answers[n].verdict == Verdict::kUnknown) barred.push_back(pairs[n]);
    if (barred.empty()) return;
    complete_greedy_job();
    const std::vector<TransitionAnswer> found = ask(barred, true);
    for (std::size_t n = 0, next = 0; n < pairs.size(); ++n)
      if (answers[n].verdict == Verdict::kUnknown) answers[n] = found[next++];
  }

  /// Asks in passing about pairs near one whose straight move is barred, as far as they are cheaper
  /// than the way around: an obstacle bars many neighbours alike, and the way around one serves the
  /// others.
  void ask_around(const Pair& barred) {
    constexpr std::size_t kMostAtOnce = 96;
    const int k = barred.transition;
    const TransitionCosts& known = costs(k);
    int& reach = reach_[static_cast<std::size_t>(k)];
    reach = std::min(kMostReach, std::max(kLeastReach, 2 * reach));
    const double most = known.at(barred.end, barred.begin) + known.rest(barred.begin);
    struct Near {
      double cost;
      Pair pair;
    };
    std::vector<Near> near;
    const auto range = [&](std::size_t centre, std::size_t count) {
      const auto w = static_cast<std::size_t>(reach);
      return std::pair{centre < w ? 0 : centre - w, std::min(count, centre + w + 1)};
    };
    const auto [first_end, last_end] = range(barred.end, known.nodes(Side::kEnd).size());
    const auto [first_begin, last_begin] = range(barred.begin, known.nodes(Side::kBegin).size());
    for (std::size_t end = first_end; end < last_end; ++end)
      for (std::size_t begin = first_begin; begin < last_begin; ++begin) {
        const double cost = known.at(end, begin) + known.rest(begin);
        if (cost < most && known.asked(end, begin) == Asked::kNothing)
          near.push_back({cost, {k, end, begin}});
      }
    std::stable_sort(near.begin(), near.end(),
                     [](const Near& a, const Near& b) { return a.cost < b.cost; });
    std::vector<Pair> pairs;
    for (const Near& x : near)
      if (pairs.size() < kMostAtOnce) pairs.push_back(x.pair);
    if (!pairs.empty()) ask(pairs, false);
  }

  /// Takes a valid job whose transitions are known if it is the cheapest so far.
  void take_job(const Candidate& job, const std::vector<double>& run_costs) {
    std::vector<double> transition_costs;
    double cost = 0;
    for (const double run : run_costs) cost += run;
    for (const Pair& pair : job.pairs) {
      double known = costs(pair.transition).at(pair.end, pair.begin);
      for (const auto& [noted, more] : noted_)
        if (noted.transition == pair.transition && noted.end == pair.end &&
            noted.begin == pair.begin)
          known = std::max(known, more);
      transition_costs.push_back(known);
      cost += known;
    }
    if (!(cost < outcome_.cost)) return;
    outcome_.cost = cost;
    outcome_.paths = job.paths;
    outcome_.run_costs = run_costs;
    outcome_.transition_costs = transition_costs;
  }

  /// Returns the last transition over which no begin node has a way to the end of the job.
  [[nodiscard]] std::size_t first_barred() {
    for (int k = last(); k > 0; --k)
      if (exists(k) && !leads_on(k)) return static_cast<std::size_t>(k);
    return 0;
  }
  /// Returns true if a transition leads to the end of the job from a node at which the run before
  /// it may end.
  [[nodiscard]] bool leads_on(int transition) {
    const Run& run = at(transition - 1);
    const std::vector<EndNode>& ends = costs(transition).nodes(Side::kEnd);
    for (std::size_t k = 0; k < ends.size(); ++k)
      if (run.onward[k].cost < kUnreachable &&
          (!run.loops || run.loops->at(ends[k].slot) < kUnreachable))
        return true;
    return false;
  }

  static constexpr int kLeastReach = 4, kMostReach = 24;
  Transitions& transitions_;
  const std::optional<Config>& home_;
  const JobSearchOptions& options_;
  JobOutcome& outcome_;
  std::vector<Run> runs_;
  std::vector<std::optional<TransitionCosts>> costs_;  // by transition
  std::map<int, std::array<Config, 2>> without_way_;   // by transition: the first pair
  std::map<std::size_t, int> reach_;                   // of ask_around(), by transition
  /// One of the nodes that no transition can leave or reach, by transition and side: then all such
  /// nodes are barred.
  std::map<std::pair<int, Side>, Config> barred_at_;
  struct Noted {
    Pair pair;
    double cost;
  };
  Candidate greedy_;                           // until it is taken
  std::vector<double> greedy_costs_;           // of its runs
  std::vector<Noted> noted_;                   // answers that are not raised yet
  int failed_searches_ = 0, last_failed_ = 0;  // last_failed_: the transition
  bool raised_ = false;                        // the cost of a transition
  double value_ = kUnreachable;                // cost of the cheapest job by what is known
};

}  // namespace

JobOutcome search_job(std::span<const SearchedRun> runs, Transitions& transitions,
                      const std::optional<Config>& home, const JobSearchOptions& options) {
  JobOutcome outcome;
  try {
    JobSearch(runs, transitions, home, options, outcome).run();
  } catch (const Stopped&) {
  }
  return outcome;
}

}  // namespace swivel
