// SPDX-License-Identifier: BSD-3-Clause
#include "files/xml.hpp"

#include <algorithm>
#include <string>

#include "files/bad_input.hpp"
#include "files/files.hpp"

namespace swivel::io {

tinyxml2::XMLElement& parse_xml(const std::string& file, const std::string& text, const char* kind,
                                const char* root_name, tinyxml2::XMLDocument& document) {
  constexpr std::ptrdiff_t kMostTags = 2'000'000;  // each takes many times its bytes
  if (std::count(text.begin(), text.end(), '<') > kMostTags)
    bad_input(file, "has too many tags", "at most " + std::to_string(kMostTags));
  const std::string allowed =
      std::string("well-formed ") + kind + " with a <" + root_name + "> element";
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    bad_input(at_line(file, document.ErrorLineNum()),
              std::string("not XML (") + document.ErrorName() + ")", allowed);
  tinyxml2::XMLElement* const root = document.RootElement();
  if (root == nullptr || std::string(root->Name()) != root_name)
    bad_input(at_line(file, root == nullptr ? 0 : root->GetLineNum()),
              std::string("no <") + root_name + "> element", allowed);
  if (const auto* const second = root->NextSiblingElement())
    bad_input(at_line(file, second->GetLineNum()),
              std::string("a second element <") + second->Name() + "> beside <" + root_name + ">",
              allowed + " alone");
  return *root;
}

tinyxml2::XMLElement& load_robot_xml(const XmlSource& source, const char* kind,
                                     tinyxml2::XMLDocument& document) {
  const std::string name = source.file.string();
  if (const auto extension = source.file.extension(); extension == ".yaml" || extension == ".yml")
    bad_input(name, std::string("is a problem file, or other YAML, and no ") + kind + " file",
              std::string("a ") + kind +
                  " file; of a problem file `swivel info --pairs` lists the bodies and `swivel "
                  "plan` plans it");
  if (!source.text)
    return parse_xml(name, read_file(source.file, std::string(kind) + " file", kMostXmlBytes), kind,
                     "robot", document);
  if (source.text->size() > kMostXmlBytes)
    bad_input(name, "has " + std::to_string(source.text->size()) + " bytes",
              "at most " + std::to_string(kMostXmlBytes));
  return parse_xml(name, *source.text, kind, "robot", document);
}

}  // namespace swivel::io
