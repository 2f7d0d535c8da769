// SPDX-License-Identifier: BSD-3-Clause
#include "schema/schema.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "swivel/core/messages/formatted.hpp"

namespace swivel::io {

bool Range::has(double value) const {
  return std::isfinite(value) && (above_least ? value > least : value >= least) && value <= most;
}

Schema::Schema(Type what) : type(what) {}

std::string Schema::Choice::allowed() const {
  std::string names;
  for (const std::string& key : keys) names += (names.empty() ? "" : ", ") + key;
  return (required ? "exactly one of " : "one of ") + names;
}

const Schema& Schema::as(Type wanted) const {
  if (type == wanted) return *this;
  for (const Schema& other : others)
    if (other.type == wanted) return other;
  throw std::logic_error("a value is read as what its schema does not name");
}

const Schema::Key* Schema::find(const std::string& key) const {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const Key& one) { return one.name == key; });
  return found == keys.end() ? nullptr : &*found;
}

std::vector<std::string> Schema::key_names() const {
  std::vector<std::string> names;
  for (const Key& key : keys) names.push_back(key.name);
  return names;
}

Schema number(const Range& range) {
  Schema schema{Schema::Type::kNumber};
  schema.range = range;
  return schema;
}

Schema integer(const Range& range) {
  Schema schema{Schema::Type::kInteger};
  schema.range = range;
  return schema;
}

Schema boolean() {
  return {Schema::Type::kBoolean};
}

Schema text() {
  return {Schema::Type::kText};
}

Schema one_of(std::vector<std::string> words) {
  Schema schema{Schema::Type::kWord};
  schema.words = std::move(words);
  return schema;
}

Schema list(Schema item, std::size_t count) {
  Schema schema{Schema::Type::kList};
  schema.count = count;
  schema.item.push_back(std::move(item));
  return schema;
}

Schema map(Schema item) {
  Schema schema{Schema::Type::kMap};
  schema.item.push_back(std::move(item));
  return schema;
}

Schema section(std::string name, std::vector<Schema::Key> keys,
               std::vector<Schema::Choice> choices) {
  Schema schema{Schema::Type::kSection};
  schema.name = std::move(name);
  schema.keys = std::move(keys);
  schema.choices = std::move(choices);
  return schema;
}

Schema::Refusal not_yet(std::string key) {
  std::string allowed = "no `" + key + "`";
  return {std::move(key), "is not supported yet", std::move(allowed)};
}

Schema refusing(Schema section, std::vector<Schema::Refusal> keys) {
  section.refused = std::move(keys);
  return section;
}

std::vector<Schema::Key> join(std::vector<Schema::Key> first,
                              const std::vector<Schema::Key>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Schema or_null(Schema schema) {
  schema.nullable = true;
  return schema;
}

Schema either(Schema first, Schema second) {
  first.others.push_back(std::move(second));
  return first;
}

Presence required() {
  return {true, ""};
}

Presence optional() {
  return {};
}

Presence otherwise(double value) {
  return {false, formatted("%.15g", value)};
}

Presence otherwise(const std::optional<double>& value) {
  return value ? otherwise(*value) : Presence{false, "null"};
}

Presence otherwise(const char* word) {
  return {false, word};
}

Presence in_words(const char* fallback) {
  return {false, fallback, true};
}

std::string allowed_text(const Schema::Key& key) {
  if (!key.allowed.empty()) return key.allowed;
  const Schema& value = key.value;
  switch (value.type) {
    case Schema::Type::kNumber:
    case Schema::Type::kInteger:
      return value.range.allowed;
    case Schema::Type::kList:
      return value.count > 0 ? "a list of " + std::to_string(value.count) + " numbers" : "a list";
    case Schema::Type::kMap:
    case Schema::Type::kSection:
      return "a map of key: value";
    default:
      return "a word or file name";
  }
}

}  // namespace swivel::io
