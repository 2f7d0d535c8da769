// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/diagnosis.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "diagnosis/constraint_removal.hpp"
#include "diagnosis/constraints.hpp"
#include "swivel/core/base/timeline.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

namespace {

/// Counts causes by their words, so that equal ones are counted together and listed in a fixed
/// order.
class Counts {
 public:
  void add(const Cause& cause, std::int64_t count = 1) {
    const auto [at, fresh] = counts_.try_emplace(words(cause), Diagnosis::Removed{cause, 0});
    at->second.count += count;
  }
  void add(const Counts& others) {
    for (const auto& [name, removed] : others.counts_) add(removed.cause, removed.count);
  }
  [[nodiscard]] bool empty() const { return counts_.empty(); }
  [[nodiscard]] Cause most_frequent() const {
    const auto most = std::max_element(
        counts_.begin(), counts_.end(),
        [](const auto& a, const auto& b) { return a.second.count < b.second.count; });
    return most == counts_.end() ? Cause{} : most->second.cause;
  }
  [[nodiscard]] std::vector<Diagnosis::Removed> list() const {
    std::vector<Diagnosis::Removed> list;
    for (const auto& [name, removed] : counts_) list.push_back(removed);
    return list;
  }

 private:
  std::map<std::string, Diagnosis::Removed> counts_;
};

constexpr int kFree = -1, kManipulability = -2, kUnknown = -3;  // instead of the index of a pair

/// Finds what blocks the nodes of one layer: manipulability, or a pair of bodies. A failure applies
/// to every node at which the failing bodies have the same poses
/// (Lattice::slots_with_same_body_poses), so that most nodes need no query, or a short one.
class LayerBlockers {
 public:
  LayerBlockers(const Lattice& lattice, const World& world, World::Query& query)
      : lattice_(lattice), world_(world), clearance_error_(lattice, world), query_(query) {}

  void start(int layer) {
    known_.assign(static_cast<std::size_t>(lattice_.slots(layer)), kUnknown);
    asked_.assign(known_.size(), 0);
    all_ = false;
  }
  /// Returns the index in World::pairs() of the first pair that is too near, or kManipulability, or
  /// kFree.
  int first(int layer, int slot, const Config& q) {
    const auto k = static_cast<std::size_t>(slot);
    if (known_[k] == kUnknown) return ask(layer, slot, q);
    for (int pair = 0; !asked_[k] && pair < known_[k]; ++pair)
      if (query_.pair_violates(q, world_.pairs()[static_cast<std::size_t>(pair)],
                               ClearanceRule::kNode))
        known_[k] = pair;
    asked_[k] = 1;
    if (!lattice_.manipulable(q)) return kManipulability;
    return known_[k];
  }
  /// Returns the index of any pair that is too near, or kManipulability, or kFree.
  int any(int layer, int slot, const Config& q) {
    const int known = known_[static_cast<std::size_t>(slot)];
    return known == kUnknown ? ask(layer, slot, q) : known;
  }
  /// Returns true if every node of the layer is blocked by the pair that was named last.
  [[nodiscard]] bool all() const { return all_; }

 private:
  int ask(int layer, int slot, const Config& q) {
    const auto k = static_cast<std::size_t>(slot);
    asked_[k] = 1;
    if (!lattice_.manipulable(q)) return known_[k] = kManipulability;
    const auto pair = query_.find_violating_pair(q, ClearanceRule::kNode);
    if (!pair) return known_[k] = kFree;
    const auto& pairs = world_.pairs();
    known_[k] = static_cast<int>(std::find(pairs.begin(), pairs.end(), *pair) - pairs.begin());
    const Config node = lattice_.is_approximate() ? *lattice_.node(layer, slot) : q;
    if (!is_shared(lattice_, world_, clearance_error_, query_, layer, node, q, *pair)) {
      all_ = false;
      return known_[k];
    }
    lattice_.slots_with_same_body_poses(layer, slot, groups_of(world_, *pair), same_poses_);
    all_ = static_cast<int>(same_poses_.size()) == lattice_.slots(layer);
    for (const int other : same_poses_) {
      int& known = known_[static_cast<std::size_t>(other)];
      if (!asked_[static_cast<std::size_t>(other)])
        known = known < 0 ? known_[k] : std::min(known, known_[k]);
    }
    return known_[k];
  }

  const Lattice& lattice_;
  const World& world_;
  ClearanceError clearance_error_;
  World::Query& query_;
  std::vector<int> known_;   // [slot] what is known to block the node, or kUnknown
  std::vector<char> asked_;  // [slot] known_ is the first pair that does
  bool all_ = false;
  std::vector<int> same_poses_;
};

class Inspector {
 public:
  Inspector(const Lattice& lattice, const World& world, const EdgeRule& rule, const Budget& budget,
            const std::shared_ptr<StateCheck>& check)
      : lattice_(lattice),
        world_(world),
        budget_(budget),
        constraints_(lattice, world, rule, budget, check),
        blockers_(lattice, world, constraints_.query()),
        blockers_before_(lattice, world, constraints_.query()) {}

  Constraints& constraints() { return constraints_; }
  /// Restarts the time estimate for the layers, so that the cause's share is not taken from theirs.
  void begin_layers() { spent_before_us_ = constraints_.spent_us(); }
  [[nodiscard]] bool affordable() const {
    constexpr double kMost = 1e6;  // us
    return constraints_.spent_us() - spent_before_us_ < kMost;
  }

  /// Returns what blocks the nodes of the layer that exist, with counts. Appends the valid ones to
  /// `left`.
  Counts blocked(int layer, std::vector<Lattice::Node>& left) {
    rows_of(layer, nodes_);
    constraints_.count_nodes(lattice_.slots(layer));
    blockers_.start(layer);
    std::map<int, std::int64_t> counts;
    for (const Lattice::Node& node : nodes_) {
      budget_.poll();
      const int blocker = blockers_.first(layer, node.slot, node.q);
      ++counts[blocker];
      if (blocker == kFree) left.push_back(node);
    }
    Counts causes;
    for (const auto& [blocker, count] : counts)
      if (blocker != kFree) causes.add(cause_of(blocker), count);
    keep_allowed(left, causes);
    return causes;
  }

  /// Returns why no node of the layer is valid; none if one is. Tests first the continuation of
  /// `hint`, a slot that is valid in the layer before, or -1; sets it to a valid slot of this
  /// layer.
  std::optional<Cause> why_empty(int layer, int& hint) {
    budget_.poll();
    blockers_.start(layer);
    std::vector<Lattice::Node> free;  // except for the user's check
    Counts causes;
    if (const int slot = hint < 0 ? -1 : lattice_.neighbour_along_path(layer - 1, hint, 1);
        slot >= 0) {
      constraints_.count_nodes(1);
      if (const auto q = lattice_.exact_config(layer, slot);
          q && blockers_.any(layer, slot, *q) == kFree) {
        free.push_back({slot, *q});
        keep_allowed(free, causes);
        hint = slot;
        if (!free.empty()) return std::nullopt;
      }
    }
    causes = {};
    lattice_.layer_nodes(layer, nodes_);
    constraints_.count_nodes(static_cast<std::int64_t>(nodes_.size()));
    // States per call of the user's check. Without a check one free node is enough.
    constexpr std::size_t kBatch = 64;
    std::map<int, std::int64_t> counts;
    for (const Lattice::Node& node : nodes_) {
      budget_.poll();
      const auto q = lattice_.exact_config(layer, node.slot, node.q);
      if (!q) continue;
      const int blocker = blockers_.any(layer, node.slot, *q);
      if (blocker == kFree) {
        free.push_back({node.slot, *q});
        if (constraints_.check() && free.size() < kBatch) continue;
        keep_allowed(free, causes);
        if (free.empty()) continue;
        hint = free.front().slot;
        return std::nullopt;
      }
      if (blockers_.all()) return cause_of(blocker);
      ++counts[blocker];
    }
    keep_allowed(free, causes);
    if (!free.empty()) {
      hint = free.front().slot;
      return std::nullopt;
    }
    for (const auto& [blocker, count] : counts) causes.add(cause_of(blocker), count);
    return causes.empty() ? kinematic_cause(layer) : causes.most_frequent();
  }

  /// Returns the kinematic cause that every node of the layer fails by, or the joint limit whose
  /// release alone would help most nodes, with the least violation.
  Cause kinematic_cause(int layer) {
    if (const auto reach = lattice_.out_of_reach(layer)) {
      Cause cause = of_kind(Cause::Kind::kReach);
      cause.side = reach->distance > reach->limit ? Cause::Side::kUpper : Cause::Side::kLower;
      cause.value = reach->distance;
      cause.limit = reach->limit;
      return cause;
    }
    bool singular = false;
    std::map<int, std::pair<std::int64_t, Cause>> released;  // by limit, if it alone removes a node
    std::optional<Cause> several;
    const auto consider = [&](const Lattice::NodeFault& fault) {
      singular = singular || fault.status == NodeStatus::kSingular;
      if (fault.status != NodeStatus::kLimit) return;
      constraints_.count_nodes(1);
      Cause worst;  // of this node
      int limit = 0;
      for (int k = 0; k < kDof; ++k) {
        if ((fault.joints >> k & 1) == 0) continue;
        const int here = constraints_.limit_beyond(k, fault.q);
        const Cause cause = constraints_.measured(here, layer, fault.q);
        if (worst.by().value_or(-1) < *cause.by()) worst = cause, limit = here;
      }
      if (std::popcount(fault.joints) == 1) {
        auto& [count, least] = released.try_emplace(limit, 0, worst).first->second;
        ++count;
        if (*worst.by() < *least.by()) least = worst;
      } else if (!several || *worst.by() < *several->by()) {
        several = worst;
        several->other_joints = true;
      }
    };
    for (int slot = 0; slot < lattice_.slots(layer); ++slot) {
      if (slot % 64 == 0) budget_.poll();
      consider(lattice_.fault(layer, slot));
    }
    for (const Lattice::NodeFault& fault : lattice_.beyond_limits(layer)) consider(fault);
    const auto most = std::max_element(
        released.begin(), released.end(),
        [](const auto& a, const auto& b) { return a.second.first < b.second.first; });
    if (most != released.end()) return most->second.second;
    if (several) return *several;
    return of_kind(singular ? Cause::Kind::kSingular : Cause::Kind::kReach);
  }

  /// Follows the path from joints `q` of a layer as if joints had no limits, by the shortest moves
  /// and with the roll at rest. Returns the joint limit that the move to the next layer exceeds the
  /// most, with the furthest that its joint gets beyond it before it comes back or the path ends;
  /// none if the move exceeds no limit, is larger than a step may be, or does not converge.
  std::optional<Cause> limit_ahead(int layer, Config q) {
    const Chain& chain = lattice_.chain();
    const ToolPath& path = lattice_.path_of_rows();
    const Config steps = joint_steps(chain, lattice_.limits());
    const int first = lattice_.layer_of_rows(layer), next = lattice_.layer_of_rows(layer + 1);
    const double roll = chain.free_roll ? roll_between(path.layer(first).tool, chain.tool(q)) : 0.0;
    std::optional<Cause> worst;
    int constraint = -1;
    for (int i = first + 1; i < path.size() && (worst || i <= next); ++i) {
      budget_.poll();
      constraints_.count_nodes(10);
      Config to = q;
      if (!put_tool_at(rolled(path.layer(i).tool, roll), path.layer(i).window, to) ||
          !((to - q).cwiseAbs().array() <= steps.array()).all())
        break;
      if (i == next && !lattice_.has_layers_between() &&
          !lattice_.row_step_allowed(layer, lattice_.delta(q, to)))
        break;
      q = to;
      if (worst) {
        const Cause here = constraints_.measured(constraint, i, q);
        if (!is_beyond(here)) break;
        if (*here.by() > *worst->by()) worst->value = here.value;
        continue;
      }
      for (int k = 0; k < kDof; ++k) {
        if (lattice_.continuous()[static_cast<std::size_t>(k)]) continue;
        const int limit = constraints_.limit_beyond(k, q);
        const Cause cause = constraints_.measured(limit, i, q);
        if (is_beyond(cause) && (!worst || *cause.by() > *worst->by()))
          worst = cause, constraint = limit;
      }
      if (worst) worst->unwinds = has_a_turn(constraint / 2);
    }
    return worst;
  }

  /// Counts the causes of the layer's slots without a node: reach, singularity and joint limits;
  /// none in a layer of a given end. blocked() must have listed the layer's nodes.
  void add_missing(int layer, Counts& causes) {
    if (lattice_.is_given(layer)) return;
    auto node = nodes_.begin();
    for (int slot = 0; slot < lattice_.slots(layer); ++slot) {
      if (node != nodes_.end() && node->slot == slot) {
        ++node;
        continue;
      }
      if (slot % 64 == 0) budget_.poll();
      const Lattice::NodeFault fault = lattice_.fault(layer, slot);
      if (fault.status == NodeStatus::kNoIk) causes.add(of_kind(Cause::Kind::kReach));
      if (fault.status == NodeStatus::kSingular) causes.add(of_kind(Cause::Kind::kSingular));
      for (int k = 0; k < kDof; ++k)
        if ((fault.joints >> k) & 1)
          causes.add(constraints_.cause(constraints_.limit_beyond(k, fault.q)));
    }
  }

  /// Returns what removes edges from valid nodes of `layer` to the nodes `left` of the next layer,
  /// with counts.
  Counts removed_edges(int layer, const std::vector<Lattice::Node>& left) {
    Counts causes;
    if (left.empty()) return causes;
    std::vector<const Lattice::Node*> heads(static_cast<std::size_t>(lattice_.slots(layer + 1)),
                                            nullptr);
    for (const Lattice::Node& b : left) heads[static_cast<std::size_t>(b.slot)] = &b;
    std::vector<Lattice::Node> before;
    rows_of(layer, before);
    blockers_before_.start(layer);
    // Collision checks of edges are the slow part of a report.
    constexpr int kMostEdges = 300;
    int edges = 0;
    std::vector<Lattice::SlotRun> runs;
    for (const Lattice::Node& a : before) {
      if (edges >= kMostEdges || !affordable()) break;
      budget_.poll();
      if (blockers_before_.any(layer, a.slot, a.q) != kFree ||
          !constraints_.check().states({&a.q, 1})[0])
        continue;
      lattice_.successors(layer, a.slot, runs);
      for (const Lattice::SlotRun& run : runs)
        for (int slot = run.first; slot < run.last; ++slot) {
          const Lattice::Node* const b = heads[static_cast<std::size_t>(slot)];
          if (b == nullptr) continue;
          const ConstraintSet violated = constraints_.edge(
              layer, a.slot, {a.q, true, 0}, slot, {b->q, true, 0}, 0, Constraints::Until::kFirst);
          const int first = std::countr_zero(violated);
          edges += !Constraints::told_by_steps(first);
          if (violated == 0) continue;
          Cause cause = constraints_.cause(first);
          cause.between_layers = first >= Constraints::kCheck;
          causes.add(cause);
        }
    }
    return causes;
  }

 private:
  /// Returns true if the range of joint k holds every angle of a turn, so that a joint at one of
  /// its ends may go on from the other.
  [[nodiscard]] bool has_a_turn(int k) const {
    constexpr double kSliver = 1e-3;  // rad
    const JointLimit& limit = lattice_.chain().limit[static_cast<std::size_t>(k)];
    return !limit.slides &&
           limit.upper - limit.lower - 2 * lattice_.limits().joint_margin >= kTwoPi - kSliver;
  }
  /// Returns true if the joint of a limit is beyond it.
  static bool is_beyond(const Cause& limit) {
    return (limit.side == Cause::Side::kUpper ? *limit.value - *limit.limit
                                              : *limit.limit - *limit.value) > kLimitTolerance;
  }
  /// Moves joints q by Newton steps of minimum norm until the tool is at a pose. The roll of an arm
  /// of six joints rests, but for what its window demands. Returns false if that does not converge.
  [[nodiscard]] bool put_tool_at(const Pose& pose, const Roll& window, Config& q) const {
    const Chain& chain = lattice_.chain();
    if (chain.roll) q[kDof - 1] = std::clamp(q[kDof - 1], window.lower, window.upper);
    constexpr int kMostSteps = 20;
    constexpr double kThere = 1e-9;  // m and rad
    for (int step = 0; step <= kMostSteps; ++step) {
      const Pose reached = chain.tool(q);
      const Eigen::AngleAxisd turn(pose.linear() * reached.linear().transpose());
      Eigen::Matrix<double, 6, 1> error;
      error << pose.translation() - reached.translation(), turn.angle() * turn.axis();
      if (error.norm() <= kThere) return true;
      Eigen::Matrix<double, 6, kDof> jacobian = chain.jacobian(q);
      if (chain.roll) jacobian.col(kDof - 1).setZero();
      q += Config(jacobian.transpose() * (jacobian * jacobian.transpose()).ldlt().solve(error));
      if (!q.allFinite()) return false;
    }
    return false;
  }

  /// Lists the nodes of a layer that have an exact configuration, with its joints.
  void rows_of(int layer, std::vector<Lattice::Node>& out) {
    lattice_.layer_nodes(layer, out);
    if (!lattice_.is_approximate()) return;
    std::erase_if(out, [&](Lattice::Node& node) {
      budget_.poll();
      const auto row = lattice_.exact_config(layer, node.slot, node.q);
      if (row) node.q = *row;
      return !row;
    });
  }

  /// Removes the nodes that the user's check refuses, and counts them; nothing else may block the
  /// nodes.
  void keep_allowed(std::vector<Lattice::Node>& nodes, Counts& causes) {
    if (!constraints_.check()) return;
    states_.clear();
    for (const Lattice::Node& node : nodes) states_.push_back(node.q);
    constraints_.count_checked(static_cast<std::int64_t>(states_.size()));
    auto allowed = constraints_.check().states(states_).begin();
    const auto refused = std::erase_if(nodes, [&](const Lattice::Node&) { return !*allowed++; });
    if (refused > 0)
      causes.add(constraints_.cause(Constraints::kCheck), static_cast<std::int64_t>(refused));
  }

  [[nodiscard]] Cause cause_of(int blocker) {
    Cause cause =
        of_kind(blocker == kManipulability ? Cause::Kind::kManipulability : Cause::Kind::kPair);
    if (blocker != kManipulability)
      cause.bodies = world_.names(world_.pairs()[static_cast<std::size_t>(blocker)]);
    return cause;
  }

  const Lattice& lattice_;
  const World& world_;
  const Budget& budget_;
  Constraints constraints_;
  LayerBlockers blockers_, blockers_before_;
  std::vector<Lattice::Node> nodes_;  // of the layer looked at last
  std::vector<Config> states_;        // scratch
  double spent_before_us_ = 0;
};

/// Adds an empty layer to the last run of layers with the same cause, or begins a new run.
void add_empty(const Lattice& lattice, int layer, const Cause& cause,
               std::vector<EmptyLayers>& runs) {
  const PathLayer& at = lattice.path().layer(layer);
  if (runs.empty() || runs.back().last + 1 != layer || !runs.back().cause.same_thing(cause))
    runs.emplace_back(), runs.back().first = layer, runs.back().first_s = at.s,
                         runs.back().cause = cause;
  EmptyLayers& run = runs.back();
  run.last = layer;
  run.last_s = at.s;
  const auto waypoints =
      lattice.path().waypoints_along(lattice.path().layer(run.first).travel, at.travel);
  run.first_waypoint = waypoints[0], run.last_waypoint = waypoints[1];
  const auto by = cause.by();
  if (!by) return;
  if (*by < run.cause.by().value_or(*by)) run.cause = cause;
  run.most = std::max(run.most.value_or(*by), *by);
}

}  // namespace

namespace {

/// Finds out why no path goes on from the furthest layer, step by step.
class Diagnoser {
 public:
  Diagnoser(const Lattice& lattice, const World& world, const EdgeRule& rule, const SlotPath& path,
            const Budget& budget, Diagnosis& diagnosis, const std::shared_ptr<StateCheck>& check)
      : lattice_(lattice),
        path_(path),
        budget_(budget),
        check_(check),
        deepest_(static_cast<int>(path.size()) - 1),
        next_(deepest_ + 1),
        inspector_(lattice, world, rule, budget, check),
        diagnosis_(diagnosis) {}

  /// Fills the diagnosis. `layers`: also list the layers without a valid node. Throws Stopped.
  void run(bool layers) {
    diagnosis_.complete = false;
    note_place();
    note_unreachable();
    diagnosis_.layers_known = next_;  // the layers before have a node: a path passes through them
    inspect_next_layer();
    find_cause();
    inspector_.begin_layers();
    if (!empty_ && (layers || !answered_)) edges_ = inspector_.removed_edges(deepest_, left_);
    // The check was not called about what other rules refuse.
    if (check_ && diagnosis_.cause.kind != Cause::Kind::kCheck) {
      diagnosis_.without_it.reset();
      diagnosis_.without_it_s.reset();
    }
    if (!empty_ && !answered_)
      diagnosis_.cause = edges_.empty() ? of_kind(Cause::Kind::kArmSlope) : edges_.most_frequent();
    find_joint_out_of_range();
    diagnosis_.layers_known = next_ + 1;
    diagnosis_.complete = !layers || list_layers();
  }

 private:
  /// Notes where paths end, and between which waypoints.
  void note_place() {
    const ToolPath& tool_path = lattice_.path();
    if (deepest_ >= 0) {
      diagnosis_.reached_layer = deepest_;
      diagnosis_.reached_s = tool_path.layer(deepest_).s;
    }
    diagnosis_.at_s = tool_path.layer(next_).s;
    constexpr double kInfinity = std::numeric_limits<double>::infinity(), kBefore = 1e-8;  // m
    const double travel = tool_path.layer(next_).travel;
    diagnosis_.waypoints = {tool_path.waypoints_along(-kInfinity, travel - kBefore)[1],
                            tool_path.waypoints_along(travel, kInfinity)[0]};
  }

  /// Notes a layer that is proved out of reach: the first waypoint, or else the first layer.
  void note_unreachable() {
    for (int layer = 0;
         layer < lattice_.layers() && diagnosis_.holds() != Diagnosis::Holds::kEveryResolution;
         ++layer) {
      if (layer % 64 == 0) budget_.poll();
      const PathLayer& at = lattice_.path().layer(layer);
      if ((!diagnosis_.unreachable || at.waypoint >= 0) && lattice_.proved_unreachable(layer))
        diagnosis_.unreachable = {layer, at.s, at.waypoint};
    }
  }

  /// Lists the valid nodes of the layer that no path reaches, and finds out why there are none.
  void inspect_next_layer() {
    removed_ = inspector_.blocked(next_, left_);
    if (left_.empty())
      empty_ = removed_.empty() ? inspector_.kinematic_cause(next_) : removed_.most_frequent();
  }

  /// Finds the constraint that blocks every path. If none is found, the cause is why the next layer
  /// is empty, or stays open.
  void find_cause() {
    constexpr double kMost = 0.5e6;  // us
    std::optional<ConstraintRemoval::Answer> answer;
    if (!lattice_.out_of_reach(next_))
      answer = ConstraintRemoval(lattice_, inspector_.constraints(), path_, budget_).find(kMost);
    answered_ = answer.has_value();
    if (answer) {
      diagnosis_.cause = answer->cause;
      diagnosis_.without_it = answer->without_it;
      if (answer->without_it)
        diagnosis_.without_it_s = lattice_.path().layer(*answer->without_it).s;
      diagnosis_.together = std::move(answer->together);
    } else if (empty_) {
      diagnosis_.cause = *empty_;
    }
  }

  /// Names the joint that runs out of its range where the path ends, if one does, in place of a
  /// limit on steps: such a limit only keeps the arm from jumping to other turns or to another
  /// solution. That joint also is the cause where no node is listed that continues the path.
  void find_joint_out_of_range() {
    if (diagnosis_.without_it && !bounds_steps(diagnosis_.cause.kind)) return;
    if (deepest_ < 0 || lattice_.is_given(next_)) return;
    if (!bounds_steps(diagnosis_.cause.kind) &&
        lattice_.neighbour_along_path(deepest_, path_.back(), 1) >= 0)
      return;
    const auto limit =
        inspector_.limit_ahead(deepest_, *lattice_.exact_config(deepest_, path_.back()));
    if (!limit) return;
    diagnosis_.cause = *limit;
    diagnosis_.without_it.reset();
    diagnosis_.without_it_s.reset();
    diagnosis_.together.clear();
  }

  /// Returns true for the limits on how far joints and tool go astray in one step.
  static bool bounds_steps(Cause::Kind kind) {
    return kind == Cause::Kind::kJointStep || kind == Cause::Kind::kSpeed ||
           kind == Cause::Kind::kPathError || kind == Cause::Kind::kAngleError ||
           kind == Cause::Kind::kStepError;
  }

  /// Lists what removes nodes and edges behind the furthest layer, and the layers without a valid
  /// node. Returns false if the estimated time is up before all layers were looked at.
  bool list_layers() {
    if (empty_) add_empty(lattice_, next_, *empty_, diagnosis_.empty_layers);
    removed_.add(edges_);
    if (deepest_ >= 0) {
      inspector_.add_missing(next_, removed_);
      diagnosis_.removed = removed_.list();
    }
    int hint = left_.empty() ? -1 : left_.front().slot;
    for (int layer = next_ + 1; layer < lattice_.layers(); ++layer) {
      if (!inspector_.affordable()) return false;
      if (const auto cause = inspector_.why_empty(layer, hint)) {
        add_empty(lattice_, layer, *cause, diagnosis_.empty_layers);
        hint = -1;
      }
      diagnosis_.layers_known = layer + 1;
    }
    return true;
  }

  const Lattice& lattice_;
  const SlotPath& path_;
  const Budget& budget_;
  const std::shared_ptr<StateCheck>& check_;
  const int deepest_, next_;  ///< the furthest layer that a path reaches, and the layer after it
  Inspector inspector_;
  Diagnosis& diagnosis_;
  std::vector<Lattice::Node> left_;  ///< valid nodes of layer next_
  Counts removed_, edges_;           ///< what removes nodes of layer next_, and edges to them
  std::optional<Cause> empty_;       ///< set if layer next_ has no valid node
  bool answered_ = false;            ///< the cause is a constraint that blocks every path
};

}  // namespace

void diagnose(const Lattice& lattice, const World& world, const EdgeRule& rule,
              const SlotPath& path, bool layers, const Budget& budget, Diagnosis& diagnosis,
              const std::shared_ptr<StateCheck>& check) {
  const TraceSpan span("diagnosis");
  Diagnoser(lattice, world, rule, path, budget, diagnosis, check).run(layers);
}

SlotPath best_path_to(const Lattice& lattice, const World& world, const EdgeRule& rule, int layer,
                      const Budget& budget, const Hooks& hooks) {
  const TraceSpan span("furthest path");
  Executor executor(1);
  CollisionValidity validity(lattice, world, rule, lattice.limits().edges, DistanceProofs::kOn,
                             executor, 1, budget);
  HookedValidity hooked(lattice, validity, hooks, budget);
  const auto cost_to_go = make_cost_to_go(lattice, Pruning::kNone, budget);
  cost_to_go->sweep(layer);
  SearchCounters counters;
  return path_first(*cost_to_go, hooked, {}, counters).path;
}

}  // namespace swivel
