// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace swivel::bench {

/// Returns what a measured number depends on besides the source: commit, compiler, flags, build
/// type, vector unit, processor and its threads.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> context();

}  // namespace swivel::bench
