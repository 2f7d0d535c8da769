// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/base/timeline.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "seed.hpp"
#include "swivel/core/base/self_times.hpp"

namespace swivel {
namespace {

using test::Random;

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

TEST(SelfTimes, LeaveOutWhatRanWithin) {
  using Event = Timeline::Event;
  // plan 0 to 100: sweep 10 to 30, ask 40 to 90 with two nodes; on another thread a node.
  const std::vector<Event> events{
      {"sweep", 10, 30, 0, nullptr, 0}, {"node", 40, 55, 0, nullptr, 0},
      {"node", 55, 60, 0, nullptr, 0},  {"ask", 40, 90, 0, nullptr, 0},
      {"plan", 0, 100, 0, nullptr, 0},  {"node", 42, 50, 1, nullptr, 0}};
  const auto times = self_times(events);
  ASSERT_EQ(times.size(), 4u);
  const auto expect = [&](std::size_t k, const char* stage, int calls, int self) {
    EXPECT_EQ(times[k].stage, stage);
    EXPECT_EQ(times[k].calls, calls);
    EXPECT_EQ(times[k].self_ns, self);
  };
  expect(0, "ask", 1, 30);
  expect(1, "plan", 1, 30);
  expect(2, "node", 3, 28);
  expect(3, "sweep", 1, 20);
  EXPECT_TRUE(self_times({}).empty());
}

/// Adds a span and random ones within it, inner before outer. How long it lasts.
std::int64_t add_spans(Random& random, int depth, int thread, std::int64_t& now,
                       std::vector<Timeline::Event>& events,
                       std::map<std::string, std::int64_t>& self) {
  constexpr const char* kNames[] = {"a", "b", "c", "d"};
  const char* const name = kNames[random.below(4)];
  const std::int64_t begin = now;
  std::int64_t own = 0;
  const auto work = [&] {
    const std::int64_t ns =
        random.below(4);  // none, too: inner spans may begin when the outer one does
    now += ns;
    own += ns;
  };
  work();
  for (int k = depth > 0 ? random.below(4) : 0; k > 0; --k) {
    add_spans(random, depth - 1, thread, now, events, self);
    work();
  }
  self[name] += own;
  events.push_back({name, begin, now, thread, nullptr, 0});
  return now - begin;
}

TEST(SelfTimes, AddUpToTheOutermostSpans) {
  const std::uint64_t base = test::seed("SelfTimes");
  Random random(base);
  std::size_t spans = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Timeline::Event> events;
    std::map<std::string, std::int64_t> self;
    std::int64_t outermost = 0, sum = 0;
    for (int thread = 0; thread < 3; ++thread) {
      std::int64_t now = random.below(3);
      for (int k = random.below(4); k > 0; --k)
        outermost += add_spans(random, 4, thread, now, events, self);
    }
    for (const SelfTime& time : self_times(events)) {
      EXPECT_EQ(time.self_ns, self[time.stage])
          << "SWIVEL_TEST_SEED " << base << " trial " << trial << " " << time.stage;
      sum += time.self_ns;
    }
    EXPECT_EQ(sum, outermost) << "SWIVEL_TEST_SEED " << base << " trial " << trial;
    spans += events.size();
  }
  std::printf("%zu spans\n", spans);
  EXPECT_GT(spans, 5000u);
}

}  // namespace
}  // namespace swivel
