// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// The ends of a path at which a problem may give the joints: PathProblem::start stands at the
/// first layer, PathProblem::end at the last one.
enum class PathEnd { kFirst, kLast };

/// Returns the joints that the problem gives for an end of the path, which must be set. The roll of
/// an arm of six joints is counted from the frame of that layer (counted_from_path()).
[[nodiscard]] Config joints_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                                  const ToolPath& path);

/// Throws InputError if the joints that the problem gives for an end of the path, which must be
/// set, are outside their limits, or if their tool pose is too far from that layer's. Allowed are
/// PathProblem::start_tolerance (m and rad) for the start, and 1e-6 m and rad for the end.
void validate_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                    const ToolPath& path);

/// Returns the roll, rad, at which the tool stands in the joints that the problem gives for an end
/// of the path, taken into `range` if that is less than a turn. Throws InputError if the range or
/// the waypoints' windows do not allow it.
[[nodiscard]] double roll_of_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                                   const ToolPath& path, const Roll& range);

}  // namespace swivel
