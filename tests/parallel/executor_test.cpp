// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "seed.hpp"
#include "swivel/parallel/executor.hpp"

namespace swivel {
namespace {

using namespace test;

/// Keeps a core busy for some nanoseconds a step.
void keep_busy(int steps) {
  for (std::atomic<int> step{0}; step < steps;) ++step;
}

TEST(Executor, EveryIndexIsVisitedOnceAndExceptionsArePassedOn) {
  using Method = void (Executor::*)(int, const std::function<void(int, int)>&);
  for (const Method for_each : {Method(&Executor::for_each), Method(&Executor::for_each_short)})
    for (const int threads : {1, 2, 3, 8}) {
      Executor executor(threads);
      EXPECT_EQ(executor.threads(), threads);
      // A hundred thousand steps an index are worth sharing, none are not.
      for (const int count : {0, 1, 7, 1000})
        for (const int work : {0, 100000}) {
          if (count == 1000 && work > 0) continue;
          std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
          (executor.*for_each)(count, [&](int index, int worker) {
            EXPECT_GE(worker, 0);
            EXPECT_LT(worker, threads);
            keep_busy(work);
            ++visits[static_cast<std::size_t>(index)];
          });
          for (const auto& visit : visits) EXPECT_EQ(visit, 1);
        }
      for (const int failing : {0, 17, 49})
        EXPECT_THROW((executor.*for_each)(50,
                                          [&](int index, int) {
                                            if (index == failing) throw std::runtime_error("x");
                                          }),
                     std::runtime_error);
    }
}

TEST(Executor, WorkBesideACallMayNotShareItself) {
  Executor executor(2);
  executor.start_helpers();
  const auto nothing = [](int, int) {};
  EXPECT_THROW(
      executor.for_each_overlapped(4, nothing, [&] { executor.for_each_short(4, nothing); }),
      std::logic_error);
  executor.for_each_short(4, nothing);
}

/// Calls of some microseconds each, with pauses in which helpers stay awake or fall asleep, and
/// some that throw.
TEST(Executor, BriefCallsInARowVisitEveryIndexOnce) {
  Random random(seed("Executor.BriefCalls"));
  std::int64_t visited = 0, thrown = 0;
  for (const int threads : {1, 2, 3, 8}) {
    Executor executor(threads);
    if (threads == 3)
      executor.start_helpers();
    else
      executor.for_each_short(40, [&](int, int) { keep_busy(1'000'000); });  // begins threads, too
    std::vector<int> visits;
    for (int call = 0; call < trials(2000); ++call) {
      const int count = random.below(20), steps = random.below(2000);
      const int failing = count > 0 && random.below(8) == 0 ? random.below(count) : -1;
      visits.assign(static_cast<std::size_t>(count), 0);
      const auto body = [&](int index, int worker) {
        if (worker < 0 || worker >= threads) throw std::logic_error("no such worker");
        keep_busy(steps);
        ++visits[static_cast<std::size_t>(index)];
        if (index == failing) throw std::runtime_error("x");
      };
      const bool beside = random.coin(), work_fails = random.below(16) == 0;
      int worked = 0;
      const auto work = [&] {
        keep_busy(steps / 2);
        ++worked;
        if (work_fails) throw std::invalid_argument("y");
      };
      const auto call_it = [&] {
        beside ? executor.for_each_overlapped(count, body, work)
               : executor.for_each_short(count, body);
      };
      if (beside && work_fails) {
        ASSERT_THROW(call_it(), std::invalid_argument);
        ++thrown;
      } else if (failing < 0) {
        call_it();
        for (const int visit : visits) ASSERT_EQ(visit, 1);
        visited += count;
      } else {
        ASSERT_THROW(call_it(), std::runtime_error);
        ++thrown;
      }
      ASSERT_EQ(worked, beside ? 1 : 0);
      if (random.below(50) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(random.below(5)));
    }
  }
  std::printf("%lld indices visited once, %lld calls threw\n", static_cast<long long>(visited),
              static_cast<long long>(thrown));
  EXPECT_GE(visited, at_least(40'000));
  EXPECT_GE(thrown, at_least(500));
}

#ifndef __SANITIZE_THREAD__
TEST(Executor, AProcessThatForksNeedNotWaitForHelpers) {
  auto executor = std::make_unique<Executor>(4);
  const auto work = [&] {
    std::atomic<int> sum{0};
    executor->for_each_short(40, [&](int index, int) {
      keep_busy(1'000'000);
      sum += index;
    });
    return sum.load();
  };
  ASSERT_EQ(work(), 780);  // began helpers
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    alarm(30);  // ends it where it waits
    const bool right = work() == 780;
    executor.reset();
    _exit(right ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(work(), 780);
}
#endif

/// Runs loops of 50 indices, some 20 us each, until helpers have called 1000 of them or 20 s are
/// over. Returns the number of loops.
int loops_until_helped(Executor& executor) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  int loops = 0;
  for (; executor.helped() < 1000 && std::chrono::steady_clock::now() < end; ++loops)
    executor.for_each_short(50, [](int, int) { keep_busy(5000); });
  return loops;
}

#ifndef __SANITIZE_THREAD__
TEST(Executor, WhatTheCallerDoesNotCallItselfIsCalledInTbbsArena) {
  Executor executor(2);
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::int64_t> elsewhere{0}, outside{0};
  executor.start_helpers();
  for (int loop = 0; loop < 20'000 && elsewhere < 1000; ++loop)
    executor.for_each_short(50, [&](int, int worker) {
      keep_busy(500);
      if (std::this_thread::get_id() == caller) return;
      ++elsewhere;
      // A thread that TBB does not own has no index in an arena.
      if (tbb::this_task_arena::current_thread_index() == tbb::task_arena::not_initialized ||
          worker == 0)
        ++outside;
    });
  EXPECT_GE(elsewhere, 1000);
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(executor.helped(), elsewhere);
}

TEST(Executor, AProgramsOwnLimitOfTbbIsKept) {
  Executor executor(4);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    executor.start_helpers();
    for (int loop = 0; loop < 100; ++loop)
      executor.for_each_short(50, [](int, int) { keep_busy(5000); });
    EXPECT_EQ(executor.helped(), 0);
  }
  EXPECT_GT(loops_until_helped(executor), 0);
  EXPECT_GE(executor.helped(), 1000);
}

TEST(Executor, LimitsNoOtherWorkOfTheProgram) {
  const std::size_t before =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  Executor executor(1 < before ? 2 : 1);
  executor.for_each(10, [](int, int) {});
  executor.start_helpers();
  EXPECT_EQ(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
            before);
}
#endif

}  // namespace
}  // namespace swivel
