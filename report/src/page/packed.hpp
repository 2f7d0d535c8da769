// SPDX-License-Identifier: BSD-3-Clause
// Bytes as the pages hold them; report/web/bytes.js and starter.js read them.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace swivel::detail {

/// Binary values of a page's data, which fill() puts behind its text.
using Bytes = std::vector<unsigned char>;

/// Encodes bytes in base 64 (RFC 4648).
[[nodiscard]] std::string base64(const unsigned char* bytes, std::size_t count);
/// Returns the values of an array in the machine's byte order; the page reads little-endian.
template <class T>
[[nodiscard]] Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Appends a number in groups of seven bits, the lowest first; a group that others follow has its
/// eighth bit set.
void append_varint(Bytes& bytes, std::uint64_t value);
/// Appends a number with a sign, which becomes the lowest bit.
void append_signed(Bytes& bytes, std::int64_t value);

/// Encodes samples of `width` values each, which lie in `values` one after the other: one value of
/// all samples after the other, as what each adds to the line through the two samples before.
/// Samples of a smooth curve become small numbers. Varints.
[[nodiscard]] Bytes encode_samples(const std::vector<std::int32_t>& values, std::size_t width);

/// The cells of a map, column by column, and which pose each shows.
struct PosedCells {
  std::size_t rows = 0;    ///< cells that lie above each other in one panel
  std::size_t column = 0;  ///< cells of all panels in one column
  /// By cell: the pose, or -1. Poses have their numbers in the order of the cells; cells above each
  /// other may show one pose.
  std::vector<int> pose;
};
/// Encodes `width` values of each pose, which lie in `values` one pose after the other: one value
/// of all poses after the other, as what it adds to the value that the cells below and to the left
/// of the pose's first cell foretell. Values of a smooth surface become small numbers. Varints.
[[nodiscard]] Bytes encode_poses(const std::vector<std::int16_t>& values, std::size_t width,
                                 const PosedCells& cells);

/// Compresses a text to a zlib stream (RFC 1950), in base 64. Equal texts give equal results with
/// one version of zlib.
[[nodiscard]] std::string compressed(std::string_view text);

}  // namespace swivel::detail
