// SPDX-License-Identifier: BSD-3-Clause
#include "terminal/terminal.hpp"

#include <cstdarg>
#include <cstdio>

#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "terminal/wrapped_output.hpp"

namespace swivel::cli {

namespace {

/// Returns a text, line by line, with '?' for characters that a terminal would obey or hide.
std::string shown(std::string_view text) {
  std::string result;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    result += printable(text.substr(0, end)) + '\n';
    text.remove_prefix(end + 1);
  }
  return result + printable(text);
}

}  // namespace

void say_text(std::string_view text) {
  std::fputs(shown(text).c_str(), stdout);
}

void say(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  say_text(formatted_list(format, arguments));
  va_end(arguments);
}

void complain(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string text = shown(formatted_list(format, arguments));
  va_end(arguments);
  if (isatty(STDERR_FILENO) != 0)
    text = wrapped_lines(text, static_cast<std::size_t>(terminal_columns(STDERR_FILENO)));
  std::fputs(text.c_str(), stderr);
}

}  // namespace swivel::cli
