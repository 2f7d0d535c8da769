// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/schema/schema_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "files/csv.hpp"
#include "schema/schema.hpp"

namespace swivel::io {

namespace {

using Json = nlohmann::ordered_json;
using Type = Schema::Type;

/// How null is treated. In files that people write it stands for a missing key, except for numbers
/// and words; in results it is a value.
enum class Absent { kMayBeNull, kIsAbsent };

Json json_of(const Schema& schema, Absent absent);

Json number_json(const char* type, const Range& range) {
  Json json = {{"type", type}};
  if (std::isfinite(range.least))
    json[range.above_least ? "exclusiveMinimum" : "minimum"] = range.least;
  if (std::isfinite(range.most)) json["maximum"] = range.most;
  return json;
}

Json choice_json(const Schema::Choice& choice) {
  if (!choice.required) return {{"not", {{"required", choice.keys}}}};
  Json one = Json::array();
  for (const std::string& key : choice.keys) one.push_back({{"required", {key}}});
  return {{"oneOf", std::move(one)}};
}

/// Returns a word or text as a JSON string, anything else parsed as JSON.
Json literal(const Schema& schema, const std::string& text) {
  return schema.type == Type::kWord || schema.type == Type::kText ? Json(text) : Json::parse(text);
}

Json section_json(const Schema& schema, Absent absent) {
  Json properties = Json::object(), required = Json::array(), choices = Json::array();
  for (const Schema::Key& key : schema.keys) {
    Schema value = key.value;
    const bool holds_more = value.type == Type::kText || value.type == Type::kList ||
                            value.type == Type::kMap || value.type == Type::kSection;
    if (absent == Absent::kMayBeNull && !key.presence.required && holds_more) value.nullable = true;
    Json property = json_of(value, absent);
    property["description"] = key.meaning;
    if (!key.unit.empty()) property["x-unit"] = key.unit;
    if (!key.presence.fallback.empty() && !key.presence.in_words)
      property["default"] = literal(value, key.presence.fallback);
    if (key.presence.required) required.push_back(key.name);
    properties[key.name] = std::move(property);
  }
  Json json = {
      {"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
  if (!required.empty()) json["required"] = std::move(required);
  for (const Schema::Choice& choice : schema.choices) choices.push_back(choice_json(choice));
  if (!choices.empty()) json["allOf"] = std::move(choices);
  for (const Schema::Key& key : schema.keys)
    if (!key.beside.empty()) json["dependencies"][key.name] = {key.beside};
  return json;
}

/// Returns the JSON Schema of the schema itself, without what is allowed instead.
Json own_json(const Schema& schema, Absent absent) {
  switch (schema.type) {
    case Type::kNumber:
      return number_json("number", schema.range);
    case Type::kInteger:
      return number_json("integer", schema.range);
    case Type::kBoolean:
      return {{"type", "boolean"}};
    case Type::kWord:
      return {{"type", "string"}, {"enum", schema.words}};
    case Type::kMap:
      return {{"type", "object"}, {"additionalProperties", json_of(schema.item.front(), absent)}};
    case Type::kSection:
      return section_json(schema, absent);
    case Type::kList: {
      Json json = {{"type", "array"}, {"items", json_of(schema.item.front(), absent)}};
      if (schema.count > 0) json["minItems"] = json["maxItems"] = schema.count;
      return json;
    }
    case Type::kText:
      break;
  }
  return {{"type", "string"}};
}

Json json_of(const Schema& schema, Absent absent) {
  Json one = own_json(schema, absent);
  if (schema.others.empty() && !schema.nullable) return one;
  Json any = Json::array({std::move(one)});
  for (const Schema& other : schema.others) any.push_back(json_of(other, absent));
  if (schema.nullable) any.push_back({{"type", "null"}});
  return {{"anyOf", std::move(any)}};
}

std::string document(const char* title, const Schema& schema, Absent absent) {
  Json json = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  json.update(json_of(schema, absent));
  return json.dump(2) + '\n';
}

// --- tables

std::string range_text(const Range& range) {
  std::string text;
  if (std::isfinite(range.least) && range.least == 0) text = range.above_least ? " > 0" : " ≥ 0";
  if (range.most < kMostMetres)
    text += ", at most " + (range.most == kTwoPi ? "2π" : csv_number(range.most));
  return text;
}

std::string value_text(const Schema& schema, const std::string& unit) {
  std::string text;
  switch (schema.type) {
    case Type::kNumber:
      text = (unit.empty() ? "number" : unit) + range_text(schema.range);
      break;
    case Type::kInteger:
      text = "integer";
      break;
    case Type::kBoolean:
      text = "`true`, `false`";
      break;
    case Type::kText:
      text = "text";
      break;
    case Type::kWord:
      for (const std::string& word : schema.words)
        text += (text.empty() ? "`" : ", `") + word + "`";
      break;
    case Type::kMap:
    case Type::kSection:
      text = "map";
      break;
    case Type::kList:
      text = schema.count > 0
                 ? std::to_string(schema.count) + " × " + value_text(schema.item.front(), unit)
                 : "list";
      break;
  }
  for (const Schema& other : schema.others) text += " or " + value_text(other, unit);
  if (schema.nullable) text += " or `null`";
  return text;
}

std::string presence_text(const Presence& presence) {
  if (presence.required) return "**required**";
  if (presence.fallback.empty() || presence.in_words) return presence.fallback;
  return '`' + presence.fallback + '`';
}

/// Escapes `|`, which would end a cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\\|");
  return text;
}

/// Returns a Markdown table of keys, with a column of defaults for files that people write.
std::string table(const std::string& name, const std::vector<Schema::Key>& keys, Absent absent) {
  const bool defaults = absent == Absent::kMayBeNull;
  std::string text = "<!-- schema " + name + " -->\n| key | value | " +
                     (defaults ? "default | |\n|---|---|---|---|\n" : "|\n|---|---|---|\n");
  for (const Schema::Key& key : keys) {
    text += "| `" + key.name + "` | " + cell(value_text(key.value, key.unit)) + " | ";
    if (defaults) text += cell(presence_text(key.presence)) + " | ";
    text += cell(key.meaning) + " |\n";
  }
  return text + "<!-- /schema -->\n";
}

/// Appends the tables of a schema and of the sections in it, each once, in the order in which they
/// are met.
void add_tables(const Schema& schema, Absent absent, std::set<std::string>& known,
                std::string& text) {
  std::vector<Schema::Key> own;
  std::vector<std::pair<std::string, std::vector<Schema::Key>>> groups;
  for (const Schema::Key& key : schema.keys) {
    if (*key.group == '\0') {
      own.push_back(key);
      continue;
    }
    if (groups.empty() || groups.back().first != key.group) groups.push_back({key.group, {}});
    groups.back().second.push_back(key);
  }
  if (!schema.name.empty() && known.insert(schema.name).second)
    text += table(schema.name, own, absent);
  for (const auto& [name, keys] : groups)
    if (known.insert(name).second) text += table(name, keys, absent);
  for (const Schema::Key& key : schema.keys) add_tables(key.value, absent, known, text);
  for (const Schema& item : schema.item) add_tables(item, absent, known, text);
  for (const Schema& other : schema.others) add_tables(other, absent, known, text);
}

}  // namespace

std::string problem_json_schema() {
  return document("Problem file of swivel", problem_schema(), Absent::kMayBeNull);
}

std::string result_json_schema() {
  return document("Result of swivel plan --json", result_schema(), Absent::kIsAbsent);
}

std::string campaign_json_schema() {
  return document("Summary of swivel campaign --json", campaign_schema(), Absent::kIsAbsent);
}

std::string schema_tables() {
  std::set<std::string> known;
  std::string text;
  add_tables(problem_schema(), Absent::kMayBeNull, known, text);
  for (const Schema* const schema :
       {&trajectory_schema(), &motion_schema(), &job_trajectory_schema(), &result_schema(),
        &campaign_schema()})
    add_tables(*schema, Absent::kIsAbsent, known, text);
  return text;
}

}  // namespace swivel::io
