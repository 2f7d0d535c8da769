// SPDX-License-Identifier: BSD-3-Clause
#include "files.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "bad_input.hpp"
#include "swivel/io/io.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

const char* const kWritable = "a file in an existing, writable folder";

/// Writes and closes; the error number of the first step that failed, else 0.
int write_all(const fs::path& file, const char* mode, const std::string& text) {
  errno = 0;
  std::FILE* const stream = std::fopen(file.c_str(), mode);
  if (stream == nullptr) return errno;
  int error = 0;
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size() || std::fflush(stream) != 0) error = errno;
  if (std::fclose(stream) != 0 && error == 0) error = errno;
  return error;
}

/// A name beside the target that no other process and no other thread uses.
fs::path name_beside(const fs::path& target) {
  static std::atomic<unsigned> count{0};
  return target.parent_path() / (".swivel-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".tmp");
}

}  // namespace

std::string read_file(const fs::path& file, const std::string& kind, std::size_t most) {
  const auto fail = [&](const std::string& what) { bad_input(file.string(), what, "a readable " + kind); };
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status)) fail("is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_fifo(status)) fail("is a device or a socket");
  const auto too_large = [&] {
    bad_input(file.string(), "is too large", "a " + kind + " of at most " + std::to_string(most >> 20) + " MiB");
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
  return text;
}

std::string format_double(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17).ptr;
  return {digits.data(), end};
}

void write_file(const fs::path& file, const std::string& text) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  // A device or pipe must not be replaced by a file; a link should keep pointing at its file.
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    if (const int failed = write_all(file, "wb", text)) bad_input(file.string(), std::strerror(failed), kWritable);
    return;
  }
  const fs::path target = fs::is_regular_file(status) ? fs::canonical(file, error) : file;
  const fs::path beside = name_beside(target);
  if (const int failed = write_all(beside, "wbx", text)) {
    fs::remove(beside, error);
    bad_input(file.string(), std::strerror(failed), kWritable);
  }
  fs::rename(beside, target, error);
  if (error) {
    const std::string reason = error.message();
    fs::remove(beside, error);
    bad_input(file.string(), reason, kWritable);
  }
}

}  // namespace swivel::io
