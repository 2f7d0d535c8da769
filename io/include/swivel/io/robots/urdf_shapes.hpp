// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// Of each of a link's shapes, in their order, what takes its place, in the link's frame; empty: the shape is taken as it is.
using ShapesInstead = std::map<std::string, std::vector<std::vector<PlacedShape>>>;

/// Of which elements the shapes are.
enum class ShapesOf { kCollision, kVisual };

/// The text of a URDF with spheres and capsules in place of some collision shapes, all else as it was; with kVisual, of links whose
/// visual shapes are given, with collision shapes beside these. A capsule is written as a cylinder between two spheres, which
/// readers of URDF 1.0 know; robot_bodies() make it one again. Relative names of meshes are made those of `folder`, where the text
/// is to lie. Throws InputError.
[[nodiscard]] std::string urdf_with_shapes(const std::filesystem::path& urdf, const ShapesInstead& instead,
                                           const std::filesystem::path& folder, ShapesOf of = ShapesOf::kCollision);

/// The robot of a URDF with the visual shapes of the links that have no collision shape, as if they were these, and no other
/// shapes. Throws InputError.
[[nodiscard]] std::shared_ptr<const RobotModel> load_visual_shapes(const std::filesystem::path& urdf,
                                                                   const std::map<std::string, std::filesystem::path>& packages);

}  // namespace swivel::io
