// SPDX-License-Identifier: BSD-3-Clause
// The proof that rows and the moves between them keep clear, against questions about each of them,
// by FCL alone.
#include "measure/first_clearance_violation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "linkages.hpp"
#include "random_problem.hpp"
#include "seed.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using test::Random;

std::optional<ClearanceViolation> by_each(const World& world, const EdgeRule& rule,
                                          const Limits& limits, const std::vector<Config>& rows) {
  World::Query query(world);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (const auto pair = query.find_violating_pair(rows[k], ClearanceRule::kNode))
      return ClearanceViolation{k, *pair};
    if (k == 0 || limits.edges != EdgeMode::kContinuous) continue;
    if (const auto pair = edge_blocked(query, rule, rows[k - 1], rows[k]))
      return ClearanceViolation{k, *pair, true};
  }
  return std::nullopt;
}

/// Rows of a walk with turns, stays and steps of all sizes, from where the robot is free.
std::vector<Config> walk(const World& world, const Chain& chain, Random& random) {
  World::Query query(world);
  Config q = test::random_config(chain, random), step;
  for (int tries = 0; tries < 30 && query.find_violating_pair(q, ClearanceRule::kNode); ++tries)
    q = test::random_config(chain, random);
  std::vector<Config> rows;
  const double length = std::pow(10, random.uniform(-3.5, -0.7));
  for (int left = 1 + random.below(60); left > 0; --left) {
    if (rows.empty() || random.coin(0.05))
      for (double& x : step) x = random.coin(0.3) ? 0 : random.uniform(-length, length);
    rows.push_back(q);
    if (!random.coin(0.05)) q += step;
  }
  return rows;
}

/// The robots of `all_robots()`, each with links that joints beside its arm move.
std::vector<test::TestRobot> robots_with_linkages(std::uint64_t seed) {
  Random random(seed);
  auto robots = test::all_robots();
  for (test::TestRobot& robot : robots) {
    const auto names = test::arm_of(robot).chain.joint_names;
    auto model = std::make_shared<RobotModel>(*robot.model);
    test::add_linkages(*model, {names.begin(), names.end()}, 2, random);
    robot.model = model;
    robot.name += " with linkages";
  }
  return robots;
}

struct Walks {
  int free = 0, at_row = 0, between = 0;
};

Walks compare_walks(const std::vector<test::TestRobot>& robots, std::uint64_t base, int count) {
  int free = 0, at_row = 0, between = 0, up_to_it = 0;
  std::int64_t rows_asked = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        test::random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (random.coin()) problem.limits.edges = EdgeMode::kContinuous;
    // Rows that must keep less than motions, too.
    if (random.coin(0.3)) problem.limits.edge_clearance = random.uniform(0, 0.02);
    const PreparedRobot robot(problem);
    const World world(robot.world(), problem, {}, random.coin() ? kVerdictBand : 0);
    const EdgeRule rule = world.edge_rule(robot.radii());
    std::vector<Config> rows = walk(world, robot.arm().chain, random);
    const auto compare = [&] {
      const auto each = by_each(world, rule, problem.limits, rows),
                 found = first_clearance_violation(world, rule, problem.limits, rows, {});
      rows_asked += static_cast<std::int64_t>(rows.size());
      const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                               std::to_string(trial) + " " + problem.source;
      EXPECT_EQ(found.has_value(), each.has_value()) << what;
      if (!found || !each) return each;
      EXPECT_EQ(found->row, each->row) << what;
      EXPECT_EQ(found->between, each->between) << what;
      EXPECT_EQ(found->pair, each->pair) << what;
      return each;
    };
    const auto each = compare();
    ++(!each ? free : each->between ? between : at_row);
    if (!each || each->row == 0) continue;
    rows.resize(each->row);  // free, and near to what ends it
    EXPECT_FALSE(compare());
    ++up_to_it;
  }
  std::printf(
      "%lld rows: %d walks free, %d end at a row, %d between two, %d of them free up to there\n",
      static_cast<long long>(rows_asked), free, at_row, between, up_to_it);
  return {free, at_row, between};
}

TEST(FirstTooNear, IsWhatEachQuestionFinds) {
  const std::uint64_t base = test::seed("FirstTooNear");
  const int count = test::trials(300);
  const Walks walks = compare_walks(test::all_robots(), base, count);
  EXPECT_GE(walks.free, test::at_least_among(count / 5));
  EXPECT_GE(walks.at_row, test::at_least_among(count / 20));
  EXPECT_GE(walks.between, test::at_least_among(count / 60));
}

TEST(FirstTooNear, IsWhatEachQuestionFindsOfRobotsWithLinkages) {
  const std::uint64_t base = test::seed("FirstTooNear.Linkages");
  const Walks walks = compare_walks(robots_with_linkages(base), base, test::trials(100));
  EXPECT_GE(walks.free, test::at_least(5));
  EXPECT_GE(walks.at_row + walks.between, test::at_least(10));
}

}  // namespace
}  // namespace swivel
