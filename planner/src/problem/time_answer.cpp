// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/problem/time_answer.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "problem/given_rows.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/complete_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/problem/given_answer.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"

namespace swivel {

namespace {

/// Returns the runs among parts.
std::vector<StrokeRun> runs_among(const std::vector<Part>& parts) {
  std::vector<StrokeRun> runs;
  for (const Part& part : parts)
    if (part.run) runs.push_back(*part.run);
  return runs;
}

/// Times rows that a file states.
class AnswerTimer {
 public:
  AnswerTimer(const PreparedProblem& prepared, GivenAnswer given, const MotionRequest& asked,
              bool proves, const Budget& budget)
      : prepared_(prepared),
        given_(std::move(given)),
        asked_(asked),
        timing_(asked.timing.value()),
        proof_(proves ? std::optional<CheckOptions>({.margins = false, .budget = budget})
                      : std::nullopt),
        budget_(budget) {}

  TimedAnswer run() {
    Answer& answer = timed_.answer;
    answer.status = PlanStatus::kSolved;
    answer.timing = timing_;
    answer.arms.resize(prepared_.arms());
    for (std::size_t k = 0; k < answer.arms.size(); ++k) {
      answer.arms[k].joint_names = prepared_.joint_names(k);
      if (prepared_.has_two_arms()) answer.arms[k].name = prepared_.two_arms().name(k);
    }
    if (prepared_.has_two_arms())
      time_two_arms(prepared_.two_arms());
    else if (is_path(given_.problem))
      time_path(prepared_.robot());
    else
      time_strokes(prepared_.robot());
    return std::move(timed_);
  }

 private:
  void time_path(const PreparedRobot& robot) {
    const PathProblem problem = path_of(given_), smoothed = with_motion_defaults(problem);
    const GivenArm& arm = given_.arms.front();
    // The rows of a motion are at points of the path with rounded corners.
    std::vector<TrajectoryRow> rows =
        arm.motion ? rows_at_layers(robot, smoothed, rows_of(*arm.motion), arm.stated, budget_)
                   : rows_at_layers(robot, problem, arm.parts.front().rows, arm.stated, budget_);
    MotionPlan made;
    if (asked_.refine) {
      made.refinement = refine(robot, smoothed, rows_on_path(robot, smoothed, rows), {}, budget_);
      rows = made.refinement->rows;
    }
    made.motion = time_trajectory(robot, problem, rows, timing_, budget_);
    if (made.motion->motion && proof_)
      require_passed(check_motion(robot, problem, made.motion->motion->rows, *proof_));
    Answer answer = answer_of(std::move(made), timing_);
    timed_.answer.refinement = std::move(answer.refinement);
    timed_.answer.refined = answer.refined;
    timed_.answer.motion = std::move(answer.motion);
    take(0, std::move(rows));
  }

  void time_strokes(const PreparedRobot& robot) {
    const Problem& problem = given_.problem;
    std::vector<Part>& parts = timed_.answer.arm().parts = proved_parts(robot);
    if (asked_.refine) {
      const Problem smoothed = with_motion_defaults(problem);
      for (Part& part : parts)
        if (part.run)
          part.rows = rows_on_path(robot, problem_of_run(smoothed, *part.run), part.rows);
      RefinedJobMotion found =
          refine_and_time_job(robot, problem, std::move(parts), timing_, {}, budget_);
      parts = std::move(found.parts);
      timed_.answer.refined = found.refinement.any();
      timed_.answer.refinement = std::move(found.refinement);
      timed_.answer.motion = std::move(found.timing);
    } else {
      timed_.answer.motion = time_job(robot, problem, parts, timing_, budget_);
    }
    std::optional<Motion>& motion = timed_.answer.motion->motion;
    if (!motion || !proof_) return;
    CheckOptions options = *proof_;
    if (timing_.speed > 0) options.speed = timing_.speed;
    const AnswerCheck check =
        check_job_motion(robot, problem, runs_among(parts), motion->arms.front(), options);
    if (!check.passed) timed_.fault = check.failures.front();
  }
  /// Returns the parts with the rows of runs at layers. Throws InputError unless they are proved to
  /// be the problem's.
  std::vector<Part> proved_parts(const PreparedRobot& robot) {
    const Problem& problem = given_.problem;
    const auto require_check = [&](const Problem& of, const std::vector<Part>& parts) {
      const AnswerCheck check = check_job(robot, of, parts, {.margins = false, .budget = budget_});
      if (!check.passed)
        throw InputError(check.failures.front() + ": allowed is a job that passes `swivel check`");
    };
    given_ = complete_answer(prepared_, std::move(given_), budget_);
    GivenArm& arm = given_.arms.front();
    if (arm.motion) {
      std::vector<Part> parts = parts_of_motion(robot, problem, arm.order, *arm.motion, budget_);
      // The rows are on the paths as motions follow them.
      require_check(with_motion_defaults(problem), parts);
      return parts;
    }
    require_check(problem, arm.parts);
    for (Part& part : arm.parts)
      if (part.run)
        part.rows =
            rows_at_layers(robot, problem_of_run(problem, *part.run), part.rows, {}, budget_);
    return std::move(arm.parts);
  }

  void time_two_arms(const PreparedWorkcell& prepared) {
    auto rows = rows_of_both_at_layers(prepared);
    Answer& answer = timed_.answer;
    if (asked_.refine) {
      auto found = refine_and_time_workcell(prepared, rows, timing_, budget_);
      answer.refinement = std::move(found.refinement);
      answer.refined = answer.refinement->any();
      answer.motion = std::move(found.timing);
      for (std::size_t k = 0; k < 2; ++k) rows[k] = answer.refinement->runs[k].rows;
    } else {
      answer.motion = time_workcell(prepared, rows, timing_, budget_);
    }
    if (const Motion* const motion = answer.timed(); motion != nullptr && proof_)
      require_passed(
          check_workcell_motion(prepared, {motion->arms[0].rows, motion->arms[1].rows}, *proof_));
    for (std::size_t k = 0; k < 2; ++k) take(k, std::move(rows[k]));
  }
  std::array<std::vector<TrajectoryRow>, 2> rows_of_both_at_layers(
      const PreparedWorkcell& prepared) {
    const std::array<Stated, 2> stated = stated_of_both(given_);
    if (given_.has_times()) return rows_at_layers(prepared, timed_of_both(given_), stated, budget_);
    if (!stated[0].rows() || !stated[1].rows())
      return complete_rows(PreparedWorkcell(given_.problem, budget_), rows_of_both(given_), stated,
                           budget_);
    return rows_of_both(given_);
  }

  /// Takes the rows of an arm that does one stroke.
  void take(std::size_t arm, std::vector<TrajectoryRow> rows) {
    timed_.answer.arms[arm].parts.push_back({.run = StrokeRun{0, false}, .rows = std::move(rows)});
  }

  const PreparedProblem& prepared_;
  GivenAnswer given_;
  const MotionRequest& asked_;
  const TimingOptions& timing_;
  const std::optional<CheckOptions> proof_;
  const Budget& budget_;
  TimedAnswer timed_;
};

}  // namespace

TimedAnswer time_answer(const PreparedProblem& prepared, GivenAnswer given,
                        const MotionRequest& asked, bool proves, const Budget& budget) {
  return AnswerTimer(prepared, std::move(given), asked, proves, budget).run();
}

}  // namespace swivel
