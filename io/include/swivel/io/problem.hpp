// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <vector>

#include "swivel/core/problem.hpp"

namespace swivel::io {

/// Tool path: header x,y,z,qw,qx,qy,qz; at least two rows. Quaternions as written, of length 1 within 1e-3.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& csv);

/// PROBLEM.yaml, docs/formats.md. Unknown keys are errors with the nearest known key named.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);

}  // namespace swivel::io
