// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// The problem with what motions assume where it says nothing: the tool rounds corners (PathSmoothing's defaults), and pairs keep
/// between layers what they keep at them, Limits::clearance in place of half of it; where self_clearance is set, halves stay.
[[nodiscard]] Problem with_motion_defaults(Problem problem);
/// The second of these alone.
void keep_clearance_between_layers(Limits& limits);

}  // namespace swivel
