// SPDX-License-Identifier: BSD-3-Clause
// The schemas of files: names, types, units, ranges and meaning of their keys. The reader of
// problem files takes from them what it allows; `swivel schema` prints them.
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

/// A range of allowed numbers.
struct Range {
  const char* allowed;  ///< completes "allowed is ..."
  double least = -std::numeric_limits<double>::infinity(),
         most = std::numeric_limits<double>::infinity();
  bool above_least = false;  ///< `least` itself is not allowed
  /// Returns true if the value is finite and within the range.
  [[nodiscard]] bool has(double value) const;
};

inline constexpr Range kFinite{"a finite number"};
inline constexpr Range kNonNegative{"a finite number >= 0", 0};
inline constexpr Range kPositive{"a finite number > 0", 0, std::numeric_limits<double>::infinity(),
                                 true};
inline constexpr Range kCoordinate{"a number from -1000 to 1000", -kMostMetres, kMostMetres};  // m
inline constexpr Range kExtent{"a number >= 0, at most 1000", 0, kMostMetres};                 // m
inline constexpr Range kLength{kLengthAllowed, 0, kMostMetres, true};                          // m
// rad
inline constexpr Range kTurn{"a finite number > 0, at most 2*pi", 0, kTwoPi, true};
inline constexpr Range kShare{"a number > 0, at most 1", 0, 1, true};
inline constexpr Range kStartTolerance{"a number > 0, at most 0.1", 0, kMostStartTolerance, true};

/// The schema of one value: its type, and what that type allows.
struct Schema {
  enum class Type { kNumber, kInteger, kBoolean, kText, kWord, kList, kMap, kSection };
  struct Key;
  /// A set of keys of which at most one may be given.
  struct Choice {
    std::vector<std::string> keys;
    bool required = false;  ///< exactly one must be given
    /// Returns the text that completes "allowed is ...".
    [[nodiscard]] std::string allowed() const;
  };

  /// A key that a section refuses with words of its own, since people expect it there.
  struct Refusal {
    std::string key, what;
    std::string allowed;  ///< completes "allowed is ..."
  };

  // implicit, and elsewhere: Clang needs a vector's type whole where its member is initialised
  Schema(Type what);
  Type type;
  Range range = kFinite;                ///< of numbers
  std::size_t count = 0;                ///< of lists: the number of items; 0 for any number
  std::vector<std::string> words = {};  ///< of words: one of these
  /// of lists and of maps with free keys: the schema of an item
  std::vector<Schema> item = {};
  std::string name = {};              ///< of sections: the name of its table
  std::vector<Key> keys;              ///< of sections
  std::vector<Choice> choices = {};   ///< of sections
  std::vector<Refusal> refused = {};  ///< of sections: keys that they do not have
  std::vector<Schema> others = {};    ///< schemas that are allowed instead
  bool nullable = false;

  /// Returns the schema of the given type: this one, or one that is allowed instead. Throws
  /// std::logic_error if there is none.
  [[nodiscard]] const Schema& as(Type type) const;
  /// Returns the key of a section with this name; null if there is none.
  [[nodiscard]] const Key* find(const std::string& key) const;
  /// Returns the names of a section's keys, in their order.
  [[nodiscard]] std::vector<std::string> key_names() const;
};

/// Whether a key is required, and what holds if it is missing.
struct Presence {
  bool required = false;
  /// as a file would say it, or in words; empty where nothing stands for the key
  std::string fallback = {};
  bool in_words = false;
};

/// A key of a section.
struct Schema::Key {
  std::string name;
  Schema value;
  std::string unit;  ///< empty: none
  Presence presence;
  std::string meaning;
  std::string allowed = {};  ///< completes "is missing: allowed is ..."; empty: as the type says
  const char* group = "";    ///< the table that describes it, where it is not the section's own
  std::string beside = {};   ///< the key beside which alone it may stand; empty: any
};

/// Returns the refusal of a key that is not built yet.
[[nodiscard]] Schema::Refusal not_yet(std::string key);
/// Returns the section with keys that it refuses in words of its own.
[[nodiscard]] Schema refusing(Schema section, std::vector<Schema::Refusal> keys);

/// Returns the schema of a number in a range.
[[nodiscard]] Schema number(const Range& range = kFinite);
/// Returns the schema of a whole number in a range.
[[nodiscard]] Schema integer(const Range& range = kFinite);
/// Returns the schema of a boolean.
[[nodiscard]] Schema boolean();
/// Returns the schema of a text.
[[nodiscard]] Schema text();
/// Returns the schema of one of several words.
[[nodiscard]] Schema one_of(std::vector<std::string> words);
/// Returns the schema of a list of `count` items, or of any number of them if it is 0.
[[nodiscard]] Schema list(Schema item, std::size_t count = 0);
/// Returns the schema of a map with free keys, whose values are items.
[[nodiscard]] Schema map(Schema item);
/// Returns the schema of a section with these keys; `name` is that of its table, or empty.
[[nodiscard]] Schema section(std::string name, std::vector<Schema::Key> keys,
                             std::vector<Schema::Choice> choices = {});
/// Returns the keys of one list and then those of another.
[[nodiscard]] std::vector<Schema::Key> join(std::vector<Schema::Key> first,
                                            const std::vector<Schema::Key>& second);
/// Returns the schema with null allowed as well.
[[nodiscard]] Schema or_null(Schema schema);
/// Returns the first schema with the second allowed instead.
[[nodiscard]] Schema either(Schema first, Schema second);

/// Returns the presence of a key that must be given.
[[nodiscard]] Presence required();
/// Returns the presence of a key that may be missing, and for which nothing stands then.
[[nodiscard]] Presence optional();
/// Returns the presence of a key for which a number stands if it is missing.
[[nodiscard]] Presence otherwise(double value);
[[nodiscard]] Presence otherwise(const std::optional<double>& value);  ///< null where there is none
/// Returns the presence of a key for which a word stands if it is missing.
[[nodiscard]] Presence otherwise(const char* word);
/// Returns the presence of a key whose default is described in words.
[[nodiscard]] Presence in_words(const char* fallback);

/// Returns the text that completes "allowed is ..." for a missing key.
[[nodiscard]] std::string allowed_text(const Schema::Key& key);

/// The `schema_version` of results; it rises when a key is removed or changes its meaning.
inline constexpr int kResultVersion = 1;

/// Returns the schema of a problem file.
[[nodiscard]] const Schema& problem_schema();
/// Returns the schema of RESULT.json.
[[nodiscard]] const Schema& result_schema();
/// Returns the schema of a campaign's summary.
[[nodiscard]] const Schema& campaign_schema();
/// Returns the schema of a row of a trajectory's CSV file, whose keys are the columns.
[[nodiscard]] const Schema& trajectory_schema();
/// Returns the schema of a row of a job's CSV file, whose keys are the columns.
[[nodiscard]] const Schema& job_trajectory_schema();
/// Returns the schema of a row of a timed motion's CSV file, whose keys are the columns.
[[nodiscard]] const Schema& motion_schema();

}  // namespace swivel::io
