// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <tinyxml2.h>

#include <filesystem>
#include <optional>
#include <string>

namespace swivel::io {

/// Parses `text` into `document` and returns its root, which must be <root_name>. `file` and `kind`
/// ("URDF") are for messages.
tinyxml2::XMLElement& parse_xml(const std::string& file, const std::string& text, const char* kind,
                                const char* root_name, tinyxml2::XMLDocument& document);

/// A file to read or, if `text` is set, that text, with the file's name for messages.
struct XmlSource {
  std::filesystem::path file;
  std::optional<std::string> text = {};
};
/// Parses a source into `document` and returns its root, which must be <robot>. `kind` is "URDF" or
/// "SRDF". Throws InputError.
[[nodiscard]] tinyxml2::XMLElement& load_robot_xml(const XmlSource& source, const char* kind,
                                                   tinyxml2::XMLDocument& document);

}  // namespace swivel::io
