// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Returns the rates of the problem's limits, else of the robot model, else 10 rad/s^2 and 100
/// rad/s^3. Throws InputError for a joint without a speed limit. `source` is the file for messages.
[[nodiscard]] JointRates joint_rates(const Chain& chain, const Limits& limits,
                                     const std::string& source);

/// Times a motion from rest to rest at the tool speed asked for, as fast as was found within the
/// joints' rates. Speeds are as high as speeds, accelerations and jerks allow on the path's
/// geometry; forward and backward passes bound the acceleration along the path (Bobrow, Dubowsky,
/// Gibson 1985), a moving average over time its jerk (Biagiotti & Melchiorri 2008, "trajectories by
/// FIR filters"). The motion is verified and slowed down where it is too fast, until it is not;
/// what was slowed down too much is sped up again. Between two samples the tool is no faster than
/// asked, along its path and in turning (to 5e-7 of it). Samples are exact solutions on the path.
/// Deterministic. Returns a failure where the arm has no solution or jumps. Throws Stopped.
[[nodiscard]] TimingResult time_path(const PathMotion& motion, const JointRates& rates,
                                     const TimingOptions& options, const Budget& budget = {});

}  // namespace swivel
