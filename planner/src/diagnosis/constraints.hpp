// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/cause.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

/// Returns a cause that has nothing but a kind.
[[nodiscard]] inline Cause of_kind(Cause::Kind kind) {
  Cause cause;
  cause.kind = kind;
  return cause;
}

/// A set of constraints, one bit for each number of Constraints.
using ConstraintSet = std::uint64_t;

/// The constraints of a problem, numbered: both limits of every joint, the limits on moves, the
/// user's check, and pairs of bodies in the order in which they are met. Each scene object has a
/// number too, which stands for all pairs with it, since an object can be removed as a whole. Tells
/// which constraints a node or an edge violates, for any lattice, by exact configurations
/// (Lattice::exact_config). The user's check is only called about what violates nothing else;
/// otherwise it counts as passed. Clearance queries go to a query of this object and are counted.
class Constraints {
 public:
  /// Numbers the constraints of a lattice in a world. `lattice`, `world` and `budget` must outlive
  /// it; `check` may be null.
  Constraints(const Lattice& lattice, const World& world, const EdgeRule& rule,
              const Budget& budget, const std::shared_ptr<StateCheck>& check);

  /// Returns the number of the lower or upper limit of joint k = 0 ... 6.
  static constexpr int limit(int k, bool upper) { return 2 * k + (upper ? 1 : 0); }
  static constexpr int kManipulability = 2 * kDof, kArmSlope = kManipulability + 1,
                       kRollSlope = kArmSlope + 1, kJointStep = kRollSlope + 1,
                       kSpeed = kJointStep + 1, kPathError = kSpeed + 1,
                       kAngleError = kPathError + 1, kStepError = kAngleError + 1,
                       kCheck = kStepError + 1, kFirstPair = kCheck + 1,
                       kCount = 63;  // one bit is left to those who use the sets
  /// Returns the set of one constraint.
  static constexpr ConstraintSet of(int constraint) { return ConstraintSet{1} << constraint; }
  /// Returns true for the constraints whose violation by a move follows from its joints alone,
  /// without a collision query.
  static constexpr bool told_by_steps(int constraint) {
    return constraint < kManipulability || (constraint >= kArmSlope && constraint <= kSpeed);
  }
  /// Returns true for the constraints that remove nodes, and so the continuation of a node on the
  /// same IK solution, rather than moves between IK solutions.
  static constexpr bool bars_nodes(int constraint) {
    return constraint <= kManipulability || constraint >= kCheck;
  }
  /// Returns the number of a pair of bodies; -1 if too many pairs have been met to be told apart.
  [[nodiscard]] int pair(const BodyPair& pair) {
    int& number = number_of_[static_cast<std::size_t>(pair.a) * world_.body_names().size() +
                             static_cast<std::size_t>(pair.b)];
    return number != kUnmet ? number : number = met(pair);
  }
  /// Returns, for a pair with a scene object, the number that stands for all pairs with that
  /// object; else -1.
  [[nodiscard]] int object_of(int constraint) const {
    return object_of_[static_cast<std::size_t>(constraint)];
  }
  /// Returns true if the number stands for all pairs with a scene object.
  [[nodiscard]] bool is_object(int constraint) const {
    return !object_name_[static_cast<std::size_t>(constraint)].empty();
  }
  /// Returns what is left of a set of violated constraints once the constraints `waived`, or all
  /// pairs with an object, are waived.
  [[nodiscard]] ConstraintSet left(ConstraintSet violated, ConstraintSet waived) const;
  /// Returns the constraints, or objects, that each alone account for all of `violated`, which must
  /// not be empty.
  [[nodiscard]] ConstraintSet removals(ConstraintSet violated) const;
  /// Returns the number of the limit of joint k that q[k] is beyond.
  [[nodiscard]] int limit_beyond(int k, const Config& q) const {
    return limit(k, q[k] > limits_of(k).second);
  }
  /// Returns the cause that names the constraint, with its limit but without a value.
  [[nodiscard]] Cause cause(int constraint) const;

  /// A node, and the constraints that it violates.
  struct Node {
    Config q = Config::Zero();  ///< its exact configuration
    /// it has a closed-form solution, limits aside, and violates only numbered constraints; else no
    /// removal would help
    bool exists = false;
    ConstraintSet violated = 0;
  };
  /// When the search for violations may stop. kFirst: after one violation outside `waived`.
  /// kNoRemoval: once there are several outside `waived` for which no single removal accounts.
  enum class Until { kFirst, kNoRemoval };
  /// Returns a node and the joint limits that it violates.
  [[nodiscard]] Node place(int layer, int slot);
  /// Adds to a node that exists what else it violates, until enough is known.
  void complete(Node& node, ConstraintSet waived, Until until);
  /// Returns limits that the move from qa at slot a of `layer` to qb at slot b of the next layer
  /// violates by the steps of its joints, until no single removal of those `asked` about accounts
  /// for them. It takes little; edge() finds the same ones and more.
  [[nodiscard]] ConstraintSet steps(int layer, int a, const Config& qa, int b, const Config& qb,
                                    ConstraintSet waived, ConstraintSet asked) const;
  /// Returns the constraints that the move from node `from` at slot a of `layer` to node `to` at
  /// slot b of the next layer violates, until enough is known: with kNoRemoval also once no single
  /// removal of those `asked` about accounts for what was found. Bodies that block a motion besides
  /// the first pair are looked for only at its quarters.
  [[nodiscard]] ConstraintSet edge(int layer, int a, const Node& from, int b, const Node& to,
                                   ConstraintSet waived, Until until,
                                   ConstraintSet asked = ~ConstraintSet{0});

  /// Returns the cause of a violation of a constraint at configuration q, with the value that
  /// violates it.
  [[nodiscard]] Cause measured(int constraint, int layer, const Config& q);
  /// Returns the cause of a violation of a constraint on the move from qa at slot a of `layer` to
  /// qb at slot b of the next layer, with the value that violates it.
  [[nodiscard]] Cause measured(int constraint, int layer, int a, const Config& qa, int b,
                               const Config& qb);

  /// Returns the query that clearances are tested with.
  [[nodiscard]] World::Query& query() { return query_; }
  /// Returns the user's check, which may be empty.
  [[nodiscard]] AskedCheck& check() { return check_; }
  /// Returns an estimate of the time spent, us, by counts of work, which is the same on every
  /// machine.
  [[nodiscard]] double spent_us() const;
  /// Adds nodes that a caller has computed to the estimate.
  void count_nodes(std::int64_t nodes) { nodes_ += nodes; }
  /// Adds calls of the user's check by a caller to the estimate.
  void count_checked(std::int64_t questions) { checked_ += questions; }

 private:
  struct Violations;
  static constexpr int kUnmet = -2;
  [[nodiscard]] int met(const BodyPair& pair);
  [[nodiscard]] std::pair<double, double> limits_of(int k) const;
  void add_other_pairs(const Config& q, const Threshold& threshold, Violations& found);
  /// Adds what the move `moved` from `from` violates by its size. `bound` is what each joint may
  /// move by its speed; `more` is added to all bounds.
  void add_steps(const Config& from, const Config& moved, const Config& bound, const Config& more,
                 Violations& found) const;
  /// Adds what a move from a layer to the next violates by its size, where no rows lie between.
  void add_steps_of_layer(int layer, int a, const Config& qa, int b, const Config& qb,
                          Violations& found) const;
  /// If the step of joint k is large only because the end of the joint's range lies between, so
  /// that it has to turn back, returns the limit at that end; else none.
  [[nodiscard]] std::optional<int> run_out(int k, const Config& from, const Config& moved) const;
  void edge_of_layers(int layer, int a, const Config& qa, int b, const Config& qb,
                      Violations& found);
  [[nodiscard]] std::optional<double> clearance(const BodyPair& pair, const Config& q, double most);
  void measure_contact(Cause& cause, int layer, int a, const Config& qa, int b, const Config& qb);
  void measure_by_rows(Cause& cause, int constraint, int layer, int a, const Config& qa, int b,
                       const Config& qb) const;
  [[nodiscard]] Config longest_move(int layer, int a, const Config& qa, int b,
                                    const Config& qb) const;
  void measure_step(Cause& cause, int layer, const Config& delta) const;

  const Lattice& lattice_;
  const World& world_;
  EdgeRule rule_;
  Config joint_steps_;  // by limits.joint_step
  const Budget& budget_;
  AskedCheck check_;
  World::Query query_;
  double question_us_, node_us_;
  std::int64_t nodes_ = 0, moves_ = 0, pairs_ = 0, checked_ = 0;
  std::vector<int> number_of_;  // of pairs, by robot body and other body
  // by names, since a link may have several bodies
  std::map<std::array<std::string, 2>, int> number_;
  std::map<std::string, int> object_number_;
  std::array<std::array<std::string, 2>, kCount> names_;  // of pairs
  std::array<std::string, kCount> object_name_;           // of numbers that stand for an object
  std::array<int, kCount> object_of_{};
  int count_ = kFirstPair;
};

}  // namespace swivel
