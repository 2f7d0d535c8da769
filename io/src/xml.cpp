// SPDX-License-Identifier: BSD-3-Clause
#include "xml.hpp"

#include <string>

#include "bad_input.hpp"
#include "files.hpp"

namespace swivel::io {

tinyxml2::XMLElement& load_robot_xml(const std::filesystem::path& file, const char* kind, tinyxml2::XMLDocument& document) {
  const std::string text = read_file(file, std::string(kind) + " file");
  const std::string allowed = std::string("well-formed ") + kind + " with a <robot> element";
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    bad_input(at_line(file.string(), document.ErrorLineNum()), std::string("not XML (") + document.ErrorName() + ")", allowed);
  tinyxml2::XMLElement* const root = document.RootElement();
  if (root == nullptr || std::string(root->Name()) != "robot")
    bad_input(at_line(file.string(), root == nullptr ? 0 : root->GetLineNum()), "no <robot> element", allowed);
  return *root;
}

}  // namespace swivel::io
