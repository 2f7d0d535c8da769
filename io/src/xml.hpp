// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <tinyxml2.h>

#include <filesystem>

namespace swivel::io {

/// Parses the file into `document` and returns its root, which must be <robot>. `kind` is "URDF" or "SRDF", for messages.
[[nodiscard]] tinyxml2::XMLElement& load_robot_xml(const std::filesystem::path& file, const char* kind,
                                                   tinyxml2::XMLDocument& document);

}  // namespace swivel::io
