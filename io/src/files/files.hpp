// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "swivel/io/files/files.hpp"

namespace swivel::io {

// Largest sizes of files, so that none takes gigabytes or minutes.
/// a text STL of kMostTriangles
inline constexpr std::size_t kMostMeshBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMostTableBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMostXmlBytes = std::size_t{32} << 20;  ///< URDF, SRDF, DAE
inline constexpr std::size_t kMostYamlBytes = std::size_t{4} << 20;
inline constexpr std::size_t kMostYamlMotionBytes = std::size_t{32} << 20;
inline constexpr std::size_t kMostCertificateBytes = std::size_t{32} << 20;

/// Returns the contents of a regular file or FIFO of at most `most` bytes, and notes it in
/// InputFiles. `kind` completes "allowed is a readable ...". Throws InputError.
[[nodiscard]] std::string read_file(const std::filesystem::path& file, const std::string& kind,
                                    std::size_t most);

/// Returns a number with 17 significant digits, which suffice for every double, in any locale.
[[nodiscard]] std::string format_double(double value);

/// Returns the identity of a file, which need not exist. Throws InputError, prefixed by `where`, if
/// neither the file nor its folder can be found.
[[nodiscard]] FileIdentity identity_of(const std::filesystem::path& file, const std::string& where);

/// Writes all of the text. Returns the error number of the write that failed, else 0.
[[nodiscard]] int write_all(int descriptor, std::string_view text);

}  // namespace swivel::io
