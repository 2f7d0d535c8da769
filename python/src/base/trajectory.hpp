// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::python {

/// Rows along a tool path, as Python holds them.
struct Trajectory {
  std::shared_ptr<const std::vector<TrajectoryRow>> rows;  // shared with arrays and other answers
  io::JointNames joint_names;
};

}  // namespace swivel::python
