// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the trajectory of a job and its motion in time. docs/formats.md "Jobs".
#pragma once
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

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

/// A job's trajectory as read from a file. Values that the file does not state are 0.
struct JobTrajectory {
  std::vector<JobTrajectoryPart> parts;
  Stated stated;  ///< complete_parts() works out the rest
};

/// Loads the trajectory of a job, for the joints of an arm: CSV with columns by name, as of one
/// path, and `stroke` and `process`. Throws InputError, by row, for strokes that come twice, for
/// transitions that follow each other, for parts of one row, for strokes whose `process` is nowhere
/// 1 or at two places, and for a file with times.
[[nodiscard]] JobTrajectory load_job_trajectory(const std::filesystem::path& csv,
                                                const JointNames& joint_names);

/// Returns the motion of a job as CSV: the columns of to_timed_csv(), then `stroke` and `process`.
/// The row at which a stroke begins has its s, arm angle, branch and roll, though its `stroke` is
/// empty where it ends a transition; other rows of transitions have none. `process` is 1 from the
/// event that switches it on to the row before the one that switches it off. Throws InputError if
/// both events of a stroke are at the same row.
[[nodiscard]] std::string to_job_motion_csv(const ArmMotion& motion, const Problem& job,
                                            const JointNames& joint_names);
/// Returns the motion of a job in the format of the file name's ending: .csv as
/// to_job_motion_csv(), .json or .yaml as to_trajectory_json() and to_trajectory_yaml(), with the
/// events of the process as the key `events`, .mcap as to_mcap(), with the events as messages in
/// JSON on the topic /process. Each event says from when to when, and from where to where, the run
/// of its stroke goes. Throws InputError for any other ending, and as to_job_motion_csv().
[[nodiscard]] std::string job_motion_text(const ArmMotion& motion, const Problem& job,
                                          const JointNames& joint_names,
                                          const std::string& frame_id,
                                          const std::filesystem::path& file);

/// The motion of a job as read from a file. Values of rows that the file does not state are 0; s of
/// an event that it does not state is not a number.
struct JobMotionFile {
  ArmMotion motion;                  ///< its rows, parts, rate, duration, events and roll
  std::vector<std::size_t> strokes;  ///< of its runs, in their order: indices in Problem::strokes
  Stated stated;                     ///< complete_job_motion() works out the rest
};
/// Loads the motion of a job, for the joints of its arm: all formats of job_motion_text(), CSV with
/// columns by name, as of one path, and `stroke` and `process`. Throws InputError, by row, for
/// times that do not ascend, for strokes that the job does not have or that come twice, for strokes
/// without a transition between them or, if the job has a home, from it or to it, for strokes whose
/// `process` is nowhere 1 or at two places, and for a file without times.
[[nodiscard]] JobMotionFile load_job_motion(const std::filesystem::path& file, const Problem& job,
                                            const JointNames& joint_names);

/// Rows of a job as read from a file, with the job of which they are: where the file has lift-offs,
/// with_lift_offs() makes it of the problem's.
struct ExecutedJobRows {
  Problem job;
  std::variant<JobTrajectory, JobMotionFile> rows;  ///< s begins at 0 in each run
};
/// Loads rows as load_job_rows() does. Where the job allows lift-offs, strokes may be in runs named
/// "<stroke>/1", "<stroke>/2", ..., whose s is that of the whole stroke. Throws InputError, by row,
/// for runs that are not in this order, that leave some of the stroke out, or that overlap by less
/// than LiftOffs::overlap.
[[nodiscard]] ExecutedJobRows load_executed_rows(const std::filesystem::path& file,
                                                 const Problem& job, const JointNames& joint_names);

/// Loads a job's motion as load_job_motion() does if the file has times, else its trajectory as
/// load_job_trajectory() does. It reads the file once, which may be a pipe. Throws InputError.
[[nodiscard]] std::variant<JobTrajectory, JobMotionFile> load_job_rows(
    const std::filesystem::path& file, const Problem& job, const JointNames& joint_names);

}  // namespace swivel::io
