// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>

#include "inexact_robots.hpp"
#include "robots.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

using namespace test;

/// Each joint up to `most` away.
Config nearby(Config q, double most, Random& random) {
  for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-most, most);
  return q;
}

/// A problem whose path joins the poses of two nearby random configurations.
struct Small {
  PathProblem problem;
  ArmModel arm;
  SrsArm srs;
  std::unique_ptr<ToolPath> path;
  std::unique_ptr<SrsLattice> lattice;
  Small(const TestRobot& robot, const Config& q0, const Config& q1, Resolution resolution)
      : problem(problem_for(robot)), arm(arm_of(robot)) {
    srs = fit_srs(arm.chain, robot.name);
    problem.waypoints = {waypoint_of(arm.chain.tool(q0)), waypoint_of(arm.chain.tool(q1))};
    problem.resolution = resolution;
    rebuild();
  }
  void rebuild() {
    path = std::make_unique<ToolPath>(waypoints_in_base(problem), problem.resolution, "test");
    lattice = std::make_unique<SrsLattice>(arm.chain, srs, *path, problem);
  }
};

/// Some of each robot. visit(small) may end the test by a fatal failure.
template <class Visit>
void each_small(Random& random, const Visit& visit,
                const std::vector<TestRobot>& robots = all_robots()) {
  for (const TestRobot& robot : robots)
    for (int trial = 0; trial < trials(20) && !testing::Test::HasFatalFailure(); ++trial) {
      const Config q0 = random_config(arm_of(robot).chain, random), q1 = nearby(q0, 0.2, random);
      Small small(robot, q0, q1, {.ds = 0.02, .dphi = 0.3, .dalpha = 0.1});
      visit(small);
    }
}

TEST(Lattice, NodesReachTheirPoseAtTheirArmAngleWithinLimits) {
  Random random(seed("Lattice.Nodes"));
  std::int64_t valid = 0, faults = 0;
  double worst = 0;
  each_small(random, [&](const Small& small) {
    const Chain& chain = small.arm.chain;
    const SrsLattice& lattice = *small.lattice;
    LayerNodes nodes;
    for (int layer = 0; layer < lattice.layers(); ++layer) {
      lattice.solve(layer, nodes);
      for (int slot = 0; slot < lattice.width(); ++slot) {
        const bool exists = nodes.valid(lattice.solution_of(slot), lattice.angle_of(slot));
        const auto fault = lattice.fault(layer, slot);
        const auto alone = lattice.node(layer, slot);
        ASSERT_EQ(exists, alone.has_value());
        if (!exists) {
          ASSERT_NE(fault.status, NodeStatus::kValid);
          ++faults;
          continue;
        }
        ASSERT_EQ(fault.status, NodeStatus::kValid);
        ++valid;
        const Config q = nodes.config(lattice.solution_of(slot), lattice.angle_of(slot));
        ASSERT_EQ(*alone, q);  // the same bits however asked
        const Pose reached = chain.tool(q), wanted = lattice.path().layer(layer).tool;
        worst = std::max({worst, (reached.translation() - wanted.translation()).norm(),
                          (reached.linear() - wanted.linear()).norm()});
        ASSERT_EQ(small.srs.branch(q), lattice.branch_of(slot));
        ASSERT_LT(std::abs(std::remainder(lattice.plane(layer).angle_of(small.srs.elbow_axis(q)) -
                                              lattice.phi(layer, slot),
                                          kTwoPi)),
                  1e-7);
        for (int j = 0; j < kDof; ++j) {
          const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
          ASSERT_TRUE(limit.continuous ||
                      (q[j] >= limit.lower - 2e-9 && q[j] <= limit.upper + 2e-9));
        }
      }
    }
  });
  std::printf("%lld valid nodes, %lld faults, worst residual %.2e\n", static_cast<long long>(valid),
              static_cast<long long>(faults), worst);
  EXPECT_GE(valid, at_least(20001));
  EXPECT_GE(faults, at_least(20001));
  EXPECT_LT(worst, 1e-9);
}

TEST(Lattice, NodesWithOneElbowAreAsManipulable) {
  Random random(seed("Lattice.Manipulability"));
  std::int64_t pairs = 0;
  double most = 0;  // difference of det(J J^T)
  each_small(random, [&](const Small& small) {
    const Chain& chain = small.arm.chain;
    const SrsLattice& lattice = *small.lattice;
    ASSERT_NE(lattice.manipulability_groups(), 0u);
    std::vector<int> same_poses;
    for (int layer = 0; layer < lattice.layers(); ++layer)
      for (int slot = 0; slot < lattice.width(); ++slot) {
        const auto q = lattice.node(layer, slot);
        if (!q) continue;
        lattice.slots_with_same_body_poses(layer, slot, lattice.manipulability_groups(),
                                           same_poses);
        const double here = chain.manipulability(*q);
        for (const int other : same_poses)
          if (const auto there = other > slot ? lattice.node(layer, other) : std::nullopt) {
            most =
                std::max(most, std::abs(std::pow(chain.manipulability(*there), 2) - here * here));
            ++pairs;
          }
      }
  });
  std::printf("%lld pairs of nodes, determinants differ by %.1e at most\n",
              static_cast<long long>(pairs), most);
  EXPECT_GE(pairs, at_least(20001));
  EXPECT_LT(most, 1e-11);  // a tenth of what a shared verdict needs
}

/// For an arm that is not exact, rows are asked: a verdict that all nodes alike fail holds for each
/// row.
TEST(Lattice, WhatIsUnmanipulableForOneElbowIsSoInEveryRow) {
  Random random(seed("Lattice.Unmanipulable"));
  std::int64_t rows = 0, too_few = 0, shared = 0, rounded_too_few = 0, rounded_shared = 0;
  each_small(
      random,
      [&](Small& small) {
        const bool rounded = small.problem.source.find("rounded") != std::string::npos;
        small.problem.limits.manipulability = random.uniform(0.005, 0.1);
        small.rebuild();
        const SrsLattice& lattice = *small.lattice;
        ASSERT_TRUE(lattice.is_approximate());
        std::vector<int> same_poses;
        for (int layer = 0; layer < lattice.layers(); ++layer)
          for (int slot = 0; slot < lattice.width(); ++slot) {
            const auto q = lattice.node(layer, slot);
            const auto row = q ? lattice.exact_config(layer, slot, *q) : std::nullopt;
            if (!row) continue;
            ++rows;
            too_few += !lattice.manipulable(*row);
            rounded_too_few += rounded && !lattice.manipulable(*row);
            if (!lattice.all_below_manipulability(layer, *q)) continue;
            ++shared;
            rounded_shared += rounded;
            lattice.slots_with_same_body_poses(layer, slot, lattice.manipulability_groups(),
                                               same_poses);
            for (const int other : same_poses) {
              const auto node = lattice.node(layer, other);
              const auto there = node ? lattice.exact_config(layer, other, *node) : std::nullopt;
              ASSERT_FALSE(there && lattice.manipulable(*there))
                  << small.problem.source << " layer " << layer << " slot " << other;
            }
          }
      },
      inexact_robots(random));
  std::printf(
      "%lld rows, %lld of too little manipulability, %lld of them proved at their nodes for all "
      "that are alike; of the rounded "
      "file's %lld %lld\n",
      static_cast<long long>(rows), static_cast<long long>(too_few), static_cast<long long>(shared),
      static_cast<long long>(rounded_too_few), static_cast<long long>(rounded_shared));
  EXPECT_GE(rows, at_least(20001));
  EXPECT_LE(shared, too_few);
  EXPECT_GE(rounded_too_few, at_least(2001));
  EXPECT_GE(rounded_shared, rounded_too_few / 2);
}

TEST(Lattice, WindingsAreAllImagesInsideTheLimits) {
  const TestRobot robot = windings_robot();
  Random random(seed("Lattice.Windings"));
  const Chain chain = arm_of(robot).chain;
  const Config q0 = random_config(chain, random);
  const Small small(robot, q0, q0 + 0.05 * Config::Ones(),
                    {.ds = 0.02, .dphi = 0.5, .dalpha = 0.1});
  const SrsLattice& lattice = *small.lattice;
  EXPECT_EQ(lattice.windings(), 2 * 2);  // joints 1 and 7
  int images = 0;
  for (int slot = 0; slot < lattice.width(); ++slot) {
    const auto q = lattice.node(0, slot);
    if (!q) continue;
    // Every other image inside the limits must be another slot's node at the same branch and angle.
    for (const double shift : {-2 * kTwoPi, -kTwoPi, kTwoPi, 2 * kTwoPi})
      for (const int j : {0, 6}) {
        Config other = *q;
        other[j] += shift;
        const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
        if (other[j] < limit.lower || other[j] > limit.upper) continue;
        bool found = false;
        for (int winding = 0; winding < lattice.windings(); ++winding) {
          const auto candidate = lattice.node(
              0, (lattice.branch_of(slot) * lattice.windings() + winding) * lattice.angles() +
                     lattice.angle_of(slot));
          found = found || (candidate && joint_norm(*candidate - other) < 1e-9);
        }
        EXPECT_TRUE(found);
        ++images;
      }
  }
  EXPECT_GT(images, 10);
}

/// The iiwa with joints 1, 3, 5, 7 between -limit and limit.
TestRobot wide_iiwa(double limit) {
  return with_limits(data_robot("iiwa14"), [&](int number, Joint& joint) {
    if (number % 2 == 0) joint.lower = -limit, joint.upper = limit;
  });
}

TEST(Lattice, LimitsRoundedUpGiveNoMoreWindings) {
  Config q0{0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.0};
  const Config q1 = q0 + 0.05 * Config::Ones();
  const Resolution resolution{.ds = 0.02, .dphi = 0.1, .dalpha = 0.1};
  const auto windings = [&](double limit) {
    return Small(wide_iiwa(limit), q0, q1, resolution).lattice->windings();
  };
  EXPECT_EQ(windings(3.14159), 1);
  EXPECT_EQ(windings(kPi), 1);
  EXPECT_EQ(windings(3.1416), 1);
  EXPECT_EQ(windings(kPi + 0.45e-3), 1);
  EXPECT_EQ(windings(kPi + 0.55e-3), 16);
  EXPECT_EQ(windings(6.28318531), 16);
  EXPECT_EQ(windings(kTwoPi + 0.55e-3), 81);
  // All nodes are the same but those in the sliver by which the ranges differ.
  const Small exact(wide_iiwa(3.14159), q0, q1, resolution),
      rounded(wide_iiwa(3.1416), q0, q1, resolution);
  int nodes = 0;
  for (int layer = 0; layer < exact.lattice->layers(); ++layer)
    for (int slot = 0; slot < exact.lattice->width(); ++slot) {
      const auto q = exact.lattice->node(layer, slot);
      const auto same = rounded.lattice->node(layer, slot);
      if (same && same->cwiseAbs().maxCoeff() > 3.14159) continue;
      ASSERT_EQ(q, same);
      nodes += q.has_value();
    }
  EXPECT_GT(nodes, 1000);
}

TEST(Lattice, AStartInTheSliverOfARangeIsANodeWithNeighbours) {
  Random random(seed("Lattice.Sliver"));
  int tried = 0, connected = 0, near_limit = 0;
  for (int trial = 0; trial < trials(40); ++trial) {
    const double limit =
        trial % 2 ? kPi + random.uniform(1e-6, 0.49e-3) : kTwoPi + random.uniform(1e-6, 0.49e-3);
    const TestRobot robot = wide_iiwa(limit);
    Config q0{0, 0.7, 0, -1.2, 0, 0.9, 0};
    for (const int j : {0, 2, 4, 6}) q0[j] = random.uniform(-1, 1);
    const int joint = 2 * random.below(4);
    const double sign = random.coin() ? 1 : -1,
                 sliver = 2 * limit - (trial % 2 ? kTwoPi : 2 * kTwoPi);
    // At the limit, within the sliver, at its inner end.
    const double inside =
        std::array{0.0, 0.5, 1.0}[static_cast<std::size_t>(random.below(3))] * sliver;
    q0[joint] = sign * (limit - inside);
    Config q1 = q0;
    for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.02, 0.02);
    q1[joint] = q0[joint] - sign * 0.02;  // away from the limit
    Small small(robot, q0, q1, {.ds = 0.005, .dphi = 0.02, .dalpha = 0.1});
    small.problem.limits.joint_step = 0.2;
    small.problem.start = q0;
    small.rebuild();
    const SrsLattice& lattice = *small.lattice;
    ++tried;
    ASSERT_EQ(lattice.node(0, lattice.start_slot()), q0);
    bool any = false;
    const SrsLattice::Run run = lattice.run_after(0, lattice.start_slot());
    for (int solution = 0; solution < lattice.solutions() && !any; ++solution)
      for (int k = 0; k < run.count && !any; ++k) {
        const auto q =
            lattice.node(1, solution * lattice.angles() + (run.first + k) % lattice.angles());
        any = q && lattice.step_allowed(0, lattice.delta(q0, *q));
      }
    EXPECT_TRUE(any) << "joint " << joint << " at " << q0[joint] << " of " << limit;
    connected += any;
    if (trial % 2 == 0) continue;
    // The turn that is kept ends at the start's limit: nodes lie in the sliver there, and none in
    // the other.
    small.problem.resolution.dphi = 1e-3;
    small.rebuild();
    LayerNodes nodes;
    small.lattice->solve(1, nodes);
    for (int solution = 0; solution < small.lattice->solutions(); ++solution)
      for (int j = 0; j < small.lattice->angles(); ++j) {
        if (!nodes.valid(solution, j)) continue;
        const double from_limit = limit - sign * nodes.q(solution, joint)[j];
        ASSERT_LE(from_limit, kTwoPi + 3e-9);
        near_limit += from_limit < sliver;
      }
  }
  std::printf("%d starts, %d connected, %d nodes in the slivers of those of one turn\n", tried,
              connected, near_limit);
  EXPECT_EQ(connected, tried);
  EXPECT_GE(near_limit, at_least(11));
}

TEST(Lattice, RangesOverSixtyFourTurnsAreContinuous) {
  Config q0{0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.4};
  const Resolution resolution{.ds = 0.02, .dphi = 0.1, .dalpha = 0.1};
  const auto robot = [&](double lower, double upper) {
    return with_limits(data_robot("iiwa14"), [&](int number, Joint& joint) {
      if (number == 6) joint.lower = lower, joint.upper = upper;
    });
  };
  for (const auto& [lower, upper] :
       {std::pair{-1e16, 1e16}, {-1e300, 1e308}, {-202.0, 202.0}, {-5.0, 1000.0}, {100.0, 600.0}}) {
    Small small(robot(lower, upper), q0, q0 + 0.05 * Config::Ones(), resolution);
    EXPECT_EQ(small.lattice->windings(), 1);
    EXPECT_TRUE(small.lattice->continuous()[6]);
    ASSERT_EQ(limit_warnings(small.arm.chain).size(), 1u);
    EXPECT_NE(limit_warnings(small.arm.chain)[0].find("joint_a7"), std::string::npos);
    int nodes = 0;
    for (int slot = 0; slot < small.lattice->width(); ++slot)
      if (const auto q = small.lattice->node(0, slot)) {
        ++nodes;
        EXPECT_GE((*q)[6], lower);
        EXPECT_LE((*q)[6], upper);
        if (lower < -200) {
          EXPECT_LE(std::abs((*q)[6]), kPi);
        }
      }
    EXPECT_GT(nodes, 50);
  }
  EXPECT_EQ(Small(robot(-200, 200), q0, q0 + 0.05 * Config::Ones(), resolution).lattice->windings(),
            64);
  EXPECT_THROW(Small(robot(1e15, 1e16), q0, q0 + 0.05 * Config::Ones(), resolution), InputError);
  EXPECT_THROW(Small(robot(1e16, 1e16), q0, q0 + 0.05 * Config::Ones(), resolution), InputError);
}

TEST(Lattice, MoreThanOneThousandAndTwentyFourWindingsAreRefused) {
  Config q0{0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.4};
  const Resolution resolution{.ds = 0.02, .dphi = 0.1, .dalpha = 0.1};
  EXPECT_EQ(
      Small(wide_iiwa(5 * kPi), q0, q0 + 0.05 * Config::Ones(), resolution).lattice->windings(),
      625);
  try {
    Small(wide_iiwa(6 * kPi), q0, q0 + 0.05 * Config::Ones(), resolution);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* needle :
         {"1296 windings", "joint_a1: 6", "joint_a3: 6", "joint_a5: 6", "joint_a7: 6", "1024"})
      EXPECT_NE(message.find(needle), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Lattice, CarriedReferenceKeepsNeighboursAlignedWhereTheLinePassesAxisOne) {
  // The shoulder-wrist line sweeps through the vertical; the best neighbour of nearly every node
  // must stay in the window.
  const TestRobot robot = data_robot("iiwa14");
  Config q0, q1;
  q0 = {0.3, -0.35, 0.2, -1.2, 0.1, 0.6, 0.0};
  q1 = {0.3, 0.35, 0.2, -1.2, 0.1, 0.6, 0.0};
  Small small(robot, q0, q1, {.ds = 0.005, .dphi = 0.05, .dalpha = 1});
  const SrsLattice& lattice = *small.lattice;
  int nodes = 0, outside = 0;
  LayerNodes here, next;
  for (int layer = 0; layer + 1 < lattice.layers(); layer += 5) {
    lattice.solve(layer, here);
    lattice.solve(layer + 1, next);
    for (int slot = 0; slot < lattice.width(); slot += 3) {
      const int solution = lattice.solution_of(slot);
      if (!here.valid(solution, lattice.angle_of(slot))) continue;
      const Config q = here.config(solution, lattice.angle_of(slot));
      int best = -1;
      double least = 1e9;
      for (int j = 0; j < lattice.angles(); ++j)
        if (next.valid(solution, j)) {
          const double cost = lattice.edge_cost(lattice.delta(q, next.config(solution, j)));
          if (cost < least) {
            least = cost;
            best = solution * lattice.angles() + j;
          }
        }
      if (best < 0) continue;
      ++nodes;
      outside += !lattice.in_window(layer, slot, best);
    }
  }
  std::printf("%d nodes, best neighbour outside the window for %.1f %%\n", nodes,
              100.0 * outside / nodes);
  EXPECT_GT(nodes, 1000);
  EXPECT_LT(outside, nodes / 10);
}

TEST(Lattice, StartIsTheOnlyNodeOfLayerZeroAndKeepsItsJoints) {
  const TestRobot robot = data_robot("iiwa14");
  Random random(seed("Lattice.Start"));
  const Chain chain = arm_of(robot).chain;
  int tried = 0;
  for (int trial = 0; trial < trials(50); ++trial) {
    const Config q0 = random_config(chain, random);
    Small small(robot, q0, q0 + 0.1 * Config::Ones(), {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1});
    small.problem.start = q0;
    small.rebuild();
    const SrsLattice& lattice = *small.lattice;
    ASSERT_TRUE(lattice.has_start());
    LayerNodes nodes;
    lattice.solve(0, nodes);
    int valid = 0;
    for (int slot = 0; slot < lattice.width(); ++slot)
      if (nodes.valid(lattice.solution_of(slot), lattice.angle_of(slot))) {
        ++valid;
        EXPECT_EQ(slot, lattice.start_slot());
        EXPECT_EQ(nodes.config(lattice.solution_of(slot), lattice.angle_of(slot)), q0);
      }
    EXPECT_EQ(valid, 1);
    // Successors: exactly the grid nodes within the window of the start's own arm angle.
    const SrsLattice::Run run = lattice.run_after(0, lattice.start_slot());
    for (int j = 0; j < lattice.angles(); ++j) {
      const bool listed = (j - run.first + lattice.angles()) % lattice.angles() < run.count;
      EXPECT_EQ(listed, lattice.in_window(0, lattice.start_slot(), j));
    }
    ++tried;
    Config off = q0;
    off[0] += 1e-4;
    small.problem.start = off;
    EXPECT_THROW(small.rebuild(), InputError);
    off = q0;
    off[3] = 9;
    small.problem.start = off;
    EXPECT_THROW(small.rebuild(), InputError);
  }
  EXPECT_EQ(tried, trials(50));
}

TEST(Lattice, CostsAreMultiplesOfTwoToTheMinusForty) {
  const TestRobot robot = data_robot("iiwa14");
  Random random(seed("Lattice.Costs"));
  const Chain chain = arm_of(robot).chain;
  const Config q0 = random_config(chain, random);
  for (const CostMetric metric :
       {CostMetric::kL2, CostMetric::kL1, CostMetric::kMax, CostMetric::kTime}) {
    Small small(robot, q0, q0 + 0.1 * Config::Ones(), {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1});
    small.problem.cost.metric = metric;
    small.rebuild();
    for (int trial = 0; trial < trials(1000); ++trial) {
      Config delta;
      for (int j = 0; j < kDof; ++j) delta[j] = random.uniform(-0.5, 0.5);
      const double cost = small.lattice->edge_cost(delta);
      EXPECT_EQ(std::ldexp(cost, 40), std::round(std::ldexp(cost, 40)));
      EXPECT_EQ(cost, small.lattice->edge_cost(-delta));
      const double plain = metric == CostMetric::kL2    ? joint_norm(delta)
                           : metric == CostMetric::kL1  ? delta.lpNorm<1>()
                           : metric == CostMetric::kMax ? delta.lpNorm<Eigen::Infinity>()
                                                        : -1;
      EXPECT_TRUE(plain < 0 || std::abs(cost - plain) < 1e-12);
    }
  }
}

TEST(Lattice, CostsGrowWithTheWeightsToTheLastBit) {
  const TestRobot robot = data_robot("iiwa14");
  Random random(seed("Lattice.CostUnit"));
  const Config q0 = random_config(arm_of(robot).chain, random);
  Small small(robot, q0, q0 + 0.1 * Config::Ones(), {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1});
  EXPECT_EQ(small.lattice->cost_unit(), 1);
  for (const CostMetric metric : {CostMetric::kL2, CostMetric::kL1, CostMetric::kMax})
    for (int trial = 0; trial < trials(100); ++trial) {
      small.problem.cost.metric = metric;
      for (double& weight : small.problem.cost.weights.emplace())
        weight = random.coin(0.3) ? 0 : random.uniform(0, 1);
      small.rebuild();
      const std::unique_ptr<SrsLattice> plain = std::move(small.lattice);
      const double factor = std::exp2(random.below(41) - 20);
      for (double& weight : *small.problem.cost.weights) weight *= factor;
      small.rebuild();
      const double largest =
          *std::max_element(small.problem.cost.weights->begin(), small.problem.cost.weights->end());
      if (largest > 0) {
        EXPECT_GE(small.lattice->cost_unit(), largest);
        EXPECT_LT(small.lattice->cost_unit(), 2 * largest);
      }
      Config delta;
      for (int j = 0; j < kDof; ++j) delta[j] = random.uniform(-0.5, 0.5);
      EXPECT_EQ(small.lattice->edge_cost(delta), factor * plain->edge_cost(delta));
    }
}

TEST(Lattice, LeastDeltasBoundTheDeltasToABox) {
  Random random(seed("Lattice.LeastDelta"));
  int compared = 0, zero = 0;
  for (const TestRobot& robot : all_robots()) {
    const Chain chain = arm_of(robot).chain;
    const Config q0 = random_config(chain, random);
    const Small small(robot, q0, q0 + 0.1 * Config::Ones(),
                      {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1});
    for (int trial = 0; trial < trials(400); ++trial) {
      const Config q = random_config(chain, random), lower = random_config(chain, random);
      Config upper = lower, found = Config::Constant(1e9);
      for (int j = 0; j < kDof; ++j) upper[j] += random.coin(0.2) ? 0 : random.uniform(0, 7);
      const Config least = small.lattice->least_delta(q, lower, upper);
      for (int k = 0; k < 200; ++k)
        found = found.cwiseMin(
            small.lattice->delta(q, lower + (upper - lower) * (k / 199.0)).cwiseAbs());
      for (int j = 0; j < kDof; ++j) {
        ASSERT_LE(least[j], found[j]);
        ASSERT_GE(least[j], found[j] - (upper[j] - lower[j]) / 199 - 1e-9);
        ++compared;
        zero += least[j] == 0;
      }
    }
  }
  std::printf("%d bounds, %d of them 0\n", compared, zero);
  EXPECT_GE(zero, at_least(500));
  EXPECT_GE(compared - zero, at_least(500));
}

TEST(Lattice, StepErrorIsTheNormalPartOfTheSecondDerivative) {
  // Held against differences ten times as wide and a least-squares projection.
  const TestRobot robot = data_robot("iiwa14");
  Random random(seed("Lattice.StepError"));
  const Chain chain = arm_of(robot).chain;
  int compared = 0;
  for (int trial = 0; trial < trials(400); ++trial) {
    const Config q0 = random_config(chain, random), q1 = nearby(q0, 0.05, random);
    const Small small(robot, q0, q1, {.ds = 0.02, .dphi = 0.1, .dalpha = 0.1});
    const SrsLattice& lattice = *small.lattice;
    const double phi = random.uniform(-kPi, kPi), dphi = random.uniform(-0.1, 0.1);
    const int branch = random.below(8), end = random.below(2);
    const auto joints = [&](double t, double angle) -> Config {
      const Pose tool = lattice.path().at(0, end + t);
      const ArmPlane plane = carry_plane(small.srs, lattice.plane(end), tool);
      if (reach_status(small.srs, plane.reach) != ReachStatus::kReachable)
        return Config::Constant(std::nan(""));
      return srs_ik(small.srs, elbow_circles(small.srs, plane, tool), angle, branch);
    };
    const auto turn = [](const Config& d) -> Config {
      return d.unaryExpr([](double x) { return std::remainder(x, kTwoPi); });
    };
    const double h = 1e-2;
    const Config center = joints(0, phi);
    const Config second =
        (turn(joints(h, phi + h * dphi) - center) - turn(center - joints(-h, phi - h * dphi))) /
        (h * h);
    Eigen::Matrix<double, kDof, 2> tangent;
    tangent << turn(joints(h, phi) - joints(-h, phi)).head<kDof>(),
        turn(joints(0, phi + h) - joints(0, phi - h)).head<kDof>();
    if (!second.allFinite() || !tangent.allFinite() ||
        std::abs(std::sin(small.srs.shoulder_angle(center))) < 0.2 ||
        std::abs(std::sin(small.srs.wrist_angle(center))) < 0.2 ||
        std::abs(std::sin(small.srs.elbow_angle(center))) < 0.2)
      continue;  // wide differences are poor near singular poses
    const Eigen::Matrix<double, kDof, 1> along =
        tangent * tangent.colPivHouseholderQr().solve(second.head<kDof>());
    const double normal = (second.head<kDof>() - along).norm();
    EXPECT_NEAR(step_error(lattice, 0, end, branch, phi, dphi), 0.5 * normal, 0.01 * normal + 1e-6);
    ++compared;
  }
  std::printf("%d steps compared\n", compared);
  EXPECT_GE(compared, at_least(51));
}

/// Straight from the definition: the tool at a quarter, a half and three quarters of the move, and
/// the segment of its step.
TEST(Lattice, DeviationsFromThePathAreThoseOfTheTool) {
  Random random(seed("Lattice.Deviations"));
  int compared = 0, beyond = 0;  // `beyond`: the tool is beyond an end of its step
  double largest = 0;
  for (const TestRobot& robot : all_robots())
    for (int trial = 0; trial < trials(50); ++trial) {
      const Chain chain = arm_of(robot).chain;
      const Config q0 = random_config(chain, random), q1 = nearby(q0, 0.2, random);
      const Small small(robot, q0, q1, {.ds = 0.05, .dphi = 0.3, .dalpha = 0.2});
      const ToolPath& path = *small.path;
      for (int layer = 0; layer + 1 < path.size(); ++layer) {
        Config delta;
        for (int j = 0; j < kDof; ++j) delta[j] = random.uniform(-0.3, 0.3);
        const auto position = path_deviation(chain, path, layer, q0, delta),
                   angle = angle_deviation(chain, path, layer, q0, delta);
        const Vector3d start = path.layer(layer).tool.translation(),
                       end = path.layer(layer + 1).tool.translation();
        for (std::size_t k = 0; k < 3; ++k) {
          const double t = 0.25 * static_cast<double>(k + 1);
          const Pose tool = chain.tool(q0 + t * delta);
          const Vector3d p = tool.translation(), way = end - start;
          const auto off = [&](double share) { return (p - start - share * way).norm(); };
          const double foot = std::clamp((p - start).dot(way) / way.squaredNorm(), 0.0, 1.0);
          EXPECT_NEAR(position[k], off(foot), 1e-12) << robot.name;
          beyond += off(foot) > (p - start).cross(way.normalized()).norm() + 1e-9;
          // The share nearest to t whose place is as near to the tool as any, to 10 um.
          double share = t;
          if (off(t) > off(foot) + 1e-5) {
            double far = t, near = foot;
            for (int halving = 0; halving < 60; ++halving)
              (off((far + near) / 2) > off(foot) + 1e-5 ? far : near) = (far + near) / 2;
            share = near;
          }
          EXPECT_NEAR(angle[k],
                      Quaterniond(path.at(layer, share).linear())
                          .angularDistance(Quaterniond(tool.linear())),
                      1e-7)
              << robot.name;
          largest = std::max(largest, position[k]);
          ++compared;
        }
      }
    }
  std::printf("%d deviations, up to %.3f m, %d beyond the step\n", compared, largest, beyond);
  EXPECT_GE(beyond, at_least(100));
  EXPECT_GE(compared, at_least(1001));
}

}  // namespace
}  // namespace swivel
