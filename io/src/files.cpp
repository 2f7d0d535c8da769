// SPDX-License-Identifier: BSD-3-Clause
#include "files.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
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

std::string read_file(const fs::path& file, const std::string& kind) {
  std::error_code ignored;
  const bool folder = fs::is_directory(file, ignored);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (folder || !stream) bad_input(file.string(), folder ? "is a folder" : std::strerror(errno), "a readable " + kind);
  std::ostringstream text;
  if (stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (stream.bad() || !text) bad_input(file.string(), "cannot be read", "a readable " + kind);
  return text.str();
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
