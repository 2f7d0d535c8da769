// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <initializer_list>
#include <vector>

namespace swivel::test {

/// Returns the elements of all lists, one list after the other.
template <class T>
std::vector<T> concatenated(std::initializer_list<std::vector<T>> lists) {
  std::vector<T> all;
  for (const std::vector<T>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace swivel::test
