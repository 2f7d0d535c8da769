// SPDX-License-Identifier: BSD-3-Clause
#include "output/self_time_output.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/core/base/self_times.hpp"
#include "swivel/parallel/executor.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

void print_self_times(const Timeline& timeline) {
  constexpr std::size_t kMostLines = 12;
  const std::vector<Timeline::Event> events = timeline.events();
  const std::vector<SelfTime> times = self_times(events);
  const auto sum_from = [&](std::size_t first) {
    SelfTime sum;
    for (std::size_t k = first; k < times.size(); ++k) {
      sum.calls += times[k].calls;
      sum.self_ns += times[k].self_ns;
    }
    return sum;
  };
  const auto ms = [](std::int64_t ns) { return 1e-6 * static_cast<double>(ns); };
  const double all = ms(sum_from(0).self_ns);
  complain("swivel: self time by stage, %.1f ms on all threads\n  %-26s %9s %11s %7s\n", all,
           "stage", "calls", "self, ms", "share");
  const auto print = [&](const std::string& stage, const SelfTime& time) {
    const double own = ms(time.self_ns);
    complain("  %-26s %9lld %11.3f %5.1f %%\n", stage.c_str(), static_cast<long long>(time.calls),
             own, all > 0 ? 100 * own / all : 0.0);
  };
  const std::size_t shown = times.size() <= kMostLines ? times.size() : kMostLines - 1;
  for (std::size_t k = 0; k < shown; ++k) print(times[k].stage, times[k]);
  if (shown < times.size())
    print(std::to_string(times.size() - shown) + " other stages", sum_from(shown));
  std::int64_t indices = 0, arena_ns = 0;
  for (const Timeline::Event& event : events)
    if (std::string_view(event.name) == Executor::kHelperSpan) {
      ++indices;
      arena_ns += event.end_ns - event.begin_ns;
    }
  if (indices > 0)
    complain("  parts of shared loops in TBB's arena: %lld, in %.1f ms\n",
             static_cast<long long>(indices), ms(arena_ns));
}

}  // namespace swivel::cli
