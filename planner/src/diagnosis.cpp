// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "asked_hooks.hpp"
#include "collision_validity.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

using Reasons = std::map<std::string, std::int64_t>;

std::string most_frequent(const Reasons& reasons) {
  const auto most =
      std::max_element(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == reasons.end() ? "" : most->first;
}

struct Cause {
  std::string reason;
  std::optional<Shortfall> shortfall;
};

constexpr int kFree = -1, kManipulability = -2, kUnknown = -3;  // instead of the index of a pair

/// What blocks the nodes of one layer: manipulability, or a pair of bodies. A failure tells of every node whose failing bodies
/// stand alike (Lattice::alike), so that most nodes need no question, or a short one.
class LayerBlockers {
 public:
  LayerBlockers(const SrsLattice& lattice, const World& world, World::Query& query)
      : lattice_(lattice), world_(world), query_(query), known_(static_cast<std::size_t>(lattice.width())), asked_(known_.size()) {}

  void start() {
    std::fill(known_.begin(), known_.end(), kUnknown);
    std::fill(asked_.begin(), asked_.end(), 0);
    all_ = false;
  }
  /// The first of World::pairs() that is too near, or kManipulability, or kFree.
  int first(int layer, int slot, const Config& q) {
    const auto k = static_cast<std::size_t>(slot);
    if (known_[k] == kUnknown) return ask(layer, slot, q);
    for (int pair = 0; !asked_[k] && pair < known_[k]; ++pair)
      if (query_.pair_below(q, world_.pairs()[static_cast<std::size_t>(pair)], Keep::kNode)) known_[k] = pair;
    asked_[k] = 1;
    if (!lattice_.manipulable(q)) return kManipulability;
    return known_[k];
  }
  /// One of those that are too near.
  int any(int layer, int slot, const Config& q) {
    const int known = known_[static_cast<std::size_t>(slot)];
    return known == kUnknown ? ask(layer, slot, q) : known;
  }
  /// Every node of the layer is blocked by the pair that was named last.
  [[nodiscard]] bool all() const { return all_; }

 private:
  int ask(int layer, int slot, const Config& q) {
    const auto k = static_cast<std::size_t>(slot);
    asked_[k] = 1;
    if (!lattice_.manipulable(q)) return known_[k] = kManipulability;
    const auto pair = query_.first_below(q, Keep::kNode);
    if (!pair) return known_[k] = kFree;
    const auto& pairs = world_.pairs();
    known_[k] = static_cast<int>(std::find(pairs.begin(), pairs.end(), *pair) - pairs.begin());
    const Sharing sharing = sharing_of(lattice_, world_, query_, q, *pair);
    if (!sharing.shared) {
      all_ = false;
      return known_[k];
    }
    lattice_.alike(layer, slot, sharing.groups, alike_);
    all_ = static_cast<int>(alike_.size()) == lattice_.slots(layer);
    for (const int other : alike_) {
      int& known = known_[static_cast<std::size_t>(other)];
      if (!asked_[static_cast<std::size_t>(other)]) known = known < 0 ? known_[k] : std::min(known, known_[k]);
    }
    return known_[k];
  }

  const SrsLattice& lattice_;
  const World& world_;
  World::Query& query_;
  std::vector<int> known_;   // [slot] kUnknown, or what is known to block it
  std::vector<char> asked_;  // [slot] known_ is the first that does
  bool all_ = false;
  std::vector<int> alike_;
};

class Inspector {
 public:
  Inspector(const SrsLattice& lattice, const World& world, const EdgeRule& rule, const Budget& budget,
            const std::shared_ptr<StateCheck>& check)
      : lattice_(lattice),
        world_(world),
        rule_(rule),
        budget_(budget),
        check_(check, budget),
        query_(world, Certificates::kOn),
        blockers_(lattice, world, query_),
        blockers_before_(lattice, world, query_) {
    question_us_ = world.has_meshes() ? 300 : 3;
    ik_us_ = lattice.arm().exact ? 0.3 : 5;
  }

  /// An estimate of the time spent, that is the same on every machine.
  [[nodiscard]] bool affordable() const {
    constexpr double kMost = 1e6;  // us
    const CollisionCounters c = query_.counters();
    return question_us_ * static_cast<double>(c.certified_free + c.certified_colliding + c.fcl_calls) +
               ik_us_ * static_cast<double>(ik_) <
           kMost;
  }

  /// What blocks the nodes of the layer that exist, by count. `left`: those that are valid.
  Reasons blocked(int layer, std::vector<int>& left) {
    lattice_.solve(layer, nodes_);
    ik_ += lattice_.width();
    blockers_.start();
    std::map<int, std::int64_t> counts;
    for (int slot = 0; slot < lattice_.width(); ++slot) {
      if (!nodes_.valid(lattice_.label_of(slot), lattice_.angle_of(slot))) continue;
      budget_.poll();
      const auto q = lattice_.row(layer, slot, config(nodes_, slot));
      if (!q) continue;
      const int blocker = blockers_.first(layer, slot, *q);
      ++counts[blocker];
      if (blocker == kFree) left.push_back(slot);
    }
    Reasons reasons;
    for (const auto& [blocker, count] : counts)
      if (blocker != kFree) reasons[name(blocker)] += count;
    if (!check_) return reasons;
    states_.clear();
    for (const int slot : left) states_.push_back(config(nodes_, slot));
    const auto allowed = check_.states(states_);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < allowed.size(); ++k)
      if (allowed[k]) left[kept++] = left[k];
    left.resize(kept);
    if (kept < allowed.size()) reasons[check_.cause()] = static_cast<std::int64_t>(allowed.size() - kept);
    return reasons;
  }

  /// Why no node of the layer is valid; none where one is. Asks around `hint`, a slot valid in a layer before, angle by angle.
  std::optional<Cause> why_empty(int layer, int& hint) {
    budget_.poll();
    if (!lattice_.alive(layer)) return kinematic_cause(layer);
    blockers_.start();
    std::map<int, std::int64_t> counts;
    std::int64_t refused = 0;
    const int n = lattice_.angles(), hint_label = lattice_.label_of(hint), hint_angle = lattice_.angle_of(hint);
    for (int k = 0; k < n; ++k) {
      const int j = (hint_angle + (k % 2 ? n - (k + 1) / 2 : k / 2)) % n;  // at the hint, then on either side
      lattice_.solve(layer, j, 1, nodes_);
      ik_ += lattice_.labels();
      states_.clear();
      free_.clear();
      for (int l = 0; l < lattice_.labels(); ++l) {
        const int label = (hint_label + l) % lattice_.labels(), slot = label * n + j;
        if (!nodes_.valid(label, 0)) continue;
        budget_.poll();
        const auto q = lattice_.row(layer, slot, nodes_.config(label, 0));
        if (!q) continue;
        const int blocker = blockers_.any(layer, slot, *q);
        if (blocker == kFree) {
          states_.push_back(*q);
          free_.push_back(slot);
          if (!check_) break;
          continue;
        }
        if (blockers_.all()) return Cause{name(blocker), {}};
        ++counts[blocker];
      }
      const auto allowed = check_.states(states_);
      const auto first = std::find(allowed.begin(), allowed.end(), true) - allowed.begin();
      if (first < static_cast<std::ptrdiff_t>(free_.size())) {
        hint = free_[static_cast<std::size_t>(first)];
        return std::nullopt;
      }
      refused += static_cast<std::int64_t>(free_.size());
    }
    if (counts.empty() && refused == 0) return kinematic_cause(layer);
    Reasons reasons;
    if (refused > 0) reasons[check_.cause()] = refused;
    for (const auto& [blocker, count] : counts) reasons[name(blocker)] += count;
    return Cause{most_frequent(reasons), {}};
  }

  /// What every node of the layer fails, or the joint whose release alone would help; and by how little.
  Cause kinematic_cause(int layer) {
    Reasons released, statuses;
    std::map<std::string, Shortfall> least;  // by the reason that it belongs to
    const auto add = [&](const std::string& reason, const Shortfall& shortfall) {
      const auto [at, fresh] = least.try_emplace(reason, shortfall);
      if (!fresh && shortfall.by() < at->second.by()) at->second = shortfall;
    };
    for (int slot = 0; slot < lattice_.width(); ++slot) {
      if (slot % 64 == 0) budget_.poll();
      const SrsLattice::NodeFault fault = lattice_.fault(layer, slot);
      ++statuses[status_name(fault)];
      if (fault.status != NodeStatus::kLimit) continue;
      ++ik_;
      const auto shortfall = limit_shortfall(fault);
      if (shortfall) add("joint limits", *shortfall);
      if (std::popcount(fault.joints) != 1) continue;
      const std::string reason = joint_name(std::countr_zero(fault.joints));
      ++released[reason];
      if (shortfall) add(reason, *shortfall);
    }
    Cause cause{"no IK", {}};
    for (const char* status : {"no IK", "singular", "joint limits"})
      if (statuses.contains(status)) cause.reason = status;
    if (!released.empty()) cause.reason = most_frequent(released);
    if (cause.reason == "no IK")
      cause.shortfall = reach_shortfall(layer);
    else if (const auto found = least.find(cause.reason); found != least.end())
      cause.shortfall = found->second;
    return cause;
  }

  /// The nodes that closed form and limits take out of the layer.
  void add_missing(int layer, Reasons& reasons) {
    for (int slot = 0; slot < lattice_.width(); ++slot) {
      const bool exists = nodes_.valid(lattice_.label_of(slot), lattice_.angle_of(slot));
      if (exists && lattice_.row(layer, slot, config(nodes_, slot))) continue;
      if (slot % 64 == 0) budget_.poll();
      const SrsLattice::NodeFault fault = lattice_.fault(layer, slot);
      if (fault.status != NodeStatus::kLimit) ++reasons[status_name(fault)];
      for (int k = 0; k < kDof; ++k)
        if ((fault.joints >> k) & 1) ++reasons[joint_name(k)];
    }
  }

  /// What removes edges from valid nodes of `layer` to the nodes `left` of the next, whose joints blocked() has solved.
  Reasons removed_edges(int layer, const std::vector<int>& left) {
    Reasons reasons;
    if (left.empty()) return reasons;
    std::vector<std::optional<Config>> left_rows(static_cast<std::size_t>(lattice_.width()));
    for (const int b : left) left_rows[static_cast<std::size_t>(b)] = lattice_.row(layer + 1, b, config(nodes_, b));
    LayerNodes before;
    lattice_.solve(layer, before);
    blockers_before_.start();
    constexpr int kMostEdges = 300;  // collision checks of edges are the slow part of a report
    int edges = 0;
    for (int a = 0; a < lattice_.width() && edges < kMostEdges && affordable(); ++a) {
      if (!before.valid(lattice_.label_of(a), lattice_.angle_of(a))) continue;
      budget_.poll();
      const Config node = config(before, a);
      const auto row = lattice_.row(layer, a, node);
      if (!row || blockers_before_.any(layer, a, *row) != kFree || !check_.states({&*row, 1})[0]) continue;
      const SrsLattice::Run run = lattice_.run_after(layer, a);
      for (int label = 0; label < lattice_.labels(); ++label)
        for (int k = 0; k < run.count; ++k) {
          const int b = label * lattice_.angles() + (run.first + k) % lattice_.angles();
          const auto& row_b = left_rows[static_cast<std::size_t>(b)];
          if (!row_b) continue;
          const bool may_step = lattice_.step_allowed(layer, lattice_.delta(node, config(nodes_, b)));
          const std::string reason = may_step ? edge_reason(layer, a, *row, b, *row_b) : "joint step";
          if (!reason.empty()) ++reasons[reason];
          edges += reason != "joint step";
        }
    }
    return reasons;
  }

 private:
  [[nodiscard]] Config config(const LayerNodes& nodes, int slot) const {
    return nodes.config(lattice_.label_of(slot), lattice_.angle_of(slot));
  }

  std::string edge_reason(int layer, int a, const Config& qa, int b, const Config& qb) {
    const Config delta = lattice_.delta(qa, qb);
    if (!lattice_.row_step_allowed(layer, delta)) return "joint step";
    if (!lattice_.follows_path(layer, a, qa, b, qb)) return "tool-path error";
    if (lattice_.limits().edges == EdgeMode::kContinuous) {
      const auto pair = edge_blocked(query_, rule_, qa, qa + delta, budget_);
      if (pair) return name(*pair) + " between layers";
    }
    const StateCheck::Motion motion{qa, qa + delta};
    if (check_.checks_motions() && !check_.motions({&motion, 1})[0]) return check_.cause() + " between layers";
    return "";
  }

  [[nodiscard]] std::optional<Shortfall> reach_shortfall(int layer) const {
    const SrsArm& arm = lattice_.arm();
    const double reach = lattice_.plane(layer).reach, most = arm.upper + arm.fore, least = std::abs(arm.upper - arm.fore);
    if (reach > most) return Shortfall{Shortfall::Kind::kTooFar, reach, most, {}};
    if (reach < least) return Shortfall{Shortfall::Kind::kTooNear, reach, least, {}};
    return std::nullopt;
  }

  /// The joint that is furthest outside, each taken at the winding where it is nearest to its limits.
  [[nodiscard]] std::optional<Shortfall> limit_shortfall(const SrsLattice::NodeFault& fault) const {
    std::optional<Shortfall> worst;
    for (int k = 0; k < kDof; ++k) {
      if (((fault.joints >> k) & 1) == 0) continue;
      const JointLimit& limit = lattice_.chain().limit[static_cast<std::size_t>(k)];
      const double margin = lattice_.limits().joint_margin, lower = limit.lower + margin, upper = limit.upper - margin;
      const double above = fault.q[k] + kTwoPi * std::ceil((lower - fault.q[k]) / kTwoPi), below = above - kTwoPi;
      if (above <= upper) continue;  // inside, at another winding than this node's
      const bool high = above - upper < lower - below;
      const Shortfall shortfall{high ? Shortfall::Kind::kUpperLimit : Shortfall::Kind::kLowerLimit, high ? above : below,
                                high ? upper : lower, lattice_.chain().joint_names[static_cast<std::size_t>(k)]};
      if (!worst || shortfall.by() > worst->by()) worst = shortfall;
    }
    return worst;
  }

  [[nodiscard]] std::string name(const BodyPair& pair) const {
    return world_.body_names()[static_cast<std::size_t>(pair.a)] + " - " + world_.body_names()[static_cast<std::size_t>(pair.b)];
  }
  [[nodiscard]] std::string name(int blocker) const {
    return blocker == kManipulability ? "manipulability" : name(world_.pairs()[static_cast<std::size_t>(blocker)]);
  }
  [[nodiscard]] std::string joint_name(int k) const { return "joint " + lattice_.chain().joint_names[static_cast<std::size_t>(k)]; }
  static const char* status_name(const SrsLattice::NodeFault& fault) {
    switch (fault.status) {
      case NodeStatus::kNoIk:
        return "no IK";
      case NodeStatus::kSingular:
        return "singular";
      default:
        return "joint limits";
    }
  }

  const SrsLattice& lattice_;
  const World& world_;
  EdgeRule rule_;
  const Budget& budget_;
  AskedCheck check_;
  World::Query query_;
  LayerBlockers blockers_, blockers_before_;
  LayerNodes nodes_;
  std::vector<Config> states_;  // that only the user's check may refuse
  std::vector<int> free_;       // their slots
  double question_us_ = 0, ik_us_ = 0;
  std::int64_t ik_ = 0;
};

EmptyLayer empty_layer(const SrsLattice& lattice, int layer, const Cause& cause) {
  const PathLayer& at = lattice.path().layer(layer);
  return {layer, at.waypoint, at.s, cause.reason, cause.shortfall};
}

}  // namespace

void diagnose(const SrsLattice& lattice, const World& world, const EdgeRule& rule, int deepest_layer, bool layers,
              const Budget& budget, Diagnosis& diagnosis, const std::shared_ptr<StateCheck>& check) {
  const Span span("diagnosis");
  diagnosis.complete = false;
  if (deepest_layer >= 0) {
    diagnosis.reached_layer = deepest_layer;
    diagnosis.reached_s = lattice.path().layer(deepest_layer).s;
  }
  diagnosis.layers_known = deepest_layer + 1;  // those before have a node: a path leads through them
  Inspector inspector(lattice, world, rule, budget, check);

  const int next = deepest_layer + 1;
  std::vector<int> left;
  Reasons removed = inspector.blocked(next, left);
  if (left.empty()) {
    const Cause cause = removed.empty() ? inspector.kinematic_cause(next) : Cause{most_frequent(removed), {}};
    diagnosis.reason = cause.reason;
    diagnosis.shortfall = cause.shortfall;
    if (layers) diagnosis.empty_layers.push_back(empty_layer(lattice, next, cause));
  } else {
    const Reasons edges = inspector.removed_edges(deepest_layer, left);
    diagnosis.reason = edges.empty() ? "arm slope" : most_frequent(edges);
    for (const auto& [reason, count] : edges) removed[reason] += count;
  }
  diagnosis.layers_known = next + 1;
  if (layers) {
    if (deepest_layer >= 0) {
      inspector.add_missing(next, removed);
      diagnosis.removed = removed;
    }
    int hint = left.empty() ? 0 : left.front();
    for (int layer = next + 1; layer < lattice.layers(); ++layer) {
      if (!inspector.affordable()) return;
      if (const auto cause = inspector.why_empty(layer, hint))
        diagnosis.empty_layers.push_back(empty_layer(lattice, layer, *cause));
      diagnosis.layers_known = layer + 1;
    }
  }
  diagnosis.complete = true;
}

}  // namespace swivel
