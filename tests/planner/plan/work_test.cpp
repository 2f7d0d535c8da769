// SPDX-License-Identifier: BSD-3-Clause
// How much work a plan is, in counts that no machine changes: a slower algorithm shows here,
// whatever the clock says. A change that moves a count on purpose puts the printed row into the
// table, and says why in its commit.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "robots.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/isa.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {
std::atomic<std::int64_t> allocations{0};
// Before main, so before the unit is chosen for the whole process: how kernels group their work may
// show in counts.
const int scalar_forced = setenv("SWIVEL_FORCE_ISA", "scalar", 1);

void* counted(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace swivel {
namespace {

struct Work {
  const char* problem;
  PlannerKind planner;
  EdgeMode edges;
  std::int64_t nodes_checked, edges_checked, fcl_calls, proved, expansions, iterations, ik_nodes,
      edges_compared;
  std::int64_t most_allocations;  ///< operator new in a second plan on the same robot, rounded up
};
using enum PlannerKind;
using enum EdgeMode;
constexpr Work kTable[] = {
    // clang-format off
    {"experiment_a", kEager, kNodes, 7118, 95038, 64, 0, 7118, 0, 26208, 412884, 746},
    {"experiment_a", kEagerDp, kNodes, 7118, 4602, 64, 0, 0, 0, 26208, 412884, 5455},
    {"experiment_a", kLazy, kNodes, 101, 100, 0, 101, 101, 1, 42064, 51280, 1118},
    {"experiment_a", kLazy, kContinuous, 101, 100, 0, 201, 101, 1, 42064, 51280, 1223},
    {"experiment_a", kParallel, kNodes, 101, 100, 0, 101, 101, 1, 42064, 51280, 922},
    {"experiment_a", kParallel, kContinuous, 101, 100, 0, 201, 101, 1, 42064, 51280, 1027},
    {"experiment_b", kEager, kNodes, 6927, 37300, 8690, 0, 3409, 0, 26208, 156468, 8072},
    {"experiment_b", kEagerDp, kNodes, 6927, 1838, 8690, 0, 0, 0, 26208, 156468, 9908},
    {"experiment_b", kLazy, kNodes, 3477, 100, 2, 3475, 303, 3, 108096, 107893, 10621},
    {"experiment_b", kLazy, kContinuous, 3477, 100, 2, 3575, 303, 3, 108096, 107893, 10809},
    {"experiment_b", kParallel, kNodes, 3477, 100, 2, 3475, 303, 3, 108096, 107893, 8013},
    {"experiment_b", kParallel, kContinuous, 3477, 100, 2, 3575, 303, 3, 108096, 107893, 8200},
    {"experiment_c", kEager, kNodes, 11000, 136596, 11144, 0, 11000, 0, 37296, 659664, 1096},
    {"experiment_c", kEagerDp, kNodes, 11000, 8096, 11144, 0, 0, 0, 37296, 659664, 9508},
    {"experiment_c", kLazy, kNodes, 109, 108, 0, 109, 109, 1, 39592, 26800, 1250},
    {"experiment_c", kLazy, kContinuous, 109, 108, 0, 217, 109, 1, 39592, 26800, 1494},
    {"experiment_c", kParallel, kNodes, 109, 108, 0, 109, 109, 1, 39592, 26800, 1036},
    {"experiment_c", kParallel, kContinuous, 109, 108, 0, 217, 109, 1, 39592, 26800, 1281},
    // clang-format on
};

std::string row(const Work& w) {
  char text[300];
  std::snprintf(
      text, sizeof text, "{\"%s\", %s, %s, %lld, %lld, %lld, %lld, %lld, %lld, %lld, %lld, %lld},",
      w.problem,
      std::string(w.planner == kEager     ? "kEager"
                  : w.planner == kEagerDp ? "kEagerDp"
                  : w.planner == kLazy    ? "kLazy"
                                          : "kParallel")
          .c_str(),
      w.edges == kNodes ? "kNodes" : "kContinuous", static_cast<long long>(w.nodes_checked),
      static_cast<long long>(w.edges_checked), static_cast<long long>(w.fcl_calls),
      static_cast<long long>(w.proved), static_cast<long long>(w.expansions),
      static_cast<long long>(w.iterations), static_cast<long long>(w.ik_nodes),
      static_cast<long long>(w.edges_compared), static_cast<long long>(w.most_allocations));
  return text;
}

Work measured(const Work& expected) {
  PathProblem problem = io::load_path_problem(test::data_dir() / "problems" /
                                              (std::string(expected.problem) + ".yaml"));
  problem.limits.edges = expected.edges;
  if (expected.planner == kEager || expected.planner == kEagerDp)
    problem.resolution.ds = 0.02;  // tests are to be quick
  const PreparedRobot robot(problem);
  PlanOptions options;
  options.check = false;  // the work of planning is counted
  options.planner = expected.planner;
  options.threads = 1;
  static_cast<void>(plan(robot, problem, options));
  const std::int64_t before = allocations;
  const PlanResult result = plan(robot, problem, options);
  const std::int64_t made = allocations - before;
  const Counters& c = result.counters;
  return {expected.problem,
          expected.planner,
          expected.edges,
          c.nodes_checked,
          c.edges_checked,
          c.fcl_calls,
          c.proved_free + c.proved_colliding,
          c.expansions,
          c.iterations,
          c.ik_nodes,
          c.edges,
          made};
}

TEST(Work, IsWhatTheTableSays) {
  ASSERT_EQ(active_isa(), Isa::kScalar);
  for (const Work& expected : kTable) {
    Work now = measured(expected);
    const bool within = now.most_allocations <= expected.most_allocations;
    // A twentieth to spare, so that a library's own allocations may differ a little.
    const std::int64_t rounded = now.most_allocations + now.most_allocations / 20 + 10;
    now.most_allocations = expected.most_allocations;
    const bool same = row(now) == row(expected);
    now.most_allocations = within ? expected.most_allocations : rounded;
    EXPECT_TRUE(same && within) << "now: " << row(now) << "\nwas: " << row(expected);
  }
}

/// The inner loop of every search: asking about a posture or a motion that distance proofs decide.
TEST(Work, AskingAboutAPostureAllocatesNothing) {
  const PathProblem problem =
      io::load_path_problem(test::data_dir() / "problems/experiment_c.yaml");
  const PreparedRobot robot(problem);
  const World& world = robot.world();
  world.make_ready([] { return false; });
  World::Query query(world, DistanceProofs::kOn);
  test::Random random(test::seed("Work"));
  std::vector<Config> postures;
  for (int k = 0; k < 2000; ++k) postures.push_back(test::random_config(robot.arm().chain, random));
  int asked = 0;
  for (const Config& q : postures) {
    const std::int64_t calls = query.counters().fcl_calls;
    const std::int64_t before = allocations;
    static_cast<void>(query.find_violating_pair(q, ClearanceRule::kNode));
    static_cast<void>(query.find_violating_pair_incremental(q, ClearanceRule::kNode));
    const std::int64_t made = allocations - before;
    if (query.counters().fcl_calls != calls) continue;  // FCL allocates
    EXPECT_EQ(made, 0);
    ++asked;
  }
  std::printf("%d of %zu postures decided without FCL\n", asked, postures.size());
  EXPECT_GT(asked, 1000);
}

}  // namespace
}  // namespace swivel
