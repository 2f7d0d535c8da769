// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace swivel::cli {

inline constexpr const char* kPackagesHelp = "NAME=FOLDER, where meshes of package://NAME/... lie";

/// Returns what --packages says, as a map from package name to folder. Throws InputError for an
/// item that is not NAME=FOLDER.
[[nodiscard]] std::map<std::string, std::filesystem::path> parse_packages(
    const std::vector<std::string>& items);

}  // namespace swivel::cli
