// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

/// The time of all spans of one name, less that of the spans within them.
struct SelfTime {
  std::string stage;         ///< their name
  std::int64_t calls = 0;    ///< how many there were, on all threads
  std::int64_t self_ns = 0;  ///< of all threads together
};

/// Self time by stage, the longest first. `events` are those of a Timeline, in its order: by
/// thread, inner spans before the outer one. The sum over all stages is the time that the threads
/// spent in outermost spans.
[[nodiscard]] std::vector<SelfTime> self_times(const std::vector<Timeline::Event>& events);

}  // namespace swivel
