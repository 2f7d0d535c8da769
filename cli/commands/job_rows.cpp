// SPDX-License-Identifier: BSD-3-Clause
#include "commands/job_rows.hpp"

#include <algorithm>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/job/check_job.hpp"

namespace swivel::cli {

std::vector<JobPart> parts_of(const PreparedRobot& robot, const Job& job,
                              const io::JobTrajectory& read) {
  std::vector<JobPart> parts;
  for (const io::JobTrajectoryPart& part : read.parts) {
    JobPart& made = parts.emplace_back();
    made.rows = part.rows;
    if (part.stroke.empty()) continue;
    const auto stroke = std::find_if(job.strokes.begin(), job.strokes.end(),
                                     [&](const Stroke& one) { return one.name == part.stroke; });
    if (stroke == job.strokes.end())
      throw InputError(formatted("data row %zu: stroke: ", part.first_row + 1) + "'" + part.stroke +
                       "' is no stroke of the job: allowed are the names of its " + "strokes");
    const auto index = static_cast<std::size_t>(stroke - job.strokes.begin());
    made.run = StrokeRun{index, begins_at_last_waypoint(robot, job, index, part.rows)};
  }
  return parts;
}

std::vector<StrokeRun> order_of(const PreparedRobot& robot, const Job& job,
                                const io::JobMotionFile& read) {
  std::vector<StrokeRun> order;
  for (std::size_t k = 0; k < read.strokes.size(); ++k) {
    const std::size_t part = job.home ? 2 * k + 1 : 2 * k;
    const auto own = std::find(read.motion.part.begin(), read.motion.part.end(), part);
    // A run begins with the last row of the transition before it.
    const auto row = static_cast<std::size_t>(own - read.motion.part.begin());
    const TrajectoryRow& first = read.motion.rows[row > 0 ? row - 1 : 0].row;
    order.push_back(
        {read.strokes[k], begins_at_last_waypoint(robot, job, read.strokes[k], {first})});
  }
  return order;
}

}  // namespace swivel::cli
