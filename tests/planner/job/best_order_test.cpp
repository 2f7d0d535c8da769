// SPDX-License-Identifier: BSD-3-Clause
// Jobs in the best order against the same jobs planned in all orders, each given.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "random_jobs.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kSame = 1e-9;

/// Draws a job of strokes of another in any order and direction, at another placement; strokes that
/// are taken again are displaced.
Problem draw(const JobCase& of, std::size_t strokes, Random& random) {
  Problem job = of.job;
  if (!job.vary.empty()) job = of.episode(static_cast<std::uint64_t>(random.below(1000)));
  std::vector<Stroke> all = job.arm().strokes;
  for (std::size_t k = all.size(); k > 1; --k)
    std::swap(all[k - 1], all[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  job.arm().strokes.clear();
  for (std::size_t k = 0; k < strokes; ++k) {
    Stroke& stroke = job.arm().strokes.emplace_back(all[k % all.size()]);
    if (k >= all.size()) {
      const Vector3d by(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03),
                        random.uniform(0, 0.03));
      for (Waypoint& waypoint : stroke.waypoints) waypoint.position += by;
      stroke.name += " again " + std::to_string(k);
    }
    stroke.reversible = !stroke.closed && random.coin(0.6);
    stroke.approach = random.coin() ? Vector3d(0, 0, -0.02) : Vector3d::Zero();
    stroke.retract = stroke.closed   ? stroke.approach
                     : random.coin() ? Vector3d(0, 0, -0.03)
                                     : Vector3d::Zero();
    stroke.resolution.ds = 0.03;
    if (!stroke.closed) stroke.resolution.dphi = 0.2;
    stroke.limits.tool_path_error = 0.02;
    if (!stroke.closed && random.coin())
      std::reverse(stroke.waypoints.begin(), stroke.waypoints.end());
  }
  if (random.coin(0.3)) job.arm().home.reset();
  job.arm().order = StrokeOrder::kBest;
  return job;
}

/// Returns the job with its strokes listed in an order, which is then given.
Problem listed(const Problem& of, const std::vector<std::size_t>& order) {
  Problem job = of;
  for (std::size_t k = 0; k < order.size(); ++k) job.arm().strokes[k] = of.arm().strokes[order[k]];
  job.arm().order = StrokeOrder::kGiven;
  return job;
}

/// Returns the least cost of a job in all orders, with the directions that plans choose.
double least_of_all(const PreparedRobot& robot, const Problem& job, const PlanOptions& options) {
  std::vector<std::size_t> order(job.arm().strokes.size());
  std::iota(order.begin(), order.end(), 0);
  double least = kNone;
  do {
    const Answer given = plan_job(robot, listed(job, order), options);
    if (given.has_rows()) least = std::min(least, given.lattice_cost);
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

struct Met {
  int jobs = 0, none = 0, moved = 0, around = 0, proved = 0;
};

/// Holds jobs of a file against all orders.
void expect_cheapest(const char* file, std::size_t strokes, int count, Random& random, Met& met) {
  const JobCase of(file);
  PlanOptions options;
  options.check = false;
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = std::string(file) + " of " + std::to_string(strokes) +
                             " strokes, trial " + std::to_string(trial);
    const Problem job = draw(of, strokes, random);
    const Answer best = plan_job(of.robot, job, {});
    const double least = least_of_all(of.robot, job, options);
    ++met.jobs;
    ASSERT_EQ(best.has_rows(), least != kNone) << what;
    if (!best.has_rows()) {
      ++met.none;
      continue;
    }
    ASSERT_NEAR(best.lattice_cost, least, kSame) << what;
    ASSERT_LE(best.bound_orders, best.lattice_cost) << what;
    ASSERT_GE(best.lattice_cost, best.bound) << what;
    const AnswerCheck check = check_job(of.robot, job, best.arm().parts);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    std::vector<std::size_t> order;
    for (const RunAnswer& run : best.arm().runs) order.push_back(run.run.stroke);
    met.moved += !std::is_sorted(order.begin(), order.end());
    met.around += best.arm().transitions.searches > 0;
    met.proved += best.bound_orders == best.lattice_cost;
    // The answer is that of the same job with its strokes listed in this order.
    ASSERT_EQ(plan_job(of.robot, listed(job, order), options).lattice_cost, best.lattice_cost)
        << what;
  }
}

TEST(BestOrder, IsTheCheapestOfAllOrdersAndDirections) {
  Random random(seed("BestOrder"));
  Met met;
  for (const auto& [file, of_three, of_four, of_five] :
       {std::tuple("door_job.yaml", 8, 2, 1), std::tuple("iiwa14_bench_job.yaml", 8, 8, 2),
        std::tuple("kr6_weld_pipe_job.yaml", 2, 0, 0),
        std::tuple("ur5e_deburr_plate_job.yaml", 6, 1, 0),
        std::tuple("panda_polish_covers_job.yaml", 6, 2, 0)}) {
    const std::size_t strokes[] = {3, 4, 5};
    const int counts[] = {of_three, of_four, of_five};
    for (std::size_t k = 0; k < 3; ++k) {
      if (counts[k] > 0) expect_cheapest(file, strokes[k], trials(counts[k]), random, met);
      if (HasFatalFailure()) return;
    }
  }
  std::printf(
      "%d jobs, %d without an answer; %d in another order than listed, %d around obstacles, "
      "%d proved to be the cheapest\n",
      met.jobs, met.none, met.moved, met.around, met.proved);
  EXPECT_GE(met.moved, at_least(25));
  EXPECT_GE(met.around, at_least(8));
  EXPECT_GE(met.proved, at_least(36));
}

/// Where time runs out, no order is cheaper than the answer says.
TEST(BestOrder, BoundsAllOrdersWhereTimeRunsOut) {
  Random random(seed("BestOrder time"));
  const JobCase of("iiwa14_bench_job.yaml");
  int answers = 0, open = 0;
  for (int trial = 0; trial < trials(3); ++trial) {
    const Problem job = draw(of, 4, random);
    const double least = least_of_all(of.robot, job, {});
    for (double timeout = 0.001; timeout < 0.1; timeout *= 1.3) {
      PlanOptions options;
      options.timeout_s = timeout;
      const Answer best = plan_job(of.robot, job, options);
      if (!best.has_rows()) continue;
      ++answers;
      open += best.bound_orders < best.lattice_cost;
      ASSERT_LE(best.bound_orders, least + kSame) << "trial " << trial;
      ASSERT_GE(best.lattice_cost, least - kSame) << "trial " << trial;
      ASSERT_GT(best.bound_orders, 0) << "trial " << trial;
    }
  }
  std::printf("%d answers, %d of them not proved to be the cheapest\n", answers, open);
  EXPECT_GE(answers, at_least(10));
}

/// Jobs of 9 and of 13 strokes in the best order cost no more than in the given order and in its
/// reverse, and no less than the bound of all orders.
TEST(BestOrder, OfManyStrokesIsNoDearerThanTheGivenOrderEitherWay) {
  Random random(seed("BestOrder many"));
  const JobCase of("iiwa14_bench_job.yaml");
  for (const std::size_t strokes : {9, 13}) {
    const Problem job = draw(of, strokes, random);
    const Answer best = plan_job(of.robot, job, {});
    ASSERT_TRUE(best.has_rows());
    EXPECT_GT(best.bound_orders, 0);
    EXPECT_LE(best.bound_orders, best.lattice_cost);
    std::vector<std::size_t> order(strokes);
    std::iota(order.begin(), order.end(), 0);
    for (int way = 0; way < 2; ++way) {
      const Answer given = plan_job(of.robot, listed(job, order), {});
      EXPECT_LE(best.lattice_cost, given.lattice_cost + kSame);
      EXPECT_LE(best.bound_orders, given.lattice_cost + kSame);
      EXPECT_EQ(given.bound_orders, given.bound);
      std::reverse(order.begin(), order.end());
    }
  }
}

}  // namespace
}  // namespace swivel
