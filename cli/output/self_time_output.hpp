// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/timeline.hpp"

namespace swivel::cli {

/// Prints the stages of a timeline on standard error, the longest first: number of calls, their own
/// time without that of stages within them, and its share of the time of all threads. Stages after
/// the first eleven are summed up in one line.
void print_self_times(const Timeline& timeline);

}  // namespace swivel::cli
