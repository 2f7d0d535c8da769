// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/results/given_answer.hpp"

#include <utility>
#include <variant>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/jobs/job_trajectory.hpp"
#include "swivel/io/workcells/workcell_csv.hpp"

namespace swivel::io {

namespace {

/// Returns an arm whose rows all belong to its only stroke.
GivenArm arm_of(std::vector<TrajectoryRow> rows, std::vector<TimedRow> timed,
                const Stated& stated) {
  const StrokeRun run{0, false};
  GivenArm arm{.stated = stated};
  if (timed.empty()) {
    arm.parts.push_back({.run = run, .rows = std::move(rows)});
    return arm;
  }
  arm.motion.emplace().rows = std::move(timed);
  arm.order = {run};
  return arm;
}

GivenArm arm_of(const JobTrajectory& read, const Problem& problem,
                const std::filesystem::path& file) {
  GivenArm arm{.stated = read.stated};
  for (const JobTrajectoryPart& part : read.parts) {
    Part& made = arm.parts.emplace_back();
    made.rows = part.rows;
    std::vector<bool>& process = arm.process.emplace_back(part.rows.size());
    if (part.stroke.empty()) continue;
    const auto stroke = find_stroke(problem, part.stroke);
    if (!stroke)
      throw InputError(file.string() + ": " +
                       formatted("data row %zu: stroke: ", part.first_row + 1) + "'" + part.stroke +
                       "' is no stroke of the job: allowed are the names of its strokes");
    made.run = StrokeRun{*stroke, false};
    for (std::size_t row = part.first_process; row <= part.last_process; ++row) process[row] = true;
  }
  return arm;
}

GivenArm arm_of(JobMotionFile read) {
  GivenArm arm{.motion = std::move(read.motion), .stated = read.stated};
  for (const std::size_t stroke : read.strokes) arm.order.push_back({stroke, false});
  return arm;
}

}  // namespace

GivenAnswer load_answer(const std::filesystem::path& file, const Problem& problem,
                        const std::vector<JointNames>& joint_names) {
  GivenAnswer given{problem, {}};
  if (problem.arms.size() == 2) {
    WorkcellRows read = load_workcell_rows(file, {problem.arms[0].name, problem.arms[1].name},
                                           {joint_names.at(0), joint_names.at(1)});
    for (std::size_t k = 0; k < 2; ++k)
      given.arms.push_back(
          arm_of(std::move(read.rows[k]), std::move(read.timed[k]), read.stated[k]));
  } else if (is_path(problem)) {
    TrajectoryFile read = load_trajectory_file(file, joint_names.front());
    given.arms.push_back(arm_of(std::move(read.rows), std::move(read.timed), read.stated));
  } else {
    ExecutedJobRows read = load_executed_rows(file, problem, joint_names.front());
    given.problem = std::move(read.job);
    if (auto* const motion = std::get_if<JobMotionFile>(&read.rows))
      given.arms.push_back(arm_of(std::move(*motion)));
    else
      given.arms.push_back(arm_of(std::get<JobTrajectory>(read.rows), given.problem, file));
  }
  return given;
}

}  // namespace swivel::io
