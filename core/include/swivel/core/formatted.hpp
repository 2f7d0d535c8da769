// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdio>
#include <string>

namespace swivel {

/// As std::printf would print it, up to 199 characters. The format is a literal of ours, never a user's text.
template <class... Values>
[[nodiscard]] std::string formatted(const char* format, Values... values) {
  std::array<char, 200> buffer;
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

}  // namespace swivel
