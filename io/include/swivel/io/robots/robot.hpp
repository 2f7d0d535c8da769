// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// What a robot model has of its URDF.
struct RobotOptions {
  std::vector<std::string> without;  ///< links left out, with all that they carry
  bool soft_limits = true;           ///< joints keep the soft limits of their <safety_controller>, where these are narrower
};

/// URDF 1.0 to 1.2 (+ SRDF when not empty). Meshes through package:// (`packages`: name -> folder; else walk up from the URDF),
/// file://, absolute or relative names. Every element and attribute that states geometry, limits or which joints move is read or
/// refused; names that the formats do not have are warned of elsewhere (RobotModel::warnings). Visuals, materials, inertias and
/// what simulators and drivers keep in the file are not read, and may be as wrong as they like.
[[nodiscard]] std::shared_ptr<const RobotModel> load_robot(const std::filesystem::path& urdf,
                                                           const std::filesystem::path& srdf = {},
                                                           const std::map<std::string, std::filesystem::path>& packages = {},
                                                           const RobotOptions& options = {});

/// The same of texts, as a program holds them: relative names of meshes are those of the current folder.
[[nodiscard]] std::shared_ptr<const RobotModel> parse_robot(const std::string& urdf, const std::string& srdf = {},
                                                            const std::map<std::string, std::filesystem::path>& packages = {},
                                                            const RobotOptions& options = {});

/// What a URDF has of shapes.
struct ShapeSurvey {
  std::size_t collision = 0;                ///< <collision> elements
  std::size_t visual_meshes = 0;            ///< meshes in <visual> elements
  std::vector<std::string> missing_meshes;  ///< a message for each mesh of a <collision> that is not found
};

/// Links and joints of a URDF (+ SRDF when not empty) without shapes: meshes are not read.
[[nodiscard]] std::shared_ptr<const RobotModel> load_kinematics(const std::filesystem::path& urdf,
                                                                const std::filesystem::path& srdf,
                                                                const std::map<std::string, std::filesystem::path>& packages,
                                                                const RobotOptions& options, ShapeSurvey& shapes);

}  // namespace swivel::io
