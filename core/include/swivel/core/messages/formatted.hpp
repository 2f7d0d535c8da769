// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdarg>
#include <string>

namespace swivel {

/// Returns what std::printf would print in the locale "C", whatever the program's locale is:
/// numbers have a decimal point, and no digits are grouped. `format` must be a literal of the
/// program, never a user's text.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);
/// Formats like formatted(), from a list of arguments.
[[nodiscard, gnu::format(printf, 1, 0)]] std::string formatted_list(const char* format,
                                                                    std::va_list arguments);
/// Returns a share of 1 as a percentage: "42 %", "3.4 %".
[[nodiscard]] std::string percent(double share);

}  // namespace swivel
