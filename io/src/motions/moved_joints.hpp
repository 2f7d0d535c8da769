// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>

#include "swivel/core/base/types.hpp"

namespace swivel::io {

/// Returns those of seven values, by joint, that a controller has: all, or if `roll` is true, all
/// but the last, which is the roll of the tool. Refers to `values`.
template <class Values>
auto moved_joints(bool roll, const Values& values) {
  return std::span(values.data(), static_cast<std::size_t>(roll ? kDof - 1 : kDof));
}

}  // namespace swivel::io
