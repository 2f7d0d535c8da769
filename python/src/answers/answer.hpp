// SPDX-License-Identifier: BSD-3-Clause
// Answers as Python holds them. They are shared, so that arrays are views which outlive the object
// from which they were read.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bindings.hpp"
#include "base/trajectory.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::python {

/// The answer to a problem of any kind. It outlives the problem and its planner.
struct Answer {
  std::shared_ptr<const swivel::Answer> found;
  /// The strokes, home and order of arms of which `found` is, without robots and scene: what
  /// without_surroundings() leaves of executed_problem().
  std::shared_ptr<const swivel::Problem> executed;
  MotionRequest asked = {};
  bool own_functions = false;  ///< it depends on checks or costs that are functions of Python
  /// The problem as it was given, of which reports are made. Null after unpickling.
  std::shared_ptr<const swivel::Problem> given = nullptr;

  [[nodiscard]] bool has_two_arms() const { return found->arms.size() == 2; }
  /// Returns whether each arm runs one path and nothing else.
  [[nodiscard]] bool has_paths() const { return has_two_arms() || is_path(*executed); }
};

/// Leaves out the problem, which would be most of an answer.
template <class A>
void serialize(A& archive, Answer& x) {
  auto& [found, executed, asked, own_functions, given] = x;
  archive(found, executed, asked, own_functions);
}

/// What an answer says of one of its arms.
struct Arm {
  Answer of;
  std::size_t number = 0;
  [[nodiscard]] const ArmAnswer& found() const { return of.found->arms[number]; }
  [[nodiscard]] Trajectory trajectory_of(const std::vector<TrajectoryRow>& rows) const {
    return {std::shared_ptr<const std::vector<TrajectoryRow>>(of.found, &rows),
            found().joint_names};
  }
};

/// A part of what an arm does: a run of a stroke, or a transition.
struct Part {
  Trajectory trajectory;
  std::optional<std::string> stroke;  ///< none of a transition; "" of a path
  bool reversed = false;
  std::optional<double> cost;  ///< none of a part that was not planned
  std::optional<std::array<std::string, 2>> barred_by;
  std::vector<bool> process;  ///< by rows; empty: not stated
  /// Arc length of the whole stroke at which its run begins, m: not 0 only behind a lift-off.
  double begin = 0;
};

struct RefinedPath {
  std::shared_ptr<const Refined> refined;
  io::JointNames joint_names;
};

/// What a plan found out about a run of a stroke, or about a path.
struct Run {
  std::shared_ptr<const RunAnswer> found;
  std::string stroke;
  std::optional<double> cost;  ///< in the answer; none if there is no answer
  std::optional<RefinedPath> refinement;
};

/// A place at which the tool lifts off within a stroke.
struct LiftOffPlace {
  std::string stroke;
  LiftOffAnswer found;  ///< its lengths count the approach of the stroke
};

/// The motion of an answer in time, or why there is none; of one of two arms or of all arms.
struct Motion {
  Answer of;  ///< has the motion; of motions that were loaded or timed no more than that
  std::optional<std::size_t> arm = {};  ///< set of one of two arms
  /// What the check of the motion found, for which there is none; empty: nothing.
  std::string fault = {};

  [[nodiscard]] const MotionTiming& timing() const { return *of.found->motion; }
  [[nodiscard]] bool executable() const { return timing().motion && fault.empty(); }
  /// Returns the motion of all arms. Throws ValueError if there is none.
  [[nodiscard]] const swivel::Motion& motion() const;
};

/// What an independent look at rows found.
struct Check {
  AnswerCheck result;
  /// Whether result.failures has the failures of runs as well (AnswerCheck::failures).
  bool has_strokes = false;
};

/// Whether there is a figure, as to_string() says it.
using MeasureStatusName = Typed<"Literal['measured', 'none', 'not_measured']">;

/// Returns the number of the arm whose word `name` is asked for. Throws AttributeError where there
/// are two arms.
[[nodiscard]] Arm arm_of(const Answer& answer, const char* name);
[[nodiscard]] inline const Arm& arm_of(const Arm& arm, const char* /*name*/) {
  return arm;
}
/// Throws AttributeError for a word `name` that only arms with one path and nothing else have, or
/// only those with strokes.
void require_path(const Answer& answer, const char* name);
void require_strokes(const Answer& answer, const char* name);

/// Returns what Answer::executed holds of a problem.
[[nodiscard]] std::shared_ptr<const swivel::Problem> without_surroundings(
    const swivel::Problem& problem);
/// Returns the answer to a problem as Python holds it.
[[nodiscard]] Answer made_answer(swivel::Answer found, swivel::Problem given, MotionRequest asked);
/// Returns parts of an arm as Python holds them.
[[nodiscard]] std::vector<Part> parts_of(const Arm& arm, const std::vector<swivel::Part>& parts);
/// Returns what was found out about each run of an arm.
[[nodiscard]] std::vector<Run> runs_of(const Arm& arm);
/// Returns what refining made of a run of an arm, by its number; nothing where none was asked for
/// or there is no answer.
[[nodiscard]] std::optional<RefinedPath> refinement_of(const Arm& arm, std::size_t run);
/// Returns the places at which the tool of an arm lifts off.
[[nodiscard]] std::vector<LiftOffPlace> lift_offs_of(const Arm& arm);
/// Returns the runs of an arm in their order, of answers and of motions that were timed or loaded.
[[nodiscard]] std::vector<StrokeRun> order_of(const ArmAnswer& arm);
/// Returns the name of a run for people: "stroke 'ring' backwards".
[[nodiscard]] std::string run_words(const std::string& stroke, bool reversed);
/// Returns what became of a motion in a line for people.
[[nodiscard]] std::string motion_words(const Motion& motion);
[[nodiscard]] std::string refined_words(const Refined& refined);
/// Returns the joints of all rows as an array, (n, 7), rad.
[[nodiscard]] py::array_t<double> joints_of(const Trajectory& trajectory);
/// Returns the names that a caller gives to joints, or those of seven unnamed ones. Throws
/// ValueError for another number of names.
[[nodiscard]] io::JointNames to_joint_names(const std::vector<std::string>& names,
                                            std::size_t width = kDof);

/// Throws ValueError if this build has no pages.
void require_pages();
/// Returns work done by name, as JSON names it.
[[nodiscard]] Typed<"dict[str, int]"> counters_of(const Counters& c);

void bind_measures(py::module_& m);
void bind_rows(py::module_& m);
void bind_parts_of_answers(py::module_& m);
void bind_motion(py::module_& m);
void bind_answer(py::module_& m);
void bind_check(py::module_& m);
void bind_advice(py::module_& m);

}  // namespace swivel::python
