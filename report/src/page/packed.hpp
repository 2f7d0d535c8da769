// SPDX-License-Identifier: BSD-3-Clause
// Bytes as the pages hold them; report/web/bytes.js and starter.js read them.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace swivel::detail {

/// Encodes bytes in base 64 (RFC 4648).
[[nodiscard]] std::string base64(const unsigned char* bytes, std::size_t count);
/// Encodes the values of an array in the machine's byte order; the page reads little-endian.
template <class T>
[[nodiscard]] std::string base64(const std::vector<T>& values) {
  std::vector<unsigned char> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes.data(), bytes.size());
}

/// Appends a number in groups of seven bits, the lowest first; a group that others follow has its
/// eighth bit set.
void append_varint(std::vector<unsigned char>& bytes, std::uint64_t value);
/// Appends a number with a sign, which becomes the lowest bit.
void append_signed(std::vector<unsigned char>& bytes, std::int64_t value);

/// Encodes samples of `width` values each, which lie in `values` one after the other: one value of
/// all samples after the other, as what each adds to the line through the two samples before.
/// Samples of a smooth curve become small numbers. Base 64 of varints.
[[nodiscard]] std::string encode_samples(const std::vector<std::int16_t>& values,
                                         std::size_t width);
[[nodiscard]] std::string encode_samples(const std::vector<std::int32_t>& values,
                                         std::size_t width);

/// Compresses a text to a zlib stream (RFC 1950), in base 64. Equal texts give equal results with
/// one version of zlib.
[[nodiscard]] std::string compressed(std::string_view text);

}  // namespace swivel::detail
