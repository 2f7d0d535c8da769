// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// Returns the first thing in which two problems differ, in the words of a problem file; empty if
/// they are equal. Names of files, warnings and the order of attached bodies do not count, nor does
/// the tolerance of a start that there is not. Rotations may differ by 4e-15.
[[nodiscard]] std::string difference(const PathProblem& a, const PathProblem& b);
/// Returns the first thing in which two jobs differ, likewise.
[[nodiscard]] std::string difference(const Problem& a, const Problem& b);

}  // namespace swivel::io
