// SPDX-License-Identifier: BSD-3-Clause
// Writes and reads the rows of strokes and their motions in time, in files of all formats.
// docs/formats.md "Jobs".
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "motions/messages.hpp"
#include "motions/trajectory_formats.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/given_answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns true if a row of a stroke has a roll other than 0.
[[nodiscard]] bool any_rolls(const ArmAnswer& arm);

/// Returns the fields of a row without a place on a stroke: those before the joints are empty.
[[nodiscard]] std::string placeless_fields(const TrajectoryRow& row, bool roll, std::size_t joints);

/// Returns for each part of a job's motion the index of its stroke; none for transitions.
[[nodiscard]] std::vector<std::optional<std::size_t>> strokes_of_parts(const ArmMotion& motion,
                                                                       const Problem& job);
/// Throws InputError if a stroke begins and ends between two samples of a motion.
void require_samples_of_strokes(const ArmMotion& motion, const Problem& job);
/// Returns the events of a job's motion as messages. Throws as require_samples_of_strokes() does.
[[nodiscard]] std::vector<EventMessage> event_messages(const ArmMotion& motion, const Problem& job);

/// Reads the rows of a job from a file of any format. Rows of messages get from their events what
/// those of a table state by themselves: stroke and process, and s where a run begins, where its
/// process is switched, and where it ends. Throws InputError.
[[nodiscard]] FileRows read_rows_of_job(const std::filesystem::path& file,
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

/// Returns the parts that rows without times are. Throws InputError, by row, for strokes that the
/// problem does not have or that come twice, for transitions that follow each other, for parts of
/// one row, and for strokes whose `process` is nowhere 1 or at two places.
[[nodiscard]] GivenArm parts_of(const FileRows& read, const Problem& problem);
/// Returns the motion that rows with times are: its rows, parts, rate, duration, events and roll; s
/// of an event that the file does not state is not a number. Throws InputError, by row, for strokes
/// that the problem does not have or that come twice, for strokes without a transition between them
/// or, if there is a home, from it or to it, and for strokes whose `process` is nowhere 1 or at two
/// places.
[[nodiscard]] GivenArm motion_of(const FileRows& read, const Problem& problem,
                                 const JointNames& joint_names);
/// Loads the rows of strokes, with times or without. Where lift-offs are allowed, strokes may be in
/// runs named "<stroke>/1", "<stroke>/2", ..., whose s is that of the whole stroke; s of rows that
/// are returned begins at 0 in each run. Reads the file once, which may be a pipe. Throws
/// InputError as the two above do, and by row for runs that are not in this order, that leave some
/// of the stroke out, or that overlap by less than LiftOffs::overlap.
[[nodiscard]] GivenAnswer load_strokes(const std::filesystem::path& file, const Problem& problem,
                                       const JointNames& joint_names);

}  // namespace swivel::io
