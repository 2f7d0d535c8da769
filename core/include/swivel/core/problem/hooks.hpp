// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// What a program adds to the problem as code of its own. Answers must depend on the states alone: the same at every call, in any
/// order and any batches. What a hook throws leaves plan() as it is; nothing else is lost.
class Hook {
 public:
  Hook() = default;
  Hook(const Hook&) = delete;
  Hook& operator=(const Hook&) = delete;
  virtual ~Hook() = default;

  /// Names it in verdicts and messages.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Whether plans in several threads may call it at the same time. Else they take turns. One plan calls it from the thread of
  /// plan() alone, one call after the other.
  [[nodiscard]] virtual bool concurrent() const { return false; }
  /// Held by the plan whose turn it is.
  [[nodiscard]] std::timed_mutex& turn() { return turn_; }

 private:
  std::timed_mutex turn_;
};

/// A rule of the user's on joints, besides limits, manipulability and collision: what it refuses is no part of any path. It is
/// asked only about what all other rules allow, in batches, and named as the cause "check <name>".
class StateCheck : public Hook {
 public:
  /// allowed[k] = whether the arm may stand at states[k], rad, base to tip. Spans of equal size.
  virtual void states(std::span<const Config> states, std::span<bool> allowed) = 0;

  /// The joints move straight from `from` to `to`; a continuous joint's `to` is the image that it moves to.
  struct Motion {
    Config from, to;
  };
  /// Whether motions are checked as well, or states alone.
  [[nodiscard]] virtual bool checks_motions() const { return false; }
  /// The same of motions, whose ends are allowed.
  virtual void motions(std::span<const Motion>, std::span<bool>) {}
};

/// A cost of the user's: what the states of all layers cost, the first and the last included, is added to the cost of the path's
/// steps.
class StateCost : public Hook {
 public:
  /// costs[k] = what states[k] costs, from 0 to 1000 times Lattice::cost_unit (1 for weights of 1); it counts in multiples of 2^-40
  /// units. States are within the limits, but may be in collision. Spans of equal size.
  virtual void costs(std::span<const Config> states, std::span<double> costs) = 0;
};

struct Hooks {
  std::shared_ptr<StateCheck> check;  // shared: by plans and their caller
  std::shared_ptr<StateCost> cost;
};

}  // namespace swivel
