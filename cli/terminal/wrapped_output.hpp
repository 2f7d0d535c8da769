// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace swivel::cli {

/// Where standard output is a terminal, lines wider than it are from now on broken between words: a
/// terminal breaks them inside numbers. Elsewhere lines stay as they are printed.
void wrap_standard_output();

/// A line, without its end, in lines of at most `columns` where spaces allow; those after the first
/// stand four columns further in. Letters beyond ASCII count as one column, escape sequences (ESC [
/// ... letter) as none.
[[nodiscard]] std::string wrapped(std::string_view line, std::size_t columns);
/// Every line of a text.
[[nodiscard]] std::string wrapped_lines(std::string_view lines, std::size_t columns);

}  // namespace swivel::cli
