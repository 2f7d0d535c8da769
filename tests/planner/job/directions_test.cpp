// SPDX-License-Identifier: BSD-3-Clause
// Reversible strokes of a job in a given order: the job takes the cheapest of all their directions,
// and no job that passes its check costs less than what the answer says of any.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "seed.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::infinity();

Problem load(const std::string& name) {
  return io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/" + name);
}

/// Draws a job of a few strokes of another, in any order, at another placement.
Problem random_job(const Problem& of, Random& random) {
  Problem job = of;
  const auto episode = static_cast<std::uint64_t>(random.below(1000));
  if (!job.vary.empty())
    job.scene = episode_problem(problem_of_run(job, {0, false}), 1, episode).scene;
  for (std::size_t k = job.arm().strokes.size(); k > 1; --k)
    std::swap(job.arm().strokes[k - 1],
              job.arm().strokes[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  const auto count = static_cast<std::size_t>(1 + random.below(3));
  while (job.arm().strokes.size() > count) job.arm().strokes.pop_back();
  job.arm().order = StrokeOrder::kGiven;
  if (random.coin(0.3)) job.arm().home.reset();
  for (Stroke& stroke : job.arm().strokes) {
    stroke.reversible = random.coin(0.8);
    stroke.approach = random.coin() ? Vector3d(0, 0, -0.02) : Vector3d::Zero();
    stroke.retract = random.coin() ? Vector3d(0, 0, -0.03) : Vector3d::Zero();
    stroke.resolution.ds = 0.03;
    stroke.resolution.dphi = 0.2;
    stroke.limits.tool_path_error = 0.02;
    if (random.coin()) std::reverse(stroke.waypoints.begin(), stroke.waypoints.end());
  }
  return job;
}

/// Returns the job with strokes written in the directions that the bits of `turned` say, none of
/// them reversible; nothing where a stroke that is not reversible would be turned.
std::optional<Problem> written(const Problem& of, unsigned turned) {
  Problem job = of;
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k) {
    Stroke& stroke = job.arm().strokes[k];
    if ((turned >> k & 1) != 0) {
      if (!stroke.reversible) return std::nullopt;
      std::reverse(stroke.waypoints.begin(), stroke.waypoints.end());
    }
    stroke.reversible = false;
  }
  return job;
}

bool is_straight(const Answer& job) {
  return std::all_of(job.arm().parts.begin(), job.arm().parts.end(),
                     [](const Part& part) { return part.run || part.rows.size() == 2; });
}

/// Returns a job whose runs are those of other jobs, with straight moves between them.
std::vector<Part> joined(const Problem& job, const std::vector<const Part*>& runs) {
  std::vector<Part> parts;
  std::optional<Config> at = job.arm().home;
  const auto go_to = [&](const Config& q) {
    if (!at) return;
    Part& move = parts.emplace_back();
    for (const Config& end : {*at, q}) {
      TrajectoryRow row;
      row.q = end;
      move.rows.push_back(row);
    }
  };
  for (const Part* const run : runs) {
    go_to(run->rows.front().q);
    parts.push_back(*run);
    at = run->rows.back().q;
  }
  if (job.arm().home) go_to(*job.arm().home);
  return parts;
}

struct Met {
  int jobs = 0, equal = 0, turned = 0, none = 0, checked = 0;
};

/// Holds a job against all directions of its strokes, each written by hand.
void expect_cheapest(const PreparedRobot& robot, const Problem& job, const std::string& what,
                     Random& random, Met& met) {
  const Answer found = plan_job(robot, job);
  std::vector<std::vector<Part>> runs(job.arm().strokes.size());  // by stroke, of all directions
  double least = kNone;
  bool straight = is_straight(found), sought = found.arm().transitions.searches > 0;
  for (unsigned turned = 0; turned < 1U << job.arm().strokes.size(); ++turned) {
    const std::optional<Problem> by_hand = written(job, turned);
    if (!by_hand) continue;
    Answer other = plan_job(robot, *by_hand);
    if (other.arm().parts.empty()) continue;
    straight = straight && is_straight(other);
    sought = sought || other.arm().transitions.searches > 0;
    least = std::min(least, other.cost);
    for (Part& part : other.arm().parts) {
      if (!part.run) continue;
      part.run->reversed = (turned >> part.run->stroke & 1) != 0;
      runs[part.run->stroke].push_back(part);
    }
    const AnswerCheck check = check_job(robot, job, other.arm().parts);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    ASSERT_GE(check.cost, found.bound_any - 1e-9) << what;
    ++met.checked;
  }
  ++met.jobs;
  ASSERT_EQ(found.arm().parts.empty(), least == kNone) << what;
  if (found.arm().parts.empty()) {
    ++met.none;
    return;
  }
  const AnswerCheck own = check_job(robot, job, found.arm().parts);
  ASSERT_TRUE(own.passed) << what << ": " << own.failures.front();
  for (const Part& part : found.arm().parts) met.turned += part.run && part.run->reversed;
  if (straight) {  // else costs depend on the ways around that were found
    // Where ways around were sought, those of a joint's nearest turn alone were.
    ASSERT_NEAR(found.cost, least, sought ? 1e-3 * least : 1e-9) << what;
    ASSERT_LE(found.bound, found.lattice_cost) << what;
    met.equal += sought ? 0 : 1;
  }
  for (int k = 0; k < 4; ++k) {
    std::vector<const Part*> taken;
    for (const auto& of : runs)
      taken.push_back(&of[static_cast<std::size_t>(random.below(static_cast<int>(of.size())))]);
    const AnswerCheck check = check_job(robot, job, joined(job, taken));
    if (!check.passed) continue;
    ASSERT_GE(check.cost, found.bound_any - 1e-9) << what;
    ++met.checked;
  }
}

TEST(Directions, AreTheCheapestOfAllInTheGivenOrder) {
  Random random(seed("Directions"));
  Met met;
  for (const char* const name : {"door_job.yaml", "iiwa14_bench_job.yaml",
                                 "ur5e_deburr_plate_job.yaml", "kr6_weld_pipe_job.yaml"}) {
    const Problem of = load(name);
    const PreparedRobot robot(problem_of_run(of, {0, false}));
    for (int trial = 0; trial < trials(50); ++trial) {
      const std::string what = std::string(name) + " trial " + std::to_string(trial);
      expect_cheapest(robot, random_job(of, random), what, random, met);
      if (HasFatalFailure()) return;
    }
  }
  std::printf(
      "%d jobs, %d with straight transitions alone, %d without a job, %d strokes turned; "
      "%d other jobs passed and cost no less than the bound\n",
      met.jobs, met.equal, met.none, met.turned, met.checked);
  EXPECT_GE(met.equal, at_least(60));
  EXPECT_GE(met.turned, at_least(60));
  EXPECT_GE(met.checked, at_least(500));
}

/// A stroke that only its last waypoint lets the arm begin has a path backwards alone.
TEST(Directions, TheOneWithAPathIsTakenWhereTheOtherHasNone) {
  Problem job = load("door_job.yaml");
  job.arm().strokes.resize(1);
  job.arm().home.reset();
  Stroke& stroke = job.arm().strokes.front();
  stroke.reversible = true;
  stroke.approach = Vector3d(0, 0, -3);  // out of reach, before whichever waypoint comes first
  EXPECT_EQ(plan_job(job).status, PlanStatus::kInfeasible);
  EXPECT_EQ(plan_job(job).arm().runs.front().run, (StrokeRun{0, false}));
}

}  // namespace
}  // namespace swivel
