// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/timeline.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <thread>

namespace swivel {
namespace {

void work(int depth) {
  TraceSpan span("outer");
  span.count("depth", depth);
  for (int k = 0; k < 3; ++k) const TraceSpan inner("inner");
}

TEST(Timeline, RecordsEveryThreadsSpansInnerBeforeOuter) {
  const Timeline timeline;
  for (int k = 0; k < 4; ++k) std::thread(work, k).join();
  const auto events = timeline.events();
  ASSERT_EQ(events.size(), 16u);
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Timeline::Event& event = events[k];
    EXPECT_EQ(event.thread, static_cast<int>(k / 4));
    EXPECT_EQ(std::string(event.name), k % 4 == 3 ? "outer" : "inner");
    EXPECT_LE(event.begin_ns, event.end_ns);
    const Timeline::Event& outer = events[k / 4 * 4 + 3];
    EXPECT_GE(event.begin_ns, outer.begin_ns);
    EXPECT_LE(event.end_ns, outer.end_ns);
    EXPECT_EQ(event.count, k % 4 == 3 ? static_cast<int>(k / 4) : 0);
  }
}

TEST(Timeline, ForgetsWhatRanBeforeItAndAllowsNoSecond) {
  work(0);
  {
    const Timeline first;
    EXPECT_THROW(Timeline second, std::logic_error);
    work(0);
    EXPECT_EQ(first.events().size(), 4u);
  }
  const Timeline next;
  EXPECT_TRUE(next.events().empty());
  work(0);
  EXPECT_EQ(next.events().size(), 4u);
}

}  // namespace
}  // namespace swivel
