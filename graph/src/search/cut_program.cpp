// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/search/cut_program.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "cost_to_go/kernels/relax_task.hpp"
#include "search/path_validator.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

namespace {

/// Returns the nodes of a layer, in the order of slots.
std::vector<Lattice::Node> nodes_of(const Lattice& lattice, int layer) {
  std::vector<Lattice::Node> nodes;
  lattice.layer_nodes(layer, nodes);
  return nodes;
}

/// Returns for each node the index of the nearest one among others, by the joint that is furthest
/// away; -1 where that is further than `most`, rad.
std::vector<int> nearest_nodes(const std::vector<Lattice::Node>& nodes,
                               const std::vector<Lattice::Node>& others, double most) {
  std::vector<std::pair<double, int>> by_first_joint;
  for (std::size_t k = 0; k < others.size(); ++k)
    by_first_joint.push_back({others[k].q[0], static_cast<int>(k)});
  std::sort(by_first_joint.begin(), by_first_joint.end());
  std::vector<int> nearest;
  for (const Lattice::Node& node : nodes) {
    nearest.push_back(-1);
    double least = most;
    for (auto other = std::lower_bound(by_first_joint.begin(), by_first_joint.end(),
                                       std::pair(node.q[0] - most, -1));
         other != by_first_joint.end() && other->first <= node.q[0] + most; ++other) {
      const double away =
          (others[static_cast<std::size_t>(other->second)].q - node.q).cwiseAbs().maxCoeff();
      if (away < least || (away == least && nearest.back() < 0))
        least = away, nearest.back() = other->second;
    }
  }
  return nearest;
}

std::vector<Config> joints_of(const std::vector<Lattice::Node>& nodes) {
  std::vector<Config> joints;
  for (const Lattice::Node& node : nodes) joints.push_back(node.q);
  return joints;
}

}  // namespace

/// Straight moves of the joints from some configurations, the ends, to others, the begins, whose
/// ways on cost something each.
class CutProgram::FreeMoves {
 public:
  FreeMoves(const Lattice& lattice, std::vector<Config> ends, std::vector<Config> begins)
      : lattice_(&lattice),
        ends_(std::move(ends)),
        begins_(std::move(begins)),
        from_(by_joint(ends_)),
        to_(by_joint(begins_)),
        blocks_(relax_blocks(lattice, to_)) {}
  /// Sets what going on from each begin costs.
  void set_rest(std::vector<double> rest) { rest_ = std::move(rest); }
  /// Lowers the cost of each end to that of its best move and of going on, where that is less.
  void lower(std::vector<double>& costs) const {
    RelaxTask<double> task = relax_task(*lattice_, 0);
    std::fill(std::begin(task.bound), std::end(task.bound), 1e9);  // rad: none
    if (lattice_->chain().roll) task.scale[kDof - 1] = 0;
    std::vector<double> least_of_blocks;
    relax_all_pairs(task, from_, to_, &blocks_, rest_, least_of_blocks, costs);
  }
  struct Move {
    std::size_t begin = 0;
    double cost = kUnreachable;
  };
  /// Returns the best move from an end, with the cost of going on; the first of several.
  [[nodiscard]] Move from(std::size_t end) const {
    Move best;
    for (std::size_t k = 0; k < begins_.size(); ++k) {
      if (!(rest_[k] < best.cost)) continue;
      Config delta = lattice_->delta(ends_[end], begins_[k]);
      if (lattice_->chain().roll) delta[kDof - 1] = 0;
      const double cost = lattice_->edge_cost(delta) + rest_[k];
      if (cost < best.cost) best = {k, cost};
    }
    return best;
  }
  [[nodiscard]] const std::vector<double>& rest() const { return rest_; }
  [[nodiscard]] const std::vector<Config>& ends() const { return ends_; }
  [[nodiscard]] const std::vector<Config>& begins() const { return begins_; }

 private:
  static NodeJoints by_joint(const std::vector<Config>& configurations) {
    NodeJoints joints;
    for (std::size_t j = 0; j < kDof; ++j)
      for (const Config& q : configurations) joints[j].push_back(q[static_cast<Eigen::Index>(j)]);
    return joints;
  }

  const Lattice* lattice_;
  std::vector<Config> ends_, begins_;
  NodeJoints from_, to_;
  RelaxBlocks blocks_;
  std::vector<double> rest_;
};

/// A line with the least costs along it.
class CutProgram::Line {
 public:
  /// `nodes` are those of the path's layer, at which the line begins or ends.
  Line(CutLine line, LineKind kind, const std::vector<Lattice::Node>& nodes, const Budget& budget)
      : line_(std::move(line)), values_(make_cost_to_go(*line_.lattice, Pruning::kNone, budget)) {
    PathFirstOptions options;
    options.batch = 16;
    validator_.emplace(*values_, *line_.validity, options);
    const int last = line_.lattice->layers() - 1;
    begins_ = nodes_of(*line_.lattice, 0);
    ends_ = nodes_of(*line_.lattice, last);
    // A line's nodes that are not the layer's lead nowhere.
    const std::vector<int> same =
        nearest_nodes(nodes, kind == LineKind::kApproach ? ends_ : begins_, line_.same);
    const auto slots = [&](const std::vector<Lattice::Node>& of) {
      std::vector<int> result;
      for (const int k : same) result.push_back(k < 0 ? -1 : of[static_cast<std::size_t>(k)].slot);
      return result;
    };
    const auto all = [](const std::vector<Lattice::Node>& of) {
      std::vector<int> result;
      for (const Lattice::Node& node : of) result.push_back(node.slot);
      return result;
    };
    first_slots_ = kind == LineKind::kApproach ? all(begins_) : slots(begins_);
    last_slots_ = kind == LineKind::kApproach ? slots(ends_) : all(ends_);
  }
  /// Returns the nodes at the end of the line that is not on the path.
  [[nodiscard]] const std::vector<Lattice::Node>& outer(LineKind kind) const {
    return kind == LineKind::kApproach ? begins_ : ends_;
  }
  /// Returns what it costs to go along the line from each of the nodes at which it begins, and on
  /// from those at which it ends, which costs `ahead`. That must not be less than in the call
  /// before.
  std::vector<double> values(const std::vector<double>& ahead) {
    const int last = line_.lattice->layers() - 1;
    std::vector<double> exits(static_cast<std::size_t>(line_.lattice->slots(last)), kUnreachable);
    end_of_slot_.assign(exits.size(), -1);
    for (std::size_t k = 0; k < ahead.size(); ++k) {
      if (last_slots_[k] < 0) continue;
      const auto slot = static_cast<std::size_t>(last_slots_[k]);
      if (end_of_slot_[slot] >= 0 && !(ahead[k] < exits[slot])) continue;
      exits[slot] = ahead[k];
      end_of_slot_[slot] = static_cast<int>(k);
    }
    values_->verdicts().raise_exit_costs(exits);
    if (std::exchange(swept_, true))
      values_->repair();
    else
      values_->sweep(last);
    std::vector<double> result;
    for (const int slot : first_slots_)
      result.push_back(slot < 0 ? kUnreachable : values_->at(0, slot));
    return result;
  }
  /// Returns at which of the nodes at its end the best way from node `first` ends; -1 where there
  /// is no way.
  [[nodiscard]] int end_from(int first) {
    path_ = best_path_from(first_slots_[static_cast<std::size_t>(first)], *values_, expansions_);
    return path_.empty() ? -1 : end_of_slot_[static_cast<std::size_t>(path_.back())];
  }
  /// Asks about the way that end_from() returned last. Returns true if it is valid; else it is
  /// removed, and values() must follow.
  [[nodiscard]] bool ask() { return validator_->valid(path_); }

 private:
  CutLine line_;
  std::unique_ptr<CostToGo> values_;
  std::optional<PathValidator> validator_;
  std::vector<Lattice::Node> begins_, ends_;   // of the first and the last layer
  std::vector<int> first_slots_, last_slots_;  // of the nodes at which the line begins and ends
  std::vector<int> end_of_slot_;               // by slot of the last layer, from last_slots_
  SlotPath path_;
  std::int64_t expansions_ = 0;
  bool swept_ = false;
};

/// The nodes of a layer of the path, and the edges from there to the next.
struct CutProgram::Layer {
  std::vector<Lattice::Node> nodes;
  std::vector<int> index_of_slot;  // -1: no node
  // The edges from node a are first[a] ... first[a + 1] - 1. Removed ones cost kUnreachable.
  std::vector<std::size_t> first;
  std::vector<int> to;  // index of a node
  std::vector<double> cost;
  int revision = 0;  // grows when a node or an edge of this layer is removed
};

/// The way from the end of a run to the begin of the next one; from home, or from nowhere, to the
/// first run; or from the last run to there.
class CutProgram::Gate {
 public:
  /// `from`, `to`: layers at which a run ends and the next one begins; -1 where there is none.
  Gate(CutProgram& program, int from, int to) : program_(program), from_(from), to_(to) {
    connect();
  }
  /// Sets what it costs to go on from the nodes at which the next run begins, not less than before.
  void set_ahead(const std::vector<double>& ahead) {
    ahead_ = ahead;
    refresh();
  }
  /// Lowers the cost of each node to that of ending a run there and going on to the end of all,
  /// where that is less.
  void lower(std::vector<double>& costs) const {
    for (std::size_t k = 0; k < costs.size(); ++k) costs[k] = std::min(costs[k], ended_[k]);
  }
  /// Returns what all costs where no run ends before.
  [[nodiscard]] double cost() const { return best_from(0).cost; }
  /// Returns the node at which the next run begins after one that ends at node `end`; -1 where none
  /// begins.
  [[nodiscard]] int next(int end) {
    const int outer = retract_ ? retract_->end_from(end) : end;
    if (to_ < 0) return -1;
    const auto begin = static_cast<int>(best_from(static_cast<std::size_t>(outer)).begin);
    return approach_ ? approach_->end_from(begin) : begin;
  }
  /// Asks about the lines on the way from the node `end`. Returns true if they are valid; else
  /// something is removed from them, or they are no longer taken to cost nothing.
  bool ask(int end) {
    if (add_lines()) return false;
    (void)next(end);
    bool valid = true;
    if (retract_) valid = retract_->ask() && valid;
    if (approach_) valid = approach_->ask() && valid;
    if (!valid) refresh();
    return valid;
  }

 private:
  [[nodiscard]] const std::vector<Lattice::Node>& nodes(int layer) const {
    return program_.layers_[static_cast<std::size_t>(layer)].nodes;
  }
  /// Makes the lines, where there are some that are not made yet.
  bool add_lines() {
    const Setting& setting = program_.setting_;
    const bool retract = from_ >= 0 && setting.retract, approach = to_ >= 0 && setting.approach;
    if (retract == (retract_ != nullptr) && approach == (approach_ != nullptr)) return false;
    const auto make = [&](int layer, LineKind kind) {
      return std::make_unique<Line>(setting.make_line(layer, kind), kind, nodes(layer),
                                    program_.budget_);
    };
    if (retract) retract_ = make(from_, LineKind::kRetract);
    if (approach) approach_ = make(to_, LineKind::kApproach);
    connect();
    refresh();
    return true;
  }
  /// Sets between which configurations the joints move freely.
  void connect() {
    const auto side = [&](int layer, const std::unique_ptr<Line>& line, LineKind kind,
                          const std::optional<Config>& home) {
      if (layer >= 0) return joints_of(line ? line->outer(kind) : nodes(layer));
      return home ? std::vector<Config>{*home} : std::vector<Config>();
    };
    const Setting& setting = program_.setting_;
    moves_.emplace(*program_.lattice_,
                   side(from_, retract_, LineKind::kRetract, setting.home_before),
                   side(to_, approach_, LineKind::kApproach, setting.home_after));
  }
  void refresh() {
    moves_->set_rest(to_ < 0     ? std::vector<double>(1, 0.0)
                     : approach_ ? approach_->values(ahead_)
                                 : ahead_);
    const bool to_nowhere = to_ < 0 && moves_->begins().empty();
    ended_.assign(moves_->ends().size(), to_nowhere ? 0.0 : kUnreachable);
    if (from_ >= 0 && !to_nowhere) moves_->lower(ended_);
    if (retract_) ended_ = retract_->values(ended_);
  }
  /// Returns the best move from the end of a line, or of a run without one.
  [[nodiscard]] FreeMoves::Move best_from(std::size_t end) const {
    if (from_ >= 0 || !moves_->ends().empty()) return moves_->from(end);
    FreeMoves::Move best;  // from nowhere
    const std::vector<double>& rest = moves_->rest();
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (rest[k] < best.cost) best = {k, rest[k]};
    return best;
  }

  CutProgram& program_;
  int from_, to_;
  std::unique_ptr<Line> retract_, approach_;
  std::optional<FreeMoves> moves_;
  std::vector<double> ahead_;  // from the begin of the next run
  std::vector<double> ended_;  // from the end of a run
};

/// The values of one number of cuts left: the least cost from each node to the end of all.
struct CutProgram::Level {
  static constexpr int kNone = -1, kLifts = -2;
  std::vector<std::vector<double>> values;   // by layer and node
  std::vector<std::vector<int>> next;        // node of the next layer; kLifts: a run ends here
  std::vector<std::unique_ptr<Gate>> gates;  // by the layer at which a run ends
  std::unique_ptr<Gate> start;
  std::vector<std::uint8_t> barred;  // by layer
  std::vector<int> revision;         // by layer, grows when values change
  std::vector<int> gate_revision;    // by layer, grows when a gate's lines change
  /// What a layer was computed from.
  struct Stamp {
    int layer = -1, next = -1, ahead = -1, gate = -1;
    bool operator==(const Stamp&) const = default;
  };
  std::vector<Stamp> computed;
  explicit Level(std::size_t layers)
      : values(layers),
        next(layers),
        gates(layers),
        barred(layers, 0),
        revision(layers, 0),
        gate_revision(layers, 0),
        computed(layers) {}
};

/// A way to cut the path.
struct CutProgram::Way {
  struct Run {
    int first_layer = 0;
    std::vector<int> nodes;  // of the layers from there on
    [[nodiscard]] int last_layer() const {
      return first_layer + static_cast<int>(nodes.size()) - 1;
    }
  };
  std::vector<Run> runs;
  double cost = 0;
};

CutProgram::CutProgram(const Lattice& lattice, Validity& validity, Setting setting,
                       const Budget& budget)
    : lattice_(&lattice),
      validity_(&validity),
      setting_(std::move(setting)),
      budget_(budget),
      verdicts_(lattice),
      layers_(static_cast<std::size_t>(lattice.layers())) {
  find_edges();
}

CutProgram::~CutProgram() = default;

void CutProgram::find_edges() {
  const TraceSpan span("edges");
  for (int layer = 0; layer < lattice_->layers(); ++layer) {
    Layer& own = layers_[static_cast<std::size_t>(layer)];
    lattice_->layer_nodes(layer, own.nodes);
    own.index_of_slot.assign(static_cast<std::size_t>(lattice_->slots(layer)), -1);
    for (std::size_t k = 0; k < own.nodes.size(); ++k)
      own.index_of_slot[static_cast<std::size_t>(own.nodes[k].slot)] = static_cast<int>(k);
  }
  std::vector<Lattice::SlotRun> runs;
  for (int layer = 0; layer + 1 < lattice_->layers(); ++layer) {
    budget_.poll();
    Layer& own = layers_[static_cast<std::size_t>(layer)];
    const Layer& next = layers_[static_cast<std::size_t>(layer) + 1];
    own.first.assign(1, 0);
    for (const Lattice::Node& node : own.nodes) {
      lattice_->successors(layer, node.slot, runs);
      for (const auto& [first, last] : runs)
        for (int slot = first; slot < last; ++slot) {
          const int to = next.index_of_slot[static_cast<std::size_t>(slot)];
          if (to < 0) continue;
          const Config delta = lattice_->delta(node.q, next.nodes[static_cast<std::size_t>(to)].q);
          if (!lattice_->step_allowed(layer, delta)) continue;
          own.to.push_back(to);
          own.cost.push_back(lattice_->edge_cost(delta));
        }
      own.first.push_back(own.to.size());
    }
  }
}

// --- values

CutProgram::Gate* CutProgram::gate(int left, int layer) {
  Level& level = *levels_[static_cast<std::size_t>(left)];
  const auto i = static_cast<std::size_t>(layer);
  const bool last = layer + 1 == lattice_->layers();
  if (last ? left > 0 : left == 0 || layer == 0 || !setting_.places[i].allowed || level.barred[i])
    return nullptr;
  if (!level.gates[i])
    level.gates[i] = std::make_unique<Gate>(*this, layer, last ? -1 : setting_.places[i].resumed);
  return level.gates[i].get();
}

void CutProgram::compute(int left) {
  budget_.poll();
  while (levels_.size() <= static_cast<std::size_t>(left))
    levels_.push_back(std::make_unique<Level>(layers_.size()));
  for (int layer = lattice_->layers(); layer-- > 0;) compute_layer(left, layer);
}

void CutProgram::compute_layer(int left, int layer) {
  Level& level = *levels_[static_cast<std::size_t>(left)];
  const auto i = static_cast<std::size_t>(layer);
  const bool last = i + 1 == layers_.size();
  Gate* const gate = this->gate(left, layer);
  const Level* const fewer = left > 0 ? levels_[static_cast<std::size_t>(left) - 1].get() : nullptr;
  const auto begin = static_cast<std::size_t>(setting_.places[i].resumed);
  const Level::Stamp stamp{layers_[i].revision, last ? 0 : level.revision[i + 1],
                           gate && !last ? fewer->revision[begin] : 0, level.gate_revision[i]};
  if (stamp == level.computed[i]) return;
  if (gate && !last && stamp.ahead != level.computed[i].ahead)
    gate->set_ahead(fewer->values[begin]);
  if (gate && last && level.values[i].empty()) gate->set_ahead({});
  level.computed[i] = stamp;
  const Layer& own = layers_[i];
  std::vector<double> values(own.nodes.size(), kUnreachable);
  level.next[i].assign(own.nodes.size(), Level::kNone);
  for (std::size_t a = 0; a < own.nodes.size(); ++a) {
    if (verdicts_.node(layer, own.nodes[a].slot) == Verdict::kRemoved) continue;
    double& value = values[a];
    int& next = level.next[i][a];
    if (!last)
      for (std::size_t k = own.first[a]; k < own.first[a + 1]; ++k) {
        const double cost = own.cost[k] + level.values[i + 1][static_cast<std::size_t>(own.to[k])];
        if (cost < value) value = cost, next = own.to[k];
      }
  }
  if (gate) {
    std::vector<double> lowered = values;
    gate->lower(lowered);
    for (std::size_t a = 0; a < own.nodes.size(); ++a)
      if (lowered[a] < values[a] && verdicts_.node(layer, own.nodes[a].slot) != Verdict::kRemoved)
        values[a] = lowered[a], level.next[i][a] = Level::kLifts;
  }
  if (values == level.values[i]) return;
  level.values[i] = std::move(values);
  ++level.revision[i];
}

std::optional<CutProgram::Way> CutProgram::trace(int cuts) {
  Level& top = *levels_[static_cast<std::size_t>(cuts)];
  if (!top.start) top.start = std::make_unique<Gate>(*this, -1, 0);
  top.start->set_ahead(top.values.front());
  Way way;
  way.cost = top.start->cost();
  if (way.cost == kUnreachable) return std::nullopt;
  int layer = 0, left = cuts, node = top.start->next(0);
  way.runs.push_back({0, {node}});
  while (layer + 1 < lattice_->layers()) {
    const Level& level = *levels_[static_cast<std::size_t>(left)];
    const int next = level.next[static_cast<std::size_t>(layer)][static_cast<std::size_t>(node)];
    if (next == Level::kLifts) {
      node = gate(left, layer)->next(node);
      layer = setting_.places[static_cast<std::size_t>(layer)].resumed;
      --left;
      way.runs.push_back({layer, {node}});
    } else {
      node = next;
      ++layer;
      way.runs.back().nodes.push_back(node);
    }
  }
  return way;
}

std::optional<CutPath> CutProgram::best(int cuts) {
  for (;;) {
    for (int left = 0; left <= cuts; ++left) compute(left);
    const auto way = trace(cuts);
    if (!way) return std::nullopt;
    if (!ask_runs(*way) || !ask_gates(*way)) continue;
    CutPath found{{}, way->cost};
    for (std::size_t k = 0; k + 1 < way->runs.size(); ++k)
      found.ends.push_back(way->runs[k].last_layer());
    return found;
  }
}

std::optional<int> CutProgram::least_cuts() {
  for (int cuts = 0;; ++cuts) {
    if (best(cuts)) return cuts;
    if (!adds_nodes(cuts)) return std::nullopt;
  }
}

bool CutProgram::adds_nodes(int cuts) const {
  const auto leads_on = [&](int left, std::size_t layer, std::size_t node) {
    return levels_[static_cast<std::size_t>(left)]->values[layer][node] != kUnreachable;
  };
  for (std::size_t i = 0; i < layers_.size(); ++i)
    for (std::size_t a = 0; a < layers_[i].nodes.size(); ++a) {
      bool known = !leads_on(cuts, i, a);
      for (int left = 0; left < cuts && !known; ++left) known = leads_on(left, i, a);
      if (!known) return true;
    }
  return false;
}

void CutProgram::bar(int left, int layer) {
  if (layer < 0 || layer >= lattice_->layers()) return;
  Level& level = *levels_[static_cast<std::size_t>(left)];
  level.barred[static_cast<std::size_t>(layer)] = 1;
  ++level.gate_revision[static_cast<std::size_t>(layer)];
}

// --- questions

/// Asks about nodes of which nothing is known, and about those beside nodes that fail: what blocks
/// a node mostly blocks its neighbours. Returns true if all of the nodes are valid.
bool CutProgram::ask_nodes(std::vector<NodeQuestion> questions) {
  constexpr int kMostNeighbours = 1024;
  std::vector<NodeAnswer> answers;
  std::vector<int> same;
  bool valid = true;
  int left = kMostNeighbours;
  for (bool given = true; !questions.empty(); given = false) {
    budget_.poll();
    answers.assign(questions.size(), {});
    validity_->nodes(questions, answers);
    std::vector<NodeQuestion> beside;
    std::set<std::pair<int, int>> listed;
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const NodeQuestion& x = questions[k];
      if (answers[k].valid) {
        if (verdicts_.node(x.layer, x.slot) == Verdict::kUnknown)
          verdicts_.keep_node(x.layer, x.slot);
        continue;
      }
      valid = valid && !given;
      if (answers[k].shared)
        lattice_->slots_with_same_body_poses(x.layer, x.slot, answers[k].groups, same);
      else
        same.assign(1, x.slot);
      verdicts_.remove_nodes(x.layer, same);
      ++layers_[static_cast<std::size_t>(x.layer)].revision;
      const auto add = [&](int layer, int slot) {
        if (layer < 0 || layer >= lattice_->layers() || slot < 0 || left <= 0) return;
        const Layer& of = layers_[static_cast<std::size_t>(layer)];
        const int node = of.index_of_slot[static_cast<std::size_t>(slot)];
        if (node < 0 || verdicts_.node(layer, slot) != Verdict::kUnknown ||
            !listed.insert({layer, slot}).second)
          return;
        --left;
        beside.push_back(
            {layer, slot, of.nodes[static_cast<std::size_t>(node)].q, answers[k].failure});
      };
      for (const int by : {-1, 1}) {
        add(x.layer, lattice_->neighbour_in_redundancy(x.layer, x.slot, by));
        if (x.layer + by >= 0 && x.layer + by < lattice_->layers())
          add(x.layer + by, lattice_->neighbour_along_path(x.layer, x.slot, by));
      }
    }
    std::erase_if(beside, [&](const NodeQuestion& x) {
      return verdicts_.node(x.layer, x.slot) != Verdict::kUnknown;
    });
    questions = std::move(beside);
  }
  return valid;
}

bool CutProgram::ask_runs(const Way& way) {
  std::vector<NodeQuestion> nodes;
  std::vector<EdgeQuestion> edges;
  std::set<std::pair<int, int>> listed;  // runs may overlap
  for (const Way::Run& run : way.runs)
    for (int layer = run.first_layer; layer <= run.last_layer(); ++layer) {
      const auto at = [&](int i) -> const Lattice::Node& {
        const auto node = run.nodes[static_cast<std::size_t>(i - run.first_layer)];
        return layers_[static_cast<std::size_t>(i)].nodes[static_cast<std::size_t>(node)];
      };
      const Lattice::Node& a = at(layer);
      if (verdicts_.node(layer, a.slot) == Verdict::kUnknown &&
          listed.insert({layer, a.slot}).second)
        nodes.push_back({layer, a.slot, a.q});
      if (layer == run.last_layer()) continue;
      const Lattice::Node& b = at(layer + 1);
      if (verdicts_.edge(layer, a.slot, b.slot) == Verdict::kUnknown)
        edges.push_back({layer, a.slot, b.slot, a.q, b.q});
    }
  if (!ask_nodes(std::move(nodes))) return false;
  if (!validity_->asks_edges()) return true;
  std::vector<std::uint8_t> answers(edges.size(), 1);
  validity_->edges(edges, answers);
  bool valid = true;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const EdgeQuestion& edge = edges[k];
    if (answers[k] != 0) {
      verdicts_.keep_edge(edge.layer, edge.a, edge.b);
      continue;
    }
    valid = false;
    Layer& own = layers_[static_cast<std::size_t>(edge.layer)];
    const Layer& next = layers_[static_cast<std::size_t>(edge.layer) + 1];
    const auto a = static_cast<std::size_t>(own.index_of_slot[static_cast<std::size_t>(edge.a)]);
    for (std::size_t e = own.first[a]; e < own.first[a + 1]; ++e)
      if (next.nodes[static_cast<std::size_t>(own.to[e])].slot == edge.b)
        own.cost[e] = kUnreachable;
    ++own.revision;
  }
  return valid;
}

bool CutProgram::ask_gates(const Way& way) {
  const auto cuts = static_cast<int>(way.runs.size()) - 1;
  bool valid = levels_[static_cast<std::size_t>(cuts)]->start->ask(0);
  for (int k = 0; k <= cuts; ++k) {
    const Way::Run& run = way.runs[static_cast<std::size_t>(k)];
    if (gate(cuts - k, run.last_layer())->ask(run.nodes.back())) continue;
    valid = false;
    ++levels_[static_cast<std::size_t>(cuts - k)]
          ->gate_revision[static_cast<std::size_t>(run.last_layer())];
  }
  return valid;
}

// --- reach

int CutProgram::reach(int layer) {
  const auto first = static_cast<std::size_t>(layer);
  for (;;) {
    budget_.poll();
    // nodes to which a run leads, and the node before on one way there
    std::vector<std::vector<int>> before;
    for (const Layer& each : layers_) before.emplace_back(each.nodes.size(), -2);
    std::size_t last = 0;
    bool any = false;
    const auto left = [&](std::size_t i, std::size_t a) {
      return verdicts_.node(static_cast<int>(i), layers_[i].nodes[a].slot) != Verdict::kRemoved;
    };
    for (std::size_t a = 0; a < layers_[first].nodes.size(); ++a)
      if (left(first, a)) before[first][a] = -1, any = true, last = first;
    if (!any) return -1;
    for (std::size_t i = first; i + 1 < layers_.size() && last == i; ++i)
      for (std::size_t a = 0; a < layers_[i].nodes.size(); ++a)
        if (before[i][a] != -2)
          for (std::size_t k = layers_[i].first[a]; k < layers_[i].first[a + 1]; ++k) {
            const auto to = static_cast<std::size_t>(layers_[i].to[k]);
            if (layers_[i].cost[k] == kUnreachable || before[i + 1][to] != -2 || !left(i + 1, to))
              continue;
            before[i + 1][to] = static_cast<int>(a);
            last = i + 1;
          }
    Way way;
    Way::Run& run = way.runs.emplace_back();
    run.first_layer = layer;
    const auto reached =
        std::find_if(before[last].begin(), before[last].end(), [](int node) { return node != -2; });
    int node = static_cast<int>(reached - before[last].begin());
    for (std::size_t i = last + 1; i-- > first;) {
      run.nodes.push_back(node);
      node = before[i][static_cast<std::size_t>(node)];
    }
    std::reverse(run.nodes.begin(), run.nodes.end());
    if (ask_runs(way)) return static_cast<int>(last);
  }
}

}  // namespace swivel
