// SPDX-License-Identifier: BSD-3-Clause
// Arcs of arm angles within the joint limits against sampling, and the cells that are moved onto
// them.
#include "swivel/core/kinematics/srs/limit_arcs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robots.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel {
namespace {

using namespace test;

/// The robot with limits so narrow that arcs are short and many; joints of more than a turn keep
/// more than one image.
TestRobot narrowed(const TestRobot& robot, Random& random) {
  return with_limits(robot, [&](int, Joint& joint) {
    if (joint.type == Joint::Type::kContinuous) {
      if (random.coin()) return;
      joint.type = Joint::Type::kRevolute;
      joint.lower = -kPi;
      joint.upper = kPi;
    }
    const double width = joint.upper - joint.lower,
                 kept = width > kTwoPi ? random.uniform(0.9, 1) : random.uniform(0.3, 1);
    joint.lower += random.uniform(0, 1 - kept) * width;
    joint.upper = joint.lower + kept * width;
  });
}

/// A pose of the robot and one nearby, and the lattice between them.
struct Small {
  PathProblem problem;
  ArmModel arm;
  SrsArm srs;
  std::unique_ptr<ToolPath> path;
  Small(const TestRobot& robot, const Resolution& resolution, Random& random)
      : problem(problem_for(robot)), arm(arm_of(robot)) {
    srs = fit_srs(arm.chain, robot.name);
    const Config q0 = random_config(arm.chain, random);
    Config q1 = q0;
    for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.3, 0.3);
    problem.waypoints = {waypoint_of(arm.chain.tool(q0)), waypoint_of(arm.chain.tool(q1))};
    problem.resolution = resolution;
    if (random.coin(0.3)) problem.limits.joint_margin = random.uniform(0, 0.05);
    path = std::make_unique<ToolPath>(waypoints_in_base(problem), problem.resolution, "test");
  }
  [[nodiscard]] SrsLattice lattice(bool arcs) const {
    PathProblem asked = problem;
    asked.resolution.arcs = arcs;
    return SrsLattice(arm.chain, srs, *path, asked);
  }
};

bool holds(const std::vector<AngleArc>& arcs, double phi, double margin = 0) {
  return std::any_of(arcs.begin(), arcs.end(), [&](const AngleArc& arc) {
    for (const double turn : {-kTwoPi, 0.0, kTwoPi})
      if (phi + turn >= arc.begin - margin && phi + turn <= arc.end + margin) return true;
    return false;
  });
}

/// Says by the definition whether the images of an IK solution's winding exist, one joint after the
/// other.
/// `near`: some joint is so near to an end of its range, or some angle so near to singular, that
/// rounding decides.
bool within(const Small& small, const std::array<ElbowCircle, 2>& circles,
            const SrsLattice& lattice, int solution, double phi, bool& near) {
  const int branch = solution / lattice.windings();
  const Config q = srs_ik(small.srs, circles, phi, branch);
  int winding = solution % lattice.windings();
  near = std::abs(std::sin(small.srs.shoulder_angle(q))) < 1e-4 ||
         std::abs(std::sin(small.srs.wrist_angle(q))) < 1e-4;
  bool inside = true;
  for (int j = kDof - 1; j >= 0; --j) {
    const JointLimit& limit = small.arm.chain.limit[static_cast<std::size_t>(j)];
    if (limit.continuous) continue;
    const double lower = limit.lower + small.problem.limits.joint_margin,
                 upper = limit.upper - small.problem.limits.joint_margin;
    const int images = std::max(1, static_cast<int>(std::ceil((upper - lower - 1e-3) / kTwoPi)));
    const double first = lower + std::fmod(std::fmod(q[j] - lower, kTwoPi) + kTwoPi, kTwoPi);
    const double value = first + kTwoPi * (winding % images);
    winding /= images;
    inside = inside && value <= upper;
    near = near || std::abs(std::remainder(q[j] - lower, kTwoPi)) < 1e-7 ||
           std::abs(std::remainder(q[j] - upper, kTwoPi)) < 1e-7;
  }
  return inside;
}

/// Counts arm angles that were compared with the limits, and the arcs that held them.
struct SampleCounts {
  std::int64_t sampled = 0, inside = 0, arcs_found = 0, narrow = 0, whole = 0, several = 0,
               skipped = 0, images = 0;
};

/// One IK solution with one winding at a layer: a sheet of the lattice over the arm angle.
struct Sheet {
  const Small& small;
  const SrsLattice& lattice;
  const std::array<ElbowCircle, 2>& circles;
  int solution;
  std::string name;  ///< in messages
};

/// Checks that the arcs hold the arm angle phi (rad) where it is within the limits.
void check_angle(const Sheet& sheet, const std::vector<AngleArc>& arcs, double phi,
                 SampleCounts& counts) {
  bool near = false;
  const bool expected =
      within(sheet.small, sheet.circles, sheet.lattice, sheet.solution, phi, near);
  ++(near ? counts.skipped : counts.sampled);
  counts.inside += expected;
  ASSERT_TRUE(near || holds(arcs, phi) == expected)
      << sheet.name << " phi " << phi << " expected " << expected;
}

/// Compares the arcs of a sheet with the limits at random arm angles and in the middles of arcs and
/// gaps.
void check_sheet(const Sheet& sheet, const std::vector<AngleArc>& arcs, Random& random,
                 SampleCounts& counts) {
  const int windings = sheet.lattice.windings();
  const int samples = windings > 1 ? 40 : 400;
  for (int k = 0; k < samples; ++k) check_angle(sheet, arcs, random.uniform(-kPi, kPi), counts);
  if (::testing::Test::HasFatalFailure()) return;
  for (std::size_t k = 0; k < arcs.size();
       ++k) {  // also what samples miss: the middles of arcs, and of gaps between them
    ASSERT_LE(arcs[k].begin, arcs[k].end);
    check_angle(sheet, arcs, (arcs[k].begin + arcs[k].end) / 2, counts);
    const double next = k + 1 < arcs.size() ? arcs[k + 1].begin : arcs[0].begin + kTwoPi;
    ASSERT_GE(next, arcs[k].end - 1e-12);
    if (!arcs[k].whole()) check_angle(sheet, arcs, (arcs[k].end + next) / 2, counts);
    counts.narrow += arcs[k].end - arcs[k].begin < 0.01;
    counts.whole += arcs[k].whole();
  }
  counts.arcs_found += static_cast<std::int64_t>(arcs.size());
  counts.several += arcs.size() > 1;
  counts.images += sheet.solution % windings > 0 && !arcs.empty();
}

TEST(LimitArcs, AreThoseOfDenseSampling) {
  Random random(seed("LimitArcs.AreThoseOfDenseSampling"));
  SampleCounts counts;
  std::vector<AngleArc> arcs;
  for (const TestRobot& robot : all_robots())
    for (int trial = 0; trial < trials(100); ++trial) {
      const Small small(narrowed(robot, random), {.ds = 10, .dphi = 1, .dalpha = 10}, random);
      const SrsLattice lattice = small.lattice(false);
      for (int layer = 0; layer < 2; ++layer) {
        const Pose& tool = small.path->layer(layer).tool;
        if (reach_status(small.srs, lattice.plane(layer).reach) != ReachStatus::kReachable)
          continue;
        const auto circles = elbow_circles(small.srs, lattice.plane(layer), tool);
        for (int solution = 0; solution < lattice.solutions(); ++solution) {
          lattice.arcs(layer, solution, arcs);
          const std::string name =
              robot.name + " trial " + std::to_string(trial) + " sheet " + std::to_string(solution);
          check_sheet({small, lattice, circles, solution, name}, arcs, random, counts);
          if (HasFatalFailure()) return;
        }
      }
    }
  const auto& [sampled, inside, arcs_found, narrow, whole, several, skipped, images] = counts;
  std::printf(
      "%lld angles, %lld of them within the limits, %lld too near to tell; %lld arcs: %lld of them "
      "narrower than 0.01 rad, %lld "
      "whole circles; %lld sheets with several, %lld of a second image\n",
      static_cast<long long>(sampled), static_cast<long long>(inside),
      static_cast<long long>(skipped), static_cast<long long>(arcs_found),
      static_cast<long long>(narrow), static_cast<long long>(whole),
      static_cast<long long>(several), static_cast<long long>(images));
  EXPECT_GE(sampled, at_least(1000000));
  EXPECT_GE(inside, at_least(50000));
  EXPECT_GE(arcs_found, at_least(2000));
  EXPECT_GE(narrow, at_least(8));  // 1 to 11 of a quarter
  EXPECT_GE(whole, at_least(50));
  EXPECT_GE(several, at_least(100));
  EXPECT_GE(images, at_least(100));
  EXPECT_LT(skipped, sampled / 1000 + 10);
}

/// Counts cells that arcs meet, nodes that were moved off the grid and kept on it, and cells that
/// have no node.
struct CellCounts {
  std::int64_t cells = 0, moved = 0, kept = 0, middles = 0, shared = 0, missed = 0;
};

/// One problem's lattice with nodes on the grid alone, and the lattice that moves nodes onto arcs.
struct Lattices {
  SrsLattice grid, lattice;
};

/// Checks the nodes of a layer against those of the grid, however they are asked for: slot by slot,
/// the layer at once (into `nodes`), or a random run of angles (into `run`).
void check_nodes(const Lattices& lattices, int layer, LayerNodes& nodes, LayerNodes& run,
                 Random& random, CellCounts& counts) {
  const auto& [grid, lattice] = lattices;
  const int n = lattice.angles();
  lattice.solve(layer, nodes);
  // A run of angles, which may go on past the last angle to the first, gives the same bits as the
  // whole layer.
  const int first = random.below(n), count = 1 + random.below(2 * n);
  lattice.solve(layer, first, count, run);
  std::vector<char> stands(static_cast<std::size_t>(lattice.width()), 0);
  for (const SrsLattice::OffGridNode& cell : lattice.off_grid_nodes(layer))
    stands[static_cast<std::size_t>(cell.slot)] = 1;
  for (int slot = 0; slot < lattice.width(); ++slot) {
    const int solution = lattice.solution_of(slot), j = lattice.angle_of(slot);
    const auto alone = lattice.node(layer, slot), plain = grid.node(layer, slot);
    ASSERT_EQ(nodes.valid(solution, j), alone.has_value());
    ASSERT_EQ(lattice.fault(layer, slot).status == NodeStatus::kValid, alone.has_value());
    for (int k = (j - first + n) % n; k < count; k += n) {
      ASSERT_EQ(run.valid(solution, k), alone.has_value());
      if (alone) {
        ASSERT_EQ(run.config(solution, k), *alone);
      }
    }
    if (alone) {
      ASSERT_EQ(nodes.config(solution, j), *alone);
    }
    if (plain) {
      ASSERT_EQ(*alone, *plain);  // nothing that the grid has is lost
      ASSERT_EQ(lattice.phi(layer, slot), grid.phi(layer, slot));
      ++counts.kept;
    } else {
      ASSERT_EQ(alone.has_value(), stands[static_cast<std::size_t>(slot)] != 0);
    }
  }
}

/// Checks that the joints of a moved node are those of its pose, arm angle and branch, within the
/// limits.
void check_joints(const Small& small, const SrsLattice& lattice, int layer,
                  const SrsLattice::OffGridNode& cell) {
  if (small.srs.exact) {
    const Pose reached = small.arm.chain.tool(cell.q), &wanted = small.path->layer(layer).tool;
    ASSERT_LT((reached.translation() - wanted.translation()).norm() +
                  (reached.linear() - wanted.linear()).norm(),
              1e-9);
    ASSERT_LT(std::abs(std::remainder(
                  lattice.plane(layer).angle_of(small.srs.elbow_axis(cell.q)) - cell.phi, kTwoPi)),
              1e-7);
  }
  ASSERT_EQ(small.srs.branch(cell.q), lattice.branch_of(cell.slot));
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = small.arm.chain.limit[static_cast<std::size_t>(j)];
    const double margin = small.problem.limits.joint_margin;
    ASSERT_TRUE(limit.continuous || (cell.q[j] >= limit.lower + margin - 2e-9 &&
                                     cell.q[j] <= limit.upper - margin + 2e-9));
  }
}

/// Checks that a moved node stands in its cell and within an arc that does not reach the grid's
/// angle.
void check_moved_node(const Small& small, const Lattices& lattices, int layer,
                      const SrsLattice::OffGridNode& cell, CellCounts& counts) {
  const auto& [grid, lattice] = lattices;
  const double own = grid.phi(layer, cell.slot), step = kTwoPi / lattice.angles();
  ASSERT_LE(std::abs(std::remainder(cell.phi - own, kTwoPi)), step / 2 + 1e-12);
  std::vector<AngleArc> arcs;
  lattice.arcs(layer, lattice.solution_of(cell.slot), arcs);
  ASSERT_TRUE(holds(arcs, cell.phi));
  ASSERT_FALSE(holds(arcs, own, -1e-5));
  ASSERT_EQ(lattice.phi(layer, cell.slot), cell.phi);
  ASSERT_EQ(*lattice.node(layer, cell.slot), cell.q);
  check_joints(small, lattice, layer, cell);
  if (::testing::Test::HasFatalFailure()) return;
  // IK solutions whose bodies are said to have the same poses have the same arm angle.
  std::vector<int> same_poses;
  lattice.slots_with_same_body_poses(layer, cell.slot, 0b0011000, same_poses);
  ASSERT_NE(std::find(same_poses.begin(), same_poses.end(), cell.slot), same_poses.end());
  for (const int other : same_poses) {
    ASSERT_EQ(lattice.phi(layer, other), cell.phi);
    counts.shared += other != cell.slot;
  }
  ++counts.moved;
}

/// Counts the cells that the arcs of a solution meet, and those of them without a node.
void count_cells(const SrsLattice& lattice, int layer, int solution, CellCounts& counts) {
  const int n = lattice.angles();
  const double step = kTwoPi / n;
  std::vector<AngleArc> arcs;
  lattice.arcs(layer, solution, arcs);
  for (const AngleArc& arc : arcs) {
    if (arc.whole() || arc.end - arc.begin < 1e-5) continue;
    bool found = false;
    for (long long cell = std::llround((arc.begin + 1e-5 + kPi) / step);
         cell <= std::llround((arc.end - 1e-5 + kPi) / step); ++cell) {
      const int slot = solution * n + static_cast<int>((cell % n + n) % n);
      if (!lattice.node(layer, slot)) {
        ++counts.missed;
        continue;
      }
      ++counts.cells;
      const double phi = lattice.phi(layer, slot);
      found = found || holds({arc}, phi);
      counts.middles += std::abs(std::remainder(phi - (arc.begin + arc.end) / 2, kTwoPi)) < 1e-12;
    }
    counts.missed += !found && arcs.size() == 1;
  }
}

/// Every cell that an arc meets has a node, which stands in the cell, within the arc, and where the
/// grid has a node that one stays.
TEST(LimitArcs, MovedCellsAreNodesWhereverArcsAre) {
  Random random(seed("LimitArcs.MovedCells"));
  CellCounts counts;
  for (const TestRobot& robot : all_robots())
    for (int trial = 0; trial < trials(40); ++trial) {
      const Small small(narrowed(robot, random),
                        {.ds = 0.05, .dphi = random.uniform(0.1, 0.5), .dalpha = 0.5}, random);
      const Lattices lattices{small.lattice(false), small.lattice(true)};
      const SrsLattice& lattice = lattices.lattice;
      ASSERT_EQ(lattices.grid.off_grid_nodes(0).size(), 0u);
      LayerNodes nodes, run;
      for (int layer = 0; layer < lattice.layers(); ++layer) {
        check_nodes(lattices, layer, nodes, run, random, counts);
        if (HasFatalFailure()) return;
        for (const SrsLattice::OffGridNode& cell : lattice.off_grid_nodes(layer)) {
          check_moved_node(small, lattices, layer, cell, counts);
          if (HasFatalFailure()) return;
        }
        for (int solution = 0; solution < lattice.solutions(); ++solution)
          count_cells(lattice, layer, solution, counts);
      }
    }
  const auto& [cells, moved, kept, middles, shared, missed] = counts;
  std::printf(
      "%lld cells that arcs meet, %lld moved (%lld to the middle of an arc), %lld of the grid "
      "kept, %lld pairs alike, %lld "
      "missed\n",
      static_cast<long long>(cells), static_cast<long long>(moved), static_cast<long long>(middles),
      static_cast<long long>(kept), static_cast<long long>(shared), static_cast<long long>(missed));
  EXPECT_EQ(missed, 0);
  EXPECT_GE(moved, at_least(2000));
  EXPECT_GE(middles, at_least(100));
  EXPECT_GE(shared, at_least(100));
  EXPECT_GE(kept, at_least(20000));
}

}  // namespace
}  // namespace swivel
