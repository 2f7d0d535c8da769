// SPDX-License-Identifier: BSD-3-Clause
#include "schema/yaml_text.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace swivel::io {

namespace {

bool is_digit_or_point(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.';
}

/// Returns true if a word can stand without quotes, between brackets as well.
bool is_plain(const std::string& word) {
  constexpr std::string_view kInWords = "_-./+";
  constexpr std::string_view kNulls[] = {"~", "null", "Null", "NULL"};
  if (word.empty() || std::ranges::find(kNulls, word) != std::end(kNulls)) return false;
  if (word.front() == '-' && (word.size() == 1 || !is_digit_or_point(word[1]))) return false;
  return std::ranges::all_of(word,
                             [&](char c) {
                               return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                                      kInWords.find(c) != std::string_view::npos;
                             }) &&
         word != "...";
}

std::string quoted(const std::string& word) {
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    if (c == '\n')
      text += "\\n";
    else if (c == '\t')
      text += "\\t";
    else if (c == '\r')
      text += "\\r";
    else
      text += c;
  }
  return text + '"';
}

std::string with_comma(const std::string& text, const std::string& more) {
  return text.empty() ? more : text + ", " + more;
}

bool has_maps(const YAML::Node& value) {
  return value.IsSequence() && value.size() > 0 && value.begin()->IsMap();
}

}  // namespace

std::string flow_text(const YAML::Node& value) {
  if (value.IsScalar()) return is_plain(value.Scalar()) ? value.Scalar() : quoted(value.Scalar());
  std::string text;
  if (value.IsSequence()) {
    for (const YAML::Node& item : value) text = with_comma(text, flow_text(item));
    return "[" + text + "]";
  }
  if (!value.IsMap()) return "null";
  for (const auto& entry : value)
    text = with_comma(text, flow_text(entry.first) + ": " + flow_text(entry.second));
  return "{" + text + "}";
}

std::string block_text(const YAML::Node& value, std::size_t indent, const std::string& new_line) {
  if (!has_maps(value)) return " " + flow_text(value);
  std::string text;
  for (const YAML::Node& item : value)
    text += new_line + std::string(indent + 2, ' ') + "- " + flow_text(item);
  return text;
}

std::string document_text(const YAML::Node& root) {
  std::string text;
  for (const auto& section : root) {
    const std::string name = section.first.Scalar();
    text += name + ":";
    if (name != "robot" && name != "path") {
      text += block_text(section.second, 0, "\n") + "\n";
      continue;
    }
    for (const auto& entry : section.second)
      text += "\n  " + flow_text(entry.first) + ":" + block_text(entry.second, 2, "\n");
    text += "\n";
  }
  return text;
}

}  // namespace swivel::io
