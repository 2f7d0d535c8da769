// SPDX-License-Identifier: BSD-3-Clause
// Campaigns and placements of jobs: every row against a plan of its job alone, whatever the
// threads.
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>

#include "episode_rows.hpp"
#include "seed.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/study_failure.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "swivel/planner/study/place.hpp"

namespace swivel {
namespace {

using namespace test;

/// The first two strokes of the car door's job on a coarse lattice, which are planned in an
/// instant.
struct DoorJob {
  DoorJob() {
    job.arm().strokes.resize(2);
    for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.02, .dphi = 0.1};
    job.vary[0].xyz *= 2.5;
    job.arm().strokes[1].reversible = true;
    job.arm().strokes[1].approach = Vector3d(0, 0, -0.02);
  }
  Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/door_job.yaml");
  std::shared_ptr<const PreparedRobot> robot =
      std::make_shared<const PreparedRobot>(problem_of_run(job, {0, false}));
};

std::vector<EpisodeRow> campaign(const DoorJob& door, const CampaignOptions& options) {
  std::vector<EpisodeRow> rows;
  run_campaign(*door.robot, door.job, options, [&](const EpisodeRow& row) { rows.push_back(row); });
  return rows;
}

void expect_same(const EpisodeRow& a, const EpisodeRow& b) {
  expect_same_rows(a, b, "episode " + std::to_string(b.episode));
}

TEST(JobCampaign, EachRowIsThatOfItsJobAtAnyThreadCount) {
  const DoorJob door;
  CampaignOptions options;
  options.episodes = 12;
  options.seed = 5;
  options.plan.threads = 1;
  std::mutex mutex;
  std::map<std::uint64_t, double> told;  // costs
  options.planned = [&](std::uint64_t episode, const Answer& result) {
    const std::lock_guard lock(mutex);
    told[episode] = result.cost;
  };
  const std::vector<EpisodeRow> rows = campaign(door, options);
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_EQ(told.size(), 12u);
  options.plan.threads = 3;
  const std::vector<EpisodeRow> others = campaign(door, options);
  ASSERT_EQ(others.size(), rows.size());
  std::map<PlanStatus, int> met;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    expect_same(others[k], rows[k]);
    const Problem job = episode_problem(door.job, 5, k);
    EXPECT_EQ(job.scene[0].pose.matrix(),
              episode_problem(problem_of_run(door.job, {0, false}), 5, k).scene[0].pose.matrix());
    PlanOptions alone;
    alone.evidence.tool_path_error = true;
    const Answer result = plan_job(*door.robot, job, alone);
    EpisodeRow expected(k, result, job);
    expected.offsets = episode_offsets(job.vary, 5, k);
    expect_same(rows[k], expected);
    ++met[result.status];
    EXPECT_EQ(rows[k].cost.value_or(0), told[k]);
    EXPECT_EQ(rows[k].cost.has_value(), result.status == PlanStatus::kSolved);
    EXPECT_EQ(rows[k].reason.empty(), result.status == PlanStatus::kSolved);
    if (result.status == PlanStatus::kSolved) {
      EXPECT_GT(*rows[k].tool_path_error_mm_mean, 0);
      EXPECT_LT(*rows[k].tool_path_error_mm_mean, *rows[k].tool_path_error_mm_max);
    } else if (rows[k].cause != "transition") {
      EXPECT_EQ(rows[k].reason.find("stroke '"), 0u) << rows[k].reason;
    }
  }
  EXPECT_GT(met[PlanStatus::kSolved], 2);
  EXPECT_GT(met[PlanStatus::kInfeasible], 2);
  options.shard = {1, 3};
  options.skip = 1;
  const std::vector<EpisodeRow> share = campaign(door, options);
  ASSERT_EQ(share.size(), 3u);
  for (std::size_t k = 0; k < share.size(); ++k) expect_same(share[k], rows[4 + 3 * k]);
}

TEST(JobCampaign, RefusesWhatMakesNoSenseAndStops) {
  DoorJob door;
  CampaignOptions options;
  options.episodes = 2;
  const std::atomic<bool> cancelled{true};
  options.plan.cancel = &cancelled;
  EXPECT_TRUE(campaign(door, options).empty());
  options.plan.cancel = nullptr;
  options.plan.timeout_s = 1e-9;
  EXPECT_TRUE(campaign(door, options).empty());
  options.plan.timeout_s.reset();
  door.job.vary.clear();
  EXPECT_THROW(campaign(door, options), InputError);
  door.job.arm().strokes.clear();
  EXPECT_THROW(campaign(door, options), InvalidArgument);
}

/// Returns the row that a plan of the placed job alone gives.
PlacementRow row_alone(const DoorJob& door, const Movable& thing, const PlacementCell& cell) {
  PlacementRow row{.cell = cell.cell, .offset = cell.offset};
  PlanOptions options;
  options.evidence.postures = true;
  const Answer result =
      plan_job(*door.robot, placed_problem(door.job, thing, cell.offset), options);
  row.status = result.status;
  if (result.status != PlanStatus::kSolved) {
    const StudyFailure failure = failure_of(result, door.job);
    row.failed_s = failure.reached_s;
    row.cause = failure.cause, row.by = failure.by, row.reason = failure.reason;
    return row;
  }
  row.cost = result.cost;
  row.checked = result.checked;
  for (const RunAnswer& run : result.arm().runs) {
    const Measures& m = run;
    if (!row.clearance_margin || m.min_margin->margin < *row.clearance_margin)
      row.clearance_margin = m.min_margin->margin, row.clearance = m.min_margin->clearance;
    if (!row.joint_margin || m.nearest_limit->margin < *row.joint_margin)
      row.joint_margin = m.nearest_limit->margin;
    if (!row.tool_speed || m.top_tool_speed->speed < *row.tool_speed)
      row.tool_speed = m.top_tool_speed->speed;
  }
  return row;
}

TEST(JobPlacements, EachRowIsThatOfThePlacedJobAtAnyThreadCount) {
  const DoorJob door;
  std::map<PlanStatus, int> met;
  for (const Movable& thing :
       {Movable{Movable::Kind::kBase, ""}, Movable{Movable::Kind::kPath, ""},
        Movable{Movable::Kind::kObject, "door"}, Movable{Movable::Kind::kObject, "post"}}) {
    const PlacementGrid grid(
        {placement_axis(0, -0.15, 0.15, 0.15), placement_axis(5, 0, 0.2, 0.2)});
    std::vector<PlacementCell> cells;
    for (std::uint64_t k = 0; k < grid.size(); ++k) cells.push_back({k, grid.placement(k).offset});
    ASSERT_EQ(cells.size(), 6u);
    for (const int threads : {1, 3}) {
      PlanOptions options;
      options.threads = threads;
      PlacementPlanner planner(door.robot, door.job, thing, options);
      int done = 0;
      const auto rows = planner.plan(cells, [&](const PlacementRow&) { ++done; });
      EXPECT_EQ(done, 6);
      EXPECT_FALSE(planner.stopped());
      ASSERT_EQ(rows.size(), cells.size());
      for (std::size_t k = 0; k < cells.size(); ++k) {
        const PlacementRow expected = row_alone(door, thing, cells[k]);
        const std::string what = "cell " + std::to_string(k);
        EXPECT_EQ(rows[k].cell, expected.cell) << what;
        EXPECT_EQ(rows[k].offset, expected.offset) << what;
        EXPECT_EQ(rows[k].status, expected.status) << what;
        EXPECT_EQ(rows[k].cost, expected.cost) << what;
        EXPECT_EQ(rows[k].clearance, expected.clearance) << what;
        EXPECT_EQ(rows[k].clearance_margin, expected.clearance_margin) << what;
        EXPECT_EQ(rows[k].joint_margin, expected.joint_margin) << what;
        EXPECT_EQ(rows[k].tool_speed, expected.tool_speed) << what;
        EXPECT_EQ(rows[k].failed_s, expected.failed_s) << what;
        EXPECT_EQ(rows[k].cause, expected.cause) << what;
        EXPECT_EQ(rows[k].by, expected.by) << what;
        EXPECT_EQ(rows[k].reason, expected.reason) << what;
        ++met[rows[k].status];
      }
    }
  }
  EXPECT_GT(met[PlanStatus::kSolved], 5);
  EXPECT_GT(met[PlanStatus::kInfeasible], 5);
}

TEST(JobPlacements, StopsInTime) {
  const DoorJob door;
  PlanOptions options;
  options.timeout_s = 1e-9;
  PlacementPlanner planner(door.robot, door.job, {Movable::Kind::kBase, ""}, options);
  EXPECT_TRUE(planner.plan({{0, {}}}).empty());
  EXPECT_TRUE(planner.stopped());
  EXPECT_THROW(PlacementPlanner(door.robot, door.job, {Movable::Kind::kObject, "doer"}, {}),
               InvalidArgument);
}

/// Moving one thing moves it as seen by each stroke's own problem, lines of approach and retract
/// included.
TEST(PlacedJob, MovesEachStrokeAsItsProblem) {
  DoorJob door;
  door.job.arm().strokes[0].path_frame.clear();
  door.job.arm().strokes[0].retract = Vector3d(0.01, 0, -0.03);
  Random random(seed("placed job"));
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Movable thing = trial % 3 == 0   ? Movable{Movable::Kind::kBase, ""}
                          : trial % 3 == 1 ? Movable{Movable::Kind::kPath, ""}
                                           : Movable{Movable::Kind::kObject, "door"};
    Offset offset{};
    for (double& value : offset)
      if (random.coin()) value = random.uniform(-1, 1);
    const Problem placed = placed_problem(door.job, thing, offset);
    EXPECT_EQ(placed.arm().home, door.job.arm().home);
    for (std::size_t k = 0; k < placed.arm().strokes.size(); ++k) {
      const PathProblem is = problem_of_run(placed, {k, false}),
                        should =
                            placed_problem(problem_of_run(door.job, {k, false}), thing, offset);
      ASSERT_EQ(is.waypoints.size(), should.waypoints.size());
      for (std::size_t i = 0; i < is.waypoints.size(); ++i) {
        EXPECT_LT((is.waypoints[i].position - should.waypoints[i].position).norm(), 1e-12);
        EXPECT_LT(is.waypoints[i].orientation.angularDistance(should.waypoints[i].orientation),
                  1e-7);
        ++compared;
      }
      for (std::size_t i = 0; i < is.scene.size(); ++i)
        EXPECT_EQ(is.scene[i].pose.matrix(), should.scene[i].pose.matrix());
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(StudyFailure, NamesTheTransitionThatHasNoWay) {
  DoorJob door;
  door.job.arm().transition_limits.clearance =
      0.3;  // of transitions: the arm is nearer to things at home
  const Answer result = plan_job(*door.robot, door.job);
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  ASSERT_TRUE(result.arm().no_transition && result.arm().no_transition->bodies);
  const StudyFailure failure = failure_of(result, door.job);
  EXPECT_EQ(failure.cause, "transition");
  EXPECT_FALSE(failure.reached_s);
  EXPECT_NE(failure.by, "");
  EXPECT_EQ(failure.reason.find("at home "), 0u) << failure.reason;
  EXPECT_NE(failure.reason.find(failure.by), std::string::npos);
}

}  // namespace
}  // namespace swivel
