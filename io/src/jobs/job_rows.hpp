// SPDX-License-Identifier: BSD-3-Clause
// What is common to trajectories and motions of jobs, in files of all formats.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "motions/messages.hpp"
#include "motions/trajectory_formats.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/io/jobs/job_trajectory.hpp"

namespace swivel::io {

/// Returns true if a row of a stroke has a roll other than 0.
[[nodiscard]] bool any_rolls(const ArmAnswer& arm);

/// Returns the fields of a row without a place on a stroke: those before the joints are empty.
[[nodiscard]] std::string placeless_fields(const TrajectoryRow& row, bool roll);

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

/// Returns the parts of a trajectory without times. Throws InputError as load_job_trajectory()
/// does.
[[nodiscard]] JobTrajectory trajectory_of(const FileRows& read);
/// Returns the motion that rows with times are. Throws InputError as load_job_motion() does.
[[nodiscard]] JobMotionFile motion_of(const FileRows& read, const Problem& job,
                                      const JointNames& joint_names);

}  // namespace swivel::io
