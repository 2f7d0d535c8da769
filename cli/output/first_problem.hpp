// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::cli {

/// The files that a problem names its robot by.
struct RobotFiles {
  std::filesystem::path urdf, srdf;  ///< empty: no SRDF
  std::map<std::string, std::filesystem::path> packages;
  std::vector<std::string> without;
};

/// Returns the text of a problem file to begin with: robot, tool at the tip, the two waypoints of a
/// first path, and the limits that most jobs set, with comments. Names of files are relative to the
/// folder that `file` is in, for a text that is to be written to `file`.
[[nodiscard]] std::string first_problem(const RobotFiles& files, const Robot& robot,
                                        const ArmModel& arm, const std::vector<Waypoint>& waypoints,
                                        const std::filesystem::path& file);

}  // namespace swivel::cli
