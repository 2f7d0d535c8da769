// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace swivel::cli {

// All commands print through say(), say_text() and complain(). Names of files, links and objects
// come from files and may hold anything; characters that a terminal would obey or hide (control
// characters, changes of the writing direction) are printed as '?'.

/// Prints to standard output as std::printf() does in the locale "C".
[[gnu::format(printf, 1, 2)]] void say(const char* format, ...);
/// Prints a text to standard output.
void say_text(std::string_view text);
/// Prints to standard error as std::fprintf() does in the locale "C". If that is a terminal, breaks
/// lines wider than it between words.
[[gnu::format(printf, 1, 2)]] void complain(const char* format, ...);

/// Returns the number of columns of the terminal at standard output or another stream; 100 if that
/// is no terminal.
inline int terminal_columns(int descriptor = STDOUT_FILENO) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 100;
}

/// Returns whether standard output is a terminal and the user accepts colours
/// (https://no-color.org).
inline bool coloured() {
  const char* no_colour = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) && (no_colour == nullptr || *no_colour == '\0');
}

}  // namespace swivel::cli
