// SPDX-License-Identifier: BSD-3-Clause
#include "page/packed.hpp"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>

namespace swivel::detail {

std::string base64(const unsigned char* bytes, std::size_t count) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (count / 3 + 1));
  for (std::size_t k = 0; k < count; k += 3) {
    const std::size_t rest = std::min<std::size_t>(3, count - k);
    unsigned word = 0;
    for (std::size_t j = 0; j < 3; ++j) word = word << 8 | (j < rest ? bytes[k + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += j <= rest ? kDigits[word >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

void append_varint(Bytes& bytes, std::uint64_t value) {
  for (; value > 127; value >>= 7) bytes.push_back(static_cast<unsigned char>(value | 128));
  bytes.push_back(static_cast<unsigned char>(value));
}

void append_signed(Bytes& bytes, std::int64_t value) {
  const std::uint64_t doubled = static_cast<std::uint64_t>(value) << 1;
  append_varint(bytes, value < 0 ? ~doubled : doubled);
}

Bytes encode_samples(const std::vector<std::int32_t>& values, std::size_t width) {
  Bytes bytes;
  for (std::size_t k = 0; k < width; ++k) {
    std::int64_t before = 0, step = 0;
    for (std::size_t n = k; n < values.size(); n += width) {
      const std::int64_t next = values[n] - before;
      append_signed(bytes, next - step);
      step = next;
      before = values[n];
    }
  }
  return bytes;
}

namespace {

/// Returns the pose of the cell that is `left` columns to the left of another and `below` rows
/// below it in the same panel; -1 without one.
int pose_beside(const PosedCells& cells, std::size_t cell, std::size_t left, std::size_t below) {
  const std::size_t away = left * cells.column + below;
  return cell % cells.rows < below || cell < away ? -1 : cells.pose[cell - away];
}

/// Returns what poses beside a cell foretell of the value of its own: that the values' bend from
/// row to row is that of the column to the left, or their slope is; else that they go on straight,
/// or do not change. `value`: of a pose; `last`: of the last one.
template <class Value>
std::int64_t foretold(const PosedCells& cells, std::size_t cell, std::int64_t last,
                      const Value& value) {
  const int below = pose_beside(cells, cell, 0, 1), further = pose_beside(cells, cell, 0, 2),
            left = pose_beside(cells, cell, 1, 0), left_below = pose_beside(cells, cell, 1, 1),
            left_further = pose_beside(cells, cell, 1, 2);
  const bool has_slope = below >= 0 && left >= 0 && left_below >= 0,
             goes_on = below >= 0 && further >= 0;
  if (has_slope && goes_on && left_further >= 0)
    return 2 * value(below) - value(further) + value(left) - 2 * value(left_below) +
           value(left_further);
  if (has_slope) return value(below) + value(left) - value(left_below);
  if (goes_on) return 2 * value(below) - value(further);
  return left >= 0 ? value(left) : below >= 0 ? value(below) : last;
}

}  // namespace

Bytes encode_poses(const std::vector<std::int16_t>& values, std::size_t width,
                   const PosedCells& cells) {
  Bytes bytes;
  for (std::size_t k = 0; k < width; ++k) {
    const auto value = [&](int pose) -> std::int64_t {
      return values[static_cast<std::size_t>(pose) * width + k];
    };
    int next = 0;
    for (std::size_t cell = 0; cell < cells.pose.size(); ++cell) {
      if (cells.pose[cell] != next) continue;
      append_signed(bytes,
                    value(next) - foretold(cells, cell, next > 0 ? value(next - 1) : 0, value));
      ++next;
    }
  }
  return bytes;
}

std::string compressed(std::string_view text) {
  std::vector<unsigned char> bytes(compressBound(text.size()));
  uLongf count = bytes.size();
  if (compress2(bytes.data(), &count, reinterpret_cast<const Bytef*>(text.data()), text.size(),
                Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error("zlib could not compress the data of a page");
  return base64(bytes.data(), count);
}

}  // namespace swivel::detail
