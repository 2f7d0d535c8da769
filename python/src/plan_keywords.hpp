// SPDX-License-Identifier: BSD-3-Clause
// Keywords that functions which plan and time have.
#pragma once
#include <optional>

#include "base/bindings.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel::python {

/// Returns options of a plan. `planner`: a PlannerKind or its name; `threads`: 0 to 1024, 0 for all
/// cores; `timeout`: s; `prove`: whether answers are proved. Throws ValueError, which names the
/// keyword, for other values.
[[nodiscard]] PlanOptions to_plan_options(const py::object& planner, int threads,
                                          std::optional<double> timeout, bool prove = true);
/// Returns a function that passes progress on to Python every 20 ms at most: often enough to look
/// smooth, and seldom enough to cost nothing. It is empty for None. The Python object must outlive
/// it. Throws TypeError for what cannot be called.
[[nodiscard]] ProgressFunction to_progress(const py::object& progress);
/// Returns seconds, or none for None. Throws ValueError unless they are positive.
[[nodiscard]] std::optional<double> to_timeout(std::optional<double> timeout);

/// What plan() is asked, as Python keywords.
struct PlanKeywords {
  py::object planner;
  int threads = 0;
  std::optional<double> timeout;
  bool prove = true, evidence = false;
  /// The caller's own functions of arrays of states; None where there is none.
  py::object check, check_motions, cost;
  py::object progress;
  /// Returns the options, whose hooks call the functions with states of the robot's arm. The
  /// functions must outlive them, and the interpreter's lock must be held where the options are
  /// destroyed. Throws ValueError, TypeError and InputError.
  [[nodiscard]] PlanOptions options(const Robot& robot) const;
  [[nodiscard]] bool has_own_functions() const {
    return !check.is_none() || !check_motions.is_none() || !cost.is_none();
  }
};

/// How a motion is asked for, as Python keywords.
struct MotionKeywords {
  std::optional<double> speed, turn_speed, rate, chord;
  /// Returns the timing of a motion: where no speed is given at limits.tool_speed, the lower one of
  /// two arms', and of strokes at the speed of each. Throws ValueError for numbers that are not
  /// allowed, and where there is no speed.
  [[nodiscard]] TimingOptions timing(const swivel::Problem& problem) const;
  /// Returns the timing of a motion that plan() is asked for; none where it is not. Throws
  /// ValueError as above, and for a keyword of motions where a speed must be given and is not.
  [[nodiscard]] std::optional<TimingOptions> asked_timing(const swivel::Problem& problem) const;
};

/// Returns the function that Python calls with the keywords of plan(), in their order: it calls
/// plan(self, PlanKeywords, refine, MotionKeywords).
template <class Self, class Plan>
auto with_plan_keywords(const Plan& plan) {
  return
      [plan](Self self, OrName<PlannerKind> planner, int threads, std::optional<double> timeout,
             bool prove, bool evidence, Typed<"_Check"> check, Typed<"_MotionCheck"> check_motions,
             Typed<"_Check"> cost, ProgressCallback progress, bool refine,
             std::optional<double> speed, std::optional<double> turn_speed,
             std::optional<double> rate, std::optional<double> chord) {
        const PlanKeywords keywords{std::move(planner),
                                    threads,
                                    timeout,
                                    prove,
                                    evidence,
                                    std::move(check),
                                    std::move(check_motions),
                                    std::move(cost),
                                    std::move(progress)};
        return plan(self, keywords, refine, MotionKeywords{speed, turn_speed, rate, chord});
      };
}

}  // namespace swivel::python
