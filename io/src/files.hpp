// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

namespace swivel::io {

/// The whole file. `kind` completes "allowed is a readable ...".
[[nodiscard]] std::string read_file(const std::filesystem::path& file, const std::string& kind);

/// 17 significant digits: enough for every double, in any locale.
[[nodiscard]] std::string format_double(double value);

}  // namespace swivel::io
