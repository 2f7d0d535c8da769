// SPDX-License-Identifier: BSD-3-Clause
// What a problem may hold, whether it comes from files or from a program.
#pragma once
#include <string>
#include <string_view>

namespace swivel {

/// Sizes and coordinates, m. Beyond it distances between bodies are no longer right to 0.05 mm.
inline constexpr double kMostMetres = 1000;
inline constexpr double kMostStartTolerance = 0.1;  ///< m and rad

/// Names of links, joints, bodies and frames stand in messages, JSON, SVG, pages and on terminals: UTF-8 that XML can hold, without
/// control characters (C0, DEL, C1, and what turns the direction of writing or breaks lines), and not empty.
[[nodiscard]] bool is_valid_name(std::string_view name);
/// Completes "allowed is ...".
inline constexpr const char* kValidName = "a name in UTF-8 without control characters";

/// The text with '?' for every byte that is not part of a valid name: for messages about it.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace swivel
