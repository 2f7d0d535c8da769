// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <tinyxml2.h>

#include <filesystem>
#include <string>

namespace swivel::io {

/// Parses `text` into `document` and returns its root, which must be <root_name>. `file` and `kind` ("URDF") are for messages.
tinyxml2::XMLElement& parse_xml(const std::string& file, const std::string& text, const char* kind, const char* root_name,
                                tinyxml2::XMLDocument& document);

/// The same for a file whose root is <robot>. `kind` is "URDF" or "SRDF".
[[nodiscard]] tinyxml2::XMLElement& load_robot_xml(const std::filesystem::path& file, const char* kind,
                                                   tinyxml2::XMLDocument& document);

}  // namespace swivel::io
