// SPDX-License-Identifier: BSD-3-Clause
// Values as YAML text, in the layout of the problem files in data/problems.
#pragma once
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>

namespace swivel::io {

/// Returns a value on one line: maps in braces, lists in brackets, words in quotes where they need
/// them.
[[nodiscard]] std::string flow_text(const YAML::Node& value);

/// Returns what follows "key:" or "-" in a block whose keys or dashes stand in column `indent`: a
/// list of maps with one item a line, everything else as flow_text() behind a space.
[[nodiscard]] std::string block_text(const YAML::Node& value, std::size_t indent,
                                     const std::string& new_line);

/// Returns a problem file: the keys of `root`, of `robot` and of `path` have a line each.
[[nodiscard]] std::string document_text(const YAML::Node& root);

}  // namespace swivel::io
