// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <set>
#include <string>

#include "files/xml.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// Fills has_srdf, disabled_pairs and Joint::passive, and adds warnings of what is not known and of names that the robot does not
/// have. `left_out`: links and joints that its URDF has and the model was asked to leave out. Throws InputError.
void load_srdf(const XmlSource& srdf, RobotModel& robot, const std::set<std::string>& left_out);

}  // namespace swivel::io
