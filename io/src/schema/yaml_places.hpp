// SPDX-License-Identifier: BSD-3-Clause
// Where the parts of a YAML document stand in its text: yaml-cpp knows where values begin, not
// where they end.
#pragma once
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>
#include <vector>

namespace swivel::io {

/// A part of a map or list: an entry "key: value", or an item. Places are indices of the text.
struct YamlPart {
  YAML::Node key, value;      ///< `key` of entries only
  std::size_t begin = 0;      ///< of the key, the dash, or in brackets the item
  std::size_t separated = 0;  ///< behind the colon or the dash
  std::size_t value_begin = 0, end = 0;
  [[nodiscard]] const std::string& name() const { return key.Scalar(); }
};

/// Finds the parts of a document in its text.
class YamlPlaces {
 public:
  /// `source` is the file's name for messages.
  YamlPlaces(std::string text, std::string source)
      : text_(std::move(text)), source_(std::move(source)) {}

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Returns true if a map or list stands in braces or brackets.
  [[nodiscard]] bool in_brackets(const YAML::Node& node) const;
  /// Returns the entries of a map, or the items of a list, in their order. Throws InputError where
  /// their text is not as simple as a change of it needs.
  [[nodiscard]] std::vector<YamlPart> parts(const YAML::Node& node) const;
  /// Throws InputError, at the line of a node, that `what` cannot be changed in place.
  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const;

  /// Returns the column of a place, from 0.
  [[nodiscard]] std::size_t column(std::size_t at) const;
  /// Returns the end of a place's line, without its line break.
  [[nodiscard]] std::size_t line_end(std::size_t at) const;
  /// Returns the beginning of a place's line.
  [[nodiscard]] std::size_t line_begin(std::size_t at) const;
  /// Returns the line break of the text: that of its first line.
  [[nodiscard]] std::string new_line() const;

 private:
  [[nodiscard]] std::size_t place(const YAML::Node& node) const;
  [[nodiscard]] char at(std::size_t place) const {
    return place < text_.size() ? text_[place] : '\n';
  }
  [[nodiscard]] std::size_t skip_blanks(std::size_t from) const;
  [[nodiscard]] std::size_t skip_space(std::size_t from) const;
  [[nodiscard]] std::size_t skip_word(std::size_t from) const;
  [[nodiscard]] std::size_t skip_properties(std::size_t from) const;
  [[nodiscard]] std::size_t quoted_end(std::size_t from) const;
  [[nodiscard]] std::size_t brackets_end(std::size_t from) const;
  [[nodiscard]] std::size_t scalar_end(const YAML::Node& node, std::size_t from) const;
  [[nodiscard]] std::size_t end_of(const YAML::Node& node, std::size_t from) const;
  /// Finds value_begin and end of a part whose value follows `separated`.
  void find_value(YamlPart& part) const;
  [[nodiscard]] std::vector<YamlPart> entries(const YAML::Node& map) const;
  [[nodiscard]] std::vector<YamlPart> items(const YAML::Node& list) const;

  std::string text_, source_;
};

}  // namespace swivel::io
