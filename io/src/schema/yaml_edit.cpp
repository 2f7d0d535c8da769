// SPDX-License-Identifier: BSD-3-Clause
#include "schema/yaml_edit.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "schema/yaml_text.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

YAML::Node value_of(const YAML::Node& map, const std::string& key) {
  if (map.IsMap())
    for (const auto& entry : map)
      if (entry.first.Scalar() == key) return entry.second;
  return YAML::Node(YAML::NodeType::Undefined);
}

bool is_list_of(const YAML::Node& node, YAML::NodeType::value type) {
  return node.IsSequence() && std::all_of(node.begin(), node.end(), [&](const YAML::Node& item) {
           return item.Type() == type;
         });
}

/// Returns the entries of `is` that `was` does not have, if both are maps; else `is`. A text
/// without a section states the defaults of `was`.
YAML::Node changed_keys(const YAML::Node& was, const YAML::Node& is) {
  if (!was.IsDefined() || !was.IsMap() || !is.IsMap()) return is;
  YAML::Node changed(YAML::NodeType::Map);
  for (const auto& entry : is)
    if (!same_values(value_of(was, entry.first.Scalar()), entry.second))
      changed.force_insert(entry.first.Scalar(), entry.second);
  return changed;
}

/// Returns the schema of a map with fixed keys; null if a value may be none.
const Schema* section_of(const Schema* schema) {
  if (schema == nullptr || schema->type == Schema::Type::kSection) return schema;
  for (const Schema& other : schema->others)
    if (other.type == Schema::Type::kSection) return &other;
  return nullptr;
}
const Schema* item_of(const Schema* schema) {
  if (schema == nullptr || schema->item.empty()) return nullptr;
  return &schema->item.front();
}

bool same_in_any_order(const YAML::Node& a, const YAML::Node& b) {
  if (a.IsMap() && b.IsMap())
    return a.size() == b.size() && std::all_of(a.begin(), a.end(), [&](const auto& entry) {
             return same_in_any_order(entry.second, value_of(b, entry.first.Scalar()));
           });
  if (!a.IsSequence() || !b.IsSequence()) return same_values(a, b);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_in_any_order);
}

/// Replacements in a text, by their places.
class TextEdits {
 public:
  explicit TextEdits(const YamlPlaces& places) : places_(places) {}

  void replace(std::size_t begin, std::size_t end, std::string text) {
    edits_.push_back({begin, end - begin, edits_.size(), std::move(text)});
  }
  void insert(std::size_t at, std::string text) { replace(at, at, std::move(text)); }
  /// Returns the text with all replacements: from its end on; of several at one place the one that
  /// takes text away first, then insertions, the last one first.
  [[nodiscard]] std::string text() {
    std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) {
      return std::tie(a.at, a.size, a.number) > std::tie(b.at, b.size, b.number);
    });
    std::string result = places_.text();
    for (const Edit& edit : edits_) result.replace(edit.at, edit.size, edit.text);
    return result;
  }
  [[nodiscard]] const YamlPlaces& places() const { return places_; }

 private:
  struct Edit {
    std::size_t at, size, number;
    std::string text;
  };
  const YamlPlaces& places_;
  std::vector<Edit> edits_;
};

/// The parts of a map or list, of which some are dropped and others added.
class Parts {
 public:
  Parts(TextEdits& edits, const YAML::Node& node)
      : edits_(edits),
        places_(edits.places()),
        brackets_(places_.in_brackets(node)),
        parts_(places_.parts(node)),
        dropped_(parts_.size()) {}

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] const YamlPart& operator[](std::size_t k) const { return parts_[k]; }
  [[nodiscard]] std::size_t find(const std::string& name) const {
    for (std::size_t k = 0; k < parts_.size(); ++k)
      if (parts_[k].name() == name) return k;
    return kNone;
  }
  void drop(std::size_t k) { dropped_[k] = true; }
  [[nodiscard]] bool dropped(std::size_t k) const { return dropped_[k]; }
  [[nodiscard]] bool all_dropped() const {
    return std::all_of(dropped_.begin(), dropped_.end(), [](bool dropped) { return dropped; });
  }

  /// Returns what follows the colon of an entry, or the dash of an item.
  [[nodiscard]] std::string text_of(const YAML::Node& value) const {
    return brackets_ ? " " + flow_text(value) : block_text(value, indent(), places_.new_line());
  }
  /// Adds an entry behind part `after`, which is kept, or before all that are.
  void add_entry(std::size_t after, const std::string& name, const YAML::Node& value) {
    add(after, flow_text(YAML::Node(name)) + ":" + text_of(value));
  }
  void add_item(std::size_t after, const YAML::Node& value) {
    add(after, brackets_ ? flow_text(value) : "-" + text_of(value));
  }
  /// Replaces the value of a part; a comment behind a colon stays, and the value below it.
  void replace_value(std::size_t k, const YAML::Node& value) {
    const YamlPart& part = parts_[k];
    require_plain(part);
    const std::string between =
        places_.text().substr(part.separated, part.value_begin - part.separated);
    const std::string text = text_of(value);
    if (between.find('#') == std::string::npos && !is_bracket_item(part))
      edits_.replace(part.separated, part.end, text);
    else
      edits_.replace(part.value_begin, part.end, flow_text(value));
  }
  void replace_entry(std::size_t k, const std::string& name, const YAML::Node& value) {
    require_plain(parts_[k]);
    edits_.replace(parts_[k].begin, parts_[k].end, name + ":" + text_of(value));
  }
  /// Takes the dropped parts out of the text.
  void take_out() {
    for (std::size_t k = 0; k < size(); ++k)
      if (dropped_[k]) brackets_ ? take_out_of_brackets(k) : take_out_lines(k);
  }

 private:
  [[nodiscard]] std::size_t indent() const { return places_.column(parts_.front().begin); }
  [[nodiscard]] bool is_bracket_item(const YamlPart& part) const {
    return part.separated == part.begin;
  }
  void require_plain(const YamlPart& part) const {
    const char first =
        part.value_begin < places_.text().size() ? places_.text()[part.value_begin] : ' ';
    if (std::string_view("&*!").find(first) != std::string_view::npos)
      places_.fail(part.value, part.key.IsDefined() && !part.key.IsNull() ? part.name() : "it");
  }
  void add(std::size_t after, const std::string& text) {
    const std::string separator =
        brackets_ ? ", " : places_.new_line() + std::string(indent(), ' ');
    if (after != kNone) {
      const std::size_t end = parts_[after].end;
      return edits_.insert(brackets_ ? end : places_.line_end(end), separator + text);
    }
    std::size_t first = 0;
    while (dropped_[first]) ++first;
    edits_.insert(parts_[first].begin, text + separator);
  }
  void take_out_of_brackets(std::size_t k) {
    std::size_t next = k + 1;
    while (next < size() && dropped_[next]) ++next;
    if (next < size()) return edits_.replace(parts_[k].begin, parts_[k + 1].begin, "");
    // The first of the last parts takes all of them out, with the comma before them.
    if (k == 0 || !dropped_[k - 1])
      edits_.replace(k == 0 ? parts_[0].begin : parts_[k - 1].end, parts_.back().end, "");
  }
  void take_out_lines(std::size_t k) {
    const YamlPart& part = parts_[k];
    const std::string& text = places_.text();
    const std::size_t begin = places_.line_begin(part.begin);
    const bool alone = text.find_first_not_of(" \t", begin) == part.begin;
    if (!alone && k + 1 == size()) places_.fail(part.value, "the last of its keys");
    const std::size_t end = text.find('\n', places_.line_end(part.end));
    if (alone)
      edits_.replace(begin, end == std::string::npos ? text.size() : end + 1, "");
    else
      edits_.replace(part.begin, parts_[k + 1].begin, "");
  }

  TextEdits& edits_;
  const YamlPlaces& places_;
  bool brackets_;
  std::vector<YamlPart> parts_;
  std::vector<bool> dropped_;
};

/// Changes a document value by value.
class Changes {
 public:
  explicit Changes(TextEdits& edits) : edits_(edits) {}

  /// Changes a map. Returns false, having changed nothing, if it must be replaced as a whole.
  bool map(const YAML::Node& at, const YAML::Node& was, const YAML::Node& is,
           const Schema* schema) {
    Parts parts(edits_, at);
    const std::map<std::string, std::size_t> replaced = replacements(parts, was, is, schema);
    drop_entries(parts, was, is, schema, replaced);
    if (parts.size() == 0 || parts.all_dropped()) return false;
    const std::vector<std::string> names = order(was, is, schema);
    std::size_t after = kNone;  // the part of the last name so far that the text has
    for (const std::string& name : names) {
      const YAML::Node before = value_of(was, name), now = value_of(is, name);
      const std::size_t k = parts.find(name);
      const auto taken = replaced.find(name);
      const Schema::Key* const key = schema != nullptr ? schema->find(name) : nullptr;
      if (k != kNone && !parts.dropped(k)) {
        after = k;
        if (now.IsDefined() && !same_values(before, now) && !is_replaced(k, replaced))
          value(parts, k, before, now, key != nullptr ? &key->value : nullptr);
      } else if (taken != replaced.end()) {
        after = taken->second;
        parts.replace_entry(after, name, now);
      } else if (now.IsDefined() && !same_values(before, now)) {
        parts.add_entry(after, name, changed_keys(before, now));
      }
    }
    parts.take_out();
    return true;
  }

 private:
  using Replaced = std::map<std::string, std::size_t>;

  static bool is_replaced(std::size_t k, const Replaced& replaced) {
    return std::any_of(replaced.begin(), replaced.end(),
                       [&](const auto& entry) { return entry.second == k; });
  }

  /// Returns the names of all keys: those of the schema, or of a map with free keys its own.
  static std::vector<std::string> order(const YAML::Node& was, const YAML::Node& is,
                                        const Schema* schema) {
    if (schema != nullptr) return schema->key_names();
    std::vector<std::string> names;
    for (const YAML::Node& map : {was, is})
      for (const auto& entry : map)
        if (const std::string& name = entry.first.Scalar();
            std::find(names.begin(), names.end(), name) == names.end())
          names.push_back(name);
    return names;
  }

  /// Returns the keys of `is` that take the place of another one, which excludes them.
  static Replaced replacements(const Parts& parts, const YAML::Node& was, const YAML::Node& is,
                               const Schema* schema) {
    Replaced replaced;
    if (schema == nullptr) return replaced;
    for (const Schema::Choice& choice : schema->choices)
      for (const std::string& name : choice.keys)
        for (const std::string& other : choice.keys)
          if (other != name && parts.find(name) == kNone && parts.find(other) != kNone &&
              value_of(is, name).IsDefined() && !value_of(is, other).IsDefined() &&
              !same_values(value_of(was, name), value_of(is, name)))
            replaced[name] = parts.find(other);
    return replaced;
  }

  /// Returns true if values have a key, or one that excludes it and says the same in another way.
  static bool states(const YAML::Node& values, const std::string& name, const Schema* schema) {
    if (value_of(values, name).IsDefined()) return true;
    if (schema == nullptr) return false;
    for (const Schema::Choice& choice : schema->choices)
      if (std::find(choice.keys.begin(), choice.keys.end(), name) != choice.keys.end())
        for (const std::string& other : choice.keys)
          if (value_of(values, other).IsDefined()) return true;
    return false;
  }

  /// Drops the entries that `was` states and `is` does not, and those that only stand beside one
  /// that another key replaces.
  static void drop_entries(Parts& parts, const YAML::Node& was, const YAML::Node& is,
                           const Schema* schema, const Replaced& replaced) {
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const std::string& name = parts[k].name();
      if (is_replaced(k, replaced)) continue;
      if (states(was, name, schema) && !states(is, name, schema)) parts.drop(k);
      const Schema::Key* const key = schema != nullptr ? schema->find(name) : nullptr;
      if (key == nullptr || key->beside.empty()) continue;
      const std::size_t beside = parts.find(key->beside);
      if (beside != kNone && is_replaced(beside, replaced)) parts.drop(k);
    }
  }

  void value(Parts& parts, std::size_t k, const YAML::Node& was, const YAML::Node& is,
             const Schema* schema) {
    const YAML::Node& at = parts[k].value;
    bool done = false;
    if (at.IsMap() && was.IsMap() && is.IsMap()) done = map(at, was, is, section_of(schema));
    if (at.IsSequence() && was.IsSequence() && is.IsSequence())
      done = list(at, was, is, item_of(schema));
    if (!done) parts.replace_value(k, at.IsNull() ? changed_keys(was, is) : is);
  }

  /// Changes a list. Returns false, having changed nothing, if it must be replaced as a whole.
  bool list(const YAML::Node& at, const YAML::Node& was, const YAML::Node& is,
            const Schema* schema) {
    if (at.size() == 0 || is.size() == 0) return false;
    const bool named = value_of(*is.begin(), "name").IsDefined();
    if (named) return named_list(at, was, is, schema);
    if (at.size() != was.size()) return false;
    const bool scalars = is_list_of(was, YAML::NodeType::Scalar) &&
                         is_list_of(is, YAML::NodeType::Scalar) &&
                         is_list_of(at, YAML::NodeType::Scalar);
    if (scalars && was.size() != is.size()) return false;
    if (!scalars && !(is_list_of(at, YAML::NodeType::Map) && is_list_of(was, YAML::NodeType::Map)))
      return false;
    numbered_list(at, was, is, schema);
    return true;
  }

  /// Changes a list of as many items as `was`. Behind equal ones at its beginning and before equal
  /// ones at its end, items are changed one by one, then added or taken out.
  void numbered_list(const YAML::Node& at, const YAML::Node& was, const YAML::Node& is,
                     const Schema* schema) {
    Parts parts(edits_, at);
    const std::size_t least = std::min(was.size(), is.size());
    std::size_t same_first = 0, same_last = 0;
    while (same_first < least && same_values(was[same_first], is[same_first])) ++same_first;
    while (same_last < least - same_first &&
           same_values(was[was.size() - 1 - same_last], is[is.size() - 1 - same_last]))
      ++same_last;
    const std::size_t changed = least - same_last;
    for (std::size_t k = same_first; k < changed; ++k)
      if (!same_values(was[k], is[k])) value(parts, k, was[k], is[k], schema);
    for (std::size_t k = changed; k < is.size() - same_last; ++k)
      parts.add_item(changed == 0 ? kNone : changed - 1, is[k]);
    for (std::size_t k = changed; k < was.size() - same_last; ++k) parts.drop(k);
    parts.take_out();
  }

  using Numbers = std::map<std::string, std::size_t>;
  /// Returns the places of the maps of a list by their names.
  static Numbers numbers_of(const YAML::Node& items) {
    Numbers numbers;
    for (std::size_t k = 0; k < items.size(); ++k)
      if (const YAML::Node name = value_of(items[k], "name"); name.IsDefined() && name.IsScalar())
        numbers.emplace(name.Scalar(), k);
    return numbers;
  }
  static std::size_t number(const Numbers& numbers, const YAML::Node& item) {
    const auto found = numbers.find(value_of(item, "name").Scalar());
    return found == numbers.end() ? kNone : found->second;
  }

  /// Changes a list of maps with names. Items whose order changes are taken out and written anew.
  bool named_list(const YAML::Node& at, const YAML::Node& was, const YAML::Node& is,
                  const Schema* schema) {
    Parts parts(edits_, at);
    std::vector<std::size_t> place(is.size(), kNone);  // of items that stay
    std::size_t last = kNone, kept = 0;
    const Numbers in_text = numbers_of(at), in_was = numbers_of(was);
    for (std::size_t k = 0; k < is.size(); ++k) {
      const std::size_t found = number(in_text, is[k]);
      if (found != kNone && (last == kNone || found > last)) place[k] = last = found, ++kept;
    }
    if (kept == 0) place[0] = 0;  // so that comments between the items stay
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (std::find(place.begin(), place.end(), k) == place.end()) parts.drop(k);
    std::size_t after = kNone;
    for (std::size_t k = 0; k < is.size(); ++k) {
      if (place[k] == kNone) {
        parts.add_item(after, is[k]);
        continue;
      }
      after = place[k];
      const std::size_t before = number(in_was, is[k]);
      if (before == kNone)
        parts.replace_value(after, is[k]);
      else if (!same_values(was[before], is[k]))
        value(parts, after, was[before], is[k], schema);
    }
    parts.take_out();
    return true;
  }

  TextEdits& edits_;
};

}  // namespace

bool same_values(const YAML::Node& a, const YAML::Node& b) {
  if (a.Type() != b.Type()) return false;
  if (a.IsScalar()) return a.Scalar() == b.Scalar();
  if (!a.IsSequence() && !a.IsMap()) return true;
  if (a.size() != b.size()) return false;
  auto other = b.begin();
  for (const auto& one : a) {
    const bool same =
        a.IsMap() ? same_values(one.first, other->first) && same_values(one.second, other->second)
                  : same_values(one, *other);
    if (!same) return false;
    ++other;
  }
  return true;
}

bool says(const std::string& text, const YAML::Node& values) {
  try {
    return same_in_any_order(YAML::Load(text), values);
  } catch (const YAML::Exception&) {
    return false;
  }
}

std::string changed_text(const std::string& text, const std::string& source, const YAML::Node& was,
                         const YAML::Node& is, const Schema& schema) {
  if (same_values(was, is)) return text;
  const YamlPlaces places(text, source);
  TextEdits edits(places);
  Changes(edits).map(YAML::Load(text), was, is, &schema);
  return edits.text();
}

}  // namespace swivel::io
