// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string_view>

namespace swivel {

/// Returns the 64-bit FNV-1a checksum (Fowler, Noll, Vo) of a text. It finds damage, but is no
/// defence against forged contents. To continue over several texts, pass the checksum of what came
/// before as `from`.
[[nodiscard]] inline std::uint64_t fnv1a(std::string_view text,
                                         std::uint64_t from = 0xcbf29ce484222325) {
  for (const char c : text) from = (from ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return from;
}

}  // namespace swivel
