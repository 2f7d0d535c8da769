// SPDX-License-Identifier: BSD-3-Clause
// Which elements and attributes an XML format has, so that a file is either understood or told from one that is.
#pragma once
#include <tinyxml2.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace swivel::io {

/// What a reader does not honour, said once for each kind, at the first place where it stands.
class XmlWarnings {
 public:
  /// `where`: file and line. `what` is the same text wherever it is the same thing.
  void add(const std::string& where, const std::string& what);
  /// "<where>: <what>", with how often more, in the order of the file.
  [[nodiscard]] std::vector<std::string> list() const;

 private:
  struct Kind {
    std::string where, what;
    std::size_t count = 1;
  };
  std::vector<Kind> kinds_;
  std::size_t others_ = 0;  ///< beyond as many kinds as anybody reads
};

/// An element of a format: what it may hold.
struct XmlElement {
  /// What becomes of attributes, elements and text that the format does not have. An element that states geometry, limits or which
  /// joints move refuses them; one in which other programs put data of their own warns of them.
  enum class Unknown { kRefused, kWarnedOf };

  const char* name;
  std::vector<const char*> attributes = {};
  std::vector<XmlElement> children = {};  ///< which are read
  std::vector<const char*> unread = {};   ///< elements of the format that state nothing a planner reads; nor is read what they hold
  Unknown unknown = Unknown::kRefused;
  bool many = false;  ///< may stand more than once in its parent
};

/// Holds an element and all within it against the format. Throws InputError for unknown names, what xacro left unexpanded, and text
/// where these are refused, and for an element that stands twice and may not. (An attribute that stands twice is refused by
/// TinyXML-2.) Names with the prefix of another program (drake:, tesseract:) are warned of everywhere; declarations of name spaces
/// pass. `file` is for messages.
void check_words(const tinyxml2::XMLElement& element, const XmlElement& format, const std::string& file, XmlWarnings& warnings);

}  // namespace swivel::io
