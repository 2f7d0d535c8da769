// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// Loads a tool path from a table or an APT file, docs/formats.md: m unless the file says another
/// unit. Quaternions stay as written. Where the file has the tool's axis alone, how far waypoints
/// are turned about it is arbitrary. Throws InputError.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& file);

/// Loads a problem file and the files that it names, docs/formats.md: with `arms` two arms, with
/// `strokes` or allowed lift-offs the strokes of one, else one path. It reads the file once, which
/// may be a pipe. Throws InputError; for an unknown key it names the nearest known key.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);
/// Loads a problem file with `path` and without lift-offs as what its one path poses. Throws
/// InputError as load_problem() does, and for any other problem file.
[[nodiscard]] PathProblem load_path_problem(const std::filesystem::path& yaml);
/// Loads a problem file with `path` or `strokes` as strokes: a path is a stroke named "path".
/// Throws InputError as load_problem() does.
[[nodiscard]] Problem load_job(const std::filesystem::path& yaml);
/// Loads a problem file with `arms`. Throws InputError as load_problem() does, and for a file
/// without them.
[[nodiscard]] Problem load_workcell(const std::filesystem::path& yaml);

/// Returns the text of a problem file that gives this problem when it is loaded as `file`:
/// rotations to a rounding error, everything else bit for bit. Of a problem that was loaded from a
/// file it is the text of that file with what has changed since: the rest keeps its text, order and
/// comments, new keys are added in the order of docs/formats.md, and names of files are changed to
/// mean the same files from the folder of `file`. A problem without a source is written whole,
/// without defaults. Throws InvalidArgument for a problem that makes no sense, and InputError for
/// what no file can say or what cannot be changed in place, if the file that it was loaded from
/// cannot be read any more, and if `file` is one of those that it names.
[[nodiscard]] std::string problem_text(const PathProblem& problem,
                                       const std::filesystem::path& file);
/// Returns such a text of a problem of one arm with strokes. Throws alike.
[[nodiscard]] std::string problem_text(const Problem& problem, const std::filesystem::path& file);

/// Writes problem_text() to a file, which is replaced as a whole or left as it was. Throws as
/// problem_text() does, and InputError if the file cannot be written.
void save_problem(const PathProblem& problem, const std::filesystem::path& file);
void save_problem(const Problem& problem, const std::filesystem::path& file);

/// Turns waypoints of a tool that may turn freely about its z axis by half a turn about that axis
/// where they would turn by 180 deg from the one before, about another axis: which way such a turn
/// leads is undefined, and half a turn about the tool's axis changes nothing for the work. Readers
/// of files do this; problems that are made in memory may need it. Waypoints that make no such turn
/// stay, bit for bit.
void choose_sides(std::vector<Waypoint>& waypoints);

/// Returns the text of a problem file with the scene objects at the poses, and the joints of
/// Robot::hold at the positions, that they have in `placed` and nothing else changed: comments,
/// order and layout stay. Loading it gives them bit for bit. `text` is the text that `problem` was
/// loaded from. Throws InputError, in the name of `problem.source`, if the text states one of them
/// in a way that cannot be edited in place, and if waypoints in the base frame have moved.
[[nodiscard]] std::string with_poses(const std::string& text, const PathProblem& problem,
                                     const PathProblem& placed);

}  // namespace swivel::io
