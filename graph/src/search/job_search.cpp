// SPDX-License-Identifier: BSD-3-Clause
// The search of a job joins the lattices of its strokes' runs to one graph: every end node of every
// run of a stroke may be followed by every begin node of every run of the next stroke, at the cost
// of a transition, so that a path through the graph takes one run of each stroke. Its cost-to-go is
// that of the runs, each with the cheapest way on as the exit costs of its last layer, computed
// from the last stroke to the first. As with single paths, what turns out to be invalid is removed
// and what turns out to cost more is raised, so that the value of the best job left is always a
// lower bound. A closed run ends in the node in which it begins: its value at a node is what a loop
// from there costs at least (LoopCosts) and the exit cost of that node, and is made exact once the
// cheapest job left begins it there.
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
        knots(run.knots),
        validator(*run.cost_to_go, *run.validity, with_knots(options, run.knots)) {}
  static PathFirstOptions with_knots(PathFirstOptions options, KnotSearch* knots) {
    options.knots = knots;
    return options;
  }
  CostToGo* cost_to_go;
  Validity* validity;
  KnotSearch* knots;
  PathValidator validator;
  PathCache earlier;
  SearchCounters counters;
  bool has_path = true;  // by itself
  bool swept_with_exits = false;
  std::optional<LoopCosts> loops;  // of a closed run, once its transitions are laid out
  std::vector<double> exits;       // of a closed run, by slot; empty where all are 0
  SlotPath path;                   // of the candidate job
  bool valid = false;              // the last answer about `path`
};

/// A stroke: the runs of which a job takes one.
struct StrokeRuns {
  std::vector<Run> runs;
  std::size_t taken = 0;                        // by the candidate job
  std::vector<TransitionCosts::Onward> onward;  // from each end node of the transition behind it
  [[nodiscard]] Run& run() { return runs[taken]; }
};

/// A node at which a stroke may begin: the number of its run, and the slot in that run's layer 0.
struct BeginSlot {
  std::size_t run = 0;
  int slot = -1;  // -1: there is none
};

/// Returns the least cost from a node of a run's first layer to the end of the job.
double rest_from(const Run& run, int slot) {
  if (!run.loops) return run.cost_to_go->at(0, slot);
  const double exit = run.exits.empty() ? 0 : run.exits[static_cast<std::size_t>(slot)];
  return run.loops->at(slot) + exit;
}

/// Returns the slot at which a run begins that nothing precedes; -1 where there is none.
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

/// Returns where a stroke begins that nothing precedes: in the cheapest run, the first of equals.
BeginSlot first_begin(const StrokeRuns& stroke) {
  BeginSlot best;
  double least = kUnreachable;
  for (std::size_t k = 0; k < stroke.runs.size(); ++k) {
    if (!stroke.runs[k].has_path) continue;
    const int slot = first_slot(stroke.runs[k]);
    if (slot < 0 || !(rest_from(stroke.runs[k], slot) < least)) continue;
    best = {k, slot};
    least = rest_from(stroke.runs[k], slot);
  }
  return best;
}

/// Finds the best path of a run by itself.
SearchOutcome best_alone(Run& run, const PathFirstOptions& options) {
  const Lattice& lattice = run.cost_to_go->lattice();
  run.cost_to_go->sweep(lattice.layers() - 1);
  SearchOutcome found =
      first_valid_path(*run.cost_to_go, *run.validity, run.validator, run.earlier, run.counters);
  if (!lattice.is_closed() || found.path.empty()) return found;
  return closed_path_first(*run.cost_to_go, *run.validity, Run::with_knots(options, run.knots),
                           run.counters);
}

/// A pair of nodes of one transition.
struct Pair {
  int transition = 0;
  std::size_t end = 0, begin = 0;
};

/// A job: the run taken of each stroke, a path through it, and the pair of nodes of each
/// transition.
struct Candidate {
  std::vector<std::size_t> runs;
  std::vector<SlotPath> paths;
  std::vector<Pair> pairs;
};

/// Returns the nodes at which a stroke may end or begin that are not removed, by run and slot, with
/// the joints of their rows.
std::vector<EndNode> nodes_of(StrokeRuns& stroke, Side side) {
  std::vector<EndNode> nodes;
  for (std::size_t k = 0; k < stroke.runs.size(); ++k) {
    if (!stroke.runs[k].has_path) continue;
    CostToGo& cost_to_go = *stroke.runs[k].cost_to_go;
    const Lattice& lattice = cost_to_go.lattice();
    const int layer = side == Side::kEnd ? lattice.layers() - 1 : 0;
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      if (cost_to_go.verdicts().node(layer, slot) == Verdict::kRemoved) continue;
      const auto q = cost_to_go.node(layer, slot);
      if (const auto row = q ? lattice.exact_config(layer, slot, *q) : std::nullopt)
        nodes.push_back({k, slot, *row});
    }
  }
  return nodes;
}

std::size_t index_of(const std::vector<EndNode>& nodes, std::size_t run, int slot) {
  const auto found = std::lower_bound(
      nodes.begin(), nodes.end(), std::pair(run, slot),
      [](const EndNode& n, const auto& at) { return std::pair(n.run, n.slot) < at; });
  return static_cast<std::size_t>(found - nodes.begin());
}

class JobSearch {
 public:
  JobSearch(std::span<const SearchedStroke> strokes, Transitions& transitions,
            const std::optional<Config>& home, const JobSearchOptions& options, JobOutcome& outcome)
      : transitions_(transitions), home_(home), options_(options), outcome_(outcome) {
    strokes_.resize(strokes.size());
    for (std::size_t k = 0; k < strokes.size(); ++k) {
      strokes_[k].runs.reserve(strokes[k].runs.size());
      for (const SearchedRun& run : strokes[k].runs)
        runs_.push_back(&strokes_[k].runs.emplace_back(run, options.paths));
    }
  }

  void run() {
    if (!find_runs_alone()) return;
    begin_transitions();
    find_greedy_job();
    while (!ends_at_narrow_steps() && improve()) note_narrow_steps();
    note_narrow_steps();
    outcome_.decided = !ends_at_narrow_steps();
    if (!outcome_.decided) drop_job();
  }

 private:
  [[nodiscard]] int last() const { return static_cast<int>(strokes_.size()); }
  [[nodiscard]] StrokeRuns& at(int k) { return strokes_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] const Budget& budget() const { return runs_.front()->cost_to_go->budget(); }
  /// Calls `body` with each run of each stroke, shared among threads.
  template <class Body>
  void for_each_run(const Body& body) {
    options_.work.for_each(static_cast<int>(runs_.size()),
                           [&](int k, int) { body(*runs_[static_cast<std::size_t>(k)]); });
  }
  /// Returns the costs of transition k: to stroke k from the stroke before it or from home; 0 and
  /// last() exist only with a home.
  [[nodiscard]] TransitionCosts& costs(int k) { return *costs_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] bool exists(int transition) const {
    return home_ || (transition > 0 && transition < last());
  }

  /// Returns whether candidate paths of a run fail again and again at steps known to be narrow.
  [[nodiscard]] bool ends_at_narrow_steps() const {
    return std::any_of(runs_.begin(), runs_.end(), [](const Run* run) {
      return run->knots && run->knots->idle >= run->knots->patience;
    });
  }
  /// Forgets the job that was found: it need not be the cheapest.
  void drop_job() {
    outcome_.cost = kUnreachable;
    outcome_.runs.clear();
    outcome_.paths.clear();
    outcome_.run_costs.clear();
    outcome_.transition_costs.clear();
  }
  void note_narrow_steps() {
    if (outcome_.narrow) return;
    outcome_.narrow = std::any_of(runs_.begin(), runs_.end(), [](const Run* run) {
      return run->knots && !run->knots->narrow.empty();
    });
    if (outcome_.narrow) outcome_.narrow_from = outcome_.bound;
  }

  /// Finds the best valid path of each run by itself. Returns false if a stroke has none.
  bool find_runs_alone() {
    const TraceSpan span("runs alone");
    std::vector<SearchOutcome> found(runs_.size());
    options_.work.for_each(static_cast<int>(runs_.size()), [&](int k, int) {
      const auto i = static_cast<std::size_t>(k);
      found[i] = best_alone(*runs_[i], options_.paths);
    });
    std::size_t next = 0;
    double sum = 0;  // of the least costs of the strokes
    for (std::size_t k = 0; k < strokes_.size(); ++k) {
      std::vector<double>& costs = outcome_.least_costs.emplace_back();
      for (Run& run : strokes_[k].runs) {
        const SearchOutcome& alone = found[next++];
        run.has_path = !alone.path.empty();
        costs.push_back(run.has_path ? alone.cost : kUnreachable);
      }
      const double least = *std::min_element(costs.begin(), costs.end());
      if (least == kUnreachable && !outcome_.stroke_without_path) outcome_.stroke_without_path = k;
      sum += least;
    }
    if (!outcome_.stroke_without_path) outcome_.bound_any = outcome_.bound = sum;
    note_narrow_steps();
    if (ends_at_narrow_steps()) return false;
    outcome_.decided = outcome_.stroke_without_path.has_value();
    return !outcome_.decided;
  }

  void begin_transitions() {
    const TraceSpan span("distances");
    for_each_run([](Run& run) {
      if (run.has_path && run.cost_to_go->lattice().is_closed()) run.loops.emplace(*run.cost_to_go);
    });
    const std::vector<EndNode> home =
        home_ ? std::vector<EndNode>{{0, 0, *home_}} : std::vector<EndNode>();
    costs_.resize(strokes_.size() + 1);
    for (int k = 0; k <= last(); ++k) {
      if (!exists(k)) continue;
      costs_[static_cast<std::size_t>(k)].emplace(
          transitions_, k == 0 ? home : nodes_of(at(k - 1), Side::kEnd),
          k == last() ? home : nodes_of(at(k), Side::kBegin));
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
  /// Chooses the runs, paths and pairs of the greedy job. Returns false if a stroke cannot be
  /// reached or left.
  bool lay_greedy_job() {
    std::size_t end = 0;
    for (int k = 0; k < last(); ++k) {
      StrokeRuns& stroke = at(k);
      TransitionCosts::Onward onward;
      BeginSlot begin;
      do {
        if (exists(k)) {
          take_rest(k);
          onward = costs(k).onward(end);
          if (onward.cost == kUnreachable) return false;
          begin = begin_of(k, onward);
        } else {
          begin = first_begin(stroke);
        }
        if (begin.slot < 0) return false;
        if (ends_at_narrow_steps()) return false;
      } while (!find_path(stroke.runs[begin.run], begin.slot) || !validate(stroke.runs[begin.run]));
      const Run& run = stroke.runs[begin.run];
      if (exists(k)) greedy_.pairs.push_back({k, end, onward.begin});
      greedy_.runs.push_back(begin.run);
      greedy_.paths.push_back(run.path);
      greedy_costs_.push_back(run.cost_to_go->at(0, run.path.front()));
      if (exists(k + 1)) end = index_of(costs(k + 1).nodes(Side::kEnd), begin.run, run.path.back());
    }
    if (exists(last())) greedy_.pairs.push_back({last(), end, 0});
    return true;
  }
  /// Returns where stroke k begins by a way on from the stroke before it, or from home.
  [[nodiscard]] BeginSlot begin_of(int k, const TransitionCosts::Onward& onward) {
    const EndNode& node = costs(k).nodes(Side::kBegin)[onward.begin];
    return {node.run, node.slot};
  }
  /// Makes paths of runs end where transitions can begin.
  void forbid_barred_ends() {
    for (int k = 0; k < last(); ++k) {
      if (!exists(k + 1)) continue;
      const TransitionCosts& next = costs(k + 1);
      std::vector<std::vector<double>> exits = exits_of(at(k), 0);
      for (std::size_t end = 0; end < next.nodes(Side::kEnd).size(); ++end) {
        const EndNode& node = next.nodes(Side::kEnd)[end];
        if (next.is_barred(Side::kEnd, end))
          exits[node.run][static_cast<std::size_t>(node.slot)] = kUnreachable;
      }
      raise_exit_costs(at(k), exits);
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
    budget().poll();
    update_values();
    Candidate job;
    const BeginSlot begin = begin_cheapest_job(job);
    if (begin.slot < 0) {
      if (outcome_.cost == kUnreachable) note_without_way(static_cast<int>(first_barred()));
      outcome_.bound = outcome_.cost;
      return false;
    }
    outcome_.bound = std::min(value_, outcome_.cost);
    if (!raised_) outcome_.bound_any = outcome_.bound;
    const double bound = options_.most_cost_of_any ? outcome_.bound_any : value_;
    if (outcome_.cost <= value_ || bound >= options_.most_cost) return false;
    if (!lay_paths(begin, job)) return true;
    if (!validate_runs() || raise_noted()) return true;
    return !take_if_transitions_hold(job);
  }

  /// Computes what the rest of the job costs from all begin nodes, from the last stroke to the
  /// first.
  void update_values() {
    const TraceSpan span("job values");
    for (int k = last() - 1; k >= 0; --k) {
      if (exists(k + 1)) raise_exits(k);
      if (exists(k)) take_rest(k);
    }
  }
  void raise_exits(int k) {
    StrokeRuns& stroke = at(k);
    TransitionCosts& next = costs(k + 1);
    const std::size_t count = next.nodes(Side::kEnd).size();
    stroke.onward.resize(count);
    std::vector<std::vector<double>> exits = exits_of(stroke, kUnreachable);
    constexpr std::size_t kEach = 64;  // ends that one thread takes at a time
    options_.work.for_each(static_cast<int>((count + kEach - 1) / kEach), [&](int part, int) {
      budget().poll();
      const std::size_t first = kEach * static_cast<std::size_t>(part);
      for (std::size_t end = first; end < std::min(count, first + kEach); ++end) {
        TransitionCosts::Onward& onward = stroke.onward[end];
        // costs only rise, so the way on stays the cheapest as long as it costs what it did
        if (onward.cost == kUnreachable ||
            next.at(end, onward.begin) + next.rest(onward.begin) != onward.cost)
          onward = next.onward(end);
        const EndNode& node = next.nodes(Side::kEnd)[end];
        exits[node.run][static_cast<std::size_t>(node.slot)] = onward.cost;
      }
    });
    raise_exit_costs(stroke, exits);
  }
  /// Returns the same exit cost for all slots of the last layer of each run of a stroke.
  static std::vector<std::vector<double>> exits_of(const StrokeRuns& stroke, double cost) {
    std::vector<std::vector<double>> exits;
    for (const Run& run : stroke.runs) {
      const Lattice& lattice = run.cost_to_go->lattice();
      exits.emplace_back(static_cast<std::size_t>(lattice.slots(lattice.layers() - 1)), cost);
    }
    return exits;
  }
  /// Sets what must be paid for going on from each slot of the last layer of each run of a stroke,
  /// and makes the runs' values exact.
  void raise_exit_costs(StrokeRuns& stroke, std::vector<std::vector<double>>& exits) {
    options_.work.for_each(static_cast<int>(stroke.runs.size()), [&](int k, int) {
      const auto i = static_cast<std::size_t>(k);
      if (stroke.runs[i].has_path) raise_exit_costs(stroke.runs[i], exits[i]);
    });
  }
  static void raise_exit_costs(Run& run, std::vector<double>& exits) {
    if (run.loops) {
      run.exits = std::move(exits);
      return;
    }
    Verdicts& verdicts = run.cost_to_go->verdicts();
    verdicts.raise_exit_costs(exits);
    if (!std::exchange(run.swept_with_exits, true))
      run.cost_to_go->sweep(run.cost_to_go->lattice().layers() - 1);
    else if (!verdicts.pending.empty())
      run.cost_to_go->repair();
  }
  void take_rest(int k) {
    std::vector<double> rest;
    for (const EndNode& begin : costs(k).nodes(Side::kBegin))
      rest.push_back(rest_from(at(k).runs[begin.run], begin.slot));
    costs(k).set_rest(std::move(rest));
  }

  /// Begins the cheapest job by what is known, and sets value_ to its cost. Returns where its first
  /// stroke begins; nowhere if no job is left.
  BeginSlot begin_cheapest_job(Candidate& job) {
    value_ = kUnreachable;
    if (home_) {
      const auto onward = costs(0).onward(0);
      if (onward.cost == kUnreachable) return {};
      value_ = onward.cost;
      job.pairs.push_back({0, 0, onward.begin});
      return begin_of(0, onward);
    }
    const BeginSlot begin = first_begin(at(0));
    if (begin.slot >= 0) value_ = rest_from(at(0).runs[begin.run], begin.slot);
    return begin;
  }
  /// Lays out the cheapest job from where its first stroke begins. Returns false if a run costs
  /// more than was known.
  bool lay_paths(BeginSlot begin, Candidate& job) {
    for (int k = 0; k < last(); ++k) {
      StrokeRuns& stroke = at(k);
      stroke.taken = begin.run;
      Run& run = stroke.run();
      if (!find_path(run, begin.slot)) return false;
      if (!run.loops) run.earlier.add(run.path, *run.cost_to_go);
      job.runs.push_back(begin.run);
      job.paths.push_back(run.path);
      if (!exists(k + 1)) continue;
      const std::size_t end = index_of(costs(k + 1).nodes(Side::kEnd), begin.run, run.path.back());
      job.pairs.push_back({k + 1, end, stroke.onward[end].begin});
      if (k + 1 < last()) begin = begin_of(k + 1, stroke.onward[end]);
    }
    return true;
  }

  bool validate_runs() {
    const TraceSpan span("validate runs");
    options_.work.for_each(last(), [&](int k, int) { validate(at(k).run()); });
    return std::all_of(strokes_.begin(), strokes_.end(),
                       [](StrokeRuns& stroke) { return stroke.run().valid; });
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
    for (std::size_t k = 0; k < strokes_.size(); ++k) {
      const SlotPath& path = job.paths[k];
      const CostToGo& run = *strokes_[k].runs[job.runs[k]].cost_to_go;
      run_costs.push_back(run.at(0, path.front()) - run.verdicts().exit_cost(path.back()));
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
    outcome_.runs = job.runs;
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
  /// Returns true if a transition leads to the end of the job from a node at which the stroke
  /// before it may end.
  [[nodiscard]] bool leads_on(int transition) {
    const StrokeRuns& stroke = at(transition - 1);
    const std::vector<EndNode>& ends = costs(transition).nodes(Side::kEnd);
    for (std::size_t k = 0; k < ends.size(); ++k) {
      const std::optional<LoopCosts>& loops = stroke.runs[ends[k].run].loops;
      if (stroke.onward[k].cost < kUnreachable &&
          (!loops || loops->at(ends[k].slot) < kUnreachable))
        return true;
    }
    return false;
  }

  static constexpr int kLeastReach = 4, kMostReach = 24;
  Transitions& transitions_;
  const std::optional<Config>& home_;
  const JobSearchOptions& options_;
  JobOutcome& outcome_;
  std::vector<StrokeRuns> strokes_;
  std::vector<Run*> runs_;                             // of all strokes
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

JobOutcome search_job(std::span<const SearchedStroke> strokes, Transitions& transitions,
                      const std::optional<Config>& home, const JobSearchOptions& options) {
  JobOutcome outcome;
  try {
    JobSearch(strokes, transitions, home, options, outcome).run();
  } catch (const Stopped&) {
    outcome.narrow = false;
  }
  return outcome;
}

}  // namespace swivel
