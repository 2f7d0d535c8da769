// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <vector>

#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// A tool path as its CSV file has it.
struct PathFile {
  std::vector<Waypoint> waypoints;
  std::vector<double> feeds;  ///< m/s, one for each waypoint; empty without the column `feed`
};

/// Loads a tool path as load_path() does. The file may have a last column `feed` where `feeds` is
/// true. Throws InputError.
[[nodiscard]] PathFile load_path_file(const std::filesystem::path& csv, bool feeds);

}  // namespace swivel::io
