// SPDX-License-Identifier: BSD-3-Clause
// Plans of an arm beside another one whose motion is given, against a plain program over all nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "plain_arm.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {

namespace {

std::vector<Config> joints_of(const std::vector<TrajectoryRow>& rows) {
  std::vector<Config> joints;
  for (const TrajectoryRow& row : rows) joints.push_back(row.q);
  return joints;
}

/// Returns a workcell in which the left arm's own answer is its given motion, and the right arm's
/// path is in the world or, half of the time, on the left one's tool; nothing where the left arm
/// has no answer.
std::optional<Problem> random_cell_with_given(const TestRobot& robot, Random& random) {
  Problem cell = random_workcell(robot, random);
  const PreparedWorkcell both(cell);
  const PlanResult left = Planner(both.problem(0)).plan(lazily());
  if (left.status != PlanStatus::kSolved) return std::nullopt;
  if (random.coin()) {
    const Chain& chain = both.robot(0).arm().chain;
    for (std::size_t k = 0; k < 2; ++k) {
      const Pose tool = chain.tool((k == 0 ? left.trajectory.front() : left.trajectory.back()).q);
      Waypoint& waypoint = cell.arms[1].path().waypoints[k];
      waypoint.position = tool.inverse() * waypoint.position;
      waypoint.orientation = Quaterniond(tool.linear()).inverse() * waypoint.orientation;
    }
    cell.arms[1].path().path_frame = "left";
  }
  cell.arms[0].given = joints_of(left.trajectory);
  cell.arms[0].path().waypoints.clear();
  return cell;
}

/// The cheapest path of the right arm that keeps clear of the left one's rows, by a dynamic program
/// over all nodes that is begun anew whenever a move of its best path turns out to be invalid. FCL
/// alone answers.
class PlainBesideGiven {
 public:
  explicit PlainBesideGiven(const PreparedWorkcell& prepared)
      : prepared_(prepared),
        arm_(prepared.problem(1), prepared.robot(1)),
        query_(prepared.between(), DistanceProofs::kOff) {}

  /// Returns the least cost; infinite where there is none.
  double cost() {
    std::vector<std::vector<char>> apart(arm_.layers());
    for (std::size_t i = 0; i < arm_.layers(); ++i)
      for (const Lattice::Node& node : arm_.nodes(i))
        apart[i].push_back(
            !query_.find_violating_pair({given(i), node.q}, ClearanceRule::kNode).has_value());
    for (;;) {
      std::vector<std::vector<double>> value(arm_.layers());
      std::vector<std::vector<std::size_t>> next(arm_.layers());
      for (std::size_t i = arm_.layers(); i-- > 0;) {
        value[i].assign(arm_.nodes(i).size(), kNone);
        next[i].assign(arm_.nodes(i).size(), 0);
        for (std::size_t a = 0; a < value[i].size(); ++a) {
          if (!apart[i][a]) continue;
          if (i + 1 == arm_.layers()) {
            value[i][a] = 0;
            continue;
          }
          for (const PlainArm::Edge& edge : arm_.edges(i, a))
            if (const double cost = edge.cost + value[i + 1][edge.to];
                cost < value[i][a] && !barred_.contains({i, a, edge.to}))
              value[i][a] = cost, next[i][a] = edge.to;
        }
      }
      const auto best = std::min_element(value[0].begin(), value[0].end());
      if (best == value[0].end() || *best == kNone) return kNone;
      if (holds(static_cast<std::size_t>(best - value[0].begin()), next)) return *best;
    }
  }

 private:
  [[nodiscard]] const Config& given(std::size_t row) const { return prepared_.given_rows()[row].q; }
  bool holds(std::size_t a, const std::vector<std::vector<std::size_t>>& next) {
    bool all = true;
    for (std::size_t i = 0; i + 1 < arm_.layers(); ++i) {
      const std::size_t b = next[i][a];
      all = arm_.valid(i, a, b) && all;
      if (query_.find_pair_blocking_motion({prepared_.robot(0).radii(), prepared_.robot(1).radii()},
                                           {given(i), arm_.nodes(i)[a].q},
                                           {given(i + 1), arm_.nodes(i + 1)[b].q})) {
        barred_.insert({i, a, b});
        all = false;
      }
      a = b;
    }
    return all;
  }

  const PreparedWorkcell& prepared_;
  PlainArm arm_;
  InterArmWorld::Query query_;
  std::set<std::tuple<std::size_t, std::size_t, std::size_t>> barred_;
};

TEST(GivenMotion, CostsAsMuchAsAPlainProgramOverNodes) {
  Random random(seed("GivenMotion.CostsAsMuchAsAPlainProgramOverNodes"));
  const std::array<TestRobot, 2> robots{data_robot("sda10f"), data_robot("sda5f")};
  int drawn = 0, solved = 0, conflicts = 0, none = 0, followers = 0, alone = 0;
  const int count = trials(200);
  while (drawn < count) {
    SCOPED_TRACE(drawn);
    const auto cell = random_cell_with_given(robots[random.coin() ? 0 : 1], random);
    if (!cell) continue;
    const PreparedWorkcell prepared(*cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.arms[1].run().least_cost == kNone && random.coin(0.8)) continue;  // these are many
    ++drawn;
    ASSERT_EQ(prepared.given_arm(), 0u);
    const double cost = PlainBesideGiven(prepared).cost();
    ASSERT_EQ(found.status == PlanStatus::kSolved, cost < kNone);
    ASSERT_NE(found.pair.decided_by, PairSearch::kNone);
    conflicts += found.pair.decided_by != PairSearch::kArmsAlone;
    if (!(cost < kNone)) {
      ++none;
      continue;
    }
    ++solved;
    followers += cell->leader_of(1) == 0;
    EXPECT_NEAR(found.arms[1].cost(), cost, 1e-9);
    ASSERT_EQ(found.arms[0].rows().size(), cell->arms[0].given.size());
    for (std::size_t row = 0; row < cell->arms[0].given.size(); ++row)
      EXPECT_EQ(found.arms[0].rows()[row].q, cell->arms[0].given[row]);
    const AnswerCheck check = check_workcell(prepared, rows_of_arms(found));
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
    if (found.pair.decided_by != PairSearch::kArmsAlone) continue;
    const PlanResult own =
        Planner(on_all_layers(prepared.problem(1), prepared.robot(1).arm_class())).plan(lazily());
    expect_equal_rows(own.trajectory, found.arms[1].rows());
    ++alone;
  }
  std::printf(
      "%d cells: %d solved, %d of them with a follower; %d in conflict, %d without a path; "
      "%d as the arm alone\n",
      drawn, solved, followers, conflicts, none, alone);
  EXPECT_GE(solved, at_least(count / 3));
  EXPECT_GE(followers, at_least(count / 16));
  EXPECT_GE(conflicts, at_least(count / 5));
  EXPECT_GE(none, at_least(count / 20));
}

TEST(GivenMotion, HasLayersAtItsRowsWhereWaypointsAreAsked) {
  Random random(seed("GivenMotion.HasLayersAtItsRowsWhereWaypointsAreAsked"));
  const TestRobot robot = data_robot("sda10f");
  int cells = 0;
  const int count = trials(20);
  while (cells < count) {
    std::optional<Problem> cell = random_cell_with_given(robot, random);
    if (!cell || cell->arms[0].given.size() < 6) continue;
    ++cells;
    ArmTask& right = cell->arms[1];
    right.path().path_frame = right.base_link;
    for (std::size_t k = 0; k < 3; ++k) {
      right.path().waypoints.resize(3);
      right.path().waypoints[k].position =
          Vector3d(0.6, -0.5 + 0.08 * static_cast<double>(k * k), 1.0);
      right.path().waypoints[k].orientation = Quaterniond::Identity();
    }
    const int rows = static_cast<int>(cell->arms[0].given.size()),
              middle = 1 + random.below(rows - 2);
    right.path().steps = {middle, rows - 1 - middle};
    const PreparedWorkcell prepared(*cell);
    for (std::size_t k = 0; k < 2; ++k) {
      const ToolPath path = problem_path(prepared.problem(k), prepared.robot(k).arm().chain);
      ASSERT_EQ(path.size(), rows);
      if (k == 0)
        for (int row = 0; row < rows; ++row)
          EXPECT_TRUE(
              path.layer(row).tool.isApprox(prepared.robot(0).arm().chain.tool(
                                                cell->arms[0].given[static_cast<std::size_t>(row)]),
                                            1e-12));
      else
        EXPECT_NEAR(
            (path.layer(middle).tool.translation() - right.path().waypoints[1].position).norm(), 0,
            1e-12);
    }
    // The steps are longer than the resolution says, and this is said.
    right.path().resolution.ds = 0.005;
    const std::vector<std::string> warnings = plan_workcell(*cell, lazily()).warnings;
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.find("steps of 'right' are up to ") == 0;
    }));
    right.path().steps.clear();
    EXPECT_THROW(static_cast<void>(PreparedWorkcell(*cell)), InvalidArgument);
    right.path().waypoints.assign(cell->arms[0].given.size(),
                                  right.path().waypoints[0]);  // one for each row
    for (std::size_t k = 0; k < right.path().waypoints.size(); ++k)
      right.path().waypoints[k].position.y() += 0.001 * static_cast<double>(k * k);
    const PreparedWorkcell each(*cell);
    EXPECT_EQ(problem_path(each.problem(1), each.robot(1).arm().chain).size(), rows);
  }
}

TEST(GivenMotion, CheckRefusesOtherRows) {
  Random random(seed("GivenMotion.CheckRefusesOtherRows"));
  const TestRobot robot = data_robot("sda10f");
  int spoilt = 0;
  const int count = trials(10);
  while (spoilt < count) {
    const auto cell = random_cell_with_given(robot, random);
    if (!cell) continue;
    const PreparedWorkcell prepared(*cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status != PlanStatus::kSolved) continue;
    ++spoilt;
    std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(found);
    rows[0][1].q[6] += 1e-7;
    const AnswerCheck check = check_workcell(prepared, rows, {.margins = false});
    EXPECT_FALSE(check.passed);
    ASSERT_FALSE(check.failures.empty());
    EXPECT_NE(check.failures[0].find("row 1: a joint of 'left' is 1e-07 rad from the given motion"),
              std::string::npos)
        << check.failures[0];
  }
}

TEST(GivenMotion, IsRefusedWhereItDoesNotKeepTheLimits) {
  Random random(seed("GivenMotion.IsRefusedWhereItDoesNotKeepTheLimits"));
  const TestRobot robot = data_robot("sda10f");
  std::optional<Problem> good;
  while (!good || plan_workcell(*good, lazily()).status != PlanStatus::kSolved)
    good = random_cell_with_given(robot, random);
  const auto refuses = [&](const auto& spoil, const char* words) {
    Problem cell = *good;
    spoil(cell);
    try {
      static_cast<void>(plan_workcell(cell, lazily()));
      ADD_FAILURE() << "not refused: " << words;
    } catch (const std::exception& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refuses(
      [](Problem& c) {
        const PreparedWorkcell prepared(c);
        SceneObject ball;
        ball.name = "ball";
        ball.shape = Sphere{0.02};
        ball.pose.translation() =
            prepared.robot(0).arm().chain.tool(c.arms[0].given[2]).translation();
        c.scene.push_back(ball);
      },
      "arm 'left': given motion: row ");
  refuses([](Problem& c) { c.arms[0].path().limits.joint_step = 1e-4; }, "given motion: ");
  refuses([](Problem& c) { c.arms[0].path().limits.joint_margin = 1; }, "is outside its limits");
  refuses([](Problem& c) { c.arms[0].given[1] = c.arms[0].given[0]; },
          "given motion: row 1: the tool is where it is at the row before");
  refuses([](Problem& c) { c.arms[1].given = c.arms[0].given; }, "both motions are given");
  refuses([](Problem& c) { c.arms[0].given.resize(1); }, "allowed are two or more");
  refuses([](Problem& c) { c.arms[0].given[1][2] = kNone; }, "row 1: allowed are finite");
  refuses([](Problem& c) { c.arms[0].path().waypoints = c.arms[1].path().waypoints; }, "are none");
  refuses(
      [](Problem& c) {
        c.arms[0].path().path_frame = "right";
        c.arms[1].path().path_frame.clear();
      },
      "are none");
  refuses([](Problem& c) { c.arms[1].path().steps = {1}; }, "since the given motion ends then");
}

/// Returns the pose of the flange's tool frame for six joints, whatever the roll beside them says.
Pose real_tool(const Chain& chain, const Config& q) {
  return chain.displacements(q)[kDof - 1] * chain.home;
}

/// Returns a workcell whose left arm has six joints and its own answer with a free roll as given
/// motion; the right arm's path is on the left one's real tool. Nothing where the left arm has no
/// answer, or hardly rolls.
std::optional<Problem> random_cell_led_by_six_joints(const TestRobot& robot, Random& random) {
  Problem cell = random_workcell(robot, random);
  for (ArmTask& arm : cell.arms) arm.hold["arm_left_joint_3_e"] = 0;
  cell.arms[0].roll = Roll{};
  const PreparedWorkcell both(cell);
  const PlanResult left = Planner(both.problem(0)).plan(lazily());
  if (left.status != PlanStatus::kSolved) return std::nullopt;
  const std::vector<Config> rows = joints_of(left.trajectory);
  if (std::abs(rows.front()[kDof - 1]) < 0.2 && std::abs(rows.back()[kDof - 1]) < 0.2)
    return std::nullopt;
  for (std::size_t k = 0; k < 2; ++k) {
    const Pose tool = real_tool(both.robot(0).arm().chain, k == 0 ? rows.front() : rows.back());
    Waypoint& waypoint = cell.arms[1].path().waypoints[k];
    waypoint.position = tool.inverse() * waypoint.position;
    waypoint.orientation = Quaterniond(tool.linear()).inverse() * waypoint.orientation;
  }
  cell.arms[1].path().path_frame = "left";
  cell.arms[0].given = rows;
  cell.arms[0].path().waypoints.clear();
  return cell;
}

/// Returns how far, m and rad, the right tool is off its path on the real tool of the left arm.
std::pair<double, double> off_real_tool(const Problem& cell, const PreparedWorkcell& prepared,
                                        const Answer& found) {
  double off = 0, turned = 0;
  const std::size_t rows = cell.arms[0].given.size();
  const auto& waypoints = cell.arms[1].path().waypoints;
  for (std::size_t row = 0; row < rows; ++row) {
    const double t = static_cast<double>(row) / static_cast<double>(rows - 1);
    const Pose on_tool =
        real_tool(prepared.robot(0).arm().chain, found.arms[0].rows()[row].q).inverse() *
        prepared.robot(1).arm().chain.tool(found.arms[1].rows()[row].q);
    const Vector3d there =
        waypoints[0].position + t * (waypoints[1].position - waypoints[0].position);
    off = std::max(off, (on_tool.translation() - there).norm());
    turned = std::max(
        turned, Quaterniond(on_tool.linear())
                    .angularDistance(waypoints[0].orientation.slerp(t, waypoints[1].orientation)));
  }
  return {off, turned};
}

TEST(GivenMotion, CarriesItsFollowerOnTheToolAsSixJointsHaveTurnedIt) {
  Random random(seed("GivenMotion.CarriesItsFollowerOnTheToolAsSixJointsHaveTurnedIt"));
  const TestRobot robot = data_robot("sda10f");
  int solved = 0, drawn = 0;
  const int count = trials(20);
  while (solved < count && drawn < 100 * count) {
    SCOPED_TRACE(drawn++);
    const auto cell = random_cell_led_by_six_joints(robot, random);
    if (!cell) continue;
    const PreparedWorkcell prepared(*cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    const auto [off, turned] = off_real_tool(*cell, prepared, found);
    EXPECT_LE(off, 2e-6);
    EXPECT_LE(turned, 2e-6);
    const std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(found);
    const AnswerCheck check = check_workcell(prepared, rows);
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
    // What the file says of the roll does not matter: the joints say where the tool is.
    Problem without = *cell;
    for (Config& q : without.arms[0].given) q[kDof - 1] = 0;
    const PreparedWorkcell other(without);
    for (int layer = 0; layer < static_cast<int>(rows[0].size()); ++layer)
      EXPECT_TRUE(
          problem_path(other.problem(1), other.robot(1).arm().chain)
              .layer(layer)
              .tool.isApprox(problem_path(prepared.problem(1), prepared.robot(1).arm().chain)
                                 .layer(layer)
                                 .tool,
                             1e-9));
    // A follower that is off it is found.
    std::array<std::vector<TrajectoryRow>, 2> spoilt = rows;
    spoilt[1].back().q[kDof - 1] += 1e-4;
    const AnswerCheck refused = check_workcell(prepared, spoilt);
    EXPECT_FALSE(refused.passed);
    EXPECT_TRUE(std::any_of(refused.failures.begin(), refused.failures.end(), [](const auto& line) {
      return line.find("off its path on the tool of 'left'") != std::string::npos;
    }));
  }
  std::printf("%d of %d cells solved\n", solved, drawn);
  EXPECT_EQ(solved, count);
}

TEST(Workcell, RefusesALeaderWhoseToolIsNotWhereItsPathSays) {
  Random random(seed("Workcell.RefusesALeaderWhoseToolIsNotWhereItsPathSays"));
  const TestRobot robot = data_robot("sda10f");
  for (int trial = 0; trial < 20; ++trial) {
    Problem cell = random_workcell(robot, random);
    for (ArmTask& arm : cell.arms) arm.hold["arm_left_joint_3_e"] = 0;
    cell.arms[0].roll = random.coin() ? Roll{} : Roll{-0.4, 0.4};
    EXPECT_NO_THROW(validate(cell));
    cell.arms[1].path().path_frame = "left";
    const auto refuses = [&](const Problem& refused, const char* words) {
      try {
        validate(refused);
        ADD_FAILURE() << "not refused: " << words;
      } catch (const InvalidArgument& error) {
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      }
    };
    refuses(cell, "roll: 'left' leads 'right', whose path would turn with its tool");
    cell.arms[0].roll.reset();
    cell.arms[0].path().start.emplace(Config::Zero());
    cell.arms[0].path().start_tolerance = 0.01;
    refuses(cell, "start_at, start_tolerance: 'left' leads 'right'");
  }
}

}  // namespace

}  // namespace swivel::test
