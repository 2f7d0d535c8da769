// SPDX-License-Identifier: BSD-3-Clause
// Which thread asks a question about collision: the caller's, or one of TBB's arena.
#include <gtest/gtest.h>

#include <chrono>
#include <string_view>
#include <vector>

#include "random_problem.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

/// How many questions about nodes and edges each kind of thread asked.
struct Questions {
  int by_caller = 0;
  int in_arena = 0;
  int elsewhere = 0;
};

/// Counts the questions in the events of one plan, which come by thread, inner spans before the
/// outer one: a question in the arena is followed on its thread by the helper's span around it.
void count_questions(const std::vector<Timeline::Event>& events, Questions& asked) {
  int caller = -1;
  for (const Timeline::Event& event : events)
    if (std::string_view(event.name) == "plan") caller = event.thread;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const std::string_view name = events[k].name;
    if (name != "node" && name != "edge") continue;
    if (events[k].thread == caller) {
      ++asked.by_caller;
      continue;
    }
    bool in_arena = false;
    for (std::size_t outer = k + 1; outer < events.size() && !in_arena; ++outer)
      in_arena = events[outer].thread == events[k].thread &&
                 std::string_view(events[outer].name) == Executor::kHelperSpan &&
                 events[outer].begin_ns <= events[k].begin_ns;
    ++(in_arena ? asked.in_arena : asked.elsewhere);
  }
}

#ifndef __SANITIZE_THREAD__
TEST(Parallel, QuestionsThatTheCallerDoesNotAskAreAskedInTbbsArena) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/xarm7_polish_raster.yaml");
  problem.resolution.knot = 0;  // many questions
  const PreparedRobot robot(problem);
  PlanOptions options;
  options.planner = PlannerKind::kParallel;
  options.threads = 2;
  Questions asked;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (asked.in_arena < 100 && std::chrono::steady_clock::now() < end) {
    const Timeline timeline;
    const PlanResult result = plan(robot, problem, options);
    ASSERT_TRUE(result.status == PlanStatus::kSolved);
    count_questions(timeline.events(), asked);
  }
  EXPECT_GT(asked.by_caller, 0);
  EXPECT_GE(asked.in_arena, 100);
  EXPECT_EQ(asked.elsewhere, 0);
}
#endif

}  // namespace
}  // namespace swivel
