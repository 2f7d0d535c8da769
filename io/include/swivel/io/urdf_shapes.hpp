// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "swivel/core/shape.hpp"

namespace swivel::io {

/// Of each of a link's collision shapes, in their order, what takes its place, in the link's frame; empty: the shape stays.
using ShapesInstead = std::map<std::string, std::vector<std::vector<PlacedShape>>>;

/// The text of a URDF with spheres and capsules in place of some collision shapes, all else as it was. A capsule, which URDF does
/// not have, is a cylinder between two spheres; robot_bodies() make it one again. Relative names of the meshes that are left are
/// made those of `folder`, where the text is to lie. Throws InputError.
[[nodiscard]] std::string urdf_with_shapes(const std::filesystem::path& urdf, const ShapesInstead& instead,
                                           const std::filesystem::path& folder);

}  // namespace swivel::io
