// SPDX-License-Identifier: BSD-3-Clause
// Changes a YAML text in place: what does not change keeps its text, order and comments.
#pragma once
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>
#include <vector>

#include "schema/schema.hpp"
#include "schema/yaml_places.hpp"

namespace swivel::io {

/// Returns true if two values are equal, with keys of maps in the same order.
[[nodiscard]] bool same_values(const YAML::Node& a, const YAML::Node& b);

/// Returns true if a text is a document of these values, whatever the order of the keys of its
/// maps.
[[nodiscard]] bool says(const std::string& text, const YAML::Node& values);

/// Returns the text of a document with what `was` states changed into what `is` states. Both are
/// maps as the schema has them. The text may state `was` in another way, or leave out what is its
/// default: only that is changed in which `was` and `is` differ. New keys are added in the order of
/// the schema; a key takes the place of one that excludes it. Maps of a list are told apart by
/// their key `name`, where they have one. The caller must verify the text by reading it. Throws
/// InputError, in the name of `source`, where the text cannot be changed in place.
[[nodiscard]] std::string changed_text(const std::string& text, const std::string& source,
                                       const YAML::Node& was, const YAML::Node& is,
                                       const Schema& schema);

}  // namespace swivel::io
