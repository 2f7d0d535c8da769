// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace swivel::io {

/// Returns the number that fills the whole word, in any locale; none if it does not. May be
/// infinite or NaN if Value is a float.
template <class Value>
std::optional<Value> to_number(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Value value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Iterates over the words of a text and the lines that they are in.
class Words {
 public:
  explicit Words(std::string_view text, int first_line = 1) : rest_(text), line_(first_line) {}

  /// Returns the next word; empty at the end.
  std::string_view next() {
    skip_space();
    return take(std::min(rest_.find_first_of(kSpace), rest_.size()));
  }
  /// Returns the word that next() will return.
  [[nodiscard]] std::string_view peek() const { return Words(*this).next(); }
  /// Returns the rest of the current line, and skips it.
  std::string_view rest_of_line() { return take(std::min(rest_.find('\n'), rest_.size())); }
  /// Returns everything that was not yet returned.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  /// Returns the line of the word returned last.
  [[nodiscard]] int line() const { return line_; }

 private:
  static constexpr std::string_view kSpace = " \t\r\n\v\f";
  void skip_space() {
    std::size_t k = 0;
    for (; k < rest_.size() && kSpace.find(rest_[k]) != std::string_view::npos; ++k)
      line_ += rest_[k] == '\n';
    rest_.remove_prefix(k);
  }
  std::string_view take(std::size_t size) {
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }

  std::string_view rest_;
  int line_;
};

}  // namespace swivel::io
