// SPDX-License-Identifier: BSD-3-Clause
// The elements and attributes that an XML format has, so that a file is either understood or
// refused.
#pragma once
#include <tinyxml2.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace swivel::io {

/// Collects warnings about what a reader ignores, one for each kind, at its first place in the
/// file.
class XmlWarnings {
 public:
  /// Adds a warning. `where` is file and line; `what` is the text, equal for warnings of one kind.
  void add(const std::string& where, const std::string& what);
  /// Returns the warnings as "<where>: <what>", with the number of further ones, in the order of
  /// the file.
  [[nodiscard]] std::vector<std::string> list() const;

 private:
  struct Kind {
    std::string where, what;
    std::size_t count = 1;
  };
  std::vector<Kind> kinds_;
  std::size_t others_ = 0;  ///< warnings of further kinds, which are only counted
};

/// An element of a format, with what it may contain.
struct XmlElement {
  /// How attributes, elements and text that the format does not have are treated. An element that
  /// states geometry, limits or which joints move refuses them; one in which other programs put
  /// data of their own warns of them.
  enum class Unknown { kRefused, kWarnedOf };

  const char* name;
  std::vector<const char*> attributes = {};
  std::vector<XmlElement> children = {};  ///< that are read
  /// elements of the format that state nothing a planner reads; their content is not read either
  std::vector<const char*> unread = {};
  Unknown unknown = Unknown::kRefused;
  bool many = false;  ///< may stand more than once in its parent
};

/// Compares an element and all within it with the format. Throws InputError for unknown names, what
/// xacro left unexpanded, and text, if the element refuses these, and for an element that occurs
/// twice but may not. (TinyXML-2 refuses an attribute that occurs twice.) Names with the prefix of
/// another program (drake:, tesseract:) give a warning everywhere; declarations of name spaces are
/// allowed. `file` is for messages.
void check_words(const tinyxml2::XMLElement& element, const XmlElement& format,
                 const std::string& file, XmlWarnings& warnings);

}  // namespace swivel::io
