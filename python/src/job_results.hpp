// SPDX-License-Identifier: BSD-3-Clause
// Answers about jobs as Python holds them, which outlive the job that was planned.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problem.hpp"
#include "results.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/time_job.hpp"

namespace swivel::python {

/// A part of a job: a run of a stroke, or a transition.
struct JobPart {
  std::shared_ptr<const std::vector<TrajectoryRow>> rows;  // shared with arrays and other answers
  io::JointNames joint_names;
  std::optional<std::string> stroke;  ///< none of a transition
  bool reversed = false;
  std::optional<double> cost;  ///< none of a part that was not planned
  std::optional<std::array<std::string, 2>> barred_by;
  std::vector<bool> process;  ///< by rows; empty: not stated
  /// Arc length of the whole stroke at which its run begins, m: not 0 only behind a lift-off.
  double begin = 0;
};

/// A place at which the tool lifts off within a stroke.
struct LiftOffPlace {
  std::string stroke;
  LiftOffAnswer result;
};

/// What a plan found out about a run.
struct JobRun {
  std::shared_ptr<const RunAnswer> result;
  std::string stroke;
  std::optional<double> cost;  ///< in the job; none if there is no job
};

struct JobPlan {
  std::shared_ptr<const Answer> plan;
  /// The job's strokes, home and order, by which the answer is written; without robot and scene.
  /// Runs between lift-offs are strokes of their own.
  std::shared_ptr<const swivel::Problem> job;
  std::optional<TimingOptions> timing = {};  ///< set where a motion was asked for
  /// The job as it was given, of which reports are made. Null after unpickling.
  std::shared_ptr<const swivel::Problem> given = nullptr;
  [[nodiscard]] const Answer& result() const { return *plan; }
};

struct JobMotion {
  std::shared_ptr<const MotionTiming> timing;
  std::shared_ptr<const swivel::Problem> job;  ///< as JobPlan has it
  std::vector<StrokeRun> order;                ///< of the runs
  io::JointNames joint_names;
  /// What the check of the motion found, for which it is none; empty: nothing.
  std::string fault;
  /// Throws ValueError if it is not executable.
  [[nodiscard]] std::shared_ptr<const swivel::ArmMotion> motion() const;
};

struct JobCheck {
  AnswerCheck result;
  io::JointNames joint_names;
};

/// Returns what JobPlan::job holds of a job.
[[nodiscard]] std::shared_ptr<const swivel::Problem> without_surroundings(
    const swivel::Problem& job);
[[nodiscard]] std::vector<JobPart> parts_of(const JobPlan& plan,
                                            const std::vector<swivel::Part>& of);
void bind_job_results(py::module_& m);
void bind_job_functions(py::module_& m);
/// Returns the motion of a plan. Throws ValueError if it has none.
[[nodiscard]] JobMotion motion_of(const JobPlan& plan);

}  // namespace swivel::python
