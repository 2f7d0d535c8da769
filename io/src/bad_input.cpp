// SPDX-License-Identifier: BSD-3-Clause
#include "bad_input.hpp"

#include <algorithm>

#include "swivel/core/input_error.hpp"

namespace swivel::io {

void bad_input(const std::string& where, const std::string& what, const std::string& allowed) {
  std::string message = where + ": " + what + ": allowed is " + allowed;
  // Names and library messages may carry line breaks; the contract is one line.
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  throw InputError(message);
}

std::string at_line(const std::string& file, int line) {
  return line < 1 ? file : file + ":" + std::to_string(line);
}

}  // namespace swivel::io
