// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/motion/timed_path.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// What the joints of a chain can do: by the limits, else by the robot model; 10 rad/s^2 and 100 rad/s^3 where neither says. Throws
/// InputError for a joint without a speed limit. `source`: for messages.
[[nodiscard]] JointRates joint_rates(const Chain& chain, const Limits& limits, const std::string& source);

/// The fastest motion that was found at the tool speed asked for, within the rates of the joints, from rest to rest: as fast as
/// speeds, accelerations and jerks of the path's geometry allow, forward and backward passes for the acceleration along the path
/// (Bobrow, Dubowsky, Gibson 1985), a moving average over time for its jerk (Biagiotti & Melchiorri 2008, "trajectories by FIR
/// filters"), then verified, and slowed down where it is too fast, until it is not; what was slowed down too much is sped up again.
/// Between any two samples the tool is no faster than asked, along its path and in turning (5e-7 of it).
/// Samples are exact solutions on the path.
/// Deterministic. Throws InputError for rates that are missing, Stopped; returns NoMotion where the arm has no solution or jumps.
[[nodiscard]] TimingResult time_path(const PathMotion& motion, const JointRates& rates, const TimingOptions& options,
                                     const Budget& budget = {});

}  // namespace swivel
