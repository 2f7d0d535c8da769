// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::cli {

/// Throws InputError, which names the option and the nearest name, unless `name` is the name of one
/// of `items`. `kind` says what they are, as "link" or "joint", and `source` which file has them.
template <class Item>
void require_known(const char* option, const std::string& name, const std::vector<Item>& items,
                   const char* kind, const std::string& source) {
  std::vector<std::string> known;
  for (const Item& item : items) known.push_back(item.name);
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw InputError(std::string(option) + ": unknown " + kind + " '" + name + "'" +
                   (known.empty() ? "" : ", nearest is '" + nearest_name(name, known) + "'") +
                   ": allowed are the " + kind + "s of " + source);
}

}  // namespace swivel::cli
