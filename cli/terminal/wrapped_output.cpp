// SPDX-License-Identifier: BSD-3-Clause
#include "terminal/wrapped_output.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns the number of columns that a word takes.
std::size_t width_of(std::string_view word) {
  std::size_t width = 0;
  bool escape = false;
  for (const char c : word) {
    if (escape) {
      escape = !(c >= '@' && c <= '~' && c != '[');
      continue;
    }
    escape = c == '\033';
    // Bytes of a letter after its first one, and escape sequences, take no column.
    width += !escape && (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }
  return width;
}

/// Writes a text to standard output. Returns false, and sets errno, if it is not taken.
bool write_out(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(STDOUT_FILENO, text.data(), text.size());
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

/// Writes whole lines, which a line-buffered stream passes on, wrapped. Returns 0 on failure.
ssize_t write_wrapped(void*, const char* bytes, std::size_t count) {
  return write_out(wrapped_lines({bytes, count}, static_cast<std::size_t>(terminal_columns())))
             ? static_cast<ssize_t>(count)
             : 0;
}

}  // namespace

std::string wrapped(std::string_view line, std::size_t columns) {
  // A line is broken only if that many columns are left beside its indent.
  constexpr std::size_t kNarrow = 40;
  const std::size_t indent = std::min(line.find_first_not_of(' '), line.size()) + 4;
  if (width_of(line) <= columns || columns < indent + kNarrow) return std::string(line);
  std::string text;
  std::size_t used = 0, words = 0;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t word = std::min(line.find_first_not_of(' ', begin), line.size());
    const std::size_t end = std::min(line.find(' ', word), line.size());
    const std::size_t width = width_of(line.substr(word, end - word));
    if (words > 0 && used + (word - begin) + width > columns) {
      text += '\n' + std::string(indent, ' ');
      used = indent;
    } else {
      text.append(line.substr(begin, word - begin));
      used += word - begin;
    }
    text.append(line.substr(word, end - word));
    used += width;
    begin = end;
    ++words;
  }
  return text;
}

std::string wrapped_lines(std::string_view lines, std::size_t columns) {
  std::string text;
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    text += wrapped(lines.substr(begin, end - begin), columns) + (end < lines.size() ? "\n" : "");
    begin = end + 1;
  }
  return text;
}

void wrap_standard_output() {
  if (isatty(STDOUT_FILENO) == 0) return;
  std::FILE* const output = fopencookie(nullptr, "w", {nullptr, write_wrapped, nullptr, nullptr});
  if (output == nullptr) return;
  setvbuf(output, nullptr, _IOLBF, BUFSIZ);
  stdout = output;
}

}  // namespace swivel::cli
