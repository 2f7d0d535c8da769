// SPDX-License-Identifier: BSD-3-Clause
// Rows that a caller gives to check() and time().
#pragma once
#include <filesystem>
#include <variant>
#include <vector>

#include "answers/answer.hpp"
#include "swivel/core/answer/given_answer.hpp"

namespace swivel::python {

/// Rows of any problem: an answer, a motion, the trajectory of one path, trajectories or motions of
/// two arms by their names, the parts of strokes, or the name of a file.
using RowsByName = Typed<"Mapping[str, Trajectory] | Mapping[str, Motion]", py::dict>;
using GivenRows =
    std::variant<Answer, Motion, Trajectory, RowsByName, std::filesystem::path, std::vector<Part>>;

/// Returns whether a problem is of strokes: of one arm, and not of one path alone.
[[nodiscard]] bool has_strokes(const swivel::Problem& problem);

/// Returns rows that are no file for check_answer() and time_answer(): strokes by their names, with
/// the lift-offs that the names tell. Throws InvalidArgument for rows of another kind of problem
/// and for strokes that the problem does not have, KeyError for an arm that is missing, and
/// ValueError where there are no rows.
[[nodiscard]] GivenAnswer given_answer(const swivel::Problem& problem, const GivenRows& rows);

}  // namespace swivel::python
