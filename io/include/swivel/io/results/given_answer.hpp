// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <vector>

#include "swivel/core/answer/given_answer.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Loads a trajectory or a motion of a problem: all that Swivel writes, and files of other
/// programs. Of one path it reads what load_trajectory_file() reads; of strokes the columns
/// `stroke` and `process` besides, in messages the events; of two arms the columns of an arm with
/// "_" and its name, and the joints of both. Values that the file does not state are 0, which
/// complete_answer() works out. Where strokes may have lift-offs, the file may have runs named
/// "<stroke>/1", "<stroke>/2", ...; s of rows begins at 0 in each run. Reads the file once, which
/// may be a pipe. `joint_names` has those of each arm. Throws InputError, by row, for rows that are
/// none of this problem: strokes that it does not have or that come twice, parts of one row,
/// transitions that follow each other or are missing where the rows have times, `process` that is
/// nowhere 1 in a stroke or at two places, runs that leave some of their stroke out, and times that
/// do not ascend.
[[nodiscard]] GivenAnswer load_answer(const std::filesystem::path& file, const Problem& problem,
                                      const std::vector<JointNames>& joint_names);

}  // namespace swivel::io
