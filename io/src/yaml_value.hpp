// SPDX-License-Identifier: BSD-3-Clause
// A YAML node that knows where it stands, so that every complaint names file, line and key.
#pragma once
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/types.hpp"

namespace swivel::io {

enum class Range {
  kFinite,
  kNonNegative,
  kPositive,
  kCoordinate,  ///< m, within kMostMetres of 0
  kExtent,      ///< m, from 0 to kMostMetres
  kLength,      ///< m, > 0 and at most kMostMetres
};

class YamlSection;

/// What the values of one file share.
struct YamlFile {
  std::string name;
  std::size_t values = 0;  ///< read so far; aliases count each time
};

class YamlValue {
 public:
  YamlValue(std::shared_ptr<YamlFile> file, YAML::Node node, std::string key, int line);

  [[nodiscard]] bool is_null() const { return node_.IsNull(); }
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_sequence() const { return node_.IsSequence(); }
  [[nodiscard]] const std::string& key() const { return key_; }

  [[nodiscard]] double number(Range range) const;
  [[nodiscard]] std::vector<double> numbers(std::size_t count, Range range) const;
  [[nodiscard]] Vector3d vector3(Range range) const;
  /// A scalar that is not empty.
  [[nodiscard]] std::string text() const;
  /// The same, a valid name.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::vector<YamlValue> items() const;
  /// The entries of a map with free keys.
  [[nodiscard]] std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// A map whose keys must be among `known`.
  [[nodiscard]] YamlSection section(const std::vector<std::string>& known) const;

  /// "<file>:<line>: <key>"
  [[nodiscard]] std::string where() const;
  [[noreturn]] void fail(const std::string& what, const std::string& allowed) const;

 private:
  void count(std::size_t more) const;

  std::shared_ptr<YamlFile> file_;  // shared: every value of a file names it
  YAML::Node node_;
  std::string key_;
  int line_;
};

class YamlSection {
 public:
  YamlSection(YamlValue self, std::vector<std::pair<std::string, YamlValue>> entries);

  [[nodiscard]] const YamlValue& self() const { return self_; }
  /// The value of a key that is there, null or not.
  [[nodiscard]] std::optional<YamlValue> find(const std::string& key) const;
  /// The same, where an explicit null counts as absent: sections whose content is commented out.
  [[nodiscard]] std::optional<YamlValue> find_filled(const std::string& key) const;
  [[nodiscard]] YamlValue require(const std::string& key, const std::string& allowed) const;

 private:
  YamlValue self_;
  std::vector<std::pair<std::string, YamlValue>> entries_;
};

/// The one document of a file.
[[nodiscard]] YamlValue load_yaml(const std::filesystem::path& file);

}  // namespace swivel::io
