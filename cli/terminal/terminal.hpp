// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace swivel::cli {

// What commands print goes through these three: names of files, links and objects come from files
// and may hold anything, and what a terminal would obey or hide of it (control characters, turns of
// the direction of writing) is printed as '?'.

/// To standard output, as std::printf prints where the locale is "C".
[[gnu::format(printf, 1, 2)]] void say(const char* format, ...);
/// The text, to standard output.
void say_text(std::string_view text);
/// To standard error, as std::fprintf prints where the locale is "C"; where that is a terminal, in
/// lines no wider than it.
[[gnu::format(printf, 1, 2)]] void complain(const char* format, ...);

/// Of standard output, or of another stream; 100 where it is none.
inline int terminal_columns(int descriptor = STDOUT_FILENO) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 100;
}

/// https://no-color.org
inline bool coloured() {
  const char* no_colour = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) && (no_colour == nullptr || *no_colour == '\0');
}

}  // namespace swivel::cli
