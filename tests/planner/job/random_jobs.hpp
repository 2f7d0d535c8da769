// SPDX-License-Identifier: BSD-3-Clause
// Jobs of the data folder at other placements, with other strokes.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "seed.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::test {

/// Returns a job of data/problems.
inline Problem load(const char* name) {
  return io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/" + name);
}

/// A job of data/problems with its robot prepared, of which other placements are drawn.
struct JobCase {
  explicit JobCase(const char* name) : job(load(name)), robot(problem_of_run(job, {0, false})) {}
  /// Returns the job with its scene as in an episode of a campaign.
  [[nodiscard]] Problem episode(std::uint64_t k) const {
    Problem moved = job;
    moved.scene = episode_problem(problem_of_run(job, {0, false}), 1, k).scene;
    return moved;
  }
  Problem job;
  PreparedRobot robot;
};

/// Draws a job of the door with other placements, lines of approach and retract, and order.
inline Problem random_job(const JobCase& of, Random& random) {
  Problem job = of.episode(static_cast<std::uint64_t>(random.below(1000)));
  while (job.arm().strokes.size() > 2 && random.coin(0.4)) job.arm().strokes.pop_back();
  if (random.coin(0.3)) job.arm().home.reset();
  for (Stroke& stroke : job.arm().strokes) {
    stroke.reversible = random.coin();
    if (random.coin(0.4)) stroke.approach = Vector3d(0, 0, -0.02);
    if (random.coin(0.4)) stroke.retract = Vector3d(0, 0, -0.03);
    stroke.resolution.ds = 0.02;
    stroke.resolution.dphi = 0.1;
  }
  job.arm().order = random.coin(0.3) ? StrokeOrder::kBest : StrokeOrder::kGiven;
  return job;
}

/// Expects the same answers, bit for bit.
inline void expect_same(const Answer& a, const Answer& b, const std::string& what) {
  ASSERT_EQ(a.status, b.status) << what;
  ASSERT_EQ(a.cost, b.cost) << what;
  ASSERT_EQ(a.bound, b.bound) << what;
  ASSERT_EQ(a.bound_orders, b.bound_orders) << what;
  ASSERT_EQ(a.arm().parts.size(), b.arm().parts.size()) << what;
  ASSERT_EQ(a.arm().counters.fcl_calls, b.arm().counters.fcl_calls) << what;
  ASSERT_EQ(a.arm().transitions.pairs, b.arm().transitions.pairs) << what;
  for (std::size_t k = 0; k < a.arm().parts.size(); ++k) {
    ASSERT_EQ(a.arm().parts[k].run, b.arm().parts[k].run) << what;
    ASSERT_EQ(a.arm().parts[k].rows.size(), b.arm().parts[k].rows.size()) << what;
    for (std::size_t i = 0; i < a.arm().parts[k].rows.size(); ++i)
      ASSERT_EQ(a.arm().parts[k].rows[i].q, b.arm().parts[k].rows[i].q) << what;
  }
}

}  // namespace swivel::test
