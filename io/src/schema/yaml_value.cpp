// SPDX-License-Identifier: BSD-3-Clause
#include "schema/yaml_value.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/eventhandler.h>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::io {

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Returns a description of a value for messages.
std::string shown(const YAML::Node& node) {
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  return node.IsMap() ? "a map" : node.IsSequence() ? "a list" : "null";
}

/// Returns the number that a scalar states. yaml-cpp would read digits by the global locale; it
/// only reads .inf and .nan here, which have none.
std::optional<double> number_in(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  if (node.Scalar().find_first_of("0123456789") != std::string::npos)
    return to_number<double>(node.Scalar());
  double value = 0;
  return YAML::convert<double>::decode(node, value) ? std::optional(value) : std::nullopt;
}

}  // namespace

YamlValue::YamlValue(std::shared_ptr<YamlFile> file, YAML::Node node, const Schema& schema,
                     std::string key, int line)
    : file_(std::move(file)),
      node_(std::move(node)),
      schema_(&schema),
      key_(std::move(key)),
      line_(line) {}

std::string YamlValue::where() const {
  return at_line(file_->name, line_) + (key_.empty() ? "" : ": " + key_);
}

void YamlValue::fail(const std::string& what, const std::string& allowed) const {
  bad_input(where(), what, allowed);
}

void YamlValue::require_unquoted(const std::string& allowed) const {
  if (is_quoted()) fail("is the text '" + node_.Scalar() + "', in quotes", allowed);
}

double YamlValue::number() const {
  const Range& range = schema_->as(Schema::Type::kNumber).range;
  require_unquoted(range.allowed);
  const std::optional<double> value = number_in(node_);
  if (!value) fail(shown(node_) + " is not a number", range.allowed);
  if (!range.has(*value)) fail("is " + node_.Scalar(), range.allowed);
  return *value;
}

int YamlValue::whole_number() const {
  const Range& range = schema_->as(Schema::Type::kInteger).range;
  require_unquoted(range.allowed);
  const std::optional<double> value = number_in(node_);
  if (!value) fail(shown(node_) + " is not a number", range.allowed);
  if (!range.has(*value) || *value != std::floor(*value))
    fail("is " + node_.Scalar(), range.allowed);
  return static_cast<int>(*value);
}

std::vector<double> YamlValue::numbers() const {
  const std::size_t count = schema_->as(Schema::Type::kList).count;
  const std::string allowed = "a list of " + std::to_string(count) + " numbers";
  if (!node_.IsSequence()) fail(shown(node_) + " is not a list", allowed);
  if (node_.size() != count) fail("has " + std::to_string(node_.size()) + " entries", allowed);
  std::vector<double> values;
  for (const YamlValue& item : items()) values.push_back(item.number());
  return values;
}

Vector3d YamlValue::vector3() const {
  const std::vector<double> values = numbers();
  return {values.at(0), values.at(1), values.at(2)};
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty())
    fail(shown(node_) + " is not a name", "a word or file name");
  return node_.Scalar();
}

std::string YamlValue::name() const {
  std::string name = text();
  if (!is_valid_name(name)) fail("is '" + name + "'", kValidName);
  return name;
}

std::size_t YamlValue::word() const {
  const std::vector<std::string>& words = schema_->as(Schema::Type::kWord).words;
  const auto found = std::find(words.begin(), words.end(), text());
  if (found == words.end()) fail("is '" + text() + "'", "one of " + joined(words));
  return static_cast<std::size_t>(found - words.begin());
}

void YamlValue::count(std::size_t more) const {
  constexpr std::size_t kMostValues = 2'000'000;
  if ((file_->values += more) > kMostValues)
    fail("too many values",
         "at most " + std::to_string(kMostValues) + " in a file, aliases counted each time");
}

bool YamlValue::boolean() const {
  static_cast<void>(schema_->as(Schema::Type::kBoolean));
  require_unquoted("true or false");
  const std::string word = node_.IsScalar() ? node_.Scalar() : "";
  if (word != "true" && word != "false") fail(shown(node_) + " is neither", "true or false");
  return word == "true";
}

std::vector<YamlValue> YamlValue::items() const {
  if (!node_.IsSequence()) fail(shown(node_) + " is not a list", "a list");
  const Schema& schema = schema_->as(Schema::Type::kList).item.front();
  count(node_.size());
  std::vector<YamlValue> values;
  for (const YAML::Node& item : node_) {
    const int line = item.Mark().line;
    values.emplace_back(file_, item, schema, key_ + "[" + std::to_string(values.size()) + "]",
                        line < 0 ? line_ : line + 1);
  }
  return values;
}

template <class SchemaOf>
std::vector<std::pair<std::string, YamlValue>> YamlValue::map(const SchemaOf& schema_of) const {
  if (!node_.IsMap()) fail(shown(node_) + " is not a map", "a map of key: value");
  count(node_.size());
  std::vector<std::pair<std::string, YamlValue>> values;
  std::set<std::string> names;
  for (const auto& entry : node_) {
    const int line = entry.first.Mark().line < 0 ? line_ : entry.first.Mark().line + 1;
    const YamlValue key_value(file_, entry.first, *schema_, key_, line);
    if (!entry.first.IsScalar()) key_value.fail("a key is " + shown(entry.first), "a word as key");
    const std::string name = entry.first.Scalar();
    YamlValue value(file_, entry.second, *schema_, key_.empty() ? name : key_ + "." + name, line);
    if (!is_valid_name(name)) key_value.fail("key '" + name + "'", kValidName);
    if (!names.insert(name).second) value.fail("is given twice", "each key once");
    values.emplace_back(name, std::move(value));
  }
  for (auto& [name, value] : values) value.schema_ = &schema_of(name, value);
  return values;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  const Schema& item = schema_->as(Schema::Type::kMap).item.front();
  return map([&](const std::string&, const YamlValue&) -> const Schema& { return item; });
}

YamlSection YamlValue::section() const {
  const Schema& schema = schema_->as(Schema::Type::kSection);
  auto found = map([&](const std::string& name, const YamlValue& value) -> const Schema& {
    if (const Schema::Key* const key = schema.find(name)) return key->value;
    for (const Schema::Refusal& refused : schema.refused)
      if (refused.key == name) value.fail(refused.what, refused.allowed);
    const std::vector<std::string> known = schema.key_names();
    value.fail("unknown key, nearest known key is '" + nearest_name(name, known) + "'",
               "one of " + joined(known));
  });
  return {*this, schema, std::move(found)};
}

YamlSection::YamlSection(YamlValue self, const Schema& schema,
                         std::vector<std::pair<std::string, YamlValue>> entries)
    : self_(std::move(self)), schema_(&schema), entries_(std::move(entries)) {}

std::optional<YamlValue> YamlSection::find(const std::string& key) const {
  if (schema_->find(key) == nullptr) throw std::logic_error("the schema has no key '" + key + "'");
  for (const auto& [name, value] : entries_)
    if (name == key) return value;
  return std::nullopt;
}

std::optional<YamlValue> YamlSection::find_filled(const std::string& key) const {
  auto value = find(key);
  if (value && value->is_null()) return std::nullopt;
  return value;
}

YamlValue YamlSection::require(const std::string& key) const {
  if (auto value = find_filled(key)) return *value;
  bad_input(self_.where() + (self_.key().empty() ? ": " : ".") + key, "is missing",
            allowed_text(*schema_->find(key)));
}

std::optional<std::pair<std::string, YamlValue>> YamlSection::chosen(const std::string& key) const {
  std::optional<std::pair<std::string, YamlValue>> found;
  for (const Schema::Choice& choice : schema_->choices) {
    if (std::find(choice.keys.begin(), choice.keys.end(), key) == choice.keys.end()) continue;
    for (const std::string& name : choice.keys) {
      const auto value = find_filled(name);
      if (!value) continue;
      if (found) value->fail(found->first + " and " + name + " are both given", choice.allowed());
      found.emplace(name, *value);
    }
    if (!found && choice.required) self_.fail("has none of these", choice.allowed());
  }
  return found;
}

namespace {

class Ignored final : public YAML::EventHandler {
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Returns the number of documents, at most 2. At some misplaced characters, such as a comma at the
/// beginning, the parser finds documents without end, so that YAML::LoadAll would take all memory.
int documents_in(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Ignored ignored;
  int count = 0;
  while (count < 2 && parser.HandleNextDocument(ignored)) ++count;
  return count;
}

}  // namespace

YamlValue parse_yaml(const std::string& text, const std::string& name, const Schema& schema) {
  if (const std::size_t first = text.find_first_not_of(" \t\r\n");
      first != std::string::npos && text[first] == '<')
    bad_input(name, "is XML, as a URDF is, and no problem file",
              "YAML with a robot and a path; `swivel info` describes the robot of a URDF");
  YAML::Node document;
  int documents = 0;
  try {
    documents = documents_in(text);
    if (documents == 1) document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    bad_input(at_line(name, error.mark.line + 1), "not YAML (" + error.msg + ")",
              "well-formed YAML");
  }
  if (documents != 1)
    bad_input(name, documents == 0 ? "holds no YAML document" : "holds more than one YAML document",
              "one document");
  return {std::make_shared<YamlFile>(YamlFile{name}), document, schema, "", 1};
}

YamlValue load_yaml(const std::filesystem::path& file, const Schema& schema) {
  return parse_yaml(read_file(file, "YAML file", kMostYamlBytes), file.string(), schema);
}

}  // namespace swivel::io
