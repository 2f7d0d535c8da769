// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <set>
#include <string>

#include "files/xml.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// Reads an SRDF into the robot: fills has_srdf, disabled_pairs and Joint::passive, and adds
/// warnings about unknown elements and about names that the robot does not have. `left_out` are
/// links and joints of its URDF that the model leaves out. Throws InputError.
void load_srdf(const XmlSource& srdf, RobotModel& robot, const std::set<std::string>& left_out);

}  // namespace swivel::io
