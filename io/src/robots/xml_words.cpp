// SPDX-License-Identifier: BSD-3-Clause
#include "robots/xml_words.hpp"

#include <algorithm>
#include <string_view>

#include "files/bad_input.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kMostKinds = 50;
constexpr std::size_t kLongestName = 60;  // of the formats' own none is longer

bool has(const std::vector<const char*>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string shortened(std::string_view text) {
  return printable(text.substr(0, kLongestName)) + (text.size() > kLongestName ? "..." : "");
}

std::string in_brackets(std::string_view name) {
  return std::string("<") + shortened(name) + ">";
}

class Checker {
 public:
  Checker(const std::string& file, XmlWarnings& warnings) : file_(file), warnings_(warnings) {}

  void check(const tinyxml2::XMLElement& element, const XmlElement& format) {
    check_attributes(element, format);
    std::vector<const tinyxml2::XMLElement*> first(format.children.size());
    for (const tinyxml2::XMLNode* node = element.FirstChild(); node != nullptr;
         node = node->NextSibling()) {
      if (const tinyxml2::XMLText* const text = node->ToText()) {
        const std::string_view words = text->Value();
        if (words.find_first_not_of(" \t\r\n") != std::string_view::npos)
          unknown(format, node->GetLineNum(), std::string("text in <") + format.name + ">",
                  "attributes and elements");
      }
      const tinyxml2::XMLElement* const child = node->ToElement();
      if (child == nullptr || has(format.unread, child->Name())) continue;
      const auto known = std::find_if(
          format.children.begin(), format.children.end(),
          [&](const XmlElement& one) { return std::string_view(one.name) == child->Name(); });
      if (known == format.children.end()) {
        std::vector<std::string> names;
        for (const XmlElement& one : format.children) names.emplace_back(one.name);
        unknown_name(format, child->GetLineNum(), "element", in_brackets(child->Name()),
                     child->Name(), names);
        continue;
      }
      const tinyxml2::XMLElement*& earlier =
          first[static_cast<std::size_t>(known - format.children.begin())];
      if (earlier != nullptr && !known->many)
        bad_input(at(child->GetLineNum()),
                  std::string("<") + format.name + "> has a second <" + known->name +
                      ">, the first is in line " + std::to_string(earlier->GetLineNum()),
                  "one");
      if (earlier == nullptr) earlier = child;
      check(*child, *known);
    }
  }

 private:
  [[nodiscard]] std::string at(int line) const { return at_line(file_, line); }

  void check_attributes(const tinyxml2::XMLElement& element, const XmlElement& format) {
    for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      const std::string_view name = attribute->Name();
      if (has(format.attributes, name) || name == "xmlns" || name.starts_with("xmlns:")) continue;
      unknown_name(format, element.GetLineNum(), "attribute",
                   std::string("'") + shortened(name) + "'", name,
                   {format.attributes.begin(), format.attributes.end()});
    }
  }

  void unknown_name(const XmlElement& format, int line, const char* kind, const std::string& shown,
                    std::string_view name, const std::vector<std::string>& known) {
    const std::size_t colon = name.find(':');
    const std::string_view prefix = name.substr(0, colon == std::string_view::npos ? 0 : colon);
    if (prefix == "xacro")
      return unknown(format, line,
                     std::string(kind) + " " + shown + " in <" + format.name +
                         "> stands where xacro did not run",
                     "a file as `xacro FILE` prints it");
    std::string what = std::string("unknown ") + kind + " " + shown + " in <" + format.name + ">";
    if (!prefix.empty()) return warnings_.add(at(line), what + ": it is not read");
    std::string allowed = "nothing of the kind";
    if (!known.empty()) {
      what += ", nearest known is '" +
              nearest_name(std::string(name.substr(0, kLongestName)), known) + "'";
      allowed.clear();
      for (const std::string& one : known) allowed += (allowed.empty() ? "" : ", ") + one;
    }
    unknown(format, line, what, allowed);
  }

  void unknown(const XmlElement& format, int line, const std::string& what,
               const std::string& allowed) {
    if (format.unknown == XmlElement::Unknown::kRefused) bad_input(at(line), what, allowed);
    warnings_.add(at(line), what + ": it is not read");
  }

  const std::string& file_;
  XmlWarnings& warnings_;
};

}  // namespace

void XmlWarnings::add(const std::string& where, const std::string& what) {
  const auto known = std::find_if(kinds_.begin(), kinds_.end(),
                                  [&](const Kind& kind) { return kind.what == what; });
  if (known != kinds_.end())
    ++known->count;
  else if (kinds_.size() < kMostKinds)
    kinds_.push_back({where, what});
  else
    ++others_;
}

std::vector<std::string> XmlWarnings::list() const {
  std::vector<std::string> lines;
  for (const auto& [where, what, count] : kinds_)
    lines.push_back(printable(where) + ": " + what +
                    (count > 1 ? " (and " + std::to_string(count - 1) + " more of these)" : ""));
  if (others_ > 0) lines.push_back("and " + std::to_string(others_) + " more that are not known");
  return lines;
}

void check_words(const tinyxml2::XMLElement& element, const XmlElement& format,
                 const std::string& file, XmlWarnings& warnings) {
  Checker(file, warnings).check(element, format);
}

}  // namespace swivel::io
