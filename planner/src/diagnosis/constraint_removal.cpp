// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/constraint_removal.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

/// Calls `each` with the number of each bit of a set, lowest first.
template <class Each>
void for_each_bit(ConstraintSet set, const Each& each) {
  for (; set != 0; set &= set - 1) each(std::countr_zero(set));
}

/// Returns the constraints that bar nodes, with the bit that stands for all constraints.
constexpr ConstraintSet that_bar_nodes() {
  ConstraintSet set = Constraints::of(Constraints::kCount);
  for (int c = 0; c < Constraints::kCount; ++c)
    if (Constraints::bars_nodes(c)) set |= Constraints::of(c);
  return set;
}
constexpr ConstraintSet kBarsNodes = that_bar_nodes();

constexpr int kMostMeasured = 16;  // causes per layer: measuring a clearance takes many queries

/// Returns true if cause a violates its limit by less than cause b of the same kind.
bool misses_less(const Cause& a, const Cause& b) {
  const auto x = a.by(), y = b.by();
  return x && (!y || *x < *y);
}

constexpr std::size_t index(int k) {
  return static_cast<std::size_t>(k);
}

}  // namespace

ConstraintRemoval::ConstraintRemoval(const Lattice& lattice, Constraints& constraints,
                                     const SlotPath& path, const Budget& budget)
    : lattice_(lattice),
      constraints_(constraints),
      path_(path),
      budget_(budget),
      deepest_(static_cast<int>(path.size()) - 1) {
  const int steps = lattice.layers() - 1,
            further = std::max(1, static_cast<int>(std::ceil(0.05 * steps)));
  wanted_ = std::min(steps, std::max(0, deepest_) + further);
}

ConstraintSet ConstraintRemoval::exists(ConstraintSet violated) const {
  const ConstraintSet left = constraints_.left(violated, waived_);
  return left == 0 ? kAlways : constraints_.removals(left);
}

void ConstraintRemoval::enter(int layer) {
  Layer& here = layers_[index(layer % 2)];
  here.nodes.assign(index(lattice_.slots(layer)), {});
  here.reached.assign(here.nodes.size(), 0);
}

const Constraints::Node& ConstraintRemoval::at(int layer, int slot) {
  Known& known = met(layer, slot);
  if (!known.complete) {
    budget_.poll();
    constraints_.complete(known.node, waived_, Constraints::Until::kNoRemoval);
    known.complete = true;
  }
  return known.node;
}

ConstraintRemoval::Known& ConstraintRemoval::met(int layer, int slot) {
  Known& known = layers_[index(layer % 2)].nodes[index(slot)];
  if (!known.placed) {
    known.node = constraints_.place(layer, slot);
    known.placed = true;
    known.complete = !known.node.exists;
  }
  return known;
}

void ConstraintRemoval::blame(Pass& pass, ConstraintSet violated) const {
  ConstraintSet blamed = constraints_.left(violated, waived_);
  for_each_bit(blamed, [&](int c) {
    if (const int object = constraints_.object_of(c); object >= 0)
      blamed |= Constraints::of(object);
  });
  for_each_bit(blamed, [&](int c) { ++pass.blamed[index(c)]; });
}

void ConstraintRemoval::see(Pass& pass, int removal, int layer, const Constraints::Node& node) {
  ++pass.votes[index(removal)];
  Witness& witness = pass.witness[index(removal)];
  const auto away = [&](int from) { return std::abs(from - deepest_ - 1); };
  if (witness.found && (away(layer) > away(witness.layer) ||
                        (witness.layer == layer && witness.measured >= kMostMeasured)))
    return;
  Cause cause = constraints_.measured(std::countr_zero(constraints_.left(node.violated, waived_)),
                                      layer, node.q);
  if (constraints_.is_object(removal)) cause.object = constraints_.cause(removal).object;
  if (witness.layer != layer) witness = {};
  if (!witness.found || misses_less(cause, witness.cause)) witness.cause = cause;
  witness.found = true;
  witness.layer = layer;
  witness.measured += cause.kind == Cause::Kind::kPair || cause.kind == Cause::Kind::kContact;
}

ConstraintSet ConstraintRemoval::reach(int layer, int slot, ConstraintSet bits) {
  ConstraintSet& reached = layers_[index(layer % 2)].reached[index(slot)];
  const ConstraintSet fresh = bits & followed_ & ~reached;
  reached |= fresh;
  return fresh;
}

void ConstraintRemoval::reach_first_layer(Pass& pass) {
  for (int slot = 0; slot < lattice_.slots(0) && pass.whole; ++slot) {
    if (!affordable()) pass.whole = false;
    const Constraints::Node& node = at(0, slot);
    if (!node.exists) continue;
    const ConstraintSet bits = exists(node.violated);
    reach(0, slot, bits);
    blame(pass, node.violated);
    if (bits != kAlways) for_each_bit(bits, [&](int c) { see(pass, c, 0, node); });
  }
}

void ConstraintRemoval::see_edge(Pass& pass, int removal, int layer, ConstraintSet violated, int a,
                                 const Config& qa, int b, const Config& qb) {
  ++pass.votes[index(removal)];
  Witness& witness = pass.witness[index(removal)];
  if (witness.found && std::abs(layer - deepest_) > std::abs(witness.layer - 1 - deepest_)) return;
  if (witness.layer != layer + 1) witness.measured = 0;
  if (witness.found && witness.measured >= kMostMeasured) return;
  Cause cause = constraints_.measured(std::countr_zero(constraints_.left(violated, waived_)), layer,
                                      a, qa, b, qb);
  if (constraints_.is_object(removal)) cause.object = constraints_.cause(removal).object;
  if (!witness.found || witness.layer != layer + 1 || misses_less(cause, witness.cause))
    witness = {true, layer + 1, cause, witness.measured};
  witness.measured += cause.kind == Cause::Kind::kPair;
}

void ConstraintRemoval::move(Pass& pass, int layer, int a, int b) {
  const ConstraintSet open = layers_[index(layer % 2)].reached[index(a)] &
                             ~layers_[index((layer + 1) % 2)].reached[index(b)];
  if (open == 0) return;
  const bool blames = (open & kWithAll) != 0 && followed_ == kAlways;
  const Constraints::Node& tail = at(layer, a);
  if (!blames) {
    const Constraints::Node& there = placed(layer + 1, b);
    if (!there.exists) return;
    const ConstraintSet by_steps = constraints_.steps(layer, a, tail.q, b, there.q, waived_, open);
    if (by_steps != 0 && (exists(by_steps) & open) == 0) return;
  }
  const Constraints::Node& head = at(layer + 1, b);
  if (!head.exists) return;
  if (open & kWithAll) blame(pass, head.violated);
  const ConstraintSet own = exists(head.violated), wanted = open & own;
  if (wanted == 0) return;
  const ConstraintSet asked = blames ? kAlways : wanted;
  const ConstraintSet violated =
      constraints_.edge(layer, a, tail, b, head, waived_, Constraints::Until::kNoRemoval, asked);
  if (open & kWithAll) blame(pass, violated);
  const ConstraintSet on_edge = exists(violated), fresh = reach(layer + 1, b, wanted & on_edge);
  if (own != kAlways) for_each_bit(fresh & own, [&](int c) { see(pass, c, layer + 1, head); });
  if (on_edge == kAlways) return;
  for_each_bit(fresh & on_edge,
               [&](int c) { see_edge(pass, c, layer, violated, a, tail.q, b, head.q); });
}

bool ConstraintRemoval::sort_heads(int layer) {
  constexpr double kShare = 0.25;  // of a turn: wider steps leave out too few
  std::vector<Lattice::SlotRun> runs;
  const int slots = lattice_.slots(layer);
  lattice_.successors(layer - 1, 0, runs);
  if (lattice_.has_layers_between() || runs.size() != 1 || runs[0].first != 0 ||
      runs[0].last != slots)
    return false;
  const Config steps = joint_steps(lattice_.chain(), lattice_.limits());
  double widest = 0;
  for (int j = 0; j < kDof; ++j) {
    if (j == lattice_.chain().slide() || steps[j] > kShare * kTwoPi) continue;
    double sum = 0, across = 0;  // the spread of the joint's directions about their mean
    for (int slot = 0; slot < slots; ++slot) {
      const double q = placed(layer, slot).q[j];
      sum += std::cos(q), across += std::sin(q);
    }
    const double spread = (slots - std::hypot(sum, across)) / steps[j];
    if (spread > widest) widest = spread, sorted_joint_ = j;
  }
  if (widest == 0) return false;
  sorted_step_ = steps[sorted_joint_];
  heads_.clear();
  for (int slot = 0; slot < slots; ++slot)
    if (placed(layer, slot).exists)
      heads_.emplace_back(wrap_angle(placed(layer, slot).q[sorted_joint_]), slot);
  std::sort(heads_.begin(), heads_.end());
  return true;
}

const std::vector<int>& ConstraintRemoval::heads_near(const Config& q) {
  constexpr double kRounding = 1e-6;  // rad
  near_.clear();
  const double at = wrap_angle(q[sorted_joint_]), step = sorted_step_ + kRounding;
  for (const double turn : {-kTwoPi, 0.0, kTwoPi})
    for (auto head = std::lower_bound(heads_.begin(), heads_.end(), std::pair(at + turn - step, 0));
         head != heads_.end() && head->first <= at + turn + step; ++head)
      near_.push_back(head->second);
  std::sort(near_.begin(), near_.end());
  return near_;
}

void ConstraintRemoval::move_on(Pass& pass, int layer, bool any_slope) {
  const std::vector<ConstraintSet>& reached = layers_[index(layer % 2)].reached;
  // Moves on the same IK solution come first: where they exist, most other edges need no query.
  const int slots = lattice_.slots(layer);
  for (int a = 0; a < slots; ++a)
    if (reached[index(a)] != 0)
      if (const int b = lattice_.neighbour_along_path(layer, a, 1); b >= 0) move(pass, layer, a, b);
  // Where every node may follow every other one, most are told to be too far by one joint.
  const bool by_joint = followed_ != kAlways && !any_slope && sort_heads(layer + 1);
  std::vector<Lattice::SlotRun> runs;
  for (int a = 0; a < slots && pass.whole; ++a) {
    if (reached[index(a)] == 0) continue;
    budget_.poll();
    if (!affordable()) pass.whole = false;
    if (by_joint) {
      for (const int b : heads_near(placed(layer, a).q)) move(pass, layer, a, b);
      continue;
    }
    if (any_slope)
      runs.assign(1, {0, lattice_.slots(layer + 1)});
    else
      lattice_.successors(layer, a, runs);
    for (const Lattice::SlotRun& run : runs)
      for (int b = run.first; b < run.last; ++b) move(pass, layer, a, b);
  }
}

ConstraintRemoval::Pass ConstraintRemoval::run_pass(int from, ConstraintSet waived,
                                                    ConstraintSet followed, bool any_slope) {
  Pass pass;
  pass.furthest.fill(-1);
  waived_ = waived;
  followed_ = followed;
  enter(from);
  if (from <= 0) reach_first_layer(pass);
  for (int layer = std::max(0, from);; ++layer) {
    if (layer <= deepest_) {
      static_cast<void>(at(layer, path_[index(layer)]));
      reach(layer, path_[index(layer)], kAlways);
    }
    ConstraintSet any = 0;
    for (const ConstraintSet bits : layers_[index(layer % 2)].reached) any |= bits;
    for_each_bit(any, [&](int c) { pass.furthest[index(c)] = layer; });
    if (any == 0 || layer >= wanted_ || !pass.whole) return pass;
    if (any & kWithAll) pass.blamed.fill(0);
    enter(layer + 1);
    move_on(pass, layer, any_slope);
  }
}

ConstraintRemoval::What ConstraintRemoval::what(int constraint) const {
  if (constraints_.is_object(constraint)) return What::kObject;
  return Constraints::bars_nodes(constraint) ? What::kOnNodes : What::kOnMoves;
}

/// Returns the constraint of a kind, among those without which paths reach layer `least`, that is
/// met most often; none if there is none.
std::optional<int> ConstraintRemoval::best(const Pass& pass, What kind, int least) const {
  std::optional<int> best;
  for (int c = 0; c < Constraints::kCount; ++c) {
    if (what(c) != kind || pass.furthest[index(c)] < least || !pass.witness[index(c)].found)
      continue;
    // proved, whereas the others assume that the check passes
    if (c == Constraints::kCheck) return c;
    if (!best || pass.votes[index(c)] > pass.votes[index(*best)]) best = c;
  }
  return best;
}

/// Returns the constraint to give up if no single one suffices: the one without which paths come
/// furthest, or else the one met most often where paths end; none if there is none.
std::optional<int> ConstraintRemoval::to_give_up(const std::vector<Pass>& passes,
                                                 ConstraintSet waived) const {
  std::optional<int> best;
  for (const Pass& pass : passes) {
    int furthest = pass.furthest[Constraints::kCount];
    for (const What kind : {What::kOnNodes, What::kObject, What::kOnMoves})
      for (int c = 0; c < Constraints::kCount; ++c)
        if (what(c) == kind && pass.witness[index(c)].found && pass.furthest[index(c)] > furthest)
          best = c, furthest = pass.furthest[index(c)];
  }
  if (best) return best;
  for (const bool on_nodes : {true, false})
    for (int c = 0; c < Constraints::kCount && (on_nodes || !best); ++c) {
      if ((what(c) != What::kOnMoves) != on_nodes || passes.back().blamed[index(c)] == 0 ||
          (waived & Constraints::of(c)))
        continue;
      if (!best || passes.back().blamed[index(c)] > passes.back().blamed[index(*best)]) best = c;
    }
  return best;
}

std::optional<ConstraintRemoval::Answer> ConstraintRemoval::find(double most_us) {
  most_us_ = constraints_.spent_us() + most_us;
  constexpr int kNear = 8, kFar = 64;
  std::vector<int> begins;  // first layers of the passes, the nearest first
  for (const int back : {kNear, kFar})
    if (deepest_ > back) begins.push_back(deepest_ - back);
  begins.push_back(0);
  // Between knots every move has many rows, so a pass about nodes first keeps to steps that have
  // none, where these lead far enough.
  std::vector<int> of_nodes = begins;
  int near = wanted_;
  while (near > std::max(0, deepest_ - kNear) && !lattice_.can_halve(near - 1)) --near;
  if (near < deepest_ && near > begins.front()) of_nodes.insert(of_nodes.begin(), near);

  std::vector<Cause> given_up;
  ConstraintSet waived = 0;
  constexpr int kMostTogether = 5;
  while (static_cast<int>(given_up.size()) < kMostTogether) {
    std::vector<Pass> passes;
    std::optional<Answer> answer;
    const auto take = [&](const Pass& pass, What kind) {
      const auto c = best(pass, kind, wanted_);
      if (c) answer = {pass.witness[index(*c)].cause, pass.furthest[index(*c)], {}};
      return c.has_value();
    };
    for (const int from : of_nodes) {
      const Pass pass = run_pass(from, waived, kBarsNodes, false);
      if (take(pass, What::kOnNodes) || take(pass, What::kObject)) break;
    }
    for (const int from : begins)
      if (!answer) {
        passes.push_back(run_pass(from, waived, kAlways, false));
        take(passes.back(), What::kOnMoves);
      }
    for (const int from : {begins.front(), 0})
      if (!answer && affordable()) {
        passes.push_back(run_pass(from, waived, kAlways, true));
        take(passes.back(), What::kOnMoves);
      }
    if (answer) {
      if (given_up.empty()) return answer;
      answer->without_it.reset();
      given_up.push_back(answer->cause);
      answer->cause = given_up.front();
      answer->together.assign(given_up.begin() + 1, given_up.end());
      return answer;
    }
    const auto next = to_give_up(passes, waived);
    if (!next || !affordable()) break;
    Cause cause = constraints_.cause(*next);
    for (const Pass& pass : passes)
      if (pass.witness[index(*next)].found) cause = pass.witness[index(*next)].cause;
    waived |= Constraints::of(*next);
    given_up.push_back(std::move(cause));
  }
  if (given_up.empty()) return std::nullopt;
  return Answer{given_up.front(), {}, {}};
}

}  // namespace swivel
