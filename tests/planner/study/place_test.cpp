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

/// Returns the path, the base, or a random object, by turns as trials go on; the base where there
/// is no object.
Movable a_thing(int trial, Random& random, const PathProblem& problem) {
  const int kind = trial % 3;
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
PathProblem random_cell(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
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
  EXPECT_EQ(a.hold, b.hold) << what;
  EXPECT_EQ(a.status, b.status) << what;
  EXPECT_EQ(a.cost, b.cost) << what;
  EXPECT_EQ(a.clearance, b.clearance) << what;
  EXPECT_EQ(a.clearance_margin, b.clearance_margin) << what;
  EXPECT_EQ(a.joint_margin, b.joint_margin) << what;
  EXPECT_EQ(a.slide_margin, b.slide_margin) << what;
  EXPECT_EQ(a.tool_speed, b.tool_speed) << what;
  EXPECT_EQ(a.failed_s, b.failed_s) << what;
  EXPECT_EQ(a.cause, b.cause) << what;
  EXPECT_EQ(a.by, b.by) << what;
  EXPECT_EQ(a.reason, b.reason) << what;
}

/// Plans the cells at one, two and three threads, in two parts each; checks that the rows are the
/// same and puts them into `rows`.
void plan_at_thread_counts(const std::shared_ptr<const PreparedRobot>& robot,
                           const PathProblem& problem, const Movable& thing,
                           const std::vector<PlacementCell>& cells, PlanOptions options,
                           const std::string& what, std::vector<PlacementRow>& rows) {
  for (const int threads : {1, 2, 3}) {
    options.threads = threads;
    PlacementPlanner planner(robot, problem, thing, options);
    std::vector<PlacementRow> found = planner.plan({cells.begin(), cells.begin() + 5});
    const auto more = planner.plan({cells.begin() + 5, cells.end()});
    found.insert(found.end(), more.begin(), more.end());
    ASSERT_EQ(found.size(), cells.size()) << what;
    EXPECT_FALSE(planner.stopped());
    if (threads == 1) rows = found;
    for (std::size_t k = 0; k < cells.size(); ++k) expect_same(found[k], rows[k], what);
  }
}

/// Returns the row of a cell whose problem was planned alone.
PlacementRow row_of(const PlacementCell& cell, const PlanResult& result,
                    const PathProblem& placed) {
  PlacementRow row;
  row.cell = cell.cell;
  row.offset = cell.offset;
  row.status = result.status;
  if (row.status == PlanStatus::kSolved) {
    row.cost = result.cost;
    row.checked = result.checked;
    if (result.min_margin) {
      row.clearance = result.min_margin->clearance;
      row.clearance_margin = result.min_margin->margin;
    }
    if (result.nearest_limit) row.joint_margin = result.nearest_limit->margin;
    if (result.nearest_slide_limit) row.slide_margin = result.nearest_slide_limit->margin;
    if (result.top_tool_speed) row.tool_speed = result.top_tool_speed->speed;
  } else {
    row.failed_s = result.diagnosis->reached_s;
    row.cause = to_string(result.diagnosis->cause.kind);
    row.by = subject_of(result.diagnosis->cause, placed.scene);
    row.reason = words(result.diagnosis->cause);
  }
  return row;
}

/// Checks twelve random cells of a problem against plans of each alone; counts in `met` what the
/// cells are and have.
void check_cells(int trial, const PathProblem& problem, Random& random, const std::string& what,
                 std::map<std::string, int>& met) {
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  const Movable thing = a_thing(trial, random, problem);
  std::vector<PlacementCell> cells;
  for (std::uint64_t k = 0; k < 12; ++k)
    cells.push_back({3 * k, random_offset(random, random.coin() ? 0.01 : 0.1)});
  PlanOptions options;
  options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
  std::vector<PlacementRow> rows;
  plan_at_thread_counts(robot, problem, thing, cells, options, what, rows);
  if (::testing::Test::HasFatalFailure()) return;
  options.threads = 3;
  options.evidence.postures = true;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const PathProblem placed = placed_problem(problem, thing, cells[k].offset);
    const PlanResult result = plan(*robot, placed, options);
    ++met[to_string(result.status)];
    ++met[thing.kind == Movable::Kind::kObject ? "object"
          : thing.kind == Movable::Kind::kPath ? "path"
                                               : "base"];
    met["clearance"] += result.status == PlanStatus::kSolved && result.min_margin;
    expect_same(rows[k], row_of(cells[k], result, placed), what + " cell " + std::to_string(k));
  }
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
    const PathProblem problem =
        random_cell(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    check_cells(trial, problem, random, what, met);
    if (HasFailure()) return;
  }
  for (const auto& [name, times] : met) std::printf("%s %d; ", name.c_str(), times);
  std::printf("\n");
  for (const char* const name : {"solved", "infeasible", "object", "path", "base", "clearance"})
    EXPECT_GE(met[name], at_least(12)) << name;
}

/// Counts the cells by how they end, and the nodes that planners asked about.
struct NeighbourCounts {
  int solved = 0, infeasible = 0, changed = 0, spared = 0, cells = 0;
  std::int64_t asked = 0, asked_alone = 0;
};

/// Draws cells along a random walk, in steps of at most 5 mm and 5 mrad along and about each axis.
std::vector<PlacementCell> neighbouring_cells(Random& random) {
  std::vector<PlacementCell> cells;
  Offset at{};
  for (std::uint64_t k = 0; k < 20; ++k) {
    cells.push_back({k, at});
    const Offset step = random_offset(random, 0.005);
    for (std::size_t c = 0; c < at.size(); ++c) at[c] += step[c];
  }
  return cells;
}

/// Checks a row against the plan of its cell alone.
void expect_row_of(const PlacementRow& row, const PlanResult& alone, const std::string& here) {
  if (alone.status != PlanStatus::kSolved) {
    EXPECT_EQ(row.failed_s, alone.diagnosis->reached_s) << here;
    EXPECT_EQ(row.reason, words(alone.diagnosis->cause)) << here;
    return;
  }
  EXPECT_EQ(row.cost, alone.cost) << here;
  EXPECT_EQ(row.clearance_margin.has_value(), alone.min_margin.has_value()) << here;
  if (alone.min_margin) {
    EXPECT_EQ(row.clearance_margin, alone.min_margin->margin) << here;
    EXPECT_EQ(row.clearance, alone.min_margin->clearance) << here;
  }
}

/// Checks the trajectory that is shown of a cell, and that of a planner that goes from cell to
/// cell, against the plan of the cell alone.
void expect_trajectory_of(const PlacedPlan& shown, const PlanResult& again, const PlanResult& alone,
                          std::uint64_t cell, const std::string& here) {
  EXPECT_EQ(shown.cell.cell, cell) << here;
  ASSERT_EQ(shown.trajectory.size(), alone.trajectory.size()) << here;
  for (std::size_t i = 0; i < alone.trajectory.size(); ++i) {
    ASSERT_EQ(shown.trajectory[i].q, alone.trajectory[i].q) << here << " row " << i;
    ASSERT_EQ(again.trajectory[i].q, alone.trajectory[i].q) << here << " row " << i;
  }
}

/// Plans the cells one after the other and checks each against its plan alone.
void check_neighbours(const PathProblem& problem, const std::shared_ptr<const PreparedRobot>& robot,
                      const Movable& thing, Random& random, const std::string& what,
                      NeighbourCounts& counts) {
  PlanOptions options;
  options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
  options.threads = 1;
  const std::vector<PlacementCell> cells = neighbouring_cells(random);
  PlacementPlanner placements(robot, problem, thing, options);
  const std::vector<PlacementRow> rows = placements.plan(cells);
  const std::vector<PlacedPlan> plans = placements.trajectories(cells);
  std::vector<PlanStatus> again_of;
  placements.plan_again(cells,
                        [&](const PlacementCell& cell, const PlanResult& result, const PlanView&) {
                          EXPECT_EQ(cell.cell, cells[again_of.size()].cell) << what;
                          again_of.push_back(result.status);
                        });
  ASSERT_EQ(again_of.size(), cells.size()) << what;
  ASSERT_EQ(rows.size(), cells.size()) << what;
  Planner planner(robot, problem);
  options.evidence.postures = true;
  auto shown = plans.begin();
  std::optional<PlanStatus> before;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::string here = what + " cell " + std::to_string(k);
    const PathProblem placed = placed_problem(problem, thing, cells[k].offset);
    const PlanResult alone = plan(*robot, placed, options);
    planner.set_problem(placed);
    const PlanResult again = planner.plan(options);
    counts.asked += again.counters.nodes_checked;
    counts.asked_alone += alone.counters.nodes_checked;
    counts.spared += 2 * again.counters.nodes_checked <= alone.counters.nodes_checked;
    ++counts.cells;
    ASSERT_EQ(rows[k].status, alone.status) << here;
    ASSERT_EQ(again_of[k], alone.status) << here;
    ASSERT_EQ(again.status, alone.status) << here;
    counts.changed += before && *before != alone.status;
    before = alone.status;
    expect_row_of(rows[k], alone, here);
    (alone.status == PlanStatus::kSolved ? counts.solved : counts.infeasible) += 1;
    if (alone.status != PlanStatus::kSolved) continue;
    ASSERT_NE(shown, plans.end()) << here;
    expect_trajectory_of(*shown, again, alone, k, here);
    if (::testing::Test::HasFatalFailure()) return;
    ++shown;
  }
  EXPECT_EQ(shown, plans.end()) << what;
}

/// An object that moves a little from cell to cell: what is kept of its clearances from one to the
/// next changes no answer, and spares most questions.
TEST(Place, NeighboursAreWhatTheyAreAlone) {
  const std::uint64_t base = seed("Place.Neighbours");
  const auto robots = all_robots();
  NeighbourCounts counts;
  for (int trial = 0; trial < trials(30); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (problem.scene.empty()) continue;
    const auto robot = std::make_shared<const PreparedRobot>(problem);
    const Movable thing{
        Movable::Kind::kObject,
        problem
            .scene[static_cast<std::size_t>(random.below(static_cast<int>(problem.scene.size())))]
            .name};
    if (thing.object == problem.path_frame) continue;
    check_neighbours(problem, robot, thing, random, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d solved, %d infeasible, the verdict changed %d times; %lld nodes asked about of %lld, "
      "half or fewer in %d of %d cells\n",
      counts.solved, counts.infeasible, counts.changed, static_cast<long long>(counts.asked),
      static_cast<long long>(counts.asked_alone), counts.spared, counts.cells);
  EXPECT_GE(counts.solved, at_least(100));
  EXPECT_GE(counts.infeasible, at_least(20));
  // Not the sums of the questions, of which one cell may have more than all others.
  EXPECT_GT(counts.spared, counts.cells / 2);
}

/// Turns and shifts poses by an offset, about an origin that is given.
struct Displacement {
  explicit Displacement(const Offset& offset) : shift(offset[0], offset[1], offset[2]) {
    turn.linear() = from_rpy({offset[3], offset[4], offset[5]}).toRotationMatrix();
  }
  [[nodiscard]] Pose about(const Vector3d& origin, const Pose& pose) const {
    Pose moved = turn * pose;
    moved.translation() = origin + shift + turn * (pose.translation() - origin);
    return moved;
  }

  Pose turn = Pose::Identity();
  Vector3d shift;
};

/// Checks objects in the world: `robot` is the pose of the base in the world as it was.
void expect_objects_placed(const PathProblem& problem, const PathProblem& placed,
                           const Movable& thing, const Displacement& by, const Pose& robot,
                           int trial) {
  for (std::size_t k = 0; k < problem.scene.size(); ++k) {
    Pose expected = problem.scene[k].pose;
    if (thing.object == problem.scene[k].name)
      expected = by.about(expected.translation(), expected);
    EXPECT_TRUE((robot * placed.scene[k].pose).matrix().isApprox(expected.matrix(), 1e-9)) << trial;
    if (thing.kind != Movable::Kind::kBase && thing.object != problem.scene[k].name) {
      EXPECT_EQ(placed.scene[k].pose.matrix(), problem.scene[k].pose.matrix());
    }
  }
}

/// Checks waypoints in the world, where they move with the path or with the object whose frame
/// they are in; returns how many there are.
int expect_waypoints_placed(const PathProblem& problem, const PathProblem& placed,
                            const Movable& thing, const Displacement& by, const Pose& robot,
                            int trial) {
  Vector3d path_origin = Vector3d::Zero();
  for (const SceneObject& object : problem.scene)
    if (problem.path_frame == object.name) path_origin = object.pose.translation();
  const bool moves = thing.kind == Movable::Kind::kPath ||
                     (!thing.object.empty() && thing.object == problem.path_frame);
  const auto before = waypoints_in_base(problem), after = waypoints_in_base(placed);
  int looked_at = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    Pose pose = Pose::Identity();
    pose.linear() = before[k].orientation.toRotationMatrix();
    pose.translation() = before[k].position;
    if (moves) pose = by.about(path_origin, pose);
    EXPECT_LT((robot * after[k].position - pose.translation()).norm(), 1e-9) << trial;
    EXPECT_LT((robot.linear() * after[k].orientation.toRotationMatrix() - pose.linear()).norm(),
              1e-9)
        << trial;
    ++looked_at;
  }
  return looked_at;
}

/// Things are where they should be in the world, whichever of them is moved.
TEST(Place, MovesWhatItSaysAndNothingElse) {
  const std::uint64_t base = seed("Place.Moves");
  const auto robots = all_robots();
  int looked_at = 0, kept = 0;
  for (int trial = 0; trial < trials(300); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        random_cell(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const Offset offset = random_offset(random, 3);
    const Movable thing = a_thing(trial, random, problem);
    const PathProblem placed = placed_problem(problem, thing, offset);
    const Displacement by(offset);
    // The pose of the base in the world as it was.
    Pose robot = Pose::Identity();
    if (thing.kind == Movable::Kind::kBase) {
      robot = by.turn;
      robot.translation() = by.shift;
    }
    expect_objects_placed(problem, placed, thing, by, robot, trial);
    looked_at += expect_waypoints_placed(problem, placed, thing, by, robot, trial);
    const PathProblem still = placed_problem(problem, thing, {});
    for (std::size_t k = 0; k < problem.scene.size(); ++k, ++kept)
      EXPECT_EQ(still.scene[k].pose.matrix(), problem.scene[k].pose.matrix());
    EXPECT_EQ(still.waypoints, problem.waypoints);
    if (HasFailure()) return;
  }
  std::printf("%d waypoints, %d objects\n", looked_at, kept);
  EXPECT_GE(looked_at, at_least(600));
  EXPECT_GE(kept, at_least(300));
  const PathProblem problem = random_problem(robots[0], *std::make_unique<Random>(base));
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
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_c.yaml");
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
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_a_start.yaml");
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

/// Holds a random grid of up to three axes, and a criterion with one hill within a ball where cells
/// are solved.
class Hill {
 public:
  explicit Hill(Random& random)
      : dimensions_(1 + random.below(3)), grid_(random_axes(dimensions_, random)) {
    top_ =
        Vector3d(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    center_ = Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    radius_ = random.uniform(0.6, 2);
  }
  [[nodiscard]] int dimensions() const { return dimensions_; }
  [[nodiscard]] const PlacementGrid& grid() const { return grid_; }
  [[nodiscard]] PlacementRow row_of(std::uint64_t cell) const {
    PlacementRow row;
    row.cell = cell;
    row.offset = grid_.placement(cell).offset;
    Vector3d at = Vector3d::Zero(), hill = Vector3d::Zero(), middle = Vector3d::Zero();
    for (int a = 0; a < dimensions_; ++a) {
      at[a] = row.offset[static_cast<std::size_t>(a)];
      hill[a] = top_[a];
      middle[a] = center_[a];
    }
    row.status = (at - middle).norm() < radius_ ? PlanStatus::kSolved : PlanStatus::kInfeasible;
    if (row.status == PlanStatus::kSolved) row.cost = 1 + (at - hill).squaredNorm();
    return row;
  }

 private:
  static std::vector<PlacementAxis> random_axes(int dimensions, Random& random) {
    std::vector<PlacementAxis> axes;
    for (int a = 0; a < dimensions; ++a) {
      const int count = random.coin(0.1) ? 1 : 20 + random.below(dimensions == 3 ? 10 : 40);
      axes.push_back({a, -1, 1, 2.0 / std::max(1, count - 1), count});
    }
    return axes;
  }

  int dimensions_;
  PlacementGrid grid_;
  Vector3d top_, center_;
  double radius_ = 0;
};

/// Counts planned cells, grids whose best cells were compared, and pairs of cells across a border.
struct RefinementCounts {
  std::int64_t asked = 0, cells = 0;
  int compared = 0, worse = 0, border = 0, unlike = 0;
};

/// Refines a grid: checks that no cell is asked about twice and at most a third of them at all.
/// Puts the rows of the cells that were asked about into `known`.
void refine(const Hill& hill, int trial, std::map<std::uint64_t, PlacementRow>& known) {
  GridRefinement refinement(hill.grid(), {PlacementCriterion::kCost});
  for (auto next = refinement.next(); !next.empty(); next = refinement.next())
    for (const std::uint64_t cell : next) {
      ASSERT_LT(cell, hill.grid().size());
      ASSERT_TRUE(known.emplace(cell, hill.row_of(cell)).second) << "asked twice";
      refinement.learn(hill.row_of(cell));
    }
  ASSERT_LE(known.size(), std::max<std::size_t>(1, hill.grid().size() / 3)) << trial;
}

/// Compares what is known with the whole grid: the best ten cells, and in two dimensions the pairs
/// of neighbours of which one is solved.
void compare_with_whole_grid(const Hill& hill, const std::map<std::uint64_t, PlacementRow>& known,
                             RefinementCounts& counts) {
  const PlacementGrid& grid = hill.grid();
  std::vector<PlacementRow> all, some;
  for (std::uint64_t cell = 0; cell < grid.size(); ++cell) all.push_back(hill.row_of(cell));
  for (const auto& [cell, row] : known) some.push_back(row);
  const auto best = best_placements(all, {PlacementCriterion::kCost}, 10),
             found = best_placements(some, {PlacementCriterion::kCost}, 10);
  if (best.size() < 10) return;
  ++counts.compared;
  for (std::size_t k = 0; k < 10; ++k)
    if (k >= found.size() || *found[k].cost > 1.01 * *best[k].cost) {
      ++counts.worse;
      break;
    }
  if (hill.dimensions() != 2) return;
  for (std::uint64_t cell = 0; cell + 1 < grid.size(); ++cell) {
    if (grid.indices(cell)[0] != grid.indices(cell + 1)[0] ||
        all[cell].status == all[cell + 1].status)
      continue;
    ++counts.unlike;
    counts.border += known.contains(cell) && known.contains(cell + 1);
  }
}

/// A third of the plans at most; the best ten within 1 % of the best there are, where the criterion
/// has one hill within a region.
TEST(GridRefinement, FindsTheBestWithAThirdOfThePlans) {
  const std::uint64_t base = seed("GridRefinement");
  RefinementCounts counts;
  for (int trial = 0; trial < trials(200); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Hill hill(random);
    std::map<std::uint64_t, PlacementRow> known;
    refine(hill, trial, known);
    if (HasFatalFailure()) return;
    counts.asked += static_cast<std::int64_t>(known.size());
    counts.cells += static_cast<std::int64_t>(hill.grid().size());
    if (hill.grid().size() < 200) continue;
    compare_with_whole_grid(hill, known, counts);
  }
  std::printf(
      "%lld of %lld cells planned; the best ten more than 1 %% worse in %d of %d; %d of %d pairs "
      "across the border planned\n",
      static_cast<long long>(counts.asked), static_cast<long long>(counts.cells), counts.worse,
      counts.compared, counts.border, counts.unlike);
  EXPECT_GE(counts.compared, at_least(80));
  EXPECT_LE(counts.worse, counts.compared / 20);
  EXPECT_GE(counts.border, counts.unlike * 3 / 4);
}

TEST(Place, GridsAndSamples) {
  const PlacementGrid grid({{0, -0.1, 0.1, 0.005, 41}, {2, 0.5, 0.5, 0, 1}, {5, 0, 0.3, 0.1, 4}});
  ASSERT_EQ(grid.size(), 164u);
  for (std::uint64_t cell = 0; cell < grid.size(); ++cell)
    ASSERT_EQ(grid.cell(grid.indices(cell)), cell);
  EXPECT_EQ(grid.placement(80).offset, (Offset{0, 0, 0.5, 0, 0, 0}));
  EXPECT_FALSE(std::signbit(grid.placement(80).offset[0]));
  EXPECT_EQ(grid.placement(163).offset, (Offset{0.1, 0, 0.5, 0, 0, 0.3}));
  Offset least{}, most{};
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const Offset offset = sampled_placement(grid.axes(), 7, k).offset;
    EXPECT_EQ(offset, sampled_placement(grid.axes(), 7, k).offset);
    EXPECT_NE(offset, sampled_placement(grid.axes(), 8, k).offset);
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

TEST(Place, GridsOverJoints) {
  const PlacementGrid grid({held_axis("torso", -0.5, 0.5, 0.25), held_axis("rail", 1, 1, 0),
                            placement_axis(1, 0, 0.2, 0.1)});
  ASSERT_EQ(grid.size(), 15u);
  const Placement placement = grid.placement(7);
  EXPECT_EQ(placement.offset, (Offset{0, 0.1, 0, 0, 0, 0}));
  EXPECT_EQ(placement.hold, (HeldPositions{{"torso", 0}, {"rail", 1}}));
  const Placement drawn = sampled_placement(grid.axes(), 7, 3);
  EXPECT_LE(std::abs(drawn.hold.at("torso")), 0.5);
  EXPECT_EQ(drawn.hold.at("rail"), 1);
  EXPECT_EQ(drawn.hold, sampled_placement(grid.axes(), 7, 3).hold);
  EXPECT_THROW(static_cast<void>(held_axis("torso", 1, 0, 0.1)), InvalidArgument);
}

}  // namespace
}  // namespace swivel
