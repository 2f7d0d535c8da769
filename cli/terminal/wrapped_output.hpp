// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace swivel::cli {

/// If standard output is a terminal, breaks lines wider than it between words from now on; a
/// terminal would break them inside numbers. Otherwise does nothing.
void wrap_standard_output();

/// Returns a line (without its newline) broken at spaces into lines of at most `columns`; those
/// after the first are indented by four columns more. A line stays whole if too few columns are
/// left beside its indent. Letters beyond ASCII count as one column, escape sequences (ESC [ ...
/// letter) as none.
[[nodiscard]] std::string wrapped(std::string_view line, std::size_t columns);
/// Returns a text with every line broken as by wrapped().
[[nodiscard]] std::string wrapped_lines(std::string_view lines, std::size_t columns);

}  // namespace swivel::cli
