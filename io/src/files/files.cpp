// SPDX-License-Identifier: BSD-3-Clause
#include "files/files.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

#include "files/bad_input.hpp"
#include "swivel/io/files/files.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

std::string read_file(const fs::path& file, const std::string& kind, std::size_t most) {
  const auto fail = [&](const std::string& what) {
    bad_input(file.string(), what, "a readable " + kind);
  };
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status)) fail("is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_fifo(status))
    fail("is a device or a socket");
  const auto too_large = [&] {
    bad_input(file.string(), "is too large",
              "a " + kind + " of at most " + std::to_string(most >> 20) + " MiB");
  };
  if (fs::is_regular_file(status) && fs::file_size(file, ignored) > most && !ignored) too_large();
  errno = 0;
  std::FILE* const stream = std::fopen(file.c_str(), "rb");
  if (stream == nullptr) fail(std::strerror(errno));
  std::string text;
  std::array<char, 1 << 16> part;
  // One byte more than allowed tells.
  for (std::size_t count = 1; count > 0 && text.size() <= most;) {
    count = std::fread(part.data(), 1, part.size(), stream);
    text.append(part.data(), count);
  }
  const bool failed = std::ferror(stream) != 0;
  std::fclose(stream);
  if (failed) fail("cannot be read");
  if (text.size() > most) too_large();
  InputFiles::note(file, text);
  return text;
}

std::string format_double(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::general, 17)
                       .ptr;
  return {digits.data(), end};
}

}  // namespace swivel::io
