// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/messages/bounds.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace swivel {

namespace {

/// Returns true if a code point shows nothing and changes what is shown around it: those that turn
/// the direction of writing (a name could end with the letters that it seems to begin with), line
/// and paragraph separators, byte order marks, annotations and tags.
bool is_invisible_control(unsigned code) {
  constexpr std::array<std::pair<unsigned, unsigned>, 8> kRanges{{{0x61c, 0x61c},
                                                                  {0x200e, 0x200f},
                                                                  {0x2028, 0x202e},
                                                                  {0x2060, 0x206f},
                                                                  {0xfeff, 0xfeff},
                                                                  {0xfff9, 0xfffb},
                                                                  {0x200b, 0x200b},
                                                                  {0xe0000, 0xe007f}}};
  return std::any_of(kRanges.begin(), kRanges.end(), [&](const auto& range) {
    return code >= range.first && code <= range.second;
  });
}

/// Returns how many bytes the printable UTF-8 character at the begin of `text` has, 0 if there is
/// none. Not for an empty text.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t k) {
    return static_cast<unsigned>(static_cast<unsigned char>(text[k]));
  };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < size) return 0;
  unsigned code = first & (0x7fu >> size);
  for (std::size_t k = 1; k < size; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(k) & 0x3f);
  }
  const bool shortest = code >= (size == 2 ? 0x80u : size == 3 ? 0x800u : 0x10000u);
  const bool control = code < 0xa0 || is_invisible_control(code),
             surrogate = code >= 0xd800 && code < 0xe000, none = (code & 0xfffe) == 0xfffe;
  return shortest && !control && !surrogate && !none && code < 0x110000 ? size : 0;
}

}  // namespace

bool is_valid_name(std::string_view name) {
  if (name.empty()) return false;
  while (!name.empty()) {
    const std::size_t size = character(name);
    if (size == 0) return false;
    name.remove_prefix(size);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = character(text);
    result += size == 0 ? "?" : text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return result;
}

}  // namespace swivel
