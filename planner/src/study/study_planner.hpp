// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/study/study_failure.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

class LatticeCache;

/// The answer to a problem of a campaign or of placements.
struct StudiedAnswer {
  Answer answer;
  /// Where the motion that is given does not keep its limits here: why. `answer` says no more then
  /// than that there is none.
  std::optional<StudyFailure> fault{};
  /// Returns why the infeasible problem has no answer.
  [[nodiscard]] StudyFailure failure(const Problem& problem) const {
    return fault ? *fault : failure_of(answer, problem);
  }
  /// Returns true if the plan has its verdict, and what was asked for besides, as far as time was
  /// left for it. `budget` is that of the plan.
  [[nodiscard]] bool known(const Budget& budget) const;
};

/// Plans problems which differ in where things are, one after the other on one thread. What one
/// path takes from earlier problems changes no answer.
class StudyPlanner {
 public:
  /// `robot`: prepared for `like`; null for two arms, which are prepared for each problem anew.
  /// Throws InvalidArgument for what validate() refuses, for a robot that was prepared otherwise,
  /// and for options that the kind of problem does not have. `lattices`: where lattices of paths
  /// come from, which others share; nothing is then kept of what was found out of obstacles,
  /// because in scenes that have little in common it costs more than it saves. Null: the planner of
  /// a path keeps its own, and what it found out.
  StudyPlanner(std::shared_ptr<const PreparedRobot> robot, const Problem& like,
               const PlanOptions& options, std::shared_ptr<LatticeCache> lattices = nullptr);
  /// Throws as plan(), plan_job() and plan_workcell() do, but for a given motion that is barred by
  /// an object where it now stands; Stopped.
  [[nodiscard]] StudiedAnswer plan(const Problem& problem, const PlanOptions& options,
                                   const Budget& budget);
  /// Returns the planner of a problem of one path; null for others.
  [[nodiscard]] Planner* planner() { return planner_ ? &*planner_ : nullptr; }

 private:
  std::shared_ptr<const PreparedRobot> robot_;
  std::optional<Planner> planner_;
};

}  // namespace swivel
