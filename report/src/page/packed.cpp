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

void append_varint(std::vector<unsigned char>& bytes, std::uint64_t value) {
  for (; value > 127; value >>= 7) bytes.push_back(static_cast<unsigned char>(value | 128));
  bytes.push_back(static_cast<unsigned char>(value));
}

void append_signed(std::vector<unsigned char>& bytes, std::int64_t value) {
  const std::uint64_t doubled = static_cast<std::uint64_t>(value) << 1;
  append_varint(bytes, value < 0 ? ~doubled : doubled);
}

namespace {

template <class T>
std::string encoded(const std::vector<T>& values, std::size_t width) {
  std::vector<unsigned char> bytes;
  for (std::size_t k = 0; k < width; ++k) {
    std::int64_t before = 0, step = 0;
    for (std::size_t n = k; n < values.size(); n += width) {
      const std::int64_t next = values[n] - before;
      append_signed(bytes, next - step);
      step = next;
      before = values[n];
    }
  }
  return base64(bytes);
}

}  // namespace

std::string encode_samples(const std::vector<std::int16_t>& values, std::size_t width) {
  return encoded(values, width);
}

std::string encode_samples(const std::vector<std::int32_t>& values, std::size_t width) {
  return encoded(values, width);
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
