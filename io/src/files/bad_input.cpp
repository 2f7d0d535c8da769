// SPDX-License-Identifier: BSD-3-Clause
#include "files/bad_input.hpp"

#include <string_view>

#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::io {

void bad_input(const std::string& where, const std::string& what, const std::string& allowed) {
  // Files may hold words of any length.
  const auto part = [](const std::string& text) {
    constexpr std::size_t kMost = 400;
    return text.size() <= kMost ? printable(text)
                                : printable(std::string_view(text).substr(0, kMost)) + " ...";
  };
  // A file's name is at the beginning, a key's at the end; enough of both is kept to tell them.
  const auto place = [](std::string_view text) {
    constexpr std::size_t kEach = 1000;
    if (text.size() <= 2 * kEach) return printable(text);
    return printable(text.substr(0, kEach)) + " ... " + printable(text.substr(text.size() - kEach));
  };
  throw InputError(place(where) + ": " + part(what) + ": allowed is " + part(allowed));
}

std::string at_line(const std::string& file, int line) {
  return line < 1 ? file : file + ":" + std::to_string(line);
}

}  // namespace swivel::io
