// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/timeline.hpp"

namespace swivel::cli {

/// Prints the stages of a timeline on standard error, the longest first: calls, their own time
/// without that of stages within them, its share of all threads' time. Stages beyond the first
/// eleven are one line.
void print_self_times(const Timeline& timeline);

}  // namespace swivel::cli
