// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/robot_model.hpp"
#include "xml.hpp"

namespace swivel::io {

/// Fills has_srdf and disabled_pairs; names need not exist in the robot. Throws InputError.
void load_srdf(const XmlSource& srdf, RobotModel& robot);

}  // namespace swivel::io
