// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>

#include "swivel/core/motion/time_path.hpp"

namespace swivel::io {

/// Returns those of seven values, by joint, that a controller has: all but the roll of the tool.
/// Refers to `values`.
template <class Values>
auto moved_joints(const TimedPath& motion, const Values& values) {
  return std::span(values.data(), static_cast<std::size_t>(motion.roll ? kDof - 1 : kDof));
}

}  // namespace swivel::io
