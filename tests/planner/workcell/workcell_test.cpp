// SPDX-License-Identifier: BSD-3-Clause
// Plans of two arms against a plain program over all pairs of nodes, and their check against
// spoilt answers.
#include "swivel/planner/workcell/plan_workcell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "inexact_robots.hpp"
#include "plain_arm.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {

namespace {

/// The cheapest two paths without conflict, by a dynamic program over all pairs of nodes that is
/// begun anew whenever an edge or a motion of its best two paths turns out to be invalid. FCL alone
/// answers.
class PlainProgram {
 public:
  explicit PlainProgram(const PreparedWorkcell& prepared)
      : prepared_(prepared),
        arms_{PlainArm(prepared.problem(0), prepared.robot(0)),
              PlainArm(prepared.problem(1), prepared.robot(1))},
        query_(prepared.between(), DistanceProofs::kOff) {}

  /// Returns the least cost; infinite where there is none.
  double cost() {
    for (;;) {
      run();
      const auto [a, b] = best();
      if (a == kNowhere) return kNone;
      if (holds(a, b)) return value_[0][a][b].cost;
    }
  }

 private:
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  struct Value {
    double cost = kNone;
    std::size_t a = kNowhere, b = kNowhere;  // the next pair
  };

  bool apart(std::size_t layer, std::size_t a, std::size_t b) {
    const auto key = std::tuple(layer, a, b);
    const auto known = apart_.find(key);
    if (known != apart_.end()) return known->second;
    const bool apart = !query_.find_violating_pair(
        {arms_[0].exact(layer, a), arms_[1].exact(layer, b)}, ClearanceRule::kNode);
    return apart_[key] = apart;
  }
  void run() {
    value_.assign(arms_[0].layers(), {});
    for (std::size_t i = arms_[0].layers(); i-- > 0;) {
      auto& here = value_[i];
      here.assign(arms_[0].nodes(i).size(), std::vector<Value>(arms_[1].nodes(i).size()));
      std::vector<std::vector<PlainArm::Edge>> others;
      if (i + 1 < arms_[0].layers())
        for (std::size_t b = 0; b < arms_[1].nodes(i).size(); ++b)
          others.push_back(arms_[1].edges(i, b));
      for (std::size_t a = 0; a < here.size(); ++a) {
        std::vector<PlainArm::Edge> own;
        if (i + 1 < arms_[0].layers()) own = arms_[0].edges(i, a);
        for (std::size_t b = 0; b < here[a].size(); ++b) set(i, a, b, own, others);
      }
    }
  }
  void set(std::size_t i, std::size_t a, std::size_t b, const std::vector<PlainArm::Edge>& own,
           const std::vector<std::vector<PlainArm::Edge>>& others) {
    Value& value = value_[i][a][b];
    if (i + 1 == arms_[0].layers()) {
      if (apart(i, a, b)) value.cost = 0;
      return;
    }
    for (const PlainArm::Edge& x : own)
      for (const PlainArm::Edge& y : others[b]) {
        const double cost = x.cost + y.cost + value_[i + 1][x.to][y.to].cost;
        if (!(cost < value.cost) || barred_.contains({i, a, x.to, b, y.to})) continue;
        value = {cost, x.to, y.to};
      }
    if (value.cost < kNone && !apart(i, a, b)) value = {};
  }
  [[nodiscard]] std::pair<std::size_t, std::size_t> best() const {
    std::pair<std::size_t, std::size_t> at{kNowhere, kNowhere};
    double least = kNone;
    for (std::size_t a = 0; a < value_[0].size(); ++a)
      for (std::size_t b = 0; b < value_[0][a].size(); ++b)
        if (value_[0][a][b].cost < least) least = value_[0][a][b].cost, at = {a, b};
    return at;
  }
  /// Asks about the edges and motions of the best two paths.
  bool holds(std::size_t a, std::size_t b) {
    bool all = true;
    for (std::size_t i = 0; i + 1 < arms_[0].layers(); ++i) {
      const Value& value = value_[i][a][b];
      all = arms_[0].valid(i, a, value.a) && all;
      all = arms_[1].valid(i, b, value.b) && all;
      if (query_.find_pair_blocking_motion(
              {prepared_.robot(0).radii(), prepared_.robot(1).radii()},
              {arms_[0].exact(i, a), arms_[1].exact(i, b)},
              {arms_[0].exact(i + 1, value.a), arms_[1].exact(i + 1, value.b)})) {
        barred_.insert({i, a, value.a, b, value.b});
        all = false;
      }
      a = value.a, b = value.b;
    }
    return all;
  }

  const PreparedWorkcell& prepared_;
  std::array<PlainArm, 2> arms_;
  InterArmWorld::Query query_;
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, bool> apart_;
  std::set<std::tuple<std::size_t, std::size_t, std::size_t, std::size_t, std::size_t>> barred_;
  std::vector<std::vector<std::vector<Value>>> value_;
};

TestRobot two_armed(const char* name) {
  return data_robot(name);
}

/// Returns a post that stands or lies somewhere before the torso.
SceneObject random_post(Random& random) {
  SceneObject post;
  post.name = "post";
  post.shape = Cylinder{0.03, 0.6};
  post.pose.translation() =
      Vector3d(random.uniform(0.3, 0.6), random.uniform(-0.5, 0.5), random.uniform(0.6, 1.3));
  if (random.coin())
    post.pose.linear() = Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()).toRotationMatrix();
  return post;
}

TEST(Workcell, CostsAsMuchAsAPlainProgramOverPairs) {
  Random random(seed("Workcell.CostsAsMuchAsAPlainProgramOverPairs"));
  // The last two are not exactly S-R-S.
  const std::array<TestRobot, 4> robots{two_armed("sda10f"), two_armed("sda5f"),
                                        rounded(two_armed("sda5f"), 1e-4),
                                        perturbed(two_armed("sda10f"), 0.1, random)};
  int solved = 0, none = 0, conflicts = 0, inexact = 0;
  const int count = trials(500);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const int which = random.below(3) == 0 ? 2 + random.below(2) : random.below(2);
    Problem cell = random_workcell(robots[static_cast<std::size_t>(which)], random);
    if (random.coin()) cell.scene.push_back(random_post(random));
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    const double least = found.arms[0].run().least_cost + found.arms[1].run().least_cost;
    conflicts += found.pair.decided_by == PairSearch::kRegions ||
                 found.pair.decided_by == PairSearch::kProduct;
    const double cost = PlainProgram(prepared).cost();
    ASSERT_EQ(found.status == PlanStatus::kSolved, cost < kNone);
    ASSERT_NE(found.pair.decided_by, PairSearch::kNone);
    (cost < kNone ? solved : none) += 1;
    if (!(cost < kNone)) continue;
    inexact += which > 1;
    EXPECT_NEAR(found.arms[0].run().lattice.cost + found.arms[1].run().lattice.cost, cost, 1e-9);
    if (which < 2) {  // joints of rows are those of nodes
      EXPECT_NEAR(found.cost, cost, 1e-9);
      EXPECT_LE(least, found.cost + 1e-9);
    }
    const AnswerCheck check = check_workcell(prepared, rows_of_arms(found));
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
  }
  std::printf("%d workcells: %d solved, %d of them of inexact arms, %d none, %d with a conflict\n",
              count, solved, inexact, none, conflicts);
  EXPECT_GE(conflicts, at_least(count / 12));
  EXPECT_GE(inexact, at_least(count / 24));
  EXPECT_GE(solved, at_least(count / 8));
}

TEST(Workcell, IsTheAnswerOfEachArmWhereTheseDoNotMeet) {
  Random random(seed("Workcell.IsTheAnswerOfEachArmWhereTheseDoNotMeet"));
  const TestRobot robot = two_armed("sda10f");
  int alone = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const Problem cell = random_workcell(robot, random);
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.pair.decided_by != PairSearch::kArmsAlone || found.status != PlanStatus::kSolved)
      continue;
    ++alone;
    for (std::size_t k = 0; k < 2; ++k) {
      const PlanResult own =
          Planner(on_all_layers(prepared.problem(k), prepared.robot(k).arm_class())).plan(lazily());
      expect_equal_rows(own.trajectory, found.arms[k].rows());
    }
  }
  EXPECT_GE(alone, at_least(count / 5));
}

TEST(Workcell, IsTheSameOnTwoThreads) {
  Random random(seed("Workcell.IsTheSameOnTwoThreads"));
  const TestRobot robot = two_armed("sda10f");
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    const Problem cell = random_workcell(robot, random);
    const PreparedWorkcell prepared(cell);
    const Answer one = plan_workcell(prepared, lazily());
    PlanOptions parallel = lazily();
    parallel.planner = PlannerKind::kParallel;
    parallel.threads = 2;
    const Answer two = plan_workcell(prepared, parallel);
    ASSERT_EQ(one.status, two.status);
    EXPECT_EQ(one.cost, two.cost);
    EXPECT_EQ(one.pair.counters.rounds, two.pair.counters.rounds);
    for (std::size_t k = 0; k < 2; ++k) expect_equal_rows(one.arms[k].rows(), two.arms[k].rows());
  }
}

/// The eager planners ask about all nodes and edges of either arm first, and find the same.
TEST(Workcell, IsTheSameWithEagerPlanners) {
  Random random(seed("Workcell.IsTheSameWithEagerPlanners"));
  const TestRobot robot = two_armed("sda10f");
  int solved = 0, together = 0;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    const PreparedWorkcell prepared(random_workcell(robot, random));
    const Answer lazy = plan_workcell(prepared, lazily());
    for (const PlannerKind kind : {PlannerKind::kEager, PlannerKind::kEagerDp}) {
      PlanOptions options = lazily();
      options.planner = kind;
      const Answer eager = plan_workcell(prepared, options);
      ASSERT_EQ(eager.status, lazy.status);
      ASSERT_EQ(eager.cost, lazy.cost);
      ASSERT_EQ(eager.bound, lazy.bound);
      for (std::size_t k = 0; k < 2; ++k) {
        expect_equal_rows(eager.arms[k].rows(), lazy.arms[k].rows());
        ASSERT_GE(eager.arms[k].counters.nodes_checked, lazy.arms[k].counters.nodes_checked);
      }
    }
    solved += lazy.has_rows();
    together += lazy.has_rows() && lazy.pair.decided_by != PairSearch::kArmsAlone;
  }
  std::printf("%d of %d solved, %d not by each arm alone\n", solved, count, together);
  EXPECT_GE(solved, at_least(8));
  EXPECT_GE(together, at_least(2));
}

TEST(Workcell, BeginsAndEndsInGivenPostures) {
  Random random(seed("Workcell.BeginsAndEndsInGivenPostures"));
  const TestRobot robot = two_armed("sda10f");
  int solved = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    Problem cell = random_workcell(robot, random);
    const Answer free = plan_workcell(cell, lazily());
    if (free.status != PlanStatus::kSolved) continue;
    cell.arms[0].path().end = free.arms[0].rows().back().q;
    cell.arms[1].path().start = free.arms[1].rows().front().q;
    const PreparedWorkcell prepared(cell);
    const Answer given = plan_workcell(prepared, lazily());
    ASSERT_EQ(given.status, PlanStatus::kSolved);
    EXPECT_NEAR(given.cost, free.cost, 1e-6 * free.cost);
    EXPECT_EQ(given.arms[0].rows().back().q, *cell.arms[0].path().end);
    EXPECT_EQ(given.arms[1].rows().front().q, *cell.arms[1].path().start);
    ++solved;
  }
  EXPECT_GE(solved, at_least(count / 5));
}

TEST(Workcell, FollowsALeader) {
  Random random(seed("Workcell.FollowsALeader"));
  const TestRobot robot = two_armed("sda10f");
  int solved = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    Problem cell = random_workcell(robot, random);
    // The right tool stands against a place beside the left one's and moves a little about it.
    ArmTask& right = cell.arms[1];
    right.path().path_frame = "left";
    for (std::size_t k = 0; k < 2; ++k) {
      right.path().waypoints[k].position = Vector3d(0.05 * static_cast<double>(k), 0.18, 0.02);
      right.path().waypoints[k].orientation =
          Quaterniond(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()) *
                      Eigen::AngleAxisd(0.1, Vector3d::UnitZ()));
    }
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    const Chain &left = prepared.robot(0).arm().chain, &follower = prepared.robot(1).arm().chain;
    const auto rows = rows_of_arms(found);
    const std::size_t last = rows[0].size() - 1;
    for (const std::size_t row : {std::size_t{0}, last / 2, last}) {
      const Pose relative = left.tool(rows[0][row].q).inverse() * follower.tool(rows[1][row].q);
      const double t = static_cast<double>(row) / static_cast<double>(last);
      EXPECT_NEAR((relative.translation() - Vector3d(0.05 * t, 0.18, 0.02)).norm(), 0, 1e-6);
    }
  }
  std::printf("%d of %d followers\n", solved, count);
  EXPECT_GE(solved, at_least_among(1));
}

TEST(Workcell, CarriesABarWithTwoHands) {
  Random random(seed("Workcell.CarriesABarWithTwoHands"));
  const TestRobot robot = two_armed("sda10f");
  int solved = 0;
  double at_rows = 0, on_moves = 0;
  const int count = trials(100);
  for (int trial = 0; trial < count; ++trial) {
    Problem cell = random_workcell(robot, random);
    // Both hands point forward and keep their pose to each other along a random line.
    const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
    const double width = random.uniform(0.2, 0.5);
    const Vector3d middle(random.uniform(0.66, 0.78), random.uniform(-0.1, 0.1),
                          random.uniform(0.9, 1.2)),
        half(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.15, 0.15));
    for (std::size_t k = 0; k < 2; ++k) {
      Waypoint& waypoint = cell.arms[0].path().waypoints[k];
      waypoint.position = middle + Vector3d(0, width / 2, 0) + (k == 0 ? -1.0 : 1.0) * half;
      waypoint.orientation = forward;
      cell.arms[1].path().waypoints[k].position = Vector3d(0, -width, 0);
      cell.arms[1].path().waypoints[k].orientation = Quaterniond::Identity();
      cell.arms[k].path().limits.tool_path_error = 0.001;
      cell.arms[k].path().resolution = {.ds = 0.01, .dphi = 0.1};
    }
    cell.arms[1].path().path_frame = "left";
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    const Chain &left = prepared.robot(0).arm().chain, &right = prepared.robot(1).arm().chain;
    const auto off = [&](const Config& l, const Config& r) {
      return (left.tool(l).inverse() * right.tool(r).translation() - Vector3d(0, -width, 0)).norm();
    };
    const auto &a = found.arms[0].rows(), &b = found.arms[1].rows();
    for (std::size_t row = 0; row < a.size(); ++row) {
      at_rows = std::max(at_rows, off(a[row].q, b[row].q));
      if (row + 1 == a.size()) continue;
      for (const double t : {0.25, 0.5, 0.75})
        on_moves = std::max(on_moves, off(a[row].q + t * (a[row + 1].q - a[row].q),
                                          b[row].q + t * (b[row + 1].q - b[row].q)));
    }
  }
  std::printf("%d of %d bars; the hands off by %.2g m at rows, %.2g m between\n", solved, count,
              at_rows, on_moves);
  EXPECT_GE(solved, at_least(count / 8));
  EXPECT_LE(at_rows, 1e-9);
  EXPECT_LE(on_moves, 2 * 0.001);
}

TEST(Workcell, CheckRefusesSpoiltAnswers) {
  Random random(seed("Workcell.CheckRefusesSpoiltAnswers"));
  const TestRobot robot = two_armed("sda10f");
  int spoilt = 0, met = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    const Problem cell = random_workcell(robot, random);
    const PreparedWorkcell prepared(cell);
    const Answer found = plan_workcell(prepared, lazily());
    if (found.status == PlanStatus::kSolved) {
      const std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(found);
      const CheckOptions quick{.margins = false};
      auto joint = rows;
      joint[random.below(2)][rows[0].size() / 2].q[3] += 0.01;
      EXPECT_FALSE(check_workcell(prepared, joint, quick).passed);
      auto missing = rows;
      missing[1].erase(missing[1].begin() + 1);
      EXPECT_FALSE(check_workcell(prepared, missing, quick).passed);
      auto swapped = rows;
      std::swap(swapped[0], swapped[1]);
      EXPECT_FALSE(check_workcell(prepared, swapped, quick).passed);
      spoilt += 3;
    }
    if (found.pair.decided_by == PairSearch::kArmsAlone ||
        found.arms[0].run().least_cost == kNone || found.arms[1].run().least_cost == kNone)
      continue;
    // The answers of both arms alone meet each other, and the check says so.
    std::array<std::vector<TrajectoryRow>, 2> alone;
    for (std::size_t k = 0; k < 2; ++k)
      alone[k] = Planner(prepared.problem(k)).plan(lazily()).trajectory;
    const AnswerCheck check = check_workcell(prepared, alone);
    EXPECT_TRUE(check.runs[0].passed && check.runs[1].passed);
    EXPECT_FALSE(check.passed);
    ++met;
  }
  EXPECT_GE(spoilt, at_least(count / 4));
  EXPECT_GE(met, at_least(count / 16));
}

/// Expects that no node of the one arm's side of a region keeps clear of any of the other's, and
/// that the paths of both arms alone lead through it.
void expect_conflict(const PreparedWorkcell& prepared, const ProblemView& view, Random& random) {
  const RegionOfConflict& region = *view.region;
  InterArmWorld::Query query(prepared.between(), DistanceProofs::kOff);
  const auto rows = [&](std::size_t arm, int slot) {
    return *view.runs[arm].lattice.exact_config(region.layer, slot,
                                                *view.runs[arm].lattice.node(region.layer, slot));
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<int>& slots = region.slots[k];
    const int on_path = view.alone[k][static_cast<std::size_t>(region.layer)];
    ASSERT_NE(std::find(slots.begin(), slots.end(), on_path), slots.end());
  }
  if (!region.next[0].empty()) return;
  for (int k = 0; k < 20; ++k) {
    const auto pick = [&](const std::vector<int>& slots) {
      return slots[random.below(static_cast<int>(slots.size()))];
    };
    const std::array<Config, 2> q{rows(0, pick(region.slots[0])), rows(1, pick(region.slots[1]))};
    EXPECT_TRUE(query.find_violating_pair(q, ClearanceRule::kNode));
  }
}

/// Expects that the bodies of a conflict are those that meet on the paths of both arms alone. Where
/// bodies touch they have a point in common, else points that are as far apart as they are.
void expect_meeting(const PreparedWorkcell& prepared, const ProblemView& view,
                    const ArmConflict& conflict) {
  std::array<Config, 2> q;
  for (std::size_t k = 0; k < 2; ++k) {
    const Lattice& lattice = view.runs[k].lattice;
    q[k] = lattice.path_rows(view.alone[k])[static_cast<std::size_t>(conflict.layer)].q;
  }
  InterArmWorld::Query query(prepared.between());
  const auto pair = query.find_violating_pair(q, ClearanceRule::kNode);
  ASSERT_TRUE(pair);
  EXPECT_EQ(prepared.between().names(*pair), conflict.bodies);
  const auto least = query.clearance(q);
  ASSERT_TRUE(least);
  const auto ends = query.nearest_points(q, *least);
  EXPECT_EQ(ends.has_value(), least->distance > 0);
  EXPECT_EQ(query.common_point(q, least->pair).has_value(), !(least->distance > 0));
  if (ends) {
    EXPECT_NEAR(((*ends)[0] - (*ends)[1]).norm(), least->distance, 1e-4);
  }
}

TEST(Workcell, ShowsWhatItFoundOut) {
  Random random(seed("Workcell.ShowsWhatItFoundOut"));
  const TestRobot robot = two_armed("sda10f");
  int answers = 0, regions = 0, meetings = 0, without = 0;
  const int count = trials(100);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    Problem cell = random_workcell(robot, random);
    if (random.coin()) cell.scene.push_back(random_post(random));
    const PreparedWorkcell prepared(cell);
    ProblemView view;
    const Answer found = plan_workcell(prepared, lazily(), &view);
    EXPECT_EQ(found.cost, plan_workcell(prepared, lazily()).cost);
    ASSERT_EQ(view.runs.size(), 2u);
    const bool met = found.pair.decided_by != PairSearch::kArmsAlone;
    EXPECT_EQ(view.region.has_value(), met);
    for (std::size_t k = 0; k < 2; ++k) {
      const PlanView& arm = view.runs[k];
      const bool has_path = found.arms[k].run().least_cost < kNone;
      EXPECT_EQ(view.alone[k].empty(), !has_path);
      without += has_path ? 0 : 1;
      if (found.status == PlanStatus::kSolved) {
        expect_equal_rows(arm.lattice.path_rows(arm.path), found.arms[k].rows());
        ++answers;
      } else if (has_path) {
        EXPECT_EQ(arm.path, view.alone[k]);
      }
      for (std::size_t layer = 0; layer < arm.path.size(); ++layer)
        EXPECT_EQ(arm.verdicts->node(static_cast<int>(layer), arm.path[layer]), Verdict::kValid);
    }
    if (!met) continue;
    ++regions;
    expect_conflict(prepared, view, random);
    if (!found.pair.conflict || found.pair.conflict->of_motion) continue;
    expect_meeting(prepared, view, *found.pair.conflict);
    ++meetings;
  }
  std::printf("%d workcells: %d answers of arms, %d regions, %d meetings, %d arms without a path\n",
              count, answers, regions, meetings, without);
  EXPECT_GE(answers, at_least(count / 4));
  EXPECT_GE(regions, at_least(count / 12));
  EXPECT_GE(meetings, at_least(count / 50));
  EXPECT_GE(without, at_least(count / 30));
}

TEST(Workcell, RefusesWhatMakesNoSense) {
  Random random(7);
  const Problem good = random_workcell(two_armed("sda10f"), random);
  const auto refuses = [&](const auto& spoil, const char* words) {
    Problem cell = good;
    spoil(cell);
    try {
      static_cast<void>(PreparedWorkcell(cell));
      ADD_FAILURE() << "not refused: " << words;
    } catch (const std::exception& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refuses([](Problem& c) { c.arms[1].name = "left"; }, "is taken");
  refuses([](Problem& c) { c.arms[0].name = "base_link"; }, "is taken by the base link");
  refuses([](Problem& c) { c.arms[1].path().waypoints.pop_back(); }, "same number");
  refuses(
      [](Problem& c) {
        c.arms[0].path().path_frame = "right";
        c.arms[1].path().path_frame = "left";
      },
      "lead each other");
  refuses([](Problem& c) { c.arms[1].hold["torso_joint_b1"] = 0.1; }, "hold");
  refuses([](Problem& c) { c.arms[1].attached[0].name = "left_tool"; }, "is on both arms");
  refuses([](Problem& c) { c.arms[1].tip_link = c.arms[0].tip_link; }, "moves with both arms");
  refuses([](Problem& c) { c.arms[0].path().waypoints[1] = c.arms[0].path().waypoints[0]; },
          "is where the one before it is");
  refuses([](Problem& c) { c.may_touch.push_back({"left_tool", "nobody"}); }, "'nobody'");
  refuses([](Problem& c) { c.arms[0].path().steps = {3}; }, "steps");
  refuses(
      [](Problem& c) {
        c.arms[1].path().path_frame = "left";
        c.arms[1].path().smooth = PathSmoothing();
      },
      "smooth");
}

}  // namespace

}  // namespace swivel::test
