// SPDX-License-Identifier: BSD-3-Clause
// Many plans at a time: every row against a plan of its problem alone, whatever the threads and the
// order are, and how often lattices are made for them.
#include "swivel/planner/study/plan_many.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>

#include "episode_rows.hpp"
#include "plan/layout/lattice_cache.hpp"
#include "random_problem.hpp"
#include "study/study_planner.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel {
namespace {

using namespace test;

Problem loaded(const std::string& name) {
  return io::load_problem(std::string(SWIVEL_DATA_DIR) + "/problems/" + name + ".yaml");
}

/// Problems of one robot, by number.
struct Set {
  std::string name;
  Problem like;
  ProblemOf problem_of;
};

/// Returns problems in which all objects of a scene but the path's frame stand a few cm elsewhere.
Set moved_obstacles(const std::string& name, Problem like, double far) {
  return {name, like, [like, far](std::uint64_t number) {
            Problem problem = like;
            Random random(number * 1000 + 7);
            for (SceneObject& object : problem.scene) {
              const bool stays = is_path(like) && object.name == like.arm().path().path_frame;
              for (int k = 0; k < 3; ++k)
                object.pose.translation()[k] += stays ? 0 : random.uniform(-far, far);
            }
            return problem;
          }};
}

/// Returns episodes of a problem whose `vary` moves its path.
Set episodes(const std::string& name, const Problem& like) {
  return {name, like, [like](std::uint64_t number) { return episode_problem(like, 3, number); }};
}

/// Returns problems of one arm that have one of some paths, each in many scenes.
Set paths_by_turns(const std::string& name, const Problem& like) {
  return {name, like, [like](std::uint64_t number) {
            Problem problem = moved_obstacles("", like, 0.04).problem_of(number);
            for (Waypoint& waypoint : problem.arms.front().strokes.front().waypoints)
              waypoint.position.z() += 0.004 * static_cast<double>(number % 3);
            return problem;
          }};
}

/// An answer with all that a row of many plans says of it.
struct Expected {
  Answer answer;
  EpisodeRow row;
};

Expected planned_alone(const Set& set, std::uint64_t number) {
  const Problem problem = set.problem_of(number);
  PlanOptions options;
  options.evidence.tool_path_error = true;
  options.threads = 1;
  Answer answer;
  if (problem.arms.size() == 2)
    answer = plan_workcell(PreparedWorkcell(problem), options);
  else if (is_path(problem))
    answer = answer_of(plan(problem_of_run(problem, {0, false}), options));
  else
    answer = plan_job(PreparedRobot(problem_of_run(problem, {0, false})), problem, options);
  EpisodeRow row(number, answer, set.like);
  return {std::move(answer), std::move(row)};
}

/// Returns all joints of an answer, in the order of arms, parts and rows.
std::vector<Config> joints_of(const Answer& answer) {
  std::vector<Config> all;
  for (const ArmAnswer& arm : answer.arms)
    for (const Part& part : arm.parts)
      for (const TrajectoryRow& row : part.rows) all.push_back(row.q);
  return all;
}

struct ManyRows {
  std::vector<EpisodeRow> rows;
  std::map<std::uint64_t, std::vector<Config>> joints;
};

/// Plans `order`'s problems of a set; a row's number is the place in `order`.
ManyRows run(const Set& set, const std::vector<std::uint64_t>& order, ManyOptions options) {
  ManyRows made;
  std::mutex mutex;
  options.planned = [&](std::uint64_t number, const Answer& answer) {
    const std::lock_guard lock(mutex);
    made.joints[number] = joints_of(answer);
  };
  plan_many(
      set.like, order.size(), [&](std::uint64_t k) { return set.problem_of(order[k]); }, options,
      [&](const EpisodeRow& row) { made.rows.push_back(row); });
  return made;
}

std::vector<std::uint64_t> shuffled(int count, Random& random) {
  std::vector<std::uint64_t> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  return order;
}

/// Plans problems of a set at 1, 2 and 8 threads, each time in another order, and holds all rows
/// and joints against those of plans alone. Some plans of the last run may be out of time.
void expect_plans_alone(const Set& set, int count, std::map<PlanStatus, int>& met) {
  SCOPED_TRACE(set.name);
  std::vector<Expected> expected;
  double slowest = 0;
  for (int k = 0; k < count; ++k) {
    expected.push_back(planned_alone(set, static_cast<std::uint64_t>(k)));
    slowest = std::max(slowest, expected.back().row.plan_ms);
  }
  Random random(5);
  for (const int threads : {1, 2, 8, 0}) {
    ManyOptions options;
    options.plan.threads = threads;
    if (threads == 0) options.timeout_each_s = 0.5e-3 * slowest;
    const std::vector<std::uint64_t> order = shuffled(count, random);
    const ManyRows found = run(set, order, options);
    ASSERT_EQ(found.rows.size(), order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Expected& alone = expected[static_cast<std::size_t>(order[k])];
      EpisodeRow row = alone.row;
      row.episode = k;
      ++met[found.rows[k].status];
      if (found.rows[k].status == PlanStatus::kTimeout) {
        EXPECT_TRUE(options.timeout_each_s.has_value());
        EXPECT_EQ(found.rows[k].reason, "not planned in the time for each");
        EXPECT_EQ(found.joints.count(k), 0u);
        continue;
      }
      expect_same_rows(
          found.rows[k], row,
          set.name + " " + std::to_string(order[k]) + ", threads " + std::to_string(threads));
      EXPECT_EQ(found.joints.at(k), joints_of(alone.answer));
    }
  }
}

TEST(PlanMany, RowsAreThoseOfPlansAloneAtAnyThreadsInAnyOrder) {
  std::map<PlanStatus, int> met;
  const int many = trials(200), some = trials(60), few = trials(16);
  const Problem door = loaded("experiment_c");
  expect_plans_alone(episodes("doors", door), many, met);
  expect_plans_alone(moved_obstacles("obstacles", door, 0.08), many, met);
  expect_plans_alone(paths_by_turns("three paths", door), many, met);
  expect_plans_alone(moved_obstacles("seam", loaded("panda_weld_seam"), 0.05), some, met);
  expect_plans_alone(moved_obstacles("pipe", loaded("kr6_weld_pipe"), 0.05), some, met);
  expect_plans_alone(moved_obstacles("rolls", loaded("torch_door"), 0.05), few, met);
  expect_plans_alone(moved_obstacles("closed", loaded("panda_polish_cover"), 0.05), few, met);
  std::printf("%d solved, %d without a path, %d out of time\n", met[PlanStatus::kSolved],
              met[PlanStatus::kInfeasible], met[PlanStatus::kTimeout]);
  EXPECT_GT(met[PlanStatus::kSolved], at_least(1500));
  EXPECT_GT(met[PlanStatus::kInfeasible], at_least(100));
  EXPECT_GT(met[PlanStatus::kTimeout], at_least(20));
}

TEST(PlanMany, StrokesAndTwoArmsToo) {
  std::map<PlanStatus, int> met;
  Problem job = loaded("door_job");
  job.arm().strokes.resize(2);
  for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.02, .dphi = 0.1};
  expect_plans_alone(moved_obstacles("job", job, 0.1), trials(40), met);
  expect_plans_alone(moved_obstacles("two arms", loaded("sda10f_plate_workcell"), 0.1), trials(8),
                     met);
  std::printf("%d solved, %d without a path, %d out of time\n", met[PlanStatus::kSolved],
              met[PlanStatus::kInfeasible], met[PlanStatus::kTimeout]);
  EXPECT_GT(met[PlanStatus::kSolved], at_least(30));
  EXPECT_GT(met[PlanStatus::kInfeasible], at_least(10));
}

TEST(PlanMany, RandomTasksInRandomScenes) {
  Random random(seed("PlanMany.RandomTasksInRandomScenes"));
  const std::vector<TestRobot> robots = all_robots();
  int rows = 0;
  std::map<PlanStatus, int> met;
  for (int trial = 0; trial < trials(40); ++trial) {
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    std::vector<Problem> problems;
    PathProblem first = random_problem(robot, random);
    for (int k = 0; k < 6; ++k) {
      PathProblem problem = k % 3 == 2 ? random_problem(robot, random) : first;
      static_cast<Robot&>(problem) = first;
      for (SceneObject& object : problem.scene)
        object.pose.translation().x() += random.uniform(-0.1, 0.1);
      problem.limits.clearance = k % 2 == 0 ? 0.004 : 0.006;
      problems.push_back(one_path(problem));
    }
    const Set set{"random " + std::to_string(trial), problems[0],
                  [&](std::uint64_t number) { return problems[number]; }};
    std::vector<std::uint64_t> order(problems.size());
    std::iota(order.begin(), order.end(), std::uint64_t{0});
    ManyOptions options;
    options.plan.threads = 1 + trial % 3;
    const ManyRows found = run(set, order, options);
    ASSERT_EQ(found.rows.size(), problems.size());
    for (std::size_t k = 0; k < problems.size(); ++k) {
      const Expected alone = planned_alone(set, k);
      expect_same_rows(found.rows[k], alone.row, set.name + "." + std::to_string(k));
      EXPECT_EQ(found.joints.at(k), joints_of(alone.answer));
      ++met[found.rows[k].status];
      ++rows;
    }
  }
  std::printf("%d rows, %d solved\n", rows, met[PlanStatus::kSolved]);
  EXPECT_GT(met[PlanStatus::kSolved], at_least(40));
}

TEST(PlanMany, ThreadsShareTheLatticesOfTasks) {
  const Problem door = loaded("experiment_c");
  const auto robot = std::make_shared<const PreparedRobot>(problem_of_run(door, {0, false}));
  for (const Set& set : {moved_obstacles("one task", door, 0.08), paths_by_turns("three", door)}) {
    const auto lattices = std::make_shared<LatticeCache>();
    std::atomic<std::uint64_t> next{0}, planned{0};
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 3; ++thread)
      threads.emplace_back([&] {
        StudyPlanner planner(robot, door, {}, lattices);
        for (std::uint64_t k = next++; k < 30; k = next++) {
          PlanOptions options;
          options.threads = 1;
          static_cast<void>(planner.plan(set.problem_of(k), options, {}));
          ++planned;
        }
      });
    threads.clear();
    EXPECT_EQ(planned, 30u);
    EXPECT_EQ(lattices->made(), set.name == "one task" ? 1 : 3);
  }
}

TEST(PlanMany, ACauseThatIsNotAskedForIsNotSought) {
  int without = 0;
  Problem job = loaded("door_job");
  job.arm().strokes.resize(2);
  for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.02, .dphi = 0.1};
  for (const Set& set : {moved_obstacles("seam", loaded("panda_weld_seam"), 0.05),
                         moved_obstacles("closed", loaded("panda_polish_cover"), 0.05),
                         moved_obstacles("job", job, 0.1),
                         moved_obstacles("two arms", loaded("sda10f_plate_workcell"), 0.1)}) {
    std::vector<std::uint64_t> order(8);
    std::iota(order.begin(), order.end(), std::uint64_t{0});
    ManyOptions options;
    const ManyRows told = run(set, order, options);
    options.plan.evidence.cause = false;
    const ManyRows found = run(set, order, options);
    ASSERT_EQ(found.rows.size(), order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      EpisodeRow expected = told.rows[k];
      if (!expected.cause.empty() && expected.cause != "not_closed" &&
          expected.cause != "transition" && expected.cause != "conflict") {
        ++without;
        expected.cause = "not_asked";
        expected.by = "";
        const std::size_t who = expected.reason.find("': ");
        expected.reason =
            (who == std::string::npos ? "" : expected.reason.substr(0, who + 3)) + "not asked for";
      }
      expect_same_rows(found.rows[k], expected, set.name + " " + std::to_string(k));
      EXPECT_EQ(found.joints.at(k), told.joints.at(k));
    }
  }
  EXPECT_GT(without, 5);
}

TEST(PlanMany, StartsDifferInTheSignOfZero) {
  PathProblem like = problem_of_run(loaded("panda_weld_seam"), {0, false});
  const PreparedRobot robot(like);
  like.scene.clear();
  like.path_frame.clear();
  const Config q = Config::of(std::array{0.0, 0.3, 0.0, -1.8, 0.0, 2.2, 0.0}.data());
  const Pose tool = robot.arm().chain.tool(q);
  like.waypoints.assign(2, {tool.translation(), Quaterniond(tool.linear())});
  like.waypoints[1].position.y() += 0.1;
  like.start = q;
  const Set starts{"signs", one_path(like), [like](std::uint64_t number) {
                     PathProblem problem = like;
                     if (number % 2 == 1) (*problem.start)[0] = -0.0;
                     return one_path(problem);
                   }};
  ManyOptions options;
  options.plan.threads = 1;
  const ManyRows found = run(starts, {0, 1, 2, 3}, options);
  for (std::uint64_t k = 0; k < 4; ++k) {
    ASSERT_EQ(found.rows[k].status, PlanStatus::kSolved) << found.rows[k].reason;
    EXPECT_EQ(std::signbit(found.joints.at(k).front()[0]), k % 2 == 1) << k;
  }
}

TEST(PlanMany, ABadProblemIsARowAndTheOthersArePlanned) {
  const Set doors = moved_obstacles("obstacles", loaded("experiment_c"), 0.05);
  const auto with_faults = [&](std::uint64_t number) {
    Problem problem = doors.problem_of(number);
    PathProblem path = problem_of_run(problem, {0, false});
    if (number == 1) path.waypoints[0].position.x() = std::nan("");
    if (number == 2) path.waypoints[0].position.x() = 1e9;
    if (number == 3) path.tip_link = "nothing";
    if (number == 4) path.start = Config::Constant(1e-3);
    if (number == 5) throw InputError("row 5 of the table: is not a pose");
    if (number == 6) throw std::runtime_error("no such file");
    return one_path(path);
  };
  for (const int threads : {1, 3}) {
    ManyOptions options;
    options.plan.threads = threads;
    std::vector<std::uint64_t> told;
    std::mutex mutex;
    options.planned = [&](std::uint64_t number, const Answer&) {
      const std::lock_guard lock(mutex);
      told.push_back(number);
    };
    std::vector<EpisodeRow> rows;
    plan_many(doors.like, 10, with_faults, options,
              [&](const EpisodeRow& row) { rows.push_back(row); });
    ASSERT_EQ(rows.size(), 10u);
    for (const EpisodeRow& row : rows) {
      const bool bad = row.episode >= 1 && row.episode <= 6;
      EXPECT_EQ(row.status == PlanStatus::kError, bad) << row.episode << row.reason;
      EXPECT_EQ(row.reason.empty(), !bad && row.status == PlanStatus::kSolved) << row.episode;
      EXPECT_EQ(std::count(told.begin(), told.end(), row.episode), bad ? 0 : 1);
      if (!bad) expect_same_rows(row, planned_alone(doors, row.episode).row, "beside faults");
    }
    EXPECT_EQ(rows[5].reason, "row 5 of the table: is not a pose");
  }
}

TEST(PlanMany, StopsWithRowsFromTheFrontAndGoesOn) {
  const Set doors = episodes("doors", loaded("experiment_c"));
  std::vector<std::uint64_t> order(24);
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  ManyOptions options;
  options.plan.threads = 2;
  const ManyRows whole = run(doors, order, options);
  ASSERT_EQ(whole.rows.size(), order.size());

  std::atomic<bool> cancel{false};
  std::vector<EpisodeRow> rows;
  options.plan.cancel = &cancel;
  plan_many(doors.like, order.size(), doors.problem_of, options, [&](const EpisodeRow& row) {
    rows.push_back(row);
    cancel = rows.size() >= 5;
  });
  ASSERT_GE(rows.size(), 5u);
  ASSERT_LT(rows.size(), order.size());
  options.plan.cancel = nullptr;
  options.skip = rows.size();
  plan_many(doors.like, order.size(), doors.problem_of, options,
            [&](const EpisodeRow& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), order.size());
  for (std::size_t k = 0; k < rows.size(); ++k) expect_same_rows(rows[k], whole.rows[k], "gone on");

  options.skip = 0;
  for (std::uint64_t index = 0; index < 3; ++index) {
    options.shard = {index, 3};
    std::vector<EpisodeRow> share;
    plan_many(doors.like, order.size(), doors.problem_of, options,
              [&](const EpisodeRow& row) { share.push_back(row); });
    ASSERT_EQ(share.size(), 8u);
    for (const EpisodeRow& row : share) expect_same_rows(row, whole.rows[row.episode], "shard");
  }

  options.shard = {};
  options.plan.timeout_s = 1e-9;
  int none = 0;
  plan_many(doors.like, order.size(), doors.problem_of, options,
            [&](const EpisodeRow&) { ++none; });
  EXPECT_EQ(none, 0);
  options.plan.timeout_s.reset();
  options.timeout_each_s = 0;
  EXPECT_THROW(plan_many(doors.like, 1, doors.problem_of, options, [](const EpisodeRow&) {}),
               InvalidArgument);
}

TEST(PlanMany, WhatCallbacksThrowReachesTheCaller) {
  const Set doors = episodes("doors", loaded("experiment_c"));
  ManyOptions options;
  options.plan.threads = 2;
  EXPECT_THROW(plan_many(doors.like, 50, doors.problem_of, options,
                         [](const EpisodeRow&) { throw std::runtime_error("the disk is full"); }),
               std::runtime_error);
  options.planned = [](std::uint64_t, const Answer&) { throw std::runtime_error("no"); };
  EXPECT_THROW(plan_many(doors.like, 50, doors.problem_of, options, [](const EpisodeRow&) {}),
               std::runtime_error);
}

}  // namespace
}  // namespace swivel
