// SPDX-License-Identifier: BSD-3-Clause
// YAML values with their place in the file and their schema, so that every error message names
// file, line, key and what is allowed.
#pragma once
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/schema.hpp"
#include "swivel/core/base/types.hpp"

namespace swivel::io {

class YamlSection;

/// Data that the values of one file share.
struct YamlFile {
  std::string name;
  std::size_t values = 0;  ///< number of values read so far; aliases count each time
};

/// A YAML value with its place in the file and its schema.
class YamlValue {
 public:
  YamlValue(std::shared_ptr<YamlFile> file, YAML::Node node, const Schema& schema, std::string key,
            int line);

  [[nodiscard]] bool is_null() const { return node_.IsNull(); }
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_sequence() const { return node_.IsSequence(); }
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Returns whether the value is a text in quotes, which is no number and neither true nor false.
  [[nodiscard]] bool is_quoted() const { return node_.IsScalar() && node_.Tag() == "!"; }

  // Each of these throws InputError if the value is not what the schema allows for that type.
  [[nodiscard]] double number() const;
  [[nodiscard]] int whole_number() const;
  [[nodiscard]] std::vector<double> numbers() const;
  [[nodiscard]] Vector3d vector3() const;
  /// Returns a scalar, which must not be empty.
  [[nodiscard]] std::string text() const;
  /// Returns a scalar, which must be a valid name.
  [[nodiscard]] std::string name() const;
  /// Returns the index of the value among the schema's words.
  [[nodiscard]] std::size_t word() const;
  /// Returns true or false, as these words of YAML 1.2 say.
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::vector<YamlValue> items() const;
  /// Returns the entries of a map with free keys: names and values.
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// Returns a map as a section; all its keys must be in the schema.
  [[nodiscard]] YamlSection section() const;

  /// Returns the place of the value for messages: "<file>:<line>: <key>".
  [[nodiscard]] std::string where() const;
  /// Throws InputError with the place, what is wrong and what is allowed.
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const;

 private:
  /// Throws InputError for a text in quotes.
  void require_unquoted(const std::string& allowed) const;
  void count(std::size_t more) const;
  /// Returns names and values of a map. schema_of(name, value) is called for each after all names
  /// were read.
  template <class SchemaOf>
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> map(const SchemaOf& schema_of) const;

  std::shared_ptr<YamlFile> file_;  // shared: every value of a file names it
  YAML::Node node_;
  const Schema* schema_;
  std::string key_;
  int line_;
};

/// A YAML map whose keys the schema lists.
class YamlSection {
 public:
  YamlSection(YamlValue self, const Schema& schema,
              std::vector<std::pair<std::string, YamlValue>> entries);

  [[nodiscard]] const YamlValue& self() const { return self_; }
  /// Returns the value of a key, null values included; none if the key is missing. The schema must
  /// have the key.
  [[nodiscard]] std::optional<YamlValue> find(const std::string& key) const;
  /// Returns the value of a key; none if the key is missing or its value is null, as for a section
  /// whose content is commented out. The schema must have the key.
  [[nodiscard]] std::optional<YamlValue> find_filled(const std::string& key) const;
  /// Returns the value of a key. Throws InputError, in the words of the schema, if it is missing or
  /// null.
  [[nodiscard]] YamlValue require(const std::string& key) const;
  /// Returns the name and value of the one key that is given among `key` and those that exclude it.
  /// Throws InputError if two are given, or none and the schema requires one.
  [[nodiscard]] std::optional<std::pair<std::string, YamlValue>> chosen(
      const std::string& key) const;

 private:
  YamlValue self_;
  const Schema* schema_;
  std::vector<std::pair<std::string, YamlValue>> entries_;
};

/// Parses a YAML text of one document, which is that of the file `name`. The schema must outlive
/// the values. Throws InputError.
[[nodiscard]] YamlValue parse_yaml(const std::string& text, const std::string& name,
                                   const Schema& schema);
/// Loads a YAML file with one document. The schema must outlive the values. Throws InputError.
[[nodiscard]] YamlValue load_yaml(const std::filesystem::path& file, const Schema& schema);

}  // namespace swivel::io
