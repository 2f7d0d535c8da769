// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Access to a limit of a problem, as a number that may be unset.
struct LimitPlace {
  std::function<std::optional<double>(const Limits&)> get;
  std::function<void(Limits&, double)> set;
};
/// Returns the place of the limit that a change is about.
[[nodiscard]] LimitPlace place_of(Advice::Change change);
/// Returns true if a smaller value relaxes the limit.
[[nodiscard]] bool relaxed_downwards(Advice::Change change);
/// Returns the value that relaxes a limit as far as is sensible: 0, or an eighth or eight times the
/// value `from`.
[[nodiscard]] double most_relaxed(Advice::Change change, double from);
/// Returns the rank in which changes are tried, the expensive ones last: changes that leave the
/// lattice as large as it is, a tool that may turn, more edges, more nodes, far more edges.
[[nodiscard]] int dearness(Advice::Change change);
/// Returns true for changes of the scene: all other ones are of an arm and its task.
[[nodiscard]] bool is_of_scene(Advice::Change change);

/// Makes the change of an arm and its task.
void change_arm(const Advice& advice, Robot& robot, Task& task);
/// Makes the change of the scene.
void change_scene(const Advice& advice, std::vector<SceneObject>& scene,
                  std::vector<Variation>& vary);
/// Returns the object with all allowed depths multiplied by `factor`.
[[nodiscard]] SceneObject deeper(SceneObject object, double factor);

/// Plans with the limit `advice.from` relaxed to `most`; if that solves the problem, bisects for
/// the strictest value that does, to a sixteenth of the way. `plan(advice)` sets the outcome of
/// `advice`.
template <class OneAdvice, class Plan>
void relax_to_strictest(OneAdvice& advice, double most, Plan plan) {
  double strict = *advice.from;
  advice.to = most;
  plan(advice);
  if (advice.outcome != Advice::Outcome::kSolved) return;
  for (int k = 0; k < 4; ++k) {
    OneAdvice stricter = advice;
    stricter.to = (strict + *advice.to) / 2;
    plan(stricter);
    if (stricter.outcome == Advice::Outcome::kSolved)
      advice = stricter;
    else if (stricter.outcome == Advice::Outcome::kUnknown)
      break;
    else
      strict = *stricter.to;
  }
}

/// Finds the shortest move by a quarter, a half or all of `most`, m, along an axis of the base
/// frame that helps. `plan(advice)` sets the outcome of `advice`.
template <class OneAdvice, class Plan>
void find_shortest_move(OneAdvice& best, double most, Plan plan) {
  const OneAdvice unmoved = best;
  for (double way = most / 4; way <= most && best.outcome != Advice::Outcome::kSolved; way *= 2)
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        OneAdvice moved = unmoved;
        moved.offset[axis] = sign * way;
        plan(moved);
        if (moved.outcome == Advice::Outcome::kUnknown) break;
        const bool better =
            moved.outcome < best.outcome ||
            (moved.outcome == best.outcome &&
             (moved.outcome == Advice::Outcome::kSolved ? moved.cost < best.cost
                                                        : moved.reached_s > best.reached_s));
        if (better) best = std::move(moved);
      }
  // no single move is to be named
  if (best.outcome == Advice::Outcome::kNoHelp) best.offset.setZero(), best.reached_s.reset();
}

}  // namespace swivel
