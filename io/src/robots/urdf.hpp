// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <set>
#include <string>

#include "meshes/mesh_name.hpp"
#include "swivel/core/problem/robot_model.hpp"
#include "swivel/io/robots/robot.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"

namespace swivel::io {

/// A robot without its SRDF, and the names of links and joints in its file that were left out.
struct UrdfRobot {
  std::shared_ptr<RobotModel> model;
  std::set<std::string> left_out;
};

/// Loads a robot from its URDF, with the URDF's limits: keep_limits() narrows them. Throws
/// InputError.
[[nodiscard]] UrdfRobot load_urdf(const std::filesystem::path& urdf, const Packages& packages,
                                  const RobotOptions& options);

}  // namespace swivel::io
