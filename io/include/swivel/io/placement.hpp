// SPDX-License-Identifier: BSD-3-Clause
// Placements out: the table of all, and one as a problem file. docs/formats.md "Placements".
#pragma once
#include <string>
#include <vector>

#include "swivel/core/placement.hpp"

namespace swivel::io {

/// One line a placement, in the order given.
[[nodiscard]] std::string to_csv(const std::vector<PlacementRow>& rows);

/// The text of a problem file in which the objects of the scene stand as in `placed`, and nothing else is changed: comments, order
/// and layout stay. Reading it gives the poses of `placed` bit for bit. Throws InputError, in the name of `problem.source`, where
/// the text does not say a pose in a way that can be edited in place, and where more than objects have moved: waypoints in the
/// base frame.
[[nodiscard]] std::string with_poses(const std::string& text, const Problem& problem, const Problem& placed);

}  // namespace swivel::io
