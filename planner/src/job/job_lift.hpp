// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Adds whole turns to the joints of a job's parts, so that each part begins where the one before
/// ends and no joint jumps: of joints that the lattice treats as circles, and of continuous ones.
/// A job begins at `home`, if given, else where its first run does. Returns which bounded joints
/// then leave their limits, do not come back to `home`, or are not at the given end of a stroke
/// (Stroke::end); the parts mean nothing if there are any.
[[nodiscard]] Lattice::Joints lift(std::vector<Part>& parts, const Lattice& lattice,
                                   const Problem& job);

}  // namespace swivel
