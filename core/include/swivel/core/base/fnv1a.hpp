// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string_view>

namespace swivel {

/// A checksum of 64 bits, by Fowler, Noll and Vo: finds damage, and is no defence against forged contents. `from`: the checksum of
/// what comes before.
[[nodiscard]] inline std::uint64_t fnv1a(std::string_view text, std::uint64_t from = 0xcbf29ce484222325) {
  for (const char c : text) from = (from ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return from;
}

}  // namespace swivel
