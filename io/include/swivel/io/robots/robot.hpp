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

/// Options for loading a robot model from its URDF.
struct RobotOptions {
  std::vector<std::string> without;  ///< links to leave out, with all that they carry
  /// joints keep the soft limits of their <safety_controller>, if these are narrower
  bool soft_limits = true;
  /// joint limits of MoveIt, joint_limits.yaml; empty: none. They narrow the URDF's ranges, and
  /// their rates stand in place of the URDF's.
  std::filesystem::path joint_limits = {};
  /// joint -> range, rad or m, within that of the URDF; a continuous joint becomes a revolute one
  std::map<std::string, Joint::Range> limits = {};
};

/// Loads a robot from a URDF 1.0 to 1.2, and an SRDF if not empty. Meshes have package:// names
/// (`packages`: name -> folder; else walk up from the URDF), or file://, absolute or relative ones.
/// Every element and attribute that states geometry, limits or which joints move is read or
/// refused; elsewhere names that the formats do not have give a warning (RobotModel::warnings).
/// Visuals, materials, inertias and the data of simulators and drivers are not read, and may be
/// wrong. Throws InputError.
[[nodiscard]] std::shared_ptr<const RobotModel> load_robot(
    const std::filesystem::path& urdf, const std::filesystem::path& srdf = {},
    const std::map<std::string, std::filesystem::path>& packages = {},
    const RobotOptions& options = {});

/// Loads a robot from the text of a URDF, and of an SRDF if not empty, as load_robot() does from
/// files. Relative names of meshes are relative to the current folder. Throws InputError.
[[nodiscard]] std::shared_ptr<const RobotModel> parse_robot(
    const std::string& urdf, const std::string& srdf = {},
    const std::map<std::string, std::filesystem::path>& packages = {},
    const RobotOptions& options = {});

/// A planning group of an SRDF: joints that move together while all others rest.
struct PlanningGroup {
  std::string name;
  /// Names of its movable joints, base to tip where they are one chain.
  std::vector<std::string> joints;
  /// The link that carries the first joint and the link that the last one carries, fixed joints
  /// included; both empty unless the joints lie on one way from the robot's root outwards.
  std::string base_link, tip_link;
};
/// Returns the planning groups of the text of an SRDF, in its order: of chains, joints, links and
/// other groups. What the robot does not have is left out. Throws InputError.
[[nodiscard]] std::vector<PlanningGroup> planning_groups(const std::string& srdf,
                                                         const RobotModel& robot);

/// Counts the shapes of a URDF.
struct ShapeSurvey {
  std::size_t collision = 0;      ///< <collision> elements
  std::size_t visual_meshes = 0;  ///< meshes in <visual> elements
  /// a message for each mesh in a <collision> that is not found
  std::vector<std::string> missing_meshes;
};

/// Loads links and joints of a URDF, and an SRDF if not empty, without shapes: meshes are not read.
/// Fills in `shapes`. Throws InputError.
[[nodiscard]] std::shared_ptr<const RobotModel> load_kinematics(
    const std::filesystem::path& urdf, const std::filesystem::path& srdf,
    const std::map<std::string, std::filesystem::path>& packages, const RobotOptions& options,
    ShapeSurvey& shapes);

}  // namespace swivel::io
