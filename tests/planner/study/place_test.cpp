// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/place.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <thread>

#include "random_problem.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/grid_refinement.hpp"

namespace swivel {
namespace {

using namespace test;

Movable random_thing(Random& random, const Problem& problem) {
  const int kind = random.below(3);
  if (kind == 0 && !problem.scene.empty())
    return {
        Movable::Kind::kObject,
        problem
            .scene[static_cast<std::size_t>(random.below(static_cast<int>(problem.scene.size())))]
            .name};
  return {kind == 1 ? Movable::Kind::kPath : Movable::Kind::kBase, ""};
}

Offset random_offset(Random& random, double far) {
  Offset offset{};
  for (double& value : offset)
    if (random.coin()) value = random.uniform(-far, far);
  return offset;
}

/// A path that is in the frame of an object half of the time.
Problem random_cell(const TestRobot& robot, Random& random) {
  Problem problem = random_problem(robot, random);
  problem.start.reset();
  if (problem.scene.empty() || random.coin()) return problem;
  const Pose back = problem.scene[0].pose.inverse();
  for (Waypoint& waypoint : problem.waypoints) {
    waypoint.position = back * waypoint.position;
    waypoint.orientation = Quaterniond(back.linear()) * waypoint.orientation;
  }
  problem.path_frame = problem.scene[0].name;
  return problem;
}

void expect_same(const PlacementRow& a, const PlacementRow& b, const std::string& what) {
  EXPECT_EQ(a.cell, b.cell) << what;
  EXPECT_EQ(a.offset, b.offset) << what;
  EXPECT_EQ(a.status, b.status) << what;
  EXPECT_EQ(a.cost, b.cost) << what;
  EXPECT_EQ(a.clearance, b.clearance) << what;
  EXPECT_EQ(a.clearance_margin, b.clearance_margin) << what;
  EXPECT_EQ(a.joint_margin, b.joint_margin) << what;
  EXPECT_EQ(a.tool_speed, b.tool_speed) << what;
  EXPECT_EQ(a.failed_s, b.failed_s) << what;
  EXPECT_EQ(a.cause, b.cause) << what;
  EXPECT_EQ(a.by, b.by) << what;
  EXPECT_EQ(a.reason, b.reason) << what;
}

/// Every cell is what planning its problem with a planner of its own gives, bit for bit, and the
/// same at any number of threads.
TEST(Place, CellsAreSinglePlans) {
  const std::uint64_t base = seed("Place.Cells");
  const auto robots = all_robots();
  std::map<std::string, int> met;
  for (int trial = 0; trial < trials(24); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const Problem problem =
        random_cell(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const auto robot = std::make_shared<const PreparedRobot>(problem);
    const Movable thing = random_thing(random, problem);
    std::vector<PlacementCell> cells;
    for (std::uint64_t k = 0; k < 12; ++k)
      cells.push_back({3 * k, random_offset(random, random.coin() ? 0.01 : 0.1)});
    PlanOptions options;
    options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
    std::vector<std::vector<PlacementRow>> found;
    for (const int threads : {1, 2, 3}) {
      options.threads = threads;
      PlacementPlanner planner(robot, problem, thing, options);
      found.push_back(planner.plan({cells.begin(), cells.begin() + 5}));
      const auto more = planner.plan({cells.begin() + 5, cells.end()});
      found.back().insert(found.back().end(), more.begin(), more.end());
      ASSERT_EQ(found.back().size(), cells.size()) << what;
      EXPECT_FALSE(planner.stopped());
      for (std::size_t k = 0; k < cells.size(); ++k)
        expect_same(found.back()[k], found.front()[k], what);
    }
    options.evidence.postures = true;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const Problem placed = placed_problem(problem, thing, cells[k].offset);
      const PlanResult result = plan(*robot, placed, options);
      PlacementRow row;
      row.cell = cells[k].cell;
      row.offset = cells[k].offset;
      row.status = result.status;
      ++met[to_string(row.status)];
      ++met[thing.kind == Movable::Kind::kObject ? "object"
            : thing.kind == Movable::Kind::kPath ? "path"
                                                 : "base"];
      if (row.status == PlanStatus::kSolved) {
        row.cost = result.cost;
        if (result.min_margin) {
          row.clearance = result.min_margin->clearance;
          row.clearance_margin = result.min_margin->margin;
          ++met["clearance"];
        }
        if (result.nearest_limit) row.joint_margin = result.nearest_limit->margin;
        if (result.top_tool_speed) row.tool_speed = result.top_tool_speed->speed;
      } else {
        row.failed_s = result.diagnosis.reached_s;
        row.cause = to_string(result.diagnosis.cause.kind);
        row.by = subject_of(result.diagnosis.cause, placed);
        row.reason = words(result.diagnosis.cause);
      }
      expect_same(found.front()[k], row, what + " cell " + std::to_string(k));
    }
    if (HasFailure()) return;
  }
  for (const auto& [name, times] : met) std::printf("%s %d; ", name.c_str(), times);
  std::printf("\n");
  for (const char* const name : {"solved", "infeasible", "object", "path", "base", "clearance"})
    EXPECT_GE(met[name], at_least(12)) << name;
}

/// An object that moves a little from cell to cell: what is kept of its clearances from one to the
/// next changes no answer, and spares most questions.
TEST(Place, NeighboursAreWhatTheyAreAlone) {
  const std::uint64_t base = seed("Place.Neighbours");
  const auto robots = all_robots();
  int solved = 0, infeasible = 0, changed = 0;
  std::int64_t asked = 0, asked_alone = 0;
  for (int trial = 0; trial < trials(30); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Problem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (problem.scene.empty()) continue;
    const auto robot = std::make_shared<const PreparedRobot>(problem);
    const Movable thing{
        Movable::Kind::kObject,
        problem
            .scene[static_cast<std::size_t>(random.below(static_cast<int>(problem.scene.size())))]
            .name};
    if (thing.object == problem.path_frame) continue;
    PlanOptions options;
    options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
    options.threads = 1;
    std::vector<PlacementCell> cells;
    Offset at{};
    for (std::uint64_t k = 0; k < 20; ++k) {
      cells.push_back({k, at});
      const Offset step = random_offset(random, 0.005);
      for (std::size_t c = 0; c < at.size(); ++c) at[c] += step[c];
    }
    PlacementPlanner placements(robot, problem, thing, options);
    const std::vector<PlacementRow> rows = placements.plan(cells);
    const std::vector<PlacedPlan> plans = placements.trajectories(cells);
    ASSERT_EQ(rows.size(), cells.size()) << what;
    Planner planner(robot, problem);
    options.evidence.postures = true;
    auto shown = plans.begin();
    std::optional<PlanStatus> before;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::string here = what + " cell " + std::to_string(k);
      const Problem placed = placed_problem(problem, thing, cells[k].offset);
      const PlanResult alone = plan(*robot, placed, options);
      planner.set_problem(placed);
      const PlanResult again = planner.plan(options);
      asked += again.counters.nodes_checked;
      asked_alone += alone.counters.nodes_checked;
      ASSERT_EQ(rows[k].status, alone.status) << here;
      ASSERT_EQ(again.status, alone.status) << here;
      changed += before && *before != alone.status;
      before = alone.status;
      if (alone.status != PlanStatus::kSolved) {
        ++infeasible;
        EXPECT_EQ(rows[k].failed_s, alone.diagnosis.reached_s) << here;
        EXPECT_EQ(rows[k].reason, words(alone.diagnosis.cause)) << here;
        continue;
      }
      ++solved;
      EXPECT_EQ(rows[k].cost, alone.cost) << here;
      EXPECT_EQ(rows[k].clearance_margin.has_value(), alone.min_margin.has_value()) << here;
      if (alone.min_margin) {
        EXPECT_EQ(rows[k].clearance_margin, alone.min_margin->margin) << here;
        EXPECT_EQ(rows[k].clearance, alone.min_margin->clearance) << here;
      }
      ASSERT_NE(shown, plans.end()) << here;
      EXPECT_EQ(shown->cell.cell, k) << here;
      ASSERT_EQ(shown->trajectory.size(), alone.trajectory.size()) << here;
      for (std::size_t i = 0; i < alone.trajectory.size(); ++i) {
        ASSERT_EQ(shown->trajectory[i].q, alone.trajectory[i].q) << here << " row " << i;
        ASSERT_EQ(again.trajectory[i].q, alone.trajectory[i].q) << here << " row " << i;
      }
      ++shown;
    }
    EXPECT_EQ(shown, plans.end()) << what;
  }
  std::printf(
      "%d solved, %d infeasible, the verdict changed %d times; %lld nodes asked about of %lld\n",
      solved, infeasible, changed, static_cast<long long>(asked),
      static_cast<long long>(asked_alone));
  EXPECT_GE(solved, at_least(100));
  EXPECT_GE(infeasible, at_least(20));
  EXPECT_LT(2 * asked, asked_alone);
}

/// Things are where they should be in the world, whichever of them is moved.
TEST(Place, MovesWhatItSaysAndNothingElse) {
  const std::uint64_t base = seed("Place.Moves");
  const auto robots = all_robots();
  int looked_at = 0, kept = 0;
  for (int trial = 0; trial < trials(300); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Problem problem =
        random_cell(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const Offset offset = random_offset(random, 3);
    const Movable thing = random_thing(random, problem);
    const Problem placed = placed_problem(problem, thing, offset);
    Pose turn = Pose::Identity();
    turn.linear() = from_rpy({offset[3], offset[4], offset[5]}).toRotationMatrix();
    const Vector3d shift(offset[0], offset[1], offset[2]);
    // The pose of the base in the world as it was.
    Pose robot = Pose::Identity();
    if (thing.kind == Movable::Kind::kBase) {
      robot = turn;
      robot.translation() = shift;
    }
    const auto about = [&](const Vector3d& origin, const Pose& pose) {
      Pose moved = turn * pose;
      moved.translation() = origin + shift + turn * (pose.translation() - origin);
      return moved;
    };
    Vector3d path_origin = Vector3d::Zero();
    for (std::size_t k = 0; k < problem.scene.size(); ++k) {
      Pose expected = problem.scene[k].pose;
      if (thing.object == problem.scene[k].name) expected = about(expected.translation(), expected);
      if (problem.path_frame == problem.scene[k].name)
        path_origin = problem.scene[k].pose.translation();
      EXPECT_TRUE((robot * placed.scene[k].pose).matrix().isApprox(expected.matrix(), 1e-9))
          << trial;
      if (thing.kind != Movable::Kind::kBase && thing.object != problem.scene[k].name) {
        EXPECT_EQ(placed.scene[k].pose.matrix(), problem.scene[k].pose.matrix());
      }
    }
    const bool moves = thing.kind == Movable::Kind::kPath ||
                       (!thing.object.empty() && thing.object == problem.path_frame);
    const auto before = waypoints_in_base(problem), after = waypoints_in_base(placed);
    for (std::size_t k = 0; k < before.size(); ++k) {
      Pose pose = Pose::Identity();
      pose.linear() = before[k].orientation.toRotationMatrix();
      pose.translation() = before[k].position;
      if (moves) pose = about(path_origin, pose);
      EXPECT_LT((robot * after[k].position - pose.translation()).norm(), 1e-9) << trial;
      EXPECT_LT((robot.linear() * after[k].orientation.toRotationMatrix() - pose.linear()).norm(),
                1e-9)
          << trial;
      ++looked_at;
    }
    const Problem still = placed_problem(problem, thing, {});
    for (std::size_t k = 0; k < problem.scene.size(); ++k, ++kept)
      EXPECT_EQ(still.scene[k].pose.matrix(), problem.scene[k].pose.matrix());
    EXPECT_EQ(still.waypoints, problem.waypoints);
    if (HasFailure()) return;
  }
  std::printf("%d waypoints, %d objects\n", looked_at, kept);
  EXPECT_GE(looked_at, at_least(600));
  EXPECT_GE(kept, at_least(300));
  const Problem problem = random_problem(robots[0], *std::make_unique<Random>(base));
  EXPECT_THROW((void)placed_problem(problem, {Movable::Kind::kObject, "nothing"}, {}),
               InvalidArgument);
}

/// Roll, pitch and yaw that a file is given turn into the rotation that was planned, also where two
/// of them turn about one axis.
TEST(Place, WrittenAnglesReadBackBitForBit) {
  const std::uint64_t base = seed("Place.Angles");
  Random random(base);
  int upright = 0;
  for (int trial = 0; trial < trials(20000); ++trial) {
    Vector3d rpy(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4));
    if (random.coin(0.2))
      rpy.y() = (random.coin() ? 1 : -1) * kPi / 2 +
                (random.coin() ? 0 : std::pow(10, random.uniform(-17, -3)));
    const Matrix3d wanted = from_rpy(rpy).toRotationMatrix(),
                   written = rotation_from_rpy(written_rpy(wanted));
    ASSERT_LT((wanted - written).norm(), 1e-11) << base << " " << trial;
    ASSERT_EQ(rotation_from_rpy(written_rpy(written)), written) << base << " " << trial;
    upright += std::abs(std::sin(rpy.y())) > 1 - 1e-9;
  }
  EXPECT_GE(upright, at_least(1000));
}

TEST(Place, StopsWithWhatIsKnown) {
  Problem problem = io::load_problem(data_dir() / "problems/experiment_c.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  std::vector<PlacementCell> cells;
  for (std::uint64_t k = 0; k < 400; ++k) cells.push_back({k, {0.0001 * static_cast<double>(k)}});
  PlanOptions options;
  options.threads = 2;
  std::atomic<bool> cancel{false};
  options.cancel = &cancel;
  PlacementPlanner planner(robot, problem, {Movable::Kind::kObject, "door"}, options);
  int told = 0;
  const auto rows = planner.plan(cells, [&](const PlacementRow&) {
    if (++told == 20) cancel = true;
  });
  EXPECT_TRUE(planner.stopped());
  EXPECT_EQ(static_cast<int>(rows.size()), told);
  EXPECT_GE(told, 20);
  EXPECT_LT(told, 30);
  cancel = false;
  options.timeout_s = 1e-9;
  PlacementPlanner late(robot, problem, {Movable::Kind::kObject, "door"}, options);
  EXPECT_TRUE(late.plan(cells).empty());
  EXPECT_TRUE(late.stopped());
}

TEST(Place, AStartThatThePathLeavesIsBadInput) {
  Problem problem = io::load_problem(data_dir() / "problems/experiment_a_start.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.2};
  PlacementPlanner planner(std::make_shared<const PreparedRobot>(problem), problem,
                           {Movable::Kind::kPath, ""}, {});
  try {
    static_cast<void>(planner.plan({{0, {0.1}}}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("moved by x 0.1"), std::string::npos) << error.what();
  }
}

/// A third of the plans at most; the best ten within 1 % of the best there are, where the criterion
/// has one hill within a region.
TEST(GridRefinement, FindsTheBestWithAThirdOfThePlans) {
  const std::uint64_t base = seed("GridRefinement");
  std::int64_t asked = 0, cells = 0;
  int compared = 0, worse = 0, border = 0, unlike = 0;
  for (int trial = 0; trial < trials(200); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    std::vector<PlacementAxis> axes;
    const int dimensions = 1 + random.below(3);
    for (int a = 0; a < dimensions; ++a) {
      const int count = random.coin(0.1) ? 1 : 20 + random.below(dimensions == 3 ? 10 : 40);
      axes.push_back({a, -1, 1, 2.0 / std::max(1, count - 1), count});
    }
    const PlacementGrid grid(axes);
    const Vector3d top(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2),
                       random.uniform(-1.2, 1.2)),
        center(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double radius = random.uniform(0.6, 2);
    const auto row_of = [&](std::uint64_t cell) {
      PlacementRow row;
      row.cell = cell;
      row.offset = grid.offset(cell);
      Vector3d at = Vector3d::Zero(), hill = Vector3d::Zero(), middle = Vector3d::Zero();
      for (int a = 0; a < dimensions; ++a) {
        at[a] = row.offset[static_cast<std::size_t>(a)];
        hill[a] = top[a];
        middle[a] = center[a];
      }
      row.status = (at - middle).norm() < radius ? PlanStatus::kSolved : PlanStatus::kInfeasible;
      if (row.status == PlanStatus::kSolved) row.cost = 1 + (at - hill).squaredNorm();
      return row;
    };
    GridRefinement refinement(grid, {PlacementCriterion::kCost});
    std::map<std::uint64_t, PlacementRow> known;
    for (auto next = refinement.next(); !next.empty(); next = refinement.next())
      for (const std::uint64_t cell : next) {
        ASSERT_LT(cell, grid.size());
        ASSERT_TRUE(known.emplace(cell, row_of(cell)).second) << "asked twice";
        refinement.learn(row_of(cell));
      }
    ASSERT_LE(known.size(), std::max<std::size_t>(1, grid.size() / 3)) << trial;
    asked += static_cast<std::int64_t>(known.size());
    cells += static_cast<std::int64_t>(grid.size());
    if (grid.size() < 200) continue;
    std::vector<PlacementRow> all, some;
    for (std::uint64_t cell = 0; cell < grid.size(); ++cell) all.push_back(row_of(cell));
    for (const auto& [cell, row] : known) some.push_back(row);
    const auto best = best_placements(all, {PlacementCriterion::kCost}, 10),
               found = best_placements(some, {PlacementCriterion::kCost}, 10);
    if (best.size() < 10) continue;
    ++compared;
    for (std::size_t k = 0; k < 10; ++k)
      if (k >= found.size() || *found[k].cost > 1.01 * *best[k].cost) {
        ++worse;
        break;
      }
    if (dimensions != 2) continue;
    for (std::uint64_t cell = 0; cell + 1 < grid.size(); ++cell) {
      if (grid.indices(cell)[0] != grid.indices(cell + 1)[0] ||
          all[cell].status == all[cell + 1].status)
        continue;
      ++unlike;
      border += known.contains(cell) && known.contains(cell + 1);
    }
  }
  std::printf(
      "%lld of %lld cells planned; the best ten more than 1 %% worse in %d of %d; %d of %d pairs "
      "across the border planned\n",
      static_cast<long long>(asked), static_cast<long long>(cells), worse, compared, border,
      unlike);
  EXPECT_GE(compared, at_least(80));
  EXPECT_LE(worse, compared / 20);
  EXPECT_GE(border, unlike * 3 / 4);
}

TEST(Place, GridsAndSamples) {
  const PlacementGrid grid({{0, -0.1, 0.1, 0.005, 41}, {2, 0.5, 0.5, 0, 1}, {5, 0, 0.3, 0.1, 4}});
  ASSERT_EQ(grid.size(), 164u);
  for (std::uint64_t cell = 0; cell < grid.size(); ++cell)
    ASSERT_EQ(grid.cell(grid.indices(cell)), cell);
  EXPECT_EQ(grid.offset(80), (Offset{0, 0, 0.5, 0, 0, 0}));
  EXPECT_FALSE(std::signbit(grid.offset(80)[0]));
  EXPECT_EQ(grid.offset(163), (Offset{0.1, 0, 0.5, 0, 0, 0.3}));
  Offset least{}, most{};
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const Offset offset = sampled_offset(grid.axes(), 7, k);
    EXPECT_EQ(offset, sampled_offset(grid.axes(), 7, k));
    EXPECT_NE(offset, sampled_offset(grid.axes(), 8, k));
    EXPECT_EQ(offset[2], 0.5);
    EXPECT_EQ(offset[1], 0);
    for (std::size_t c = 0; c < 6; ++c) {
      least[c] = std::min(least[c], offset[c]);
      most[c] = std::max(most[c], offset[c]);
    }
  }
  EXPECT_LT(least[0], -0.098);
  EXPECT_GT(most[0], 0.098);
  EXPECT_GT(most[5], 0.297);
  EXPECT_GE(least[5], 0);
}

}  // namespace
}  // namespace swivel
