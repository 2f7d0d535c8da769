// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

namespace swivel {

/// Returns strokes by their names in words: "stroke 'ring'", "strokes 'a', 'b'".
inline std::string stroke_or_strokes(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return (names.size() == 1 ? "stroke " : "strokes ") + text;
}

}  // namespace swivel
