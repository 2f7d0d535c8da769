// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// Tool path: header x,y,z,qw,qx,qy,qz; at least two rows. Quaternions as written, of length 1 within 1e-3.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& csv);

/// PROBLEM.yaml, docs/formats.md. Unknown keys are errors with the nearest known key named.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);

/// The text of a problem file in which the objects of the scene stand as in `placed`, and nothing else is changed: comments, order
/// and layout stay. Reading it gives the poses of `placed` bit for bit. Throws InputError, in the name of `problem.source`, where
/// the text does not say a pose in a way that can be edited in place, and where more than objects have moved: waypoints in the
/// base frame.
[[nodiscard]] std::string with_poses(const std::string& text, const Problem& problem, const Problem& placed);

}  // namespace swivel::io
