// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the trajectory of a job. docs/formats.md "Jobs".
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/job_result.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns TRAJ.csv of a job: the columns of a trajectory, then `stroke` and `process`. Rows of the
/// parts follow each other, ends of transitions included, which are the rows beside them once more.
/// It has the column `roll` if a row of a stroke has a roll.
[[nodiscard]] std::string to_job_csv(const JobResult& result, const Job& job);

/// A part of a job's trajectory as read from a file: a run of a stroke, or a transition.
struct JobTrajectoryPart {
  std::string stroke;         ///< name; empty for a transition
  std::size_t first_row = 0;  ///< of the file's data rows, from 0
  /// At least two. Of a transition s, phi, branch and roll are 0 and mean nothing.
  std::vector<TrajectoryRow> rows;
  /// The rows on the stroke itself, rather than on its approach or retract: from the first to the
  /// last. Of a transition they mean nothing.
  std::size_t first_process = 0, last_process = 0;
};

/// A job's trajectory as read from a file.
struct JobTrajectory {
  std::vector<JobTrajectoryPart> parts;
  bool rolls = false;  ///< whether the file has the column `roll`
};

/// Loads what to_job_csv() writes, for the joints of an arm. Throws InputError, by row, for columns
/// other than these in this order, for strokes that come twice, for transitions that follow each
/// other, for parts of one row, and for strokes whose `process` is nowhere 1 or at two places.
[[nodiscard]] JobTrajectory load_job_trajectory(const std::filesystem::path& csv,
                                                const JointNames& joint_names);

}  // namespace swivel::io
