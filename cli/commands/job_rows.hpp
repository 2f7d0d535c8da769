// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/jobs/job_trajectory.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::cli {

/// Returns the parts of a job that a file has. A stroke is run backwards if the tool begins at its
/// last waypoint. Throws InputError for a stroke that the job does not have.
[[nodiscard]] std::vector<Part> parts_of(const PreparedRobot& robot, const Problem& job,
                                         const io::JobTrajectory& read);

}  // namespace swivel::cli
