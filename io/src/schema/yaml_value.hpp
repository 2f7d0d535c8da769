// SPDX-License-Identifier: BSD-3-Clause
// A YAML node that knows where it stands and what may stand there, so that every complaint names file, line, key and what is
// allowed.
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

/// What the values of one file share.
struct YamlFile {
  std::string name;
  std::size_t values = 0;  ///< read so far; aliases count each time
};

class YamlValue {
 public:
  YamlValue(std::shared_ptr<YamlFile> file, YAML::Node node, const Schema& schema, std::string key, int line);

  [[nodiscard]] bool is_null() const { return node_.IsNull(); }
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_sequence() const { return node_.IsSequence(); }
  [[nodiscard]] const std::string& key() const { return key_; }

  // Each throws InputError where what stands there is not what the schema says of that type.
  [[nodiscard]] double number() const;
  [[nodiscard]] std::vector<double> numbers() const;
  [[nodiscard]] Vector3d vector3() const;
  /// A scalar that is not empty.
  [[nodiscard]] std::string text() const;
  /// The same, a valid name.
  [[nodiscard]] std::string name() const;
  /// Which of the schema's words.
  [[nodiscard]] std::size_t word() const;
  [[nodiscard]] std::vector<YamlValue> items() const;
  /// The entries of a map with free keys.
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// A map with no keys but the schema's.
  [[nodiscard]] YamlSection section() const;

  /// "<file>:<line>: <key>"
  [[nodiscard]] std::string where() const;
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const;

 private:
  void count(std::size_t more) const;
  /// Names and values of a map; `schema_of(name, value)` is asked for each after all names were read.
  template <class SchemaOf>
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> map(const SchemaOf& schema_of) const;

  std::shared_ptr<YamlFile> file_;  // shared: every value of a file names it
  YAML::Node node_;
  const Schema* schema_;
  std::string key_;
  int line_;
};

class YamlSection {
 public:
  YamlSection(YamlValue self, const Schema& schema, std::vector<std::pair<std::string, YamlValue>> entries);

  [[nodiscard]] const YamlValue& self() const { return self_; }
  /// The value of a key that is there, null or not. The schema must know the key.
  [[nodiscard]] std::optional<YamlValue> find(const std::string& key) const;
  /// The same, where an explicit null counts as absent: sections whose content is commented out.
  [[nodiscard]] std::optional<YamlValue> find_filled(const std::string& key) const;
  /// Throws InputError, in the words of the schema, where there is none.
  [[nodiscard]] YamlValue require(const std::string& key) const;
  /// Of a key and those that exclude it the one that is there, and its name. Throws InputError where there are two, or none and
  /// the schema asks for one.
  [[nodiscard]] std::optional<std::pair<std::string, YamlValue>> chosen(const std::string& key) const;

 private:
  YamlValue self_;
  const Schema* schema_;
  std::vector<std::pair<std::string, YamlValue>> entries_;
};

/// The one document of a file. The schema must outlive the values.
[[nodiscard]] YamlValue load_yaml(const std::filesystem::path& file, const Schema& schema);

}  // namespace swivel::io
