// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// By link, for each of its shapes in their order, the shapes that take its place, in the link's
/// frame; if these are empty, the shape stays.
using ShapesInstead = std::map<std::string, std::vector<std::vector<PlacedShape>>>;

/// Which elements of a link the shapes replace: <collision>, or <visual>.
enum class ShapesOf { kCollision, kVisual };

/// Returns the text of a URDF with spheres and capsules in place of some collision shapes and all
/// else unchanged. With kVisual, links whose visual shapes are given get collision shapes beside
/// these. A capsule is written as a cylinder between two spheres, which readers of URDF 1.0 know;
/// robot_bodies() joins them again. Relative names of meshes are rewritten for `folder`, where the
/// text is to be stored. Throws InputError.
[[nodiscard]] std::string urdf_with_shapes(const std::filesystem::path& urdf,
                                           const ShapesInstead& instead,
                                           const std::filesystem::path& folder,
                                           ShapesOf of = ShapesOf::kCollision);

/// Loads the robot of a URDF with the visual shapes of those links that have no collision shape, as
/// if they were collision shapes, and with no other shapes. Throws InputError.
[[nodiscard]] std::shared_ptr<const RobotModel> load_visual_shapes(
    const std::filesystem::path& urdf,
    const std::map<std::string, std::filesystem::path>& packages);

/// A robot with its visual shapes in place of its collision shapes; null where there is none.
struct VisualRobot {
  std::shared_ptr<const RobotModel> model;
  std::vector<std::string> left_out;  ///< a message for each visual shape that cannot be read
};
/// Loads the visual shapes of a robot from its files. Returns no robot if it has none, or if its
/// URDF cannot be read once more, as one from a pipe cannot.
[[nodiscard]] VisualRobot load_visuals(const RobotModel& robot);

}  // namespace swivel::io
