// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <zlib.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace swivel::test {

/// Decodes base 64.
inline std::string unpacked(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0, bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw std::runtime_error("no digit of base 64");
    word = (word << 6 | static_cast<unsigned>(digit)) & 0xffffff;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits & 255);
  }
  return bytes;
}

/// Inflates a zlib stream in base 64.
inline std::string inflated(std::string_view text) {
  std::string bytes = unpacked(text), result(1 << 16, '\0');
  uLongf count = result.size();
  int code = Z_BUF_ERROR;
  while (code == Z_BUF_ERROR && result.size() < (1u << 30)) {
    result.resize(count = 4 * result.size());
    code = uncompress(reinterpret_cast<Bytef*>(result.data()), &count,
                      reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  }
  if (code != Z_OK) throw std::runtime_error("no zlib stream");
  result.resize(count);
  return result;
}

/// Returns the JSON text of a page's data, as a browser finds it: between the tags of its element,
/// before the binary values.
inline std::string data_of(const std::string& page) {
  const std::string open = "<script id=\"data\" type=\"application/zlib\">";
  const std::size_t begin = page.find(open) + open.size();
  const std::string all = inflated(page.substr(begin, page.find("</script>", begin) - begin));
  return all.substr(0, all.find('\0'));
}

}  // namespace swivel::test
