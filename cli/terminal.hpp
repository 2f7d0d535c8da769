// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

namespace swivel::cli {

/// Of standard output; 100 where it is none.
inline int terminal_columns() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 100;
}

/// https://no-color.org
inline bool coloured() {
  const char* no_colour = std::getenv("NO_COLOR");
  return isatty(STDOUT_FILENO) && (no_colour == nullptr || *no_colour == '\0');
}

}  // namespace swivel::cli
