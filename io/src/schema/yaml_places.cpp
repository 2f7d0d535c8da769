// SPDX-License-Identifier: BSD-3-Clause
#include "schema/yaml_places.hpp"

#include <algorithm>
#include <string_view>

#include "files/bad_input.hpp"

namespace swivel::io {

namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kSpace = " \t\r\n";

}  // namespace

void YamlPlaces::fail(const YAML::Node& node, const std::string& what) const {
  bad_input(at_line(source_, node.Mark().line + 1), what + ": cannot be changed in place",
            "plain values on lines of their own or in brackets, without anchors, aliases, tags and "
            "line breaks in words");
}

std::size_t YamlPlaces::place(const YAML::Node& node) const {
  const std::size_t begin = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  const std::size_t found = begin + static_cast<std::size_t>(std::max(0, node.Mark().pos));
  if (found > text_.size()) fail(node, "it");
  return found;
}

std::size_t YamlPlaces::column(std::size_t at) const {
  return at - line_begin(at);
}
std::size_t YamlPlaces::line_begin(std::size_t at) const {
  const std::size_t found = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
  if (found != std::string::npos) return found + 1;
  return text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
}
std::size_t YamlPlaces::line_end(std::size_t at) const {
  const std::size_t found = std::min(text_.find('\n', at), text_.size());
  return found > at && text_[found - 1] == '\r' ? found - 1 : found;
}
std::string YamlPlaces::new_line() const {
  const std::size_t first = text_.find('\n');
  return first != std::string::npos && first > 0 && text_[first - 1] == '\r' ? "\r\n" : "\n";
}

std::size_t YamlPlaces::skip_blanks(std::size_t from) const {
  return std::min(text_.find_first_not_of(kBlanks, from), text_.size());
}
/// Skips line breaks and comments as well.
std::size_t YamlPlaces::skip_space(std::size_t from) const {
  for (std::size_t k = from;;) {
    k = std::min(text_.find_first_not_of(kSpace, k), text_.size());
    if (at(k) != '#') return k;
    k = line_end(k);
  }
}
std::size_t YamlPlaces::skip_word(std::size_t from) const {
  return std::min(text_.find_first_of(" \t\r\n,[]{}", from), text_.size());
}
/// Skips anchors and tags before a value.
std::size_t YamlPlaces::skip_properties(std::size_t from) const {
  while (at(from) == '&' || at(from) == '!') from = skip_space(skip_word(from));
  return from;
}

std::size_t YamlPlaces::quoted_end(std::size_t from) const {
  const char quote = text_[from];
  for (std::size_t k = from + 1; k < text_.size(); ++k) {
    if (quote == '"' && text_[k] == '\\')
      ++k;
    else if (text_[k] == quote && quote == '\'' && at(k + 1) == '\'')
      ++k;
    else if (text_[k] == quote)
      return k + 1;
  }
  return text_.size();
}

std::size_t YamlPlaces::brackets_end(std::size_t from) const {
  int open = 0;
  for (std::size_t k = from; k < text_.size();) {
    const char c = text_[k];
    if (c == '"' || c == '\'') {
      // Within a plain word an apostrophe is a letter.
      const bool begins = kSpace.find(text_[k - 1]) != std::string_view::npos ||
                          std::string_view("[{,:").find(text_[k - 1]) != std::string_view::npos;
      k = begins ? quoted_end(k) : k + 1;
      continue;
    }
    if (c == '#' && kSpace.find(text_[k - 1]) != std::string_view::npos) {
      k = line_end(k);
      continue;
    }
    if (c == '[' || c == '{') ++open;
    if ((c == ']' || c == '}') && --open == 0) return k + 1;
    ++k;
  }
  return text_.size();
}

std::size_t YamlPlaces::scalar_end(const YAML::Node& node, std::size_t from) const {
  if (at(from) == '"' || at(from) == '\'') return quoted_end(from);
  const std::string& word = node.Scalar();
  if (text_.compare(from, word.size(), word) != 0) fail(node, "'" + word + "'");
  return from + word.size();
}

bool YamlPlaces::in_brackets(const YAML::Node& node) const {
  const char c = at(skip_properties(place(node)));
  return c == '[' || c == '{';
}

std::size_t YamlPlaces::end_of(const YAML::Node& node, std::size_t from) const {
  if (at(from) == '*') return skip_word(from);
  const std::size_t content = skip_properties(from);
  if (at(content) == '[' || at(content) == '{') return brackets_end(content);
  if (node.IsScalar()) return scalar_end(node, content);
  const std::vector<YamlPart> all = parts(node);
  return all.empty() ? content : all.back().end;
}

void YamlPlaces::find_value(YamlPart& part) const {
  if (!part.value.IsNull()) {
    part.value_begin = skip_space(part.separated);
    part.end = end_of(part.value, part.value_begin);
    return;
  }
  part.value_begin = part.end = part.separated;
  const std::size_t word = skip_blanks(part.separated);
  for (const std::string_view null : {"~", "null", "Null", "NULL"})
    if (text_.compare(word, null.size(), null) == 0)
      part.value_begin = word, part.end = word + null.size();
}

std::vector<YamlPart> YamlPlaces::entries(const YAML::Node& map) const {
  std::vector<YamlPart> all;
  for (const auto& entry : map) {
    YamlPart& part = all.emplace_back();
    part.key = entry.first, part.value = entry.second;
    part.begin = place(part.key);
    const std::size_t colon = skip_blanks(scalar_end(part.key, part.begin));
    if (at(colon) != ':') fail(part.key, "'" + part.name() + "'");
    part.separated = colon + 1;
    find_value(part);
  }
  return all;
}

std::vector<YamlPart> YamlPlaces::items(const YAML::Node& list) const {
  const bool brackets = in_brackets(list);
  std::vector<YamlPart> all;
  std::size_t from = skip_properties(place(list)) + (brackets ? 1 : 0);
  for (const YAML::Node& item : list) {
    YamlPart& part = all.emplace_back();
    part.value = item;
    part.begin = skip_space(from);
    if (!brackets && at(part.begin) != '-') fail(item, "a list");
    part.separated = part.begin + (brackets ? 0 : 1);
    find_value(part);
    from = part.end;
    if (brackets && at(skip_space(from)) == ',') from = skip_space(from) + 1;
  }
  return all;
}

std::vector<YamlPart> YamlPlaces::parts(const YAML::Node& node) const {
  if (node.IsMap()) return entries(node);
  return node.IsSequence() ? items(node) : std::vector<YamlPart>();
}

}  // namespace swivel::io
