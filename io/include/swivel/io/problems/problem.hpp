// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// Loads a tool path from a table or an APT file, docs/formats.md: m unless the file says another
/// unit. Quaternions stay as written. Where the file has the tool's axis alone, how far waypoints
/// are turned about it is arbitrary. Throws InputError.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& file);

/// Loads a problem file and the files that it names, docs/formats.md. Throws InputError; for an
/// unknown key it names the nearest known key.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);

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
[[nodiscard]] std::string with_poses(const std::string& text, const Problem& problem,
                                     const Problem& placed);

}  // namespace swivel::io
