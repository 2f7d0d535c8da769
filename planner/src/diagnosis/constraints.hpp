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

/// A cause that its kind says all of.
[[nodiscard]] inline Cause of_kind(Cause::Kind kind) {
  Cause cause;
  cause.kind = kind;
  return cause;
}

/// A set of constraints, a bit each.
using ConstraintSet = std::uint64_t;

/// The constraints of a problem, numbered: both limits of every joint, what moves must keep, the user's check, and pairs of bodies
/// as they are met. Joints are those of rows (Lattice::row). The check is asked about what violates nothing else, and counts as
/// allowing the rest.
/// Scene objects have numbers of their own, each for all pairs with it: an object can be removed as a whole.
/// Says which of them a node or an edge violates, of any lattice. Questions of clearance go to a query of its own and are counted.
class Constraints {
 public:
  Constraints(const Lattice& lattice, const World& world, const EdgeRule& rule, const Budget& budget,
              const std::shared_ptr<StateCheck>& check);

  /// Joint k of 0 ... 6 at its lower (0) or upper (1) limit.
  static constexpr int limit(int k, bool upper) { return 2 * k + (upper ? 1 : 0); }
  static constexpr int kManipulability = 2 * kDof, kArmSlope = kManipulability + 1, kRollSlope = kArmSlope + 1,
                       kJointStep = kRollSlope + 1, kSpeed = kJointStep + 1, kPathError = kSpeed + 1, kAngleError = kPathError + 1,
                       kStepError = kAngleError + 1, kCheck = kStepError + 1, kFirstPair = kCheck + 1,
                       kCount = 63;  // one bit is left to those who use the sets
  static constexpr ConstraintSet of(int constraint) { return ConstraintSet{1} << constraint; }
  /// Those that a move violates by its joints alone, which takes no question of bodies to find out.
  static constexpr bool told_by_steps(int constraint) {
    return constraint < kManipulability || (constraint >= kArmSlope && constraint <= kSpeed);
  }
  /// Those that come between a node and its continuation on the same sheet, rather than between sheets.
  static constexpr bool bars_nodes(int constraint) { return constraint <= kManipulability || constraint >= kCheck; }
  /// -1 once too many have been met to be told apart.
  [[nodiscard]] int pair(const BodyPair& pair) {
    int& number = number_of_[static_cast<std::size_t>(pair.a) * world_.body_names().size() + static_cast<std::size_t>(pair.b)];
    return number != kUnmet ? number : number = met(pair);
  }
  /// Of pairs with a scene object: the number that stands for all pairs with it; else -1.
  [[nodiscard]] int object_of(int constraint) const { return object_of_[static_cast<std::size_t>(constraint)]; }
  [[nodiscard]] bool is_object(int constraint) const { return !object_name_[static_cast<std::size_t>(constraint)].empty(); }
  /// What is left of a set of violated constraints once others are waived, or all pairs with an object.
  [[nodiscard]] ConstraintSet left(ConstraintSet violated, ConstraintSet waived) const;
  /// The constraints, or objects, of which each alone would do away with all of a set that is not empty.
  [[nodiscard]] ConstraintSet removals(ConstraintSet violated) const;
  /// The limit of joint k that q[k] is beyond.
  [[nodiscard]] int limit_beyond(int k, const Config& q) const { return limit(k, q[k] > limits_of(k).second); }
  /// Without its value; with the limit.
  [[nodiscard]] Cause cause(int constraint) const;

  struct Node {
    Config q = Config::Zero();  ///< of its row
    bool exists = false;        ///< in closed form, limits aside; else nothing would help
    ConstraintSet violated = 0;
  };
  /// When enough is known: kFirst: one violation; kNoRemoval: several outside `waived`, which no single removal does away with.
  enum class Until { kFirst, kNoRemoval };
  [[nodiscard]] Node node(int layer, int slot, ConstraintSet waived, Until until);
  /// Of the move from node `from` at slot a to node `to` at slot b of the next layer. The same. Bodies that block a motion besides
  /// the first pair are looked for at its quarters only.
  [[nodiscard]] ConstraintSet edge(int layer, int a, const Node& from, int b, const Node& to, ConstraintSet waived, Until until);

  /// What is violated there and by how much: a cause with its value.
  [[nodiscard]] Cause measured(int constraint, int layer, const Config& q);
  [[nodiscard]] Cause measured(int constraint, int layer, int a, const Config& qa, int b, const Config& qb);

  [[nodiscard]] World::Query& query() { return query_; }
  [[nodiscard]] AskedCheck& check() { return check_; }
  /// An estimate of the time spent, us, that is the same on every machine.
  [[nodiscard]] double spent_us() const;
  void count_nodes(std::int64_t nodes) { nodes_ += nodes; }
  void count_checked(std::int64_t questions) { checked_ += questions; }

 private:
  struct Violations;
  static constexpr int kUnmet = -2;
  [[nodiscard]] int met(const BodyPair& pair);
  [[nodiscard]] std::pair<double, double> limits_of(int k) const;
  void add_other_pairs(const Config& q, const Level& level, Violations& found);
  /// What a move between rows violates by its size; `bound`: what each joint may move; `more`: by how much both may be exceeded.
  void add_steps(const Config& from, const Config& moved, const Config& bound, const Config& more, Violations& found) const;
  /// Of a joint step: whether only a turn of the joint makes it so large, since the end of its range lies between. Which limit
  /// then.
  [[nodiscard]] std::optional<int> run_out(int k, const Config& from, const Config& moved) const;
  void edge_of_layers(int layer, int a, const Config& qa, int b, const Config& qb, Violations& found);
  [[nodiscard]] std::optional<double> clearance(const BodyPair& pair, const Config& q, double most);
  void measure_contact(Cause& cause, int layer, int a, const Config& qa, int b, const Config& qb);

  const Lattice& lattice_;
  const World& world_;
  EdgeRule rule_;
  const Budget& budget_;
  AskedCheck check_;
  World::Query query_;
  double question_us_, node_us_;
  std::int64_t nodes_ = 0, moves_ = 0, pairs_ = 0, checked_ = 0;
  std::vector<int> number_of_;                        // of pairs, by a body of the robot and the other
  std::map<std::array<std::string, 2>, int> number_;  // by names: links have several bodies
  std::map<std::string, int> object_number_;
  std::array<std::array<std::string, 2>, kCount> names_;  // of pairs
  std::array<std::string, kCount> object_name_;           // of those that stand for an object
  std::array<int, kCount> object_of_{};
  int count_ = kFirstPair;
};

}  // namespace swivel
