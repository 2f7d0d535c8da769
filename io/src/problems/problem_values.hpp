// SPDX-License-Identifier: BSD-3-Clause
// What a problem file says of a problem or a job, as YAML values.
#pragma once
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::io {

/// Returns a folder, the working one if its name is empty, by its absolute name without links.
[[nodiscard]] std::filesystem::path canonical_folder(const std::filesystem::path& folder);

/// Returns the name of a file or folder for a problem file in `folder`: relative to it, or absolute
/// where the two have no folder but the root in common.
[[nodiscard]] std::string name_seen_from(const std::filesystem::path& folder,
                                         const std::filesystem::path& name);

/// Returns the number of coordinates of a robot's arm, as files have them; 7 where its files do not
/// tell.
[[nodiscard]] std::size_t coordinates_of(const Robot& robot);

/// Returns all keys of a problem file, in the order of the schema, with defaults of numbers and
/// words stated. Names of files are those seen from `folder`; paths are waypoints, not files.
/// Bodies that are fixed to a link are listed in `scene`, not in `robot.attached`, where
/// `scene_names`, the names of the scene of a file in their order, has them. Throws InputError, in
/// the name of `file`, for what no file can say.
[[nodiscard]] YAML::Node problem_values(const PathProblem& problem,
                                        const std::filesystem::path& folder,
                                        const std::vector<std::string>& scene_names,
                                        const std::string& file);

/// How the file of a job states what it could state in several ways.
struct JobLayout {
  bool path = false;               ///< it has `path` instead of `strokes`
  std::vector<std::string> scene;  ///< names of the bodies in its scene, in their order
  /// names of the strokes that have an `approach` or a `retract` of their own
  std::set<std::string> with_approach, with_retract;
};
/// Returns all keys of the file of a job, as problem_values() does. Throws InputError alike.
[[nodiscard]] YAML::Node job_values(const Problem& job, const std::filesystem::path& folder,
                                    const JobLayout& layout, const std::string& file);

/// Returns the values without those that hold where a file does not state them.
[[nodiscard]] YAML::Node without_defaults(const YAML::Node& values, const Robot& robot);

}  // namespace swivel::io
