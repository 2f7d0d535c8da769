// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/witnesses.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/constraints.hpp"

namespace swivel {

namespace {

/// Returns true if a cause says nothing but what causes of its kind need as witnesses.
bool says_no_more(const Cause& cause) {
  Cause needed;
  needed.kind = cause.kind;
  if (cause.kind == Cause::Kind::kLimit) needed.joint = cause.joint, needed.side = cause.side;
  if (cause.kind == Cause::Kind::kPair) needed.bodies = cause.bodies;
  if (cause.kind == Cause::Kind::kCheck) needed.check = cause.check;
  return cause == needed;
}

}  // namespace

Witnesses::Witnesses(const Lattice& lattice, const World& world, const EdgeRule& rule,
                     DistanceProofs distance_proofs, const std::shared_ptr<StateCheck>& check,
                     const Budget& budget)
    : lattice_(lattice),
      world_(world),
      rule_(rule),
      check_(check, budget),
      query_(world, distance_proofs),
      budget_(budget) {}

std::optional<Witnesses::About> Witnesses::about(const Cause& cause) const {
  if (!says_no_more(cause)) return std::nullopt;
  About about;
  switch (cause.kind) {
    case Cause::Kind::kLimit: {
      const auto& names = lattice_.chain().joint_names;
      const auto found = std::find(names.begin(), names.end(), cause.joint);
      if (found == names.end() || cause.side == Cause::Side::kNone) return std::nullopt;
      about.joint = static_cast<int>(found - names.begin());
      return about;
    }
    case Cause::Kind::kPair:
      for (const BodyPair& pair : world_.pairs())
        if (world_.names(pair) == cause.bodies) about.pairs.push_back(pair);
      return about.pairs.empty() ? std::nullopt : std::optional(about);
    case Cause::Kind::kCheck:
      return check_ && check_.name() == cause.check ? std::optional(about) : std::nullopt;
    case Cause::Kind::kReach:
    case Cause::Kind::kSingular:
    case Cause::Kind::kManipulability:
    case Cause::Kind::kRollSlope:
    case Cause::Kind::kJointStep:
    case Cause::Kind::kSpeed:
    case Cause::Kind::kPathError:
    case Cause::Kind::kAngleError:
    case Cause::Kind::kStepError:
      return about;
    default:
      return std::nullopt;
  }
}

bool Witnesses::add(const Cause& cause) {
  auto known = about(cause);
  if (!known) return false;
  causes_.push_back(cause);
  about_.push_back(std::move(*known));
  return true;
}

int Witnesses::number(const Cause& cause) {
  const auto found = std::find(causes_.begin(), causes_.end(), cause);
  if (found != causes_.end()) return static_cast<int>(found - causes_.begin());
  return add(cause) ? static_cast<int>(causes_.size()) - 1 : -1;
}

int Witnesses::number(const BodyPair& pair) {
  Cause cause = of_kind(Cause::Kind::kPair);
  cause.bodies = world_.names(pair);
  return number(cause);
}

Cause Witnesses::limit_of(int joint, Cause::Side side) const {
  Cause cause = of_kind(Cause::Kind::kLimit);
  cause.joint = lattice_.chain().joint_names[static_cast<std::size_t>(joint)];
  cause.side = side;
  return cause;
}

/// Returns true if the cause explains why a slot has no exact configuration
/// (Lattice::exact_config).
bool Witnesses::removes_missing(const Cause& cause, const About& about, int layer, int slot) const {
  const Lattice::NodeFault fault = lattice_.fault(layer, slot);
  switch (fault.status) {
    case NodeStatus::kNoIk:
      return cause.kind == Cause::Kind::kReach;
    case NodeStatus::kSingular:
      return cause.kind == Cause::Kind::kSingular;
    case NodeStatus::kLimit:
      return cause.kind == Cause::Kind::kLimit && ((fault.joints >> about.joint) & 1) != 0 &&
             side_of(fault.q, about.joint) == cause.side;
    case NodeStatus::kValid:  // beyond a limit by rounding alone, since it is missing
      return cause.kind == Cause::Kind::kLimit;
  }
  return false;
}

/// Returns the side on which a joint is beyond its limits.
Cause::Side Witnesses::side_of(const Config& q, int joint) const {
  const JointLimit& limit = lattice_.chain().limit[static_cast<std::size_t>(joint)];
  return q[joint] > limit.upper - lattice_.limits().joint_margin ? Cause::Side::kUpper
                                                                 : Cause::Side::kLower;
}

std::optional<Cause> Witnesses::of_missing(int layer, int slot) const {
  const Lattice::NodeFault fault = lattice_.fault(layer, slot);
  if (fault.status == NodeStatus::kNoIk) return of_kind(Cause::Kind::kReach);
  if (fault.status == NodeStatus::kSingular) return of_kind(Cause::Kind::kSingular);
  int joint = 0;
  while (joint + 1 < kDof && ((fault.joints >> joint) & 1) == 0) ++joint;
  return limit_of(joint, side_of(fault.q, joint));
}

bool Witnesses::removes_node(int witness, int layer, int slot) {
  budget_.poll();
  const Cause& cause = causes_[static_cast<std::size_t>(witness)];
  const About& about = about_[static_cast<std::size_t>(witness)];
  const auto q = lattice_.exact_config(layer, slot);
  if (!q) return removes_missing(cause, about, layer, slot);
  if (cause.kind == Cause::Kind::kManipulability) return !lattice_.manipulable(*q);
  if (cause.kind == Cause::Kind::kCheck) return !check_.states({&*q, 1})[0];
  return cause.kind == Cause::Kind::kPair &&
         std::any_of(about.pairs.begin(), about.pairs.end(), [&](const BodyPair& pair) {
           return query_.pair_violates(*q, pair, ClearanceRule::kNode);
         });
}

int Witnesses::of_node(int layer, int slot, int suspected) {
  budget_.poll();
  const auto is = [&](Cause::Kind kind) {
    return suspected >= 0 && causes_[static_cast<std::size_t>(suspected)].kind == kind;
  };
  const auto q = lattice_.exact_config(layer, slot);
  if (!q) {
    if (is(Cause::Kind::kLimit) && removes_node(suspected, layer, slot)) return suspected;
    const auto cause = of_missing(layer, slot);
    return cause ? number(*cause) : -1;
  }
  if (!lattice_.manipulable(*q)) return number(of_kind(Cause::Kind::kManipulability));
  const auto pair = query_.find_violating_pair(
      *q, ClearanceRule::kNode,
      is(Cause::Kind::kPair) ? std::optional(about_[static_cast<std::size_t>(suspected)].pairs[0])
                             : std::nullopt);
  if (pair) return number(*pair);
  if (check_ && !check_.states({&*q, 1})[0]) {
    Cause cause = of_kind(Cause::Kind::kCheck);
    cause.check = check_.name();
    return number(cause);
  }
  return -1;
}

std::optional<Witnesses::Move> Witnesses::move(int layer, int a, int b) const {
  const auto qa = lattice_.exact_config(layer, a), qb = lattice_.exact_config(layer + 1, b);
  if (!qa || !qb) return std::nullopt;
  return Move{*qa, *qa + lattice_.delta(*qa, *qb)};
}

bool Witnesses::removes_move(const Cause& cause, const About& about, int layer, int a, int b,
                             const Move& move) {
  const Limits& limits = lattice_.limits();
  const Config moved = move.to - move.from;
  switch (cause.kind) {
    case Cause::Kind::kJointStep:
      return !(moved.cwiseAbs()
                   .cwiseQuotient(joint_steps(lattice_.chain(), limits))
                   .head(lattice_.chain().roll ? kDof - 1 : kDof)
                   .maxCoeff() <= 1);
    case Cause::Kind::kRollSlope: {
      const auto roll = lattice_.roll_step(layer, a, move.from, b, move.to);
      return roll && !roll->allowed;
    }
    case Cause::Kind::kSpeed:
      return !lattice_.row_step_allowed(layer, moved);
    case Cause::Kind::kPathError:
      return !keeps_path_error(lattice_.chain(), lattice_.path(), layer, move.from, moved,
                               limits.tool_path_error);
    case Cause::Kind::kAngleError:
      return !keeps_angle_error(lattice_.chain(), lattice_.path(), layer, move.from, moved,
                                limits.tool_angle_error);
    case Cause::Kind::kStepError:
      return !lattice_.keeps_step_error(layer, a, b);
    case Cause::Kind::kPair:
      return limits.edges == EdgeMode::kContinuous &&
             std::any_of(about.pairs.begin(), about.pairs.end(), [&](const BodyPair& pair) {
               return edge_blocked_by(pair, query_, rule_, move.from, move.to, budget_);
             });
    case Cause::Kind::kCheck: {
      const StateCheck::Motion asked{move.from, move.to};
      return check_.checks_motions() && !check_.motions({&asked, 1})[0];
    }
    default:
      return false;
  }
}

/// Returns the cause that names a fault between two layers; none if there is no fault.
std::optional<Cause> Witnesses::of_fault(const Lattice::InterpolatedEdge& interpolated) const {
  using Fault = Lattice::InterpolatedEdge::Fault;
  switch (interpolated.fault) {
    case Fault::kNone:
      return std::nullopt;
    case Fault::kNoIk:
      return of_kind(Cause::Kind::kReach);
    case Fault::kSingular:
      return of_kind(Cause::Kind::kSingular);
    case Fault::kManipulability:
      return of_kind(Cause::Kind::kManipulability);
    case Fault::kStep:
      return of_kind(Cause::Kind::kJointStep);
    case Fault::kRollSlope:
      return of_kind(Cause::Kind::kRollSlope);
    case Fault::kPathError:
      return of_kind(Cause::Kind::kPathError);
    case Fault::kAngleError:
      return of_kind(Cause::Kind::kAngleError);
    case Fault::kLimit:
      break;
  }
  int joint = 0;
  while (joint + 1 < kDof && ((interpolated.joints >> joint) & 1) == 0) ++joint;
  return limit_of(joint, side_of(interpolated.q, joint));
}

bool Witnesses::removes_layers(const Cause& cause, const About& about, int layer, int a, int b,
                               const Move& move) {
  const Lattice::InterpolatedEdge interpolated =
      lattice_.interpolate_edge(layer, a, move.from, b, move.to);
  if (const auto fault = of_fault(interpolated)) {
    if (cause.kind != Cause::Kind::kLimit || fault->kind != cause.kind)
      return fault->kind == cause.kind;
    return ((interpolated.joints >> about.joint) & 1) != 0 &&
           side_of(interpolated.q, about.joint) == cause.side;
  }
  if (cause.kind != Cause::Kind::kPair) return false;
  for (std::size_t k = 0; k <= interpolated.rows.size(); ++k) {
    const Config& from = k == 0 ? move.from : interpolated.rows[k - 1];
    const Config to =
        from + lattice_.delta(from, k < interpolated.rows.size() ? interpolated.rows[k] : move.to);
    for (const BodyPair& pair : about.pairs)
      if ((k < interpolated.rows.size() && query_.pair_violates(to, pair, ClearanceRule::kNode)) ||
          (lattice_.limits().edges == EdgeMode::kContinuous &&
           edge_blocked_by(pair, query_, rule_, from, to, budget_)))
        return true;
  }
  return false;
}

int Witnesses::of_layers(int layer, int a, int b, const Move& move, int suspected) {
  const Lattice::InterpolatedEdge interpolated =
      lattice_.interpolate_edge(layer, a, move.from, b, move.to);
  if (const auto fault = of_fault(interpolated)) return number(*fault);
  if (suspected >= 0 &&
      removes_layers(causes_[static_cast<std::size_t>(suspected)],
                     about_[static_cast<std::size_t>(suspected)], layer, a, b, move))
    return suspected;
  for (std::size_t k = 0; k <= interpolated.rows.size(); ++k) {
    const Config& from = k == 0 ? move.from : interpolated.rows[k - 1];
    const Config to =
        from + lattice_.delta(from, k < interpolated.rows.size() ? interpolated.rows[k] : move.to);
    if (k < interpolated.rows.size())
      if (const auto pair = query_.find_violating_pair(to, ClearanceRule::kNode))
        return number(*pair);
    if (lattice_.limits().edges == EdgeMode::kContinuous)
      if (const auto pair = edge_blocked(query_, rule_, from, to, budget_)) return number(*pair);
  }
  return -1;
}

bool Witnesses::removes_edge(int witness, int layer, int a, int b) {
  budget_.poll();
  const auto asked = move(layer, a, b);
  if (asked && lattice_.has_layers_between())
    return removes_layers(causes_[static_cast<std::size_t>(witness)],
                          about_[static_cast<std::size_t>(witness)], layer, a, b, *asked);
  return asked && removes_move(causes_[static_cast<std::size_t>(witness)],
                               about_[static_cast<std::size_t>(witness)], layer, a, b, *asked);
}

int Witnesses::of_edge(int layer, int a, int b, int suspected) {
  budget_.poll();
  const auto asked = move(layer, a, b);
  if (!asked) return -1;
  if (lattice_.has_layers_between()) return of_layers(layer, a, b, *asked, suspected);
  const auto removes = [&](int witness) {
    return witness >= 0 &&
           removes_move(causes_[static_cast<std::size_t>(witness)],
                        about_[static_cast<std::size_t>(witness)], layer, a, b, *asked);
  };
  for (const Cause::Kind kind :
       {Cause::Kind::kRollSlope, Cause::Kind::kJointStep, Cause::Kind::kSpeed,
        Cause::Kind::kPathError, Cause::Kind::kAngleError, Cause::Kind::kStepError})
    if (const Cause cause = of_kind(kind); removes_move(cause, {}, layer, a, b, *asked))
      return number(cause);
  if (removes(suspected)) return suspected;
  if (lattice_.limits().edges == EdgeMode::kContinuous)
    if (const auto pair = edge_blocked(query_, rule_, asked->from, asked->to, budget_))
      return number(*pair);
  if (!check_) return -1;
  Cause cause = of_kind(Cause::Kind::kCheck);
  cause.check = check_.name();
  const int witness = number(cause);
  return removes(witness) ? witness : -1;
}

}  // namespace swivel
