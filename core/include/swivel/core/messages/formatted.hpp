// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdarg>
#include <string>

namespace swivel {

/// What std::printf prints of it where the locale is "C": numbers have a decimal point in every program, and none are grouped. The
/// format is a literal of ours, never a user's text.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);
[[nodiscard, gnu::format(printf, 1, 0)]] std::string formatted_list(const char* format, std::va_list arguments);

}  // namespace swivel
