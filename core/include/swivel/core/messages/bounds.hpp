// SPDX-License-Identifier: BSD-3-Clause
// Bounds on what a problem may hold, whether it comes from files or from a program.
#pragma once
#include <string>
#include <string_view>

namespace swivel {

/// The largest size or coordinate, m. Beyond it distances between bodies are not accurate to 0.05
/// mm.
inline constexpr double kMostMetres = 1000;
/// The largest Task::start_tolerance, m and rad.
inline constexpr double kMostStartTolerance = 0.1;

/// Returns true if a text may name a link, joint, body or frame: it is UTF-8 that XML can hold, not
/// empty, and without control characters (C0, DEL, C1, and invisible ones that turn the direction
/// of writing or break lines). Names stand in messages, JSON, SVG, pages and on terminals.
[[nodiscard]] bool is_valid_name(std::string_view name);
/// Says what is_valid_name() allows, to complete a message "allowed is ...".
inline constexpr const char* kValidName = "a name in UTF-8 without control characters";

/// Returns the text with '?' in place of every byte that no valid name may hold: for messages that
/// quote an invalid one.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace swivel
