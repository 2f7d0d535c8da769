// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/constraints.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "swivel/core/base/angle.hpp"

namespace swivel {

/// The violations found so far, and whether they are enough.
struct Constraints::Violations {
  const Constraints& constraints;
  ConstraintSet waived = 0;
  Until until = Until::kNoRemoval;
  ConstraintSet asked = ~ConstraintSet{0};  // with kNoRemoval: the removals that matter
  ConstraintSet set = 0;
  bool uncounted = false;  // violates a constraint that has no number
  /// Adds a constraint; returns true if no more need be found.
  bool add(int constraint) {
    if (constraint < 0)
      uncounted = true;
    else
      set |= of(constraint);
    return done();
  }
  [[nodiscard]] bool done() const {
    const ConstraintSet left = constraints.left(set, waived);
    return uncounted ||
           (left != 0 && (until == Until::kFirst || (constraints.removals(left) & asked) == 0));
  }
  [[nodiscard]] bool has(int constraint) const {
    return constraint >= 0 && (set & of(constraint)) != 0;
  }
};

Constraints::Constraints(const Lattice& lattice, const World& world, const EdgeRule& rule,
                         const Budget& budget, const std::shared_ptr<StateCheck>& check)
    : lattice_(lattice),
      world_(world),
      rule_(rule),
      joint_steps_(joint_steps(lattice.chain(), lattice.limits())),
      budget_(budget),
      check_(check, budget),
      query_(world, DistanceProofs::kOn),
      question_us_(world.has_meshes() ? 300 : 3),
      node_us_(lattice.is_approximate() ? 5 : 1),
      number_of_(world.bodies().size() * world.body_names().size(), kUnmet) {
  object_of_.fill(-1);
}

double Constraints::spent_us() const {
  const CollisionCounters c = query_.counters();
  return question_us_ * (static_cast<double>(c.proved_free + c.proved_colliding + c.fcl_calls) +
                         0.1 * static_cast<double>(pairs_)) +
         node_us_ * static_cast<double>(nodes_) + 0.1 * static_cast<double>(moves_) +
         10 * static_cast<double>(checked_);
}

int Constraints::met(const BodyPair& pair) {
  const auto names = world_.names(pair);
  const auto found = number_.find(names);
  if (found != number_.end()) return found->second;
  int object = -1;
  if (pair.b >= static_cast<int>(world_.bodies().size())) {
    const auto known = object_number_.find(names[1]);
    if (known == object_number_.end() && count_ + 1 >= kCount) return -1;
    object = known != object_number_.end()
                 ? known->second
                 : object_number_.try_emplace(names[1], count_++).first->second;
    object_name_[static_cast<std::size_t>(object)] = names[1];
  }
  if (count_ >= kCount) return -1;
  names_[static_cast<std::size_t>(count_)] = names;
  object_of_[static_cast<std::size_t>(count_)] = object;
  return number_[names] = count_++;
}

ConstraintSet Constraints::left(ConstraintSet violated, ConstraintSet waived) const {
  ConstraintSet left = violated & ~waived;
  if (waived != 0)
    for (ConstraintSet rest = left; rest != 0; rest &= rest - 1) {
      const int c = std::countr_zero(rest), object = object_of(c);
      if (object >= 0 && (waived & of(object))) left &= ~of(c);
    }
  return left;
}

ConstraintSet Constraints::removals(ConstraintSet violated) const {
  const int object = object_of(std::countr_zero(violated));
  if (std::has_single_bit(violated)) return violated | (object >= 0 ? of(object) : 0);
  for (ConstraintSet rest = violated; rest != 0; rest &= rest - 1)
    if (object < 0 || object_of(std::countr_zero(rest)) != object) return 0;
  return of(object);
}

std::pair<double, double> Constraints::limits_of(int k) const {
  const JointLimit& limit = lattice_.chain().limit[static_cast<std::size_t>(k)];
  const double margin = lattice_.limits().joint_margin;
  return {limit.lower + margin, limit.upper - margin};
}

Cause Constraints::cause(int constraint) const {
  Cause cause;
  const Limits& limits = lattice_.limits();
  if (constraint < kManipulability) {
    const int k = constraint / 2;
    const auto [lower, upper] = limits_of(k);
    const bool high = constraint % 2 == 1;
    cause.kind = Cause::Kind::kLimit;
    cause.side = high ? Cause::Side::kUpper : Cause::Side::kLower;
    cause.joint = lattice_.chain().joint_names[static_cast<std::size_t>(k)];
    cause.slides = k == lattice_.chain().slide();
    cause.limit = high ? upper : lower;
  } else if (is_object(constraint)) {
    cause.kind = Cause::Kind::kPair;
    cause.object = object_name_[static_cast<std::size_t>(constraint)];
    // the first that was met
    const auto pair = std::find(object_of_.begin(), object_of_.end(), constraint);
    if (pair != object_of_.end())
      cause.bodies = names_[static_cast<std::size_t>(pair - object_of_.begin())];
  } else if (constraint >= kFirstPair) {
    cause.kind = Cause::Kind::kPair;
    cause.bodies = names_[static_cast<std::size_t>(constraint)];
  } else if (constraint == kManipulability) {
    cause.kind = Cause::Kind::kManipulability;
    cause.limit = limits.manipulability;
  } else if (constraint == kArmSlope) {
    cause.kind = Cause::Kind::kArmSlope;
  } else if (constraint == kRollSlope) {
    cause.kind = Cause::Kind::kRollSlope;
    cause.joint = lattice_.chain().roll ? lattice_.chain().joint_names.back() : "roll";
  } else if (constraint == kJointStep) {
    cause.kind = Cause::Kind::kJointStep;
    cause.limit = limits.joint_step;
  } else if (constraint == kSpeed) {
    cause.kind = Cause::Kind::kSpeed;
  } else if (constraint == kPathError) {
    cause.kind = Cause::Kind::kPathError;
    cause.limit = limits.tool_path_error;
  } else if (constraint == kAngleError) {
    cause.kind = Cause::Kind::kAngleError;
    cause.limit = limits.tool_angle_error;
  } else if (constraint == kCheck) {
    cause.kind = Cause::Kind::kCheck;
    cause.check = check_.name();
  } else {
    cause.kind = Cause::Kind::kStepError;
    cause.limit = limits.step_error;
  }
  return cause;
}

void Constraints::add_other_pairs(const Config& q, const Threshold& threshold, Violations& found) {
  for (const BodyPair& other : world_.pairs()) {
    const int number = pair(other);
    if (found.has(number) || (number >= 0 && left(of(number), found.waived) == 0)) continue;
    ++pairs_;
    if (query_.pair_violates(q, other, threshold) && found.add(number)) return;
  }
}

Constraints::Node Constraints::place(int layer, int slot) {
  ++nodes_;
  Node node;
  if (const auto q = lattice_.exact_config(layer, slot)) {
    node.q = *q;
  } else {
    ++nodes_;
    const Lattice::NodeFault fault = lattice_.fault(layer, slot);
    if (fault.status != NodeStatus::kLimit) return node;
    node.q = fault.q;
    for (int k = 0; k < kDof; ++k)
      if (fault.joints >> k & 1) node.violated |= of(limit_beyond(k, node.q));
  }
  node.exists = true;
  return node;
}

void Constraints::complete(Node& node, ConstraintSet waived, Until until) {
  Violations found{*this, waived, until};
  found.set = node.violated;
  if (!found.done() && !lattice_.manipulable(node.q)) found.add(kManipulability);
  if (!found.done())
    if (const auto first = query_.find_violating_pair(node.q, ClearanceRule::kNode))
      if (!found.add(pair(*first))) add_other_pairs(node.q, ClearanceRule::kNode, found);
  if (check_ && found.set == 0 && !found.uncounted) {
    ++checked_;
    if (!check_.states({&node.q, 1})[0]) found.add(kCheck);
  }
  node.exists = !found.uncounted;
  node.violated = found.set;
}

ConstraintSet Constraints::steps(int layer, int a, const Config& qa, int b, const Config& qb,
                                 ConstraintSet waived, ConstraintSet asked) const {
  Violations found{*this, waived, Until::kNoRemoval, asked};
  if (!lattice_.has_layers_between()) add_steps_of_layer(layer, a, qa, b, qb, found);
  return found.set;
}

ConstraintSet Constraints::edge(int layer, int a, const Node& from, int b, const Node& to,
                                ConstraintSet waived, Until until, ConstraintSet asked) {
  ++moves_;
  const Config &qa = from.q, &qb = to.q;
  Violations found{*this, waived, until, asked};
  if (!lattice_.in_arm_window(layer, a, b)) found.add(kArmSlope);
  if (const auto roll = lattice_.roll_step(layer, a, qa, b, qb); roll && !roll->allowed)
    found.add(kRollSlope);
  if (lattice_.has_layers_between()) {
    if (!found.done()) edge_of_layers(layer, a, qa, b, qb, found);
    return found.uncounted ? of(kCount) - 1 : found.set;
  }
  add_steps_of_layer(layer, a, qa, b, qb, found);
  if (found.done()) return found.set;
  const Config delta = lattice_.delta(qa, qb);
  const Limits& limits = lattice_.limits();
  moves_ += 10;
  const Chain& chain = lattice_.chain();
  const ToolPath& path = lattice_.path();
  if (!keeps_path_error(chain, path, layer, qa, delta, limits.tool_path_error))
    found.add(kPathError);
  if (!found.done() && !keeps_angle_error(chain, path, layer, qa, delta, limits.tool_angle_error))
    found.add(kAngleError);
  if (!found.done() && !lattice_.keeps_step_error(layer, a, b)) found.add(kStepError);
  if (!found.done() && limits.edges == EdgeMode::kContinuous)
    if (const auto first = edge_blocked(query_, rule_, qa, qa + delta, budget_))
      if (!found.add(pair(*first)))
        for (const double t : {0.25, 0.5, 0.75})
          if (!found.done()) add_other_pairs(qa + t * delta, ClearanceRule::kMotion, found);
  if (check_.checks_motions() && found.set == 0 && !found.uncounted && from.violated == 0 &&
      to.violated == 0) {
    ++checked_;
    const StateCheck::Motion motion{qa, qa + delta};
    if (!check_.motions({&motion, 1})[0]) found.add(kCheck);
  }
  // all constraints: removing one alone would not help
  return found.uncounted ? of(kCount) - 1 : found.set;
}

std::optional<int> Constraints::run_out(int k, const Config& from, const Config& moved) const {
  if (lattice_.continuous()[static_cast<std::size_t>(k)] || std::abs(moved[k]) <= kPi ||
      k == lattice_.chain().slide())
    return std::nullopt;
  const double near = wrap_angle(moved[k]), there = from[k] + near;
  const auto [lower, upper] = limits_of(k);
  if (std::abs(near) > lattice_.limits().joint_step || (there >= lower && there <= upper))
    return std::nullopt;
  return limit(k, there > upper);
}

void Constraints::add_steps_of_layer(int layer, int a, const Config& qa, int b, const Config& qb,
                                     Violations& found) const {
  const Config delta = lattice_.delta(qa, qb);
  const Config& bound = lattice_.row_step_bound(layer);
  if (!lattice_.row_step_allowed(layer, delta)) {
    add_steps(qa, delta, bound, Config::Zero(), found);
  } else if (lattice_.is_approximate()) {  // nodes have a bound of their own
    const auto a_node = lattice_.node(layer, a), b_node = lattice_.node(layer + 1, b);
    if (a_node && b_node)
      add_steps(*a_node, lattice_.delta(*a_node, *b_node), bound, 2 * lattice_.fit_error(), found);
  }
}

void Constraints::add_steps(const Config& from, const Config& moved, const Config& bound,
                            const Config& more, Violations& found) const {
  const Config& most = joint_steps_;
  for (int k = 0; k < (lattice_.chain().roll ? kDof - 1 : kDof); ++k) {
    if (const auto limit = run_out(k, from, moved)) {
      if (found.add(*limit)) return;
      continue;
    }
    if (!(std::abs(moved[k]) <= most[k] + more[k]) && found.add(kJointStep)) return;
    if (bound[k] < most[k] && !(std::abs(moved[k]) <= bound[k] + more[k]) && found.add(kSpeed))
      return;
  }
}

/// Adds what is violated by the configurations between the layers and the moves from one to the
/// next: the first fault decides.
void Constraints::edge_of_layers(int layer, int a, const Config& qa, int b, const Config& qb,
                                 Violations& found) {
  using Fault = Lattice::InterpolatedEdge::Fault;
  const Lattice::InterpolatedEdge interpolated = lattice_.interpolate_edge(layer, a, qa, b, qb);
  moves_ += 10 * static_cast<std::int64_t>(interpolated.rows.size() + 1);
  switch (interpolated.fault) {
    case Fault::kNone:
      break;
    case Fault::kNoIk:
    case Fault::kSingular:
      found.uncounted = true;  // no removal would help
      return;
    case Fault::kLimit:
      for (int k = 0; k < kDof; ++k)
        if (interpolated.joints >> k & 1) found.add(limit_beyond(k, interpolated.q));
      return;
    case Fault::kManipulability:
      found.add(kManipulability);
      return;
    case Fault::kStep: {
      const Config& from = interpolated.rows.empty() ? qa : interpolated.rows.back();
      add_steps(from, interpolated.q - from, joint_steps_, Config::Zero(), found);
      if (found.set == 0) found.add(kSpeed);
      return;
    }
    case Fault::kRollSlope:
      found.add(kRollSlope);
      return;
    case Fault::kPathError:
      found.add(kPathError);
      return;
    case Fault::kAngleError:
      found.add(kAngleError);
      return;
  }
  for (const Config& q : interpolated.rows)
    if (const auto first = query_.find_violating_pair(q, ClearanceRule::kNode)) {
      if (!found.add(pair(*first))) add_other_pairs(q, ClearanceRule::kNode, found);
      if (found.done()) return;
    }
  if (lattice_.limits().edges != EdgeMode::kContinuous) return;
  for (std::size_t k = 0; k <= interpolated.rows.size(); ++k) {
    const Config& from = k == 0 ? qa : interpolated.rows[k - 1];
    const Config to = k < interpolated.rows.size() ? interpolated.rows[k]
                                                   : Config(from + lattice_.delta(from, qb));
    if (const auto first = edge_blocked(query_, rule_, from, to, budget_);
        first && found.add(pair(*first)))
      return;
  }
}

std::optional<double> Constraints::clearance(const BodyPair& pair, const Config& q, double most) {
  double low = 0, high = most;  // the clearance is below `high` and not below `low`
  constexpr double kContact = 1e-6, kTelling = 1e-5;
  if (query_.pair_violates(q, pair, kContact)) return 0;
  while (high - low > kTelling) {
    const double middle = (low + high) / 2;
    (query_.pair_violates(q, pair, middle) ? high : low) = middle;
  }
  return low;
}

Cause Constraints::measured(int constraint, int, const Config& q) {
  Cause cause = this->cause(constraint);
  if (cause.kind == Cause::Kind::kLimit) {
    cause.value = q[constraint / 2];
  } else if (cause.kind == Cause::Kind::kManipulability) {
    cause.value = lattice_.chain().manipulability(q);
  } else if (cause.kind == Cause::Kind::kPair) {
    // A link may have several bodies: the nearest counts.
    for (const BodyPair& p : world_.pairs()) {
      if (world_.names(p) != cause.bodies || !query_.pair_violates(q, p, ClearanceRule::kNode))
        continue;
      const double required = world_.required_clearance(p).node;
      const auto value = required < 0 ? -query_.depth(q, p).at_least : clearance(p, q, required);
      if (!cause.value || (value && *value < *cause.value)) {
        cause.value = value;
        cause.limit = required;
        if (const double allowed = world_.required_clearance(p).motion;
            required < 0 && allowed < required)
          cause.over = -allowed;
      }
    }
    if (cause.value == 0.0) cause.kind = Cause::Kind::kContact;
  }
  return cause;
}

/// Measures the deepest contact of the cause's bodies, if they may touch to a depth, at a few
/// postures of the motion from node a to node b.
void Constraints::measure_contact(Cause& cause, int layer, int a, const Config& qa, int b,
                                  const Config& qb) {
  constexpr int kParts = 16;  // of a motion
  const bool by_rows = lattice_.has_layers_between();
  std::vector<Config> rows{qa};
  if (by_rows)
    for (const Config& q : lattice_.interpolate_edge(layer, a, qa, b, qb).rows) rows.push_back(q);
  rows.push_back(rows.back() + lattice_.delta(rows.back(), qb));
  for (const BodyPair& p : world_.pairs()) {  // a link may have several bodies
    const RequiredClearance required = world_.required_clearance(p);
    if (required.motion >= 0 || world_.names(p) != cause.bodies) continue;
    const double allowed = by_rows ? -required.node : -(required.motion + required.tolerance);
    double deepest = allowed;  // at least: else nothing would be violated
    for (std::size_t k = 1; k < rows.size(); ++k)
      for (int part = k == 1 ? 0 : 1; part <= kParts; ++part)
        deepest = std::max(
            deepest, query_.depth(rows[k - 1] + (rows[k] - rows[k - 1]) * part / kParts, p, deepest)
                         .at_least);
    if (cause.value && -deepest >= *cause.value) continue;
    cause.value = -deepest;
    cause.limit = -allowed;
    cause.over = required.motion < -allowed ? std::optional(-required.motion) : std::nullopt;
  }
}

/// Measures a violation of a lattice that has rows between its layers.
void Constraints::measure_by_rows(Cause& cause, int constraint, int layer, int a, const Config& qa,
                                  int b, const Config& qb) const {
  if (cause.kind == Cause::Kind::kLimit) {
    const Lattice::InterpolatedEdge interpolated = lattice_.interpolate_edge(layer, a, qa, b, qb);
    const Config& from = interpolated.rows.empty() ? qa : interpolated.rows.back();
    const int k = constraint / 2;
    cause.unwinds = interpolated.fault == Lattice::InterpolatedEdge::Fault::kStep;
    cause.value =
        cause.unwinds ? from[k] + wrap_angle(interpolated.q[k] - from[k]) : interpolated.q[k];
  }
  if (cause.kind == Cause::Kind::kJointStep)
    measure_step(cause, layer, longest_move(layer, a, qa, b, qb));
  cause.between_layers = cause.kind != Cause::Kind::kArmSlope;
}

/// Returns the move from row to row between two nodes that is the longest for what joints may move
/// in one layer. Where none is too long, the chord is for all layers together: returns the share of
/// one.
Config Constraints::longest_move(int layer, int a, const Config& qa, int b,
                                 const Config& qb) const {
  const Lattice::InterpolatedEdge interpolated = lattice_.interpolate_edge(layer, a, qa, b, qb);
  std::vector<Config> rows{qa};
  rows.insert(rows.end(), interpolated.rows.begin(), interpolated.rows.end());
  if (interpolated.fault == Lattice::InterpolatedEdge::Fault::kNone) rows.push_back(qb);
  if (interpolated.fault == Lattice::InterpolatedEdge::Fault::kStep) rows.push_back(interpolated.q);
  const Eigen::Index joints = lattice_.chain().roll ? kDof - 1 : kDof;  // as measure_step()
  Config longest =
      lattice_.delta(qa, qb) / (lattice_.layer_of_rows(layer + 1) - lattice_.layer_of_rows(layer));
  double most = 1;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Config move = lattice_.delta(rows[k - 1], rows[k]);
    const double part =
        move.head(joints).cwiseAbs().cwiseQuotient(joint_steps_.head(joints)).maxCoeff();
    if (part > most) longest = move, most = part;
  }
  return longest;
}

/// Names the joint of a move by `delta` that moves furthest, or furthest for its speed, and
/// measures its move.
void Constraints::measure_step(Cause& cause, int layer, const Config& delta) const {
  const Config& bound = lattice_.row_step_bound(layer);
  // the roll has a limit of its own
  const Eigen::Index joints = lattice_.chain().roll ? kDof - 1 : kDof;
  Eigen::Index k = 0;
  if (cause.kind == Cause::Kind::kJointStep)
    delta.cwiseAbs().cwiseQuotient(joint_steps_).head(joints).maxCoeff(&k);
  else
    delta.head(joints).cwiseAbs().cwiseQuotient(bound.head(joints)).maxCoeff(&k);
  cause.joint = lattice_.chain().joint_names[static_cast<std::size_t>(k)];
  cause.slides = k == lattice_.chain().slide();
  cause.value = std::abs(delta[k]);
  if (cause.slides && cause.kind == Cause::Kind::kJointStep) *cause.limit *= kSlideForTurn;
  if (cause.kind == Cause::Kind::kSpeed) cause.limit = bound[k];
}

Cause Constraints::measured(int constraint, int layer, int a, const Config& qa, int b,
                            const Config& qb) {
  Cause cause = this->cause(constraint);
  if (cause.kind == Cause::Kind::kPair) {
    cause.between_layers = true;
    measure_contact(cause, layer, a, qa, b, qb);
    return cause;
  }
  if (cause.kind == Cause::Kind::kRollSlope) {
    auto roll = *lattice_.roll_step(layer, a, qa, b, qb);
    if (roll.allowed && lattice_.has_layers_between())
      roll = lattice_.interpolate_edge(layer, a, qa, b, qb).roll;  // on the way
    cause.value = roll.change, cause.limit = roll.most, cause.over = roll.over;
    return cause;
  }
  if (lattice_.has_layers_between()) {
    measure_by_rows(cause, constraint, layer, a, qa, b, qb);
    return cause;
  }
  const Config delta = lattice_.delta(qa, qb);
  const auto most_of = [](const std::array<double, 3>& x) {
    return *std::max_element(x.begin(), x.end());
  };
  switch (cause.kind) {
    case Cause::Kind::kJointStep:
    case Cause::Kind::kSpeed:
      measure_step(cause, layer, delta);
      break;
    // The joint has run out of turns. A node beyond the joint's limits cannot end a move.
    case Cause::Kind::kLimit:
      cause.unwinds = true;
      cause.value = qa[constraint / 2] + wrap_angle(delta[constraint / 2]);
      break;
    case Cause::Kind::kPathError:
      cause.value = most_of(path_deviation(lattice_.chain(), lattice_.path(), layer, qa, delta));
      break;
    case Cause::Kind::kAngleError:
      cause.value = most_of(angle_deviation(lattice_.chain(), lattice_.path(), layer, qa, delta));
      break;
    case Cause::Kind::kArmSlope:
      cause.value = std::abs(wrap_angle(lattice_.phi(layer + 1, b) - lattice_.phi(layer, a)));
      break;
    case Cause::Kind::kCheck:
      cause.between_layers = true;
      break;
    default:
      break;
  }
  return cause;
}

}  // namespace swivel
