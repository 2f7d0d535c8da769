// SPDX-License-Identifier: BSD-3-Clause
// Arms of six joints whose tool may turn about its own z axis.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "arms.hpp"
#include "roll_windows.hpp"
#include "seed.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::infinity();

Config random_configuration(const Chain& chain, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    q[j] = limit.continuous ? random.uniform(-kPi, kPi) : random.uniform(limit.lower, limit.upper);
  }
  return q;
}

/// The tool of the six joints, by the frames of the table.
Pose tool_of(const ArmTable& arm, const Config& q) {
  Pose pose = Pose::Identity();
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const JointRow& row = arm.joints[k];
    pose = pose * urdf_pose(row.xyz, row.rpy) *
           Eigen::AngleAxisd(q[static_cast<Eigen::Index>(k)], row.axis.normalized());
  }
  return pose * urdf_pose(arm.tip_xyz, arm.tip_rpy);
}

TEST(Roll, IsTheTurnOfTheToolAboutItsOwnAxis) {
  Random random(seed("Roll.IsTheTurnOfTheToolAboutItsOwnAxis"));
  int tried = 0;
  for (const ArmTable& table : arms_6r()) {
    const Chain chain = arm_with_roll(table, {-0.7, 1.2}).chain;
    EXPECT_TRUE(chain.roll);
    EXPECT_EQ(chain.joint_names.back(), "roll");
    EXPECT_EQ(chain.limit.back().lower, -0.7);
    EXPECT_EQ(chain.limit.back().upper, 1.2);
    EXPECT_FALSE(chain.limit.back().continuous);
    EXPECT_TRUE(arm_with_roll(table, Roll{}).chain.limit.back().continuous);
    EXPECT_EQ(classify(chain, table.name).kind, ArmKind::kArcs) << table.name;
    for (int trial = 0; trial < trials(20); ++trial) {
      ++tried;
      const Config q = random_configuration(chain, random);
      const Pose turned = chain.tool(q) * Eigen::AngleAxisd(q[kDof - 1], Vector3d::UnitZ());
      EXPECT_LT((turned.matrix() - tool_of(table, q).matrix()).norm(), 1e-9);
    }
  }
  EXPECT_EQ(tried, trials(20) * static_cast<int>(arms_6r().size()));
}

TEST(Roll, IsTheSeventhJointOfSixAndOneCoordinateMoreOfSeven) {
  const ArmTable seven = arms_7r()[0], six = arms_6r()[0];
  const RobotModel model = model_of(seven, seven.joints, Pose::Identity()),
                   small = model_of(six, six.joints, Pose::Identity());
  const auto build = [](const RobotModel& robot, const std::map<std::string, double>& hold,
                        const std::optional<Roll>& roll) {
    return build_arm(robot, "base", robot.links.back().name, hold, Pose::Identity(), roll);
  };
  const auto message = [&](const auto&... arguments) -> std::string {
    try {
      (void)build(arguments...);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::map<std::string, double> none, first{{"j1", 0.3}};
  // Seven joints keep all seven, and the roll is one coordinate more.
  const Chain with_free_roll = build(model, none, Roll{-1, 2}).chain;
  EXPECT_FALSE(with_free_roll.roll);
  EXPECT_TRUE(with_free_roll.free_roll == Roll(-1, 2) && with_free_roll.tool_may_turn());
  EXPECT_EQ(with_free_roll.joint_names.front(), "j1");
  // Six joints without a range of the roll have a tool that may not turn.
  const Chain fixed = build(small, none, std::nullopt).chain,
              free = build(small, none, Roll{}).chain;
  EXPECT_TRUE(fixed.roll && fixed.roll_fixed && !fixed.tool_may_turn());
  EXPECT_TRUE(free.roll && !free.roll_fixed && free.tool_may_turn());
  EXPECT_EQ(fixed.coordinates(), 6u);
  EXPECT_EQ(free.coordinates(), 7u);
  EXPECT_EQ(named_joints(fixed.joint_names), 6u);
  EXPECT_EQ(named_joints(free.joint_names), 7u);
  EXPECT_TRUE(fixed.jacobian(Config::Ones()).col(kDof - 1).isZero(0));
  EXPECT_EQ(message(small, first, std::nullopt),
            "kr6-r900: robot.tip_link: only 5 movable joints that are not held between 'base' and "
            "'l7': allowed are at least six");
  EXPECT_EQ(build(model, first, Roll{}).chain.joint_names.front(), "j2");
  // What the arm carries moves with its six joints at most.
  const ArmModel arm = build(small, none, Roll{});
  for (const LinkPlacement& link : arm.links) EXPECT_LT(link.group, kDof);
}

/// Arms of seven whose elbow is held are singular in every posture, or nearly so.
TEST(Roll, SixJointsThatMoveTheToolInFiveWaysAreRefused) {
  const auto held = [](const std::string& name, const std::string& joint) {
    for (const ArmTable& arm : arms_7r()) {
      if (arm.name != name) continue;
      const RobotModel model = model_of(arm, arm.joints, urdf_pose(arm.tip_xyz, arm.tip_rpy));
      return build_arm(model, "base", model.links.back().name, {{joint, 0.4}}, Pose::Identity())
          .chain;
    }
    throw std::logic_error("no such arm");
  };
  try {
    (void)classify(held("iiwa7", "j4"), "file");
    FAIL() << "singular in every posture";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("singular in every posture"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(classify(held("iiwa7", "j3"), "file").kind, ArmKind::kArcs);
  EXPECT_EQ(classify(held("gen3", "j4"), "file").kind, ArmKind::kSampled);
  EXPECT_EQ(classify(held("gen3", "j3"), "file").kind, ArmKind::kArcs);
}

/// The least cost over a grid of rolls from one end of what a layer allows to the other, solved in
/// closed form; windings of joints by value.
double cheapest_of_grid(const Chain& chain, const ArcLattice& lattice,
                        const std::vector<Roll>& allowed, int count) {
  std::vector<Config> before, here;
  std::vector<double> cost, next;
  for (int i = 0; i < lattice.layers(); ++i) {
    here.clear();
    const Roll& window = allowed[static_cast<std::size_t>(i)];
    for (int k = 0; k < count; ++k) {
      const double roll = window.lower + k * ((window.upper - window.lower) / (count - 1));
      for (const Config6& six :
           ClosedForm::of(lock_joint(chain, kDof - 1, roll))->solve(lattice.path().layer(i).tool)) {
        Config q = with_joint(six, kDof - 1, roll);
        bool inside = true;
        for (std::size_t j = 0; j < kDof; ++j) {
          double& x = q[static_cast<Eigen::Index>(j)];
          const JointLimit& limit = chain.limit[j];
          if (lattice.continuous()[j] || lattice.circles()[j]) continue;
          for (const double turn : {-kTwoPi, kTwoPi})
            if (x + turn >= limit.lower && x + turn <= limit.upper &&
                (x < limit.lower || x > limit.upper))
              x += turn;
          inside = inside && x >= limit.lower && x <= limit.upper;
        }
        if (inside) here.push_back(q);
      }
    }
    next.assign(here.size(), i == 0 ? 0 : kNone);
    for (std::size_t b = 0; i > 0 && b < here.size(); ++b)
      for (std::size_t a = 0; a < before.size(); ++a) {
        const Config delta = lattice.delta(before[a], here[b]);
        if (cost[a] < kNone && lattice.step_allowed(i - 1, delta))
          next[b] = std::min(next[b], cost[a] + lattice.edge_cost(delta));
      }
    before.swap(here);
    cost.swap(next);
  }
  return cost.empty() ? kNone : *std::min_element(cost.begin(), cost.end());
}

double cheapest(const ArcLattice& lattice, std::vector<int>& slots) {
  const auto layers = static_cast<std::size_t>(lattice.layers());
  std::vector<std::vector<double>> cost(layers);
  std::vector<std::vector<int>> from(layers);
  for (std::size_t i = 0; i < layers; ++i) {
    const int layer = static_cast<int>(i);
    cost[i].assign(static_cast<std::size_t>(lattice.slots(layer)), i == 0 ? 0 : kNone);
    from[i].assign(cost[i].size(), -1);
    for (std::size_t b = 0; i > 0 && b < cost[i].size(); ++b)
      for (std::size_t a = 0; a < cost[i - 1].size(); ++a) {
        const Config delta = lattice.delta(lattice.point(layer - 1, static_cast<int>(a)).q,
                                           lattice.point(layer, static_cast<int>(b)).q);
        if (!lattice.step_allowed(layer - 1, delta) ||
            !(cost[i - 1][a] + lattice.edge_cost(delta) < cost[i][b]))
          continue;
        cost[i][b] = cost[i - 1][a] + lattice.edge_cost(delta);
        from[i][b] = static_cast<int>(a);
      }
  }
  const auto best = std::min_element(cost.back().begin(), cost.back().end());
  slots.clear();
  if (best == cost.back().end() || *best == kNone) return kNone;
  for (std::size_t i = layers, slot = static_cast<std::size_t>(best - cost.back().begin());
       i-- > 0;) {
    slots.insert(slots.begin(), static_cast<int>(slot));
    slot = static_cast<std::size_t>(from[i][slot]);
  }
  return *best;
}

/// Draws a path of three waypoints for a tool that may turn freely or within `roll`, with narrower
/// windows at the waypoints now and then.
PathProblem random_roll_problem(const Chain& chain, bool free, const Roll& roll, Random& random) {
  PathProblem problem;
  problem.source = "random path";
  problem.resolution.ds = 0.02;
  problem.resolution.knot = 0;
  problem.limits.roll_slope = random.uniform(3, 12);
  problem.limits.tool_path_error.reset();
  Config q = random_configuration(chain, random);
  if (!free) q[kDof - 1] = random.uniform(roll.lower, roll.upper);
  Pose tool = chain.tool(q);
  for (int k = 0; k < 3; ++k) {
    problem.waypoints.push_back({tool.translation(), Quaterniond(tool.linear()).normalized()});
    tool.translation() +=
        0.1 * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    tool.rotate(Eigen::AngleAxisd(random.uniform(0, 0.3), Vector3d::UnitX()));
  }
  const bool windowed = !free && random.coin();
  for (std::size_t k = 0; windowed && k < problem.waypoints.size(); ++k) {
    // Now and then the tool stands as one turn alone.
    const double middle = q[kDof - 1] + random.uniform(-0.2, 0.2),
                 half = random.coin(0.3) ? 0 : random.uniform(0.005, 0.3);
    problem.waypoints[k].roll = Roll{std::clamp(middle - half, roll.lower, roll.upper),
                                     std::clamp(middle + half, roll.lower, roll.upper)};
  }
  problem.roll = roll;
  return problem;
}

/// Returns the rolls that each layer allows, and checks that the ends of windows are inside them.
std::vector<Roll> allowed_rolls(const PathProblem& problem, const ToolPath& path, bool windowed,
                                const Roll& roll) {
  std::vector<Roll> allowed(static_cast<std::size_t>(path.size()), roll);
  for (int i = 0; windowed && i < path.size(); ++i) {
    allowed[static_cast<std::size_t>(i)] = path.layer(i).window;
    EXPECT_NEAR(outside_windows(problem, path, i, path.layer(i).window.lower), 0, 1e-12);
    EXPECT_NEAR(outside_windows(problem, path, i, path.layer(i).window.upper), 0, 1e-12);
  }
  return allowed;
}

/// Checks the rolls of a path's nodes against their ranges and the slope allowed.
void check_rolls(const ArcLattice& lattice, const PathProblem& problem,
                 const std::vector<int>& slots, bool free, bool windowed) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Config& row = lattice.point(static_cast<int>(i), slots[i]).q;
    if (!free) {
      EXPECT_TRUE(row[kDof - 1] >= problem.roll->lower && row[kDof - 1] <= problem.roll->upper);
    }
    if (windowed) {
      EXPECT_LE(outside_windows(problem, lattice.path(), static_cast<int>(i), row[kDof - 1]), 1e-8);
    }
    EXPECT_EQ(lattice.phi(static_cast<int>(i), slots[i]), row[kDof - 1]);
    if (i == 0) continue;
    const Config delta = lattice.delta(lattice.point(static_cast<int>(i) - 1, slots[i - 1]).q, row);
    EXPECT_LE(std::abs(delta[kDof - 1]), problem.limits.roll_slope * problem.resolution.ds + 1e-9);
  }
}

TEST(Roll, PathsAreAsCheapAsThoseOfAGridOfRolls) {
  Random random(seed("Roll.PathsAreAsCheapAsThoseOfAGridOfRolls"));
  int solved = 0, unsolved = 0, dearer = 0, windows = 0, fixed = 0;
  double worst = 0;
  for (const std::size_t which : {std::size_t{0}, std::size_t{3}, std::size_t{7}}) {
    for (int trial = 0; trial < trials(10); ++trial) {
      const bool free = random.coin();
      const Roll roll = free ? Roll{} : Roll{-random.uniform(0.1, 0.8), random.uniform(0.1, 0.8)};
      const Chain chain = arm_with_roll(arms_6r()[which], roll).chain;
      const PathProblem problem = random_roll_problem(chain, free, roll, random);
      const bool windowed = problem.waypoints[0].roll.has_value();
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const ArcLattice lattice(chain, lock_method(chain), path, problem);
      std::vector<int> slots;
      const double cost = cheapest(lattice, slots);
      // The grid is as fine as the lattice's nodes are where the roll moves most, ends included.
      const int count = free ? 65 : 2 + static_cast<int>((roll.upper - roll.lower) / 0.1);
      const std::vector<Roll> allowed = allowed_rolls(problem, path, windowed, roll);
      const double grid = cheapest_of_grid(chain, lattice, allowed, count);
      if (grid == kNone && cost == kNone) ++unsolved;
      if (grid == kNone) continue;
      EXPECT_LT(cost, kNone) << "only the grid has a path";
      if (cost == kNone) continue;
      ++solved;
      windows += windowed;
      fixed += windowed && std::any_of(problem.waypoints.begin(), problem.waypoints.end(),
                                       [](const Waypoint& waypoint) {
                                         return waypoint.roll->lower == waypoint.roll->upper;
                                       });
      worst = std::max(worst, cost / grid);
      dearer += cost > 1.02 * grid;
      check_rolls(lattice, problem, slots, free, windowed);
    }
  }
  std::printf(
      "  %d paths (%d with windows, %d with a turn alone), %d of both without one; at most %.3f of "
      "the grid's cost, %d dearer by 2 "
      "%%\n",
      solved, windows, fixed, unsolved, worst, dearer);
  EXPECT_GE(solved, at_least(14));
  EXPECT_GE(windows, at_least(3));
  EXPECT_GE(fixed, at_least(1));
  EXPECT_LE(dearer, (solved + 7) / 8);
}

TEST(Roll, ToolAngleErrorIsThatOfTheAxis) {
  Random random(seed("Roll.ToolAngleErrorIsThatOfTheAxis"));
  const Chain chain = arm_with_roll(arms_6r()[0], Roll{}).chain;
  Config q = Config::Zero();
  q = {0.2, -0.8, 1.1, 0.3, 0.7, -0.4, 0.1};
  const Pose tool = chain.tool(q);
  PathProblem problem;
  problem.source = "two poses";
  Pose far = tool;
  far.translation().x() += 0.01;
  for (const Pose& pose : {tool, far})
    problem.waypoints.push_back({pose.translation(), Quaterniond(pose.linear()).normalized()});
  problem.resolution.ds = 0.02;
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  // The roll alone turns nothing that counts.
  for (int trial = 0; trial < trials(20); ++trial) {
    Config delta = Config::Zero();
    delta[kDof - 1] = random.uniform(-0.5, 0.5);
    for (const double angle : angle_deviation(chain, path, 0, q, delta)) EXPECT_LT(angle, 1e-9);
    delta[4] = 0.1;
    EXPECT_GT(angle_deviation(chain, path, 0, q, delta)[1], 0.01);
  }
}

}  // namespace
}  // namespace swivel
