// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/timed_path.hpp"

namespace swivel {

/// Times straight moves in joint space through `corners` (rad, at least two), from rest to rest at
/// each of them: all joints of a move start and end together, and the one that takes longest is at
/// its speed, acceleration or jerk as long as possible (double-S profile, Biagiotti & Melchiorri
/// 2008, ch. 3.4), but for stretching each move to a whole number of samples. Joints use no more
/// than the share `rapid` of their speeds. Returns samples at t = k / rate from t = 0 on, the first
/// and the last at rest; s, arm angle and branch of their rows are 0. Consecutive samples keep the
/// rates by finite differences as well.
[[nodiscard]] std::vector<TimedRow> time_joint_moves(const std::vector<Config>& corners,
                                                     const JointRates& rates, double rapid,
                                                     double rate);

}  // namespace swivel
