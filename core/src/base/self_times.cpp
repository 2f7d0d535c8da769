// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/self_times.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace swivel {

std::vector<SelfTime> self_times(const std::vector<Timeline::Event>& events) {
  std::map<std::string, SelfTime> by_stage;
  std::vector<const Timeline::Event*> open;  // of this thread, ended, and in no later one so far
  for (const Timeline::Event& event : events) {
    if (!open.empty() && open.back()->thread != event.thread) open.clear();
    std::int64_t self = event.end_ns - event.begin_ns;
    for (; !open.empty() && open.back()->begin_ns >= event.begin_ns; open.pop_back())
      self -= open.back()->end_ns - open.back()->begin_ns;
    open.push_back(&event);
    SelfTime& sum = by_stage[event.name];
    ++sum.calls;
    sum.self_ns += self;
  }
  std::vector<SelfTime> times;
  for (auto& [stage, sum] : by_stage) {
    sum.stage = stage;
    times.push_back(std::move(sum));
  }
  std::stable_sort(times.begin(), times.end(),
                   [](const SelfTime& a, const SelfTime& b) { return a.self_ns > b.self_ns; });
  return times;
}

}  // namespace swivel
