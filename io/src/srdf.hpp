// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

#include "swivel/core/robot_model.hpp"

namespace swivel::io {

/// Fills has_srdf and disabled_pairs; names need not exist in the robot. Throws InputError.
void load_srdf(const std::filesystem::path& srdf, RobotModel& robot);

}  // namespace swivel::io
