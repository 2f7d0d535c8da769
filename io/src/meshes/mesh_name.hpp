// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace swivel::io {

using Packages = std::map<std::string, std::filesystem::path>;

/// Returns the file that a URDF means by a mesh name: package://, file://, absolute, or relative to
/// the URDF. A package's folder is taken from `packages`, else found by walking up from the URDF:
/// by its name or, if that is not found, as a folder that holds the file and is no other package.
/// Throws InputError prefixed by `where`.
[[nodiscard]] std::filesystem::path resolve_mesh_name(const std::string& name,
                                                      const std::filesystem::path& urdf,
                                                      const Packages& packages,
                                                      const std::string& where);

}  // namespace swivel::io
