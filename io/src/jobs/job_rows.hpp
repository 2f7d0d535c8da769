// SPDX-License-Identifier: BSD-3-Clause
// Fields of the rows of jobs, with and without times.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "files/csv.hpp"
#include "swivel/core/answer/job_result.hpp"
#include "swivel/io/jobs/job_trajectory.hpp"

namespace swivel::io {

/// Returns true if a row of a stroke of the job has a roll other than 0.
[[nodiscard]] bool any_rolls(const JobResult& result);

/// Returns the fields of a row without a place on a stroke: those before the joints are empty.
[[nodiscard]] std::string placeless_fields(const TrajectoryRow& row, bool roll);

/// Returns a field as a finite number. Throws InputError with place and column.
[[nodiscard]] double number_field(const CsvPlace& place, const std::string& column,
                                  const std::string& field);
/// Returns a field as a branch, 0 to 7. Throws InputError with the place.
[[nodiscard]] int branch_field(const CsvPlace& place, const std::string& field);
/// Returns the field `process`, 0 or 1. Throws InputError with the place.
[[nodiscard]] bool process_field(const CsvPlace& place, const std::string& field);

/// Throws InputError: the line at `where` is not this header of seven joints, which may have the
/// column roll behind phi as well. `what` is whose header is due.
[[noreturn]] void bad_header(const std::string& where, const std::string& what,
                             const std::vector<std::string>& header);

/// Reads the text of a file that to_job_csv() wrote; see load_job_trajectory().
[[nodiscard]] JobTrajectory read_job_trajectory(const std::string& file, std::string_view text,
                                                const JointNames& joint_names);
/// Reads the text of a file that to_job_motion_csv() wrote; see load_job_motion().
[[nodiscard]] JobMotionFile read_job_motion(const std::string& file, std::string_view text,
                                            const Job& job, const JointNames& joint_names);

}  // namespace swivel::io
