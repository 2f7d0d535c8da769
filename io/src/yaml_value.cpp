// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_value.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "bad_input.hpp"
#include "files.hpp"
#include "swivel/core/bounds.hpp"
#include "swivel/core/nearest_name.hpp"

namespace swivel::io {

namespace {

const char* allowed_text(Range range) {
  switch (range) {
    case Range::kNonNegative:
      return "a finite number >= 0";
    case Range::kPositive:
      return "a finite number > 0";
    case Range::kCoordinate:
      return "a number from -1000 to 1000";
    case Range::kExtent:
      return "a number >= 0, at most 1000";
    case Range::kLength:
      return kLengthAllowed;
    case Range::kFinite:
      break;
  }
  return "a finite number";
}

bool in_range(double value, Range range) {
  switch (range) {
    case Range::kNonNegative:
      return value >= 0 && std::isfinite(value);
    case Range::kPositive:
      return value > 0 && std::isfinite(value);
    case Range::kCoordinate:
      return std::abs(value) <= kMostMetres;
    case Range::kExtent:
      return value >= 0 && value <= kMostMetres;
    case Range::kLength:
      return value > 0 && value <= kMostMetres;
    case Range::kFinite:
      break;
  }
  return std::isfinite(value);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// What stands there, for messages.
std::string shown(const YAML::Node& node) {
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsMap() ? "a map" : node.IsSequence() ? "a list" : "null";
}

}  // namespace

YamlValue::YamlValue(std::shared_ptr<YamlFile> file, YAML::Node node, std::string key, int line)
    : file_(std::move(file)), node_(std::move(node)), key_(std::move(key)), line_(line) {}

std::string YamlValue::where() const {
  return at_line(file_->name, line_) + (key_.empty() ? "" : ": " + key_);
}

void YamlValue::fail(const std::string& what, const std::string& allowed) const {
  bad_input(where(), what, allowed);
}

double YamlValue::number(Range range) const {
  double value = 0;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value))
    fail(shown(node_) + " is not a number", allowed_text(range));
  if (!in_range(value, range)) fail("is " + node_.Scalar(), allowed_text(range));
  return value;
}

std::vector<double> YamlValue::numbers(std::size_t count, Range range) const {
  const std::string allowed = "a list of " + std::to_string(count) + " numbers";
  if (!node_.IsSequence()) fail(shown(node_) + " is not a list", allowed);
  if (node_.size() != count) fail("has " + std::to_string(node_.size()) + " entries", allowed);
  std::vector<double> values;
  for (const YamlValue& item : items()) values.push_back(item.number(range));
  return values;
}

Vector3d YamlValue::vector3(Range range) const {
  return Vector3d::Map(numbers(3, range).data());
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail(shown(node_) + " is not a name", "a word or file name");
  return node_.Scalar();
}

std::string YamlValue::name() const {
  std::string name = text();
  if (!is_valid_name(name)) fail("is '" + name + "'", kValidName);
  return name;
}

void YamlValue::count(std::size_t more) const {
  constexpr std::size_t kMostValues = 2'000'000;
  if ((file_->values += more) > kMostValues)
    fail("too many values", "at most " + std::to_string(kMostValues) + " in a file, aliases counted each time");
}

std::vector<YamlValue> YamlValue::items() const {
  if (!node_.IsSequence()) fail(shown(node_) + " is not a list", "a list");
  count(node_.size());
  std::vector<YamlValue> values;
  for (const YAML::Node& item : node_) {
    const int line = item.Mark().line;
    values.emplace_back(file_, item, key_ + "[" + std::to_string(values.size()) + "]", line < 0 ? line_ : line + 1);
  }
  return values;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  if (!node_.IsMap()) fail(shown(node_) + " is not a map", "a map of key: value");
  count(node_.size());
  std::vector<std::pair<std::string, YamlValue>> values;
  std::set<std::string> names;
  for (const auto& entry : node_) {
    const int line = entry.first.Mark().line < 0 ? line_ : entry.first.Mark().line + 1;
    const YamlValue key_value(file_, entry.first, key_, line);
    if (!entry.first.IsScalar()) key_value.fail("a key is " + shown(entry.first), "a word as key");
    const std::string name = entry.first.Scalar();
    YamlValue value(file_, entry.second, key_.empty() ? name : key_ + "." + name, line);
    if (!is_valid_name(name)) key_value.fail("key '" + name + "'", kValidName);
    if (!names.insert(name).second) value.fail("is given twice", "each key once");
    values.emplace_back(name, std::move(value));
  }
  return values;
}

YamlSection YamlValue::section(const std::vector<std::string>& known) const {
  auto found = entries();
  for (const auto& [name, value] : found) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    value.fail("unknown key, nearest known key is '" + nearest_name(name, known) + "'", "one of " + joined(known));
  }
  return {*this, std::move(found)};
}

YamlSection::YamlSection(YamlValue self, std::vector<std::pair<std::string, YamlValue>> entries)
    : self_(std::move(self)), entries_(std::move(entries)) {}

std::optional<YamlValue> YamlSection::find(const std::string& key) const {
  for (const auto& [name, value] : entries_)
    if (name == key) return value;
  return std::nullopt;
}

std::optional<YamlValue> YamlSection::find_filled(const std::string& key) const {
  auto value = find(key);
  if (value && value->is_null()) return std::nullopt;
  return value;
}

YamlValue YamlSection::require(const std::string& key, const std::string& allowed) const {
  if (auto value = find_filled(key)) return *value;
  bad_input(self_.where() + (self_.key().empty() ? ": " : ".") + key, "is missing", allowed);
}

YamlValue load_yaml(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string text = read_file(file, "YAML file", kMostYamlBytes);
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& error) {
    bad_input(at_line(name, error.mark.line + 1), "not YAML (" + error.msg + ")", "well-formed YAML");
  }
  if (documents.size() != 1) bad_input(name, "holds " + std::to_string(documents.size()) + " YAML documents", "one document");
  return {std::make_shared<YamlFile>(YamlFile{name}), documents.front(), "", 1};
}

}  // namespace swivel::io
