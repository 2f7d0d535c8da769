// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// Code of a user's program that takes part in planning. Its answers must depend on the states
/// alone: the same at every call, in any order and in any batches. An exception that it throws
/// leaves plan() as it is, and the planner stays usable.
class Hook {
 public:
  Hook() = default;
  Hook(const Hook&) = delete;
  Hook& operator=(const Hook&) = delete;
  virtual ~Hook() = default;

  /// Returns the name that stands in verdicts and messages.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Returns true if plans on several threads may call the hook at the same time; else they take
  /// turns. One plan calls it from the thread of plan() alone, one call after the other.
  [[nodiscard]] virtual bool concurrent() const { return false; }
  /// Returns the mutex that a plan holds while it calls a hook that is not concurrent().
  [[nodiscard]] std::timed_mutex& turn() { return turn_; }

 private:
  std::timed_mutex turn_;
};

/// A user's own rule on joint positions, besides limits, manipulability and collision: no path goes
/// through what it refuses. It is asked in batches, only about states that all other rules allow,
/// and named as the cause "check <name>". On the straight moves of transitions between strokes it
/// is asked about states at most 0.05 rad (or m) of each joint apart, and about the motions from
/// each of these to the next.
class StateCheck : public Hook {
 public:
  /// Sets allowed[k] to whether the arm may stand at states[k], joint positions in rad, base to
  /// tip. Both spans have equal size.
  virtual void states(std::span<const Config> states, std::span<bool> allowed) = 0;

  /// A motion that is linear in joint space, rad. The `to` of a continuous joint is the image (with
  /// its whole turns) that it moves to.
  struct Motion {
    Config from, to;
  };
  /// Returns true if motions() is to be asked too, not states() alone.
  [[nodiscard]] virtual bool checks_motions() const { return false; }
  /// Sets allowed[k] to whether the arm may move along motions[k], whose ends states() has allowed.
  /// Both spans have equal size. Called only where checks_motions().
  virtual void motions(std::span<const Motion>, std::span<bool>) {}
};

/// A user's own cost of states: the cost of a path is that of its steps plus that of the states of
/// all its layers, the first and the last included. So arms without an arm angle have nodes at
/// every layer then (on_all_layers()); an S-R-S arm with a roll has nodes at knots, and the states
/// there count. Transitions between strokes cost what their moves do.
class StateCost : public Hook {
 public:
  /// Sets costs[k] to the cost of states[k], from 0 to 1000 times Lattice::cost_unit (1 where all
  /// weights are 1); the planner rounds it to multiples of 2^-40 units. States (rad, base to tip)
  /// are within the joint limits, but may be in collision. Both spans have equal size.
  virtual void costs(std::span<const Config> states, std::span<double> costs) = 0;
};

/// A program's hooks; null: none.
struct Hooks {
  std::shared_ptr<StateCheck> check;  // shared by plans and their caller
  std::shared_ptr<StateCost> cost;
};

}  // namespace swivel
