// SPDX-License-Identifier: BSD-3-Clause
// What files say: the names, types, units, ranges and meaning of their keys. The reader of problem files takes from it what it
// allows; `swivel schema` prints it.
#pragma once
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "files/bad_input.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel::io {

/// Which numbers are allowed.
struct Range {
  const char* allowed;  ///< completes "allowed is ..."
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();
  bool above_least = false;  ///< `least` itself is not allowed
  [[nodiscard]] bool has(double value) const;
};

inline constexpr Range kFinite{"a finite number"};
inline constexpr Range kNonNegative{"a finite number >= 0", 0};
inline constexpr Range kPositive{"a finite number > 0", 0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range kCoordinate{"a number from -1000 to 1000", -kMostMetres, kMostMetres};  // m
inline constexpr Range kExtent{"a number >= 0, at most 1000", 0, kMostMetres};                 // m
inline constexpr Range kLength{kLengthAllowed, 0, kMostMetres, true};                          // m
inline constexpr Range kTurn{"a finite number > 0, at most 2*pi", 0, kTwoPi, true};            // rad
inline constexpr Range kStartTolerance{"a number > 0, at most 0.1", 0, kMostStartTolerance, true};

/// What one value is.
struct Schema {
  enum class Type { kNumber, kInteger, kBoolean, kText, kWord, kList, kMap, kSection };
  struct Key;
  /// Keys of which at most one may be there.
  struct Choice {
    std::vector<std::string> keys;
    bool required = false;  ///< one must be
    [[nodiscard]] std::string allowed() const;
  };

  Schema(Type what);  // implicit, and elsewhere: Clang needs a vector's type whole where its member is initialised
  Type type;
  Range range = kFinite;                ///< of numbers
  std::size_t count = 0;                ///< of lists: how many items; 0: any number
  std::vector<std::string> words = {};  ///< of words: one of these
  std::vector<Schema> item = {};        ///< of lists and of maps with free keys: what each item is
  std::string name = {};                ///< of sections: its table's
  std::vector<Key> keys;                ///< of sections
  std::vector<Choice> choices = {};     ///< of sections
  std::vector<Schema> others = {};      ///< what may stand there instead
  bool nullable = false;

  /// This, or what may stand in its place, of that type; throws std::logic_error where there is neither.
  [[nodiscard]] const Schema& as(Type type) const;
  [[nodiscard]] const Key* find(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> key_names() const;
};

/// Whether a key must be there, and what holds where it is not.
struct Presence {
  bool required = false;
  std::string fallback = {};  ///< as a file would say it, or in words; empty where nothing stands for the key
  bool in_words = false;
};

struct Schema::Key {
  std::string name;
  Schema value;
  std::string unit;  ///< empty: none
  Presence presence;
  std::string meaning;
  std::string allowed = {};  ///< completes "is missing: allowed is ..."; empty: as the type says
  const char* group = "";    ///< the table that describes it, where it is not the section's own
};

[[nodiscard]] Schema number(const Range& range = kFinite);
[[nodiscard]] Schema integer(const Range& range = kFinite);
[[nodiscard]] Schema boolean();
[[nodiscard]] Schema text();
[[nodiscard]] Schema one_of(std::vector<std::string> words);
[[nodiscard]] Schema list(Schema item, std::size_t count = 0);
[[nodiscard]] Schema map(Schema item);
[[nodiscard]] Schema section(std::string name, std::vector<Schema::Key> keys, std::vector<Schema::Choice> choices = {});
[[nodiscard]] Schema or_null(Schema schema);
[[nodiscard]] Schema either(Schema first, Schema second);

[[nodiscard]] Presence required();
[[nodiscard]] Presence optional();
[[nodiscard]] Presence otherwise(double value);
[[nodiscard]] Presence otherwise(const std::optional<double>& value);  ///< null where there is none
[[nodiscard]] Presence otherwise(const char* word);
[[nodiscard]] Presence in_words(const char* fallback);

/// Completes "allowed is ..." where a value is missing.
[[nodiscard]] std::string allowed_text(const Schema::Key& key);

/// `schema_version` of results: rises when a key goes or changes its meaning.
inline constexpr int kResultVersion = 1;

/// Each of one kind of file; of CSV files that of a row, whose keys are the columns.
[[nodiscard]] const Schema& problem_schema();
[[nodiscard]] const Schema& result_schema();
[[nodiscard]] const Schema& campaign_schema();
[[nodiscard]] const Schema& trajectory_schema();
[[nodiscard]] const Schema& motion_schema();

}  // namespace swivel::io
