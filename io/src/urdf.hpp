// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>

#include "mesh_name.hpp"
#include "swivel/core/robot_model.hpp"

namespace swivel::io {

/// The robot without its SRDF. Throws InputError.
[[nodiscard]] std::shared_ptr<RobotModel> load_urdf(const std::filesystem::path& urdf, const Packages& packages);

}  // namespace swivel::io
