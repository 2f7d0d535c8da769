// SPDX-License-Identifier: BSD-3-Clause
// Campaigns and placements of workcells: every row against a plan of its workcell alone, whatever
// the threads.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

#include "episode_rows.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/study_failure.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "swivel/planner/study/place.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {
namespace {

const Movable kPaths{Movable::Kind::kPath, ""}, kBase{Movable::Kind::kBase, ""},
    kTable{Movable::Kind::kObject, "table"}, kPost{Movable::Kind::kObject, "post"};
const std::array kThings{kPaths, kBase, kTable, kPost};

SceneObject object(const std::string& name, const Shape& shape, const Vector3d& at) {
  SceneObject made;
  made.name = name;
  made.shape = shape;
  made.pose.translation() = at;
  return made;
}

/// Puts the path of the left arm into the frame of the table.
void put_on_table(Problem& cell) {
  const Matrix3d back = cell.scene[0].pose.linear().transpose();
  cell.arms[0].path().path_frame = "table";
  for (Waypoint& waypoint : cell.arms[0].path().waypoints) {
    waypoint.position = back * (waypoint.position - cell.scene[0].pose.translation());
    waypoint.orientation = Quaterniond(back) * waypoint.orientation;
  }
}

/// Returns a random workcell with a post before the robot and a small table beyond the paths, which
/// carries the left one. `follows`: the left tool carries the path of the right one.
Problem cell_with_scene(Random& random, bool follows) {
  Problem cell = random_workcell(data_robot("sda10f"), random);
  cell.scene.push_back(object("table", Box{Vector3d(0.05, 0.05, 0.02)},
                              Vector3d(1.1, random.uniform(-0.1, 0.1), 0.6)));
  cell.scene[0].pose.linear() = from_rpy({0.1, -0.2, 0.3}).toRotationMatrix();
  cell.scene.push_back(object("post", Cylinder{0.03, 0.4},
                              Vector3d(random.uniform(0.4, 0.7), random.uniform(-0.6, 0.6), 0.8)));
  if (follows) {
    const Vector3d middle(random.uniform(0.62, 0.72), random.uniform(0.15, 0.25), 1.05);
    const double width = random.uniform(0.35, 0.45);
    cell.arms[1].path().path_frame = "left";
    for (std::size_t k = 0; k < 2; ++k) {
      const double side = k == 0 ? -1 : 1;
      cell.arms[0].path().waypoints[k].position = middle + side * Vector3d(0, 0.02, 0.05);
      cell.arms[0].path().waypoints[k].orientation = Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY());
      cell.arms[1].path().waypoints[k].position = Vector3d(0.02 * side, -width, 0);
      cell.arms[1].path().waypoints[k].orientation = Quaterniond::Identity();
    }
  }
  put_on_table(cell);
  cell.vary.push_back({"post", Vector3d(0.2, 0.3, 0), Vector3d(0, 0.5, 0)});
  cell.vary.push_back({"table", Vector3d(0.05, 0.1, 0.1), Vector3d::Zero()});
  return cell;
}

/// Returns the row that a plan of the placed workcell alone gives.
PlacementRow row_alone(const Problem& cell, const Movable& thing, const PlacementCell& at) {
  PlacementRow row{.cell = at.cell, .offset = at.offset, .hold = at.hold};
  PlanOptions options;
  options.evidence.postures = true;
  Problem placed = placed_problem(cell, thing, at.offset);
  for (ArmTask& arm : placed.arms)
    for (const auto& [joint, position] : at.hold) arm.hold[joint] = position;
  const Answer result = plan_workcell(placed, options);
  row.status = result.status;
  if (result.status != PlanStatus::kSolved) {
    const StudyFailure failure = failure_of(result, cell);
    row.failed_s = failure.reached_s;
    row.cause = failure.cause, row.by = failure.by, row.reason = failure.reason;
    return row;
  }
  row.cost = result.arms[0].cost() + result.arms[1].cost();
  std::vector<LeastMargin> margins{*result.pair.nearest};
  for (const ArmAnswer& of : result.arms) {
    const RunAnswer& arm = of.run();
    margins.push_back(*arm.min_margin);
    row.joint_margin =
        std::min(row.joint_margin.value_or(arm.nearest_limit->margin), arm.nearest_limit->margin);
    row.tool_speed =
        std::min(row.tool_speed.value_or(arm.top_tool_speed->speed), arm.top_tool_speed->speed);
  }
  for (const LeastMargin& one : margins)
    if (!row.clearance_margin || one.margin < *row.clearance_margin)
      row.clearance_margin = one.margin, row.clearance = one.clearance;
  return row;
}

void expect_same(const PlacementRow& a, const PlacementRow& b) {
  SCOPED_TRACE("cell " + std::to_string(b.cell));
  EXPECT_EQ(a.cell, b.cell);
  EXPECT_EQ(a.offset, b.offset);
  EXPECT_EQ(a.hold, b.hold);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.clearance, b.clearance);
  EXPECT_EQ(a.clearance_margin, b.clearance_margin);
  EXPECT_EQ(a.joint_margin, b.joint_margin);
  EXPECT_EQ(a.tool_speed, b.tool_speed);
  EXPECT_EQ(a.failed_s, b.failed_s);
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.by, b.by);
  EXPECT_EQ(a.reason, b.reason);
}

std::vector<PlacementRow> rows_of(const Problem& cell, const Movable& thing,
                                  const std::vector<PlacementCell>& cells, int threads) {
  PlanOptions options;
  options.threads = threads;
  PlacementPlanner planner(cell, thing, options);
  std::size_t done = 0;
  auto rows = planner.plan(cells, [&](const PlacementRow&) { ++done; });
  EXPECT_EQ(done, cells.size());
  EXPECT_FALSE(planner.stopped());
  EXPECT_TRUE(planner.trajectories(cells).empty());
  return rows;
}

/// Checks that the path of one arm was moved by an offset without turns, and nothing else.
void expect_path_moved(const Problem& cell, const Problem& placed, std::size_t arm,
                       const Offset& offset) {
  EXPECT_EQ(placed.arms[1 - arm].path().waypoints, cell.arms[1 - arm].path().waypoints);
  for (std::size_t k = 0; k < cell.scene.size(); ++k)
    EXPECT_EQ(placed.scene[k].pose.matrix(), cell.scene[k].pose.matrix());
  Matrix3d frame = Matrix3d::Identity();  // of a follower that of the leader's tool
  for (const SceneObject& object : cell.scene)
    if (object.name == cell.arms[arm].path().path_frame) frame = object.pose.linear();
  for (std::size_t k = 0; k < cell.arms[arm].path().waypoints.size(); ++k) {
    const Waypoint &before = cell.arms[arm].path().waypoints[k],
                   &after = placed.arms[arm].path().waypoints[k];
    EXPECT_LT(
        (frame * (after.position - before.position) - Vector3d(offset[0], offset[1], offset[2]))
            .norm(),
        1e-12);
    EXPECT_EQ(after.orientation.coeffs(), before.orientation.coeffs());
  }
}

/// The path of one arm is moved by itself, that of a leader, of a follower, and of arms side by
/// side; the torso is held elsewhere, alone and at the same time.
TEST(WorkcellPlacements, OneArmsPathAndTheTorso) {
  Random random(seed("WorkcellPlacements.OneArmsPath"));
  std::map<std::string, int> met;
  const int count = trials(12);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const bool follows = trial % 4 >= 2;
    const Problem cell = cell_with_scene(random, follows);
    const auto arm = static_cast<std::size_t>(trial % 2);
    const Movable thing = trial % 5 == 4 ? Movable{Movable::Kind::kNothing, ""}
                                         : Movable{Movable::Kind::kPath, "", cell.arms[arm].name};
    const bool moves = thing.kind == Movable::Kind::kPath, holds = !moves || trial % 3 > 0;
    std::vector<PlacementCell> cells;
    for (std::uint64_t k = 0; k < 5; ++k) {
      PlacementCell& at = cells.emplace_back(PlacementCell{k});
      for (std::size_t c = 0; moves && c < 3; ++c) at.offset[c] = random.uniform(-0.1, 0.1);
      if (holds) at.hold["torso_joint_b1"] = random.uniform(-0.2, 0.2);
      if (moves) expect_path_moved(cell, placed_problem(cell, thing, at.offset), arm, at.offset);
    }
    const auto rows = rows_of(cell, thing, cells, 1), others = rows_of(cell, thing, cells, 3);
    ASSERT_EQ(rows.size(), cells.size());
    ASSERT_EQ(others.size(), cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      expect_same(rows[k], row_alone(cell, thing, cells[k]));
      expect_same(others[k], rows[k]);
      ++met[rows[k].status == PlanStatus::kSolved ? "solved" : "no plan"];
      ++met[!moves ? "torso" : !follows ? "side by side" : arm == 0 ? "leader" : "follower"];
    }
  }
  std::printf("%d workcells:", count);
  for (const auto& [what, times] : met) std::printf(" %s %d", what.c_str(), times);
  std::printf("\n");
  for (const char* const what : {"torso", "side by side", "leader", "follower"})
    EXPECT_GE(met[what], at_least(5)) << what;
  EXPECT_GE(met["solved"], at_least(count));
  EXPECT_GE(met["no plan"], at_least(3));
}

TEST(WorkcellPlacements, AnArmIsRefusedByLine) {
  Random random(seed("WorkcellPlacements.Refused"));
  const Problem cell = cell_with_scene(random, false);
  const auto refused = [&](const Movable& thing, const char* words) {
    try {
      static_cast<void>(placed_problem(cell, thing, {}));
      ADD_FAILURE() << words;
    } catch (const InvalidArgument& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(words), std::string::npos) << message;
      EXPECT_NE(message.find("allowed "), std::string::npos) << message;
    }
  };
  refused({Movable::Kind::kPath, "", "middle"}, "unknown arm 'middle'");
  refused({Movable::Kind::kBase, "", "left"}, "both arms are of one robot");
  EXPECT_THROW(static_cast<void>(placed_problem(cell, {Movable::Kind::kNothing, ""}, {0.1})),
               InvalidArgument);
  Problem planned = cell;
  EXPECT_THROW(hold_joints(planned, {{"arm_left_joint_1_s", 0}}), InvalidArgument);
  PathProblem one;
  EXPECT_THROW(static_cast<void>(placed_problem(one, {Movable::Kind::kPath, "", "left"}, {})),
               InvalidArgument);
}

TEST(WorkcellPlacements, EachRowIsThatOfThePlacedWorkcellAtAnyThreadCount) {
  Random random(seed("WorkcellPlacements.EachRowIsThatOfThePlacedWorkcell"));
  std::map<std::string, int> met;
  const int count = trials(16);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const bool follows = trial % 4 >= 2;
    const Problem cell = cell_with_scene(random, follows);
    const Movable thing =
        kThings[static_cast<std::size_t>(trial % 4 == 0 ? random.below(4) : trial % 4)];
    // paths in two frames are not turned alike
    const bool turns = thing.kind != Movable::Kind::kPath || follows;
    const PlacementGrid grid(
        {placement_axis(1, -0.2, 0.2, 0.1), placement_axis(5, 0, turns ? 0.2 : 0, 0.2)});
    std::vector<PlacementCell> cells;
    for (std::uint64_t k = 0; k < grid.size(); ++k) cells.push_back({k, grid.placement(k).offset});
    const auto rows = rows_of(cell, thing, cells, 1), others = rows_of(cell, thing, cells, 3);
    ASSERT_EQ(rows.size(), cells.size());
    ASSERT_EQ(others.size(), cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      expect_same(rows[k], row_alone(cell, thing, cells[k]));
      expect_same(others[k], rows[k]);
      const bool solved = rows[k].status == PlanStatus::kSolved;
      EXPECT_EQ(rows[k].reason.empty(), solved);
      ++met[solved ? "solved" : rows[k].cause == "conflict" ? "conflict" : "one arm"];
    }
  }
  std::printf("%d workcells:", count);
  for (const auto& [what, times] : met) std::printf(" %s %d", what.c_str(), times);
  std::printf("\n");
  EXPECT_GE(met["solved"], at_least(count));
  EXPECT_GE(met["one arm"], at_least(count));
}

TEST(WorkcellPlacements, TellsThatTheArmsMeet) {
  Random random(1);
  Problem cell = random_workcell(data_robot("sda10f"), random);
  const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 2; ++i) {
      const double side = k == 0 ? 0.01 : -0.01, up = i == 0 ? 1.0 : 1.1;
      cell.arms[k].path().waypoints[i] = {.position = Vector3d(0.72, side, up),
                                          .orientation = forward};
    }
  const auto rows = rows_of(cell, kPaths, {{0, {}}}, 1);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].status, PlanStatus::kInfeasible);
  EXPECT_EQ(rows[0].cause, "conflict");
  EXPECT_FALSE(rows[0].failed_s);
  EXPECT_NE(rows[0].by.find(" - "), std::string::npos);
  EXPECT_EQ(rows[0].reason.find("each arm has a path by itself"), 0u) << rows[0].reason;
}

/// Returns a pose in the base frame of a thing that is moved: turned about `origin`, then shifted.
Pose moved(const Pose& pose, const Offset& offset, const Vector3d& origin) {
  const Matrix3d turn = from_rpy({offset[3], offset[4], offset[5]}).toRotationMatrix();
  Pose result = Pose::Identity();
  result.linear() = turn * pose.linear();
  result.translation() =
      origin + turn * (pose.translation() - origin) + Vector3d(offset[0], offset[1], offset[2]);
  return result;
}

Pose pose_of(const Waypoint& waypoint) {
  Pose pose = Pose::Identity();
  pose.translation() = waypoint.position;
  pose.linear() = waypoint.orientation.normalized().toRotationMatrix();
  return pose;
}

/// Returns the waypoints of an arm in the base frame, or on its leader's tool.
std::vector<Pose> in_base(const Problem& cell, std::size_t arm) {
  Pose frame = Pose::Identity();
  for (const SceneObject& one : cell.scene)
    if (one.name == cell.arms[arm].path().path_frame) frame = one.pose;
  std::vector<Pose> poses;
  for (const Waypoint& waypoint : cell.arms[arm].path().waypoints)
    poses.push_back(frame * pose_of(waypoint));
  return poses;
}

void expect_near(const Pose& is, const Pose& should, const char* what) {
  EXPECT_LT((is.matrix() - should.matrix()).cwiseAbs().maxCoeff(), 1e-11) << what;
}

TEST(PlacedWorkcell, MovesWhatGoesWithTheThing) {
  Random random(seed("PlacedWorkcell.MovesWhatGoesWithTheThing"));
  int compared = 0;
  for (int trial = 0; trial < 120; ++trial) {
    SCOPED_TRACE(trial);
    const bool follows = random.coin();
    const Problem cell = cell_with_scene(random, follows);
    const Movable thing = kThings[static_cast<std::size_t>(random.below(4))];
    Offset offset{};
    const int turns = thing.kind == Movable::Kind::kPath && !follows ? 3 : 6;
    for (int k = 0; k < turns; ++k)
      if (random.coin()) offset[static_cast<std::size_t>(k)] = random.uniform(-1, 1);
    const Problem placed = placed_problem(cell, thing, offset);
    const Vector3d table = cell.scene[0].pose.translation();
    Pose robot = Pose::Identity();  // where it stands now
    if (thing.kind == Movable::Kind::kBase) robot = moved(robot, offset, Vector3d::Zero());
    const auto seen = [&](const Pose& pose) { return Pose(robot.inverse() * pose); };
    for (std::size_t i = 0; i < 2; ++i) {
      const Pose& was = cell.scene[i].pose;
      const bool moves = thing.object == cell.scene[i].name;
      expect_near(placed.scene[i].pose, seen(moves ? moved(was, offset, was.translation()) : was),
                  "object");
    }
    for (std::size_t k = 0; k < 2; ++k) {
      const auto was = in_base(cell, k), is = in_base(placed, k);
      ASSERT_EQ(is.size(), was.size());
      const bool on_table = cell.arms[k].path().path_frame == "table", on_tool = k == 1 && follows;
      const bool moves =
          !on_tool && (thing.kind == Movable::Kind::kPath || (thing.object == "table" && on_table));
      const Vector3d origin = on_table ? table : Vector3d(0, 0, 0);
      for (std::size_t i = 0; i < is.size(); ++i, ++compared) {
        const Pose stays = on_tool ? was[i] : seen(was[i]);
        expect_near(is[i], moves ? moved(was[i], offset, origin) : stays, "waypoint");
        if (on_tool) {
          EXPECT_EQ(placed.arms[k].path().waypoints[i], cell.arms[k].path().waypoints[i]);
        }
      }
    }
  }
  EXPECT_EQ(compared, 480);
}

TEST(PlacedWorkcell, RefusesPathsThatCannotBeMovedAlike) {
  Random random(2);
  Problem cell = cell_with_scene(random, false);
  EXPECT_NO_THROW(static_cast<void>(placed_problem(cell, kPaths, {0.1, 0, 0, 0, 0, 0})));
  EXPECT_THROW(static_cast<void>(placed_problem(cell, kPaths, {0, 0, 0, 0, 0, 0.1})),
               InvalidArgument);
  EXPECT_THROW(static_cast<void>(placed_problem(cell, {Movable::Kind::kObject, "tabel"}, {})),
               InvalidArgument);
  EXPECT_THROW(PlacementPlanner(cell, {Movable::Kind::kObject, "left"}, {}), InvalidArgument);
  cell = cell_with_scene(random, true);
  cell.arms[0].given.resize(2, Config::Zero());
  cell.arms[0].path().waypoints.clear();
  cell.arms[0].path().path_frame.clear();
  EXPECT_THROW(static_cast<void>(placed_problem(cell, kPaths, {})), InvalidArgument);
  EXPECT_NO_THROW(static_cast<void>(placed_problem(cell, kBase, {0.1, 0, 0, 0, 0, 0})));
}

/// Where an object is moved into a given motion there is no plan, which the row says; elsewhere
/// rows are those of plans.
TEST(WorkcellPlacements, TellThatAGivenMotionIsBarred) {
  Random random(seed("WorkcellPlacements.TellThatAGivenMotionIsBarred"));
  int barred = 0, planned = 0;
  const int count = trials(16);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    Problem cell = random_workcell(data_robot("sda10f"), random);
    const Answer both = plan_workcell(cell);
    if (both.status != PlanStatus::kSolved) continue;
    ArmTask& left = cell.arms[0];
    const Vector3d at = left.path().waypoints[0].position;
    for (const TrajectoryRow& row : both.arms[0].rows()) left.given.push_back(row.q);
    left.path().waypoints.clear();
    cell.scene.push_back(object("post", Sphere{0.05}, at + Vector3d(0, 0, -0.6)));
    std::vector<PlacementCell> cells;
    for (std::uint64_t k = 0; k < 4; ++k) cells.push_back({k, {0, 0, 0.2 * double(k), 0, 0, 0}});
    for (const PlacementRow& row : rows_of(cell, kPost, cells, 2)) {
      if (row.cause != "given_motion") {
        expect_same(row, row_alone(cell, kPost, cells[row.cell]));
        ++planned;
        continue;
      }
      ++barred;
      EXPECT_EQ(row.status, PlanStatus::kInfeasible);
      EXPECT_EQ(row.by, "given motion of 'left'");
      EXPECT_EQ(row.reason.find(row.by + ": row "), 0u) << row.reason;
      EXPECT_NE(row.reason.find("post"), std::string::npos) << row.reason;
      EXPECT_THROW(static_cast<void>(row_alone(cell, kPost, cells[row.cell])), InputError);
    }
    CampaignOptions options;
    options.episodes = 2;
    cell.scene[0].pose.translation() = at;
    cell.vary.push_back({"post", Vector3d(1e-3, 0, 0), Vector3d::Zero()});
    run_campaign(cell, options, [&](const EpisodeRow& row) {
      EXPECT_EQ(row.status, PlanStatus::kInfeasible);
      EXPECT_EQ(row.cause, "given_motion");
      EXPECT_EQ(row.offsets, episode_offsets(cell.vary, 1, row.episode));
    });
  }
  std::printf("%d placements barred by a given motion, %d planned\n", barred, planned);
  EXPECT_GE(barred, at_least(4));
  EXPECT_GE(planned, at_least(4));
}

TEST(WorkcellPlacements, StopsInTime) {
  Random random(3);
  PlanOptions options;
  options.timeout_s = 1e-9;
  PlacementPlanner planner(cell_with_scene(random, false), kBase, options);
  EXPECT_TRUE(planner.plan({{0, {}}}).empty());
  EXPECT_TRUE(planner.stopped());
}

std::vector<EpisodeRow> campaign(const Problem& cell, const CampaignOptions& options) {
  std::vector<EpisodeRow> rows;
  run_campaign(cell, options, [&](const EpisodeRow& row) { rows.push_back(row); });
  return rows;
}

void expect_same(const EpisodeRow& a, const EpisodeRow& b) {
  expect_same_rows(a, b, "episode " + std::to_string(b.episode));
}

TEST(WorkcellCampaign, EachRowIsThatOfItsWorkcellAtAnyThreadCount) {
  Random random(seed("WorkcellCampaign.EachRowIsThatOfItsWorkcell"));
  std::map<PlanStatus, int> met;
  const int count = trials(4);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const Problem cell = cell_with_scene(random, trial % 2 == 1);
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
    const std::vector<EpisodeRow> rows = campaign(cell, options);
    options.plan.threads = 3;
    const std::vector<EpisodeRow> others = campaign(cell, options);
    ASSERT_EQ(rows.size(), 12u);
    ASSERT_EQ(others.size(), 12u);
    EXPECT_EQ(told.size(), 12u);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      expect_same(others[k], rows[k]);
      PathProblem problem;
      problem.scene = cell.scene;
      problem.vary = cell.vary;
      const Problem drawn = episode_problem(cell, 5, k);
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(drawn.scene[i].pose.matrix(),
                  episode_problem(problem, 5, k).scene[i].pose.matrix());
      PlanOptions alone;
      alone.threads = 1;
      alone.evidence.tool_path_error = true;
      const Answer result = plan_workcell(drawn, alone);
      EpisodeRow expected(k, result, cell);
      expected.offsets = episode_offsets(cell.vary, 5, k);
      expect_same(rows[k], expected);
      ++met[result.status];
      EXPECT_EQ(rows[k].cost.value_or(0), told[k]);
      EXPECT_EQ(rows[k].reason.empty(), result.status == PlanStatus::kSolved);
      if (result.status != PlanStatus::kSolved) continue;
      EXPECT_EQ(*rows[k].cost, result.arms[0].cost() + result.arms[1].cost());
      EXPECT_EQ(rows[k].nodes_checked,
                result.arms[0].counters.nodes_checked + result.arms[1].counters.nodes_checked);
      EXPECT_GT(*rows[k].tool_path_error_mm_mean, 0);
      EXPECT_LT(*rows[k].tool_path_error_mm_mean, *rows[k].tool_path_error_mm_max);
    }
    options.shard = {1, 3};
    options.skip = 1;
    const std::vector<EpisodeRow> share = campaign(cell, options);
    ASSERT_EQ(share.size(), 3u);
    for (std::size_t k = 0; k < share.size(); ++k) expect_same(share[k], rows[4 + 3 * k]);
  }
  std::printf("%d episodes solved, %d infeasible\n", met[PlanStatus::kSolved],
              met[PlanStatus::kInfeasible]);
  EXPECT_GE(met[PlanStatus::kSolved], at_least(2));
  EXPECT_GE(met[PlanStatus::kInfeasible], at_least(2));
}

TEST(WorkcellCampaign, RefusesWhatMakesNoSenseAndStops) {
  Random random(4);
  Problem cell = cell_with_scene(random, false);
  CampaignOptions options;
  options.episodes = 2;
  const std::atomic<bool> cancelled{true};
  options.plan.cancel = &cancelled;
  EXPECT_TRUE(campaign(cell, options).empty());
  options.plan.cancel = nullptr;
  options.plan.timeout_s = 1e-9;
  EXPECT_TRUE(campaign(cell, options).empty());
  options.plan.timeout_s.reset();
  options.plan.hooks.check = std::make_shared<AllowsAll>();
  EXPECT_THROW(campaign(cell, options), InvalidArgument);
  options.plan.hooks.check.reset();
  cell.vary.clear();
  EXPECT_THROW(campaign(cell, options), InputError);
  cell.arms[1].path().waypoints.clear();
  EXPECT_THROW(campaign(cell, options), InvalidArgument);
}

}  // namespace
}  // namespace swivel::test
