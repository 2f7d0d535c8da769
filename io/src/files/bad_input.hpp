// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace swivel::io {

/// Throws InputError "<where>: <what>: allowed is <allowed>", always one line.
[[noreturn]] void bad_input(const std::string& where, const std::string& what,
                            const std::string& allowed);

/// Completes "allowed is ..." for sizes in metres (kMostMetres).
inline constexpr const char* kLengthAllowed = "a number > 0, at most 1000";

/// Returns "<file>:<line>", or the file alone if the line is unknown (< 1).
[[nodiscard]] std::string at_line(const std::string& file, int line);

}  // namespace swivel::io
