// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

namespace swivel::io {

// What files may hold, so that none takes gigabytes or minutes.
inline constexpr std::size_t kMostMeshBytes = std::size_t{256} << 20;  ///< a text STL of kMostTriangles
inline constexpr std::size_t kMostTableBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMostXmlBytes = std::size_t{32} << 20;  ///< URDF, SRDF, DAE
inline constexpr std::size_t kMostYamlBytes = std::size_t{4} << 20;

/// The whole file: regular, or a FIFO, of at most `most` bytes. `kind` completes "allowed is a readable ...".
[[nodiscard]] std::string read_file(const std::filesystem::path& file, const std::string& kind, std::size_t most);

/// 17 significant digits: enough for every double, in any locale.
[[nodiscard]] std::string format_double(double value);

}  // namespace swivel::io
