// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/problem/path_problem.hpp"

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

/// Returns the directions in which moves are tried, unit vectors in the base frame, without their
/// opposites: the axes of the base frame, and those of an object that stands slanted, since bodies
/// part along the normals of its faces.
[[nodiscard]] std::vector<Vector3d> directions_of_moves(const std::vector<SceneObject>& scene = {},
                                                        const std::string& object = {});

/// The lengths of moves that are tried: `least`, twice as much, ... `most`, m.
struct MoveLengths {
  double least, most;
};
inline constexpr MoveLengths kObjectMoves{0.005, Advice::kMostMove};
inline constexpr MoveLengths kPathMoves{0.01, Advice::kMostPathMove};

/// Finds the shortest move that helps, along one of some directions (directions_of_moves()) or
/// against it; one of more than 20 mm is then shortened to an eighth of its length. `offset`: the
/// member of the advice that is the move. `plan(advice)` sets the outcome of `advice`; the outcome
/// of `best` is unknown where time was up before a move was found to help.
template <class OneAdvice, class Plan>
void find_shortest_move(OneAdvice& best, const MoveLengths& lengths,
                        const std::vector<Vector3d>& directions, Plan plan,
                        Vector3d Advice::*offset = &Advice::offset) {
  constexpr double kShort = 0.02;
  using Outcome = Advice::Outcome;
  const OneAdvice unmoved = best;
  bool all_tried = true;
  for (double way = lengths.least;
       way <= lengths.most * (1 + 1e-9) && best.outcome != Outcome::kSolved; way *= 2)
    for (const Vector3d& direction : directions)
      for (const double sign : {1.0, -1.0}) {
        OneAdvice moved = unmoved;
        moved.*offset = sign * way * direction;
        plan(moved);
        all_tried = all_tried && moved.outcome != Outcome::kUnknown;
        if (moved.outcome == Outcome::kUnknown) break;
        const bool better =
            moved.outcome < best.outcome ||
            (moved.outcome == best.outcome &&
             (moved.outcome == Outcome::kSolved ? moved.cost < best.cost
                                                : moved.reached_s > best.reached_s));
        if (better) best = std::move(moved);
      }
  const Vector3d longest = best.*offset;
  if (best.outcome == Outcome::kSolved && longest.norm() > kShort * (1 + 1e-9)) {
    double short_of = 0.5, enough = 1;  // shares of it
    for (int k = 0; k < 2; ++k) {
      const double share = (short_of + enough) / 2;
      OneAdvice shorter = unmoved;
      shorter.*offset = share * longest;
      plan(shorter);
      if (shorter.outcome == Outcome::kUnknown) break;
      if (shorter.outcome == Outcome::kSolved)
        best = std::move(shorter), enough = share;
      else
        short_of = share;
    }
  }
  if (best.outcome != Outcome::kNoHelp) return;
  best = unmoved;  // no single move is to be named
  if (all_tried) best.outcome = Outcome::kNoHelp;
}

}  // namespace swivel
