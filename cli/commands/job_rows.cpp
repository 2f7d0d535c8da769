// SPDX-License-Identifier: BSD-3-Clause
#include "commands/job_rows.hpp"

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/job/check_job.hpp"

namespace swivel::cli {

std::vector<Part> parts_of(const PreparedRobot& robot, const Problem& job,
                           const io::JobTrajectory& read) {
  std::vector<Part> parts;
  for (const io::JobTrajectoryPart& part : read.parts) {
    Part& made = parts.emplace_back();
    made.rows = part.rows;
    if (part.stroke.empty()) continue;
    const auto stroke = find_stroke(job, part.stroke);
    if (!stroke)
      throw InputError(formatted("data row %zu: stroke: ", part.first_row + 1) + "'" + part.stroke +
                       "' is no stroke of the job: allowed are the names of its strokes");
    made.run = StrokeRun{*stroke, begins_at_last_waypoint(robot, job, *stroke, part.rows)};
  }
  return parts;
}

}  // namespace swivel::cli
