// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/arc_lattice.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <limits>

#include "arms.hpp"
#include "seed.hpp"

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

Waypoint waypoint_of(const Pose& pose) {
  return {pose.translation(), Quaterniond(pose.linear()).normalized()};
}

/// Straight, curved or turning, from a random configuration.
PathProblem random_path(const Chain& chain, double length, double ds, Random& random) {
  PathProblem problem;
  problem.source = "random path";
  problem.resolution.ds = ds;
  problem.resolution.knot = 0;
  problem.limits.tool_path_error.reset();
  Pose tool = chain.tool(random_configuration(chain, random));
  problem.waypoints.push_back(waypoint_of(tool));
  const int waypoints = 1 + random.below(3);
  for (int k = 0; k < waypoints; ++k) {
    const auto any = [&] {
      return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    };
    tool.translation() += length / waypoints * any().normalized();
    if (random.coin()) tool.rotate(Eigen::AngleAxisd(random.uniform(0, 0.6), any().normalized()));
    problem.waypoints.push_back(waypoint_of(tool));
  }
  return problem;
}

struct Found {
  double cost = kNone;
  std::vector<int> slots;
};

/// Plain dynamic program over all pairs.
Found cheapest(const Lattice& lattice) {
  const auto layers = static_cast<std::size_t>(lattice.layers());
  std::vector<std::vector<double>> g(layers);
  std::vector<std::vector<int>> next(layers);
  std::vector<Lattice::Node> here, after;
  for (std::size_t i = layers; i-- > 0;) {
    lattice.layer_nodes(static_cast<int>(i), here);
    g[i].assign(here.size(), i + 1 == layers ? 0 : kNone);
    next[i].assign(here.size(), -1);
    for (std::size_t a = 0; i + 1 < layers && a < here.size(); ++a)
      for (std::size_t b = 0; b < after.size(); ++b) {
        if (g[i + 1][b] == kNone) continue;
        const Config delta = lattice.delta(here[a].q, after[b].q);
        if (!lattice.step_allowed(static_cast<int>(i), delta)) continue;
        const double cost = lattice.edge_cost(delta) + g[i + 1][b];
        if (cost < g[i][a]) {
          g[i][a] = cost;
          next[i][a] = static_cast<int>(b);
        }
      }
    here.swap(after);
  }
  Found found;
  const auto best = std::min_element(g[0].begin(), g[0].end());
  if (best == g[0].end() || *best == kNone) return found;
  found.cost = *best;
  for (int slot = static_cast<int>(best - g[0].begin()), i = 0; i < lattice.layers(); ++i) {
    found.slots.push_back(slot);
    slot = next[static_cast<std::size_t>(i)][static_cast<std::size_t>(slot)];
  }
  return found;
}

/// Cost of rows moved along their curves of self-motion, inside the limits, until no move of 1e-3
/// gains 1e-6.
double relaxed(const ArcLattice& lattice, const SelfMotion& motion, const Found& found) {
  std::vector<Config> rows;
  for (int i = 0; i < lattice.layers(); ++i)
    rows.push_back(lattice.point(i, found.slots[static_cast<std::size_t>(i)]).q);
  const auto around = [&](std::size_t i, const Config& q) {
    double cost = 0;
    for (const std::size_t other : {i - 1, i + 1}) {
      if (other >= rows.size()) continue;  // also of 0 - 1
      const Config delta = lattice.delta(rows[other], q);
      if (!lattice.step_allowed(0, delta)) return kNone;
      cost += lattice.edge_cost(delta);
    }
    return cost;
  };
  for (double step = 0.1; step > 5e-4; step /= 3)
    for (int sweep = 0; sweep < 300; ++sweep) {
      double gain = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto J = lattice.chain().jacobian(rows[i]);
        const Eigen::HouseholderQR<Eigen::Matrix<double, kDof, 6>> qr(J.transpose());
        const Config null = qr.householderQ() * Eigen::Matrix<double, kDof, 1>::Unit(kDof - 1);
        const double before = around(i, rows[i]);
        for (const double sign : {1.0, -1.0}) {
          auto q = motion.image(rows[i] + sign * step * null,
                                lattice.path().layer(static_cast<int>(i)).tool);
          if (!q || !motion.canonical(*q)) continue;
          const double after = around(i, *q);
          if (after < before - 1e-9) {
            gain += before - after;
            rows[i] = *q;
            break;
          }
        }
      }
      if (gain < 1e-6) break;
    }
  double cost = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i)
    cost += lattice.edge_cost(lattice.delta(rows[i], rows[i + 1]));
  return cost;
}

std::vector<ArmTable> arms() {
  return {arms_7r()[0], arms_7r()[1], arms_7r()[3], arms_7r()[6], arms_6r()[0], arms_6r()[3]};
}

/// Counts nodes of arc lattices: at ends of arcs, continued from the layer before, placed in gaps,
/// and twins of flipped arcs.
struct NodeCounts {
  int ends = 0, transported = 0, filled = 0, twins = 0;
};

/// Checks that joints (rad) are inside their limits less the margin (rad), and returns whether one
/// is at its limit.
bool check_limits(const ArcLattice& lattice, const Config& joints, double margin) {
  const Chain& chain = lattice.chain();
  bool at_limit = false;
  for (std::size_t j = 0; j < kDof; ++j) {
    const double q = joints[static_cast<Eigen::Index>(j)];
    if (lattice.continuous()[j]) {
      EXPECT_LE(std::abs(q), kPi);
      continue;
    }
    const double lower = chain.limit[j].lower + margin, upper = chain.limit[j].upper - margin;
    EXPECT_TRUE(q >= lower && q <= upper);
    at_limit = at_limit || q == lower || q == upper;
  }
  return at_limit;
}

/// Checks the nodes of layer i: `again` is the lattice of the problem built once more.
void check_nodes(const ArcLattice& lattice, const ArcLattice& again, const PathProblem& problem,
                 int i, NodeCounts& counts) {
  const Pose& tool = lattice.path().layer(i).tool;
  for (int slot = 0; slot < lattice.slots(i); ++slot) {
    const auto& point = lattice.point(i, slot);
    ASSERT_EQ(point.q, again.point(i, slot).q);
    const Pose reached = lattice.chain().tool(point.q);
    EXPECT_LT((reached.matrix() - tool.matrix()).norm(), 1e-9);
    counts.ends += check_limits(lattice, point.q, problem.limits.joint_margin);
    (point.along[0] >= 0 ? counts.transported : counts.filled) += 1;
    // Neighbours along the arc are no farther than a gap that would be filled.
    if (point.beside[1] >= 0) {
      const auto& next = lattice.point(i, point.beside[1]);
      EXPECT_EQ(next.beside[0], slot);
      double chord = 0;
      for (int j = 0; j < kDof; ++j)
        chord += std::pow(std::remainder(next.q[j] - point.q[j], kTwoPi), 2);
      EXPECT_LE(std::sqrt(chord), 1.5 * *problem.resolution.arc + 1e-2);
    }
  }
}

/// Both arcs of a pair have the same nodes, flipped, and these continue corresponding nodes.
void check_flipped_arcs(const ArcLattice& lattice, const SelfMotion& motion, int i,
                        NodeCounts& counts) {
  for (int slot = 0, half = lattice.slots(i) / 2;
       motion.has_flipped_arcs() && slot < lattice.slots(i); ++slot) {
    const int other = slot < half ? slot + half : slot - half;
    EXPECT_LT(joint_norm(lattice.delta(motion.flipped(lattice.point(i, slot).q),
                                       lattice.point(i, other).q)),
              1e-9);
    const int before = lattice.point(i, slot).along[0];
    if (before < 0) continue;
    const int half_before = lattice.slots(i - 1) / 2;
    EXPECT_EQ(lattice.point(i, other).along[0],
              before < half_before ? before + half_before : before - half_before);
    ++counts.twins;
  }
}

/// Every end of an arc is a node, bit for bit.
void check_ends_of_arcs(const ArcLattice& lattice, const SelfMotion& motion, int i) {
  const auto arcs = motion.arcs(lattice.path().layer(i).tool);
  for (const SelfMotionArc& arc : arcs) {
    if (arc.closed) continue;
    for (const Config& end : {arc.q.front(), arc.q.back()}) {
      double nearest = 1e9;
      for (int slot = 0; slot < lattice.slots(i); ++slot)
        nearest = std::min(nearest, joint_norm(lattice.point(i, slot).q - end));
      EXPECT_LE(nearest, 1e-9);
    }
  }
}

TEST(ArcLattice, NodesReachTheirPosesAndLieCloseTogether) {
  Random random(seed("ArcLattice.NodesReachTheirPosesAndLieCloseTogether"));
  NodeCounts counts;
  for (const ArmTable& table : arms()) {
    const Chain chain = chain_of(table);
    const LockMethod method = lock_method(chain);
    for (int trial = 0; trial < trials(2); ++trial) {
      PathProblem problem = random_path(chain, 0.2, 0.02, random);
      problem.limits.joint_margin = random.coin() ? 0.05 : 0;
      problem.resolution.arc = random.uniform(0.1, 0.3);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const ArcLattice lattice(chain, method, path, problem), again(chain, method, path, problem);
      const SelfMotion motion(chain, method, problem.limits.joint_margin);
      std::int64_t nodes = 0;
      for (int i = 0; i < lattice.layers(); ++i) {
        nodes += lattice.slots(i);
        check_nodes(lattice, again, problem, i, counts);
        if (HasFatalFailure()) return;
        check_flipped_arcs(lattice, motion, i, counts);
        check_ends_of_arcs(lattice, motion, i);
      }
      EXPECT_EQ(nodes, lattice.nodes());
    }
  }
  std::printf(
      "  %d nodes on limits, %d transported, %d filled, %d continue the like of their twins\n",
      counts.ends, counts.transported, counts.filled, counts.twins);
  EXPECT_GE(counts.twins, at_least(500));
  EXPECT_GE(counts.ends, at_least(300));
  EXPECT_GT(counts.transported, 3 * counts.filled);
}

/// Knots that are inserted have nodes at their poses; other knots keep theirs; links lead to slots
/// that there are.
TEST(ArcLattice, HalvedStepsKeepTheNodesOfOtherKnots) {
  Random random(seed("ArcLattice.HalvedSteps"));
  int inserted = 0, links = 0;
  for (const ArmTable& table : arms()) {
    const Chain chain = chain_of(table);
    const LockMethod method = lock_method(chain);
    PathProblem problem = random_path(chain, 0.3, 0.01, random);
    problem.resolution.arc = 0.25;
    problem.resolution.knot = 0.08;
    const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
    std::unique_ptr<Lattice> coarse = std::make_unique<ArcLattice>(chain, method, path, problem);
    for (int level = 0; level < 3; ++level) {
      std::set<int> steps;
      for (int step = 0; step + 1 < coarse->layers(); ++step)
        if (random.coin(0.6)) steps.insert(step);
      std::unique_ptr<Lattice> fine = coarse->with_knots(steps, {});
      if (!fine) break;
      int old = 0;
      for (int layer = 0; layer < fine->layers(); ++layer) {
        const Pose& tool = path.layer(fine->layer_of_rows(layer)).tool;
        const bool kept =
            old < coarse->layers() && coarse->layer_of_rows(old) == fine->layer_of_rows(layer);
        for (int slot = 0; slot < fine->slots(layer); ++slot) {
          const Config q = *fine->node(layer, slot);
          ASSERT_LT((chain.tool(q).matrix() - tool.matrix()).norm(), 1e-9);
          if (kept) {
            ASSERT_EQ(q, *coarse->node(old, slot));
          }
          for (const int by : {-1, 1}) {
            const int other = fine->neighbour_along_path(layer, slot, by);
            if (other < 0) continue;
            ASSERT_GE(layer + by, 0);
            ASSERT_LT(layer + by, fine->layers());
            ASSERT_LT(other, fine->slots(layer + by));
            ++links;
          }
        }
        (kept ? old : inserted)++;
      }
      ASSERT_EQ(old, coarse->layers());
      coarse = std::move(fine);
    }
  }
  std::printf("  %d knots inserted, %d links\n", inserted, links);
  EXPECT_GE(inserted, 10);
  EXPECT_GE(links, 500);
}

TEST(ArcLattice, PathsCostLittleMoreThanTheBestKnown) {
  Random random(seed("ArcLattice.PathsCostLittleMoreThanTheBestKnown"));
  std::vector<double> plain,
      others;  // by the norm of joints alike; by the largest of them, or weighted
  for (const ArmTable& table : arms()) {
    const Chain chain = chain_of(table);
    const LockMethod method = lock_method(chain);
    const SelfMotion motion(chain, method, 0);
    std::vector<double> ratio;
    int unsolved = 0;
    double nodes = 0;
    for (int trial = 0; trial < trials(4); ++trial) {
      PathProblem problem = random_path(chain, 0.3, 0.02, random);
      if (trial % 2 == 1) problem.cost.metric = trial % 4 == 1 ? CostMetric::kMax : CostMetric::kL1;
      if (trial % 4 == 3)
        for (double& weight : problem.cost.weights.emplace()) weight = random.uniform(0.2, 3);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const ArcLattice lattice(chain, method, path, problem);
      nodes += static_cast<double>(lattice.nodes()) / lattice.layers();
      PathProblem fine = problem;
      fine.resolution.arc = 0.08;
      const ArcLattice reference(chain, method, path, fine);
      const Found found = cheapest(lattice), best = cheapest(reference);
      EXPECT_EQ(found.cost == kNone, best.cost == kNone);
      if (found.cost == kNone) {
        ++unsolved;
        continue;
      }
      const double least =
          std::min({best.cost, relaxed(reference, motion, best), relaxed(lattice, motion, found)});
      ratio.push_back(found.cost / least);
      (trial % 2 == 1 ? others : plain).push_back(ratio.back());
    }
    std::sort(ratio.begin(), ratio.end());
    if (ratio.empty()) continue;
    std::printf(
        "  %s: %zu paths (%d without one), %.0f nodes a layer, cost over the best known: median "
        "%.4f, 95 %% %.4f, most %.4f\n",
        table.name.c_str(), ratio.size(), unsolved, nodes / trials(4), ratio[ratio.size() / 2],
        ratio[ratio.size() * 19 / 20], ratio.back());
  }
  for (auto* const all : {&plain, &others}) {
    std::sort(all->begin(), all->end());
    ASSERT_GE(all->size(), static_cast<std::size_t>(at_least(4)));
    if (all->empty()) continue;
    EXPECT_LE((*all)[all->size() / 2], all == &plain ? 1.01 : 1.05);
    EXPECT_LE((*all)[all->size() * 19 / 20], 1.1);
  }
}

TEST(ArcLattice, WithoutAClosedFormArcsAreFollowedFromLayerToLayer) {
  Random random(seed("ArcLattice.WithoutAClosedFormArcsAreFollowedFromLayerToLayer"));
  std::int64_t all = 0, found = 0;
  int solved = 0;
  for (const ArmTable& table : {arms_7r()[0], arms_7r()[3]}) {
    const Chain chain = chain_of(table);
    for (int trial = 0; trial < trials(4); ++trial) {
      const PathProblem problem = random_path(chain, 0.2, 0.02, random);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const ArcLattice whole(chain, lock_method(chain), path, problem),
          sampled(chain, LockMethod{}, path, problem);
      all += whole.arcs();
      found += sampled.arcs();
      for (int i = 0; i < sampled.layers(); ++i)
        for (int slot = 0; slot < sampled.slots(i); ++slot)
          EXPECT_LT(
              (chain.tool(sampled.point(i, slot).q).matrix() - path.layer(i).tool.matrix()).norm(),
              1e-9);
      const Found best = cheapest(whole), other = cheapest(sampled);
      if (best.cost == kNone) continue;
      ++solved;
      EXPECT_LE(other.cost, 1.05 * best.cost);
    }
  }
  std::printf("  %d arcs of %d, %d paths\n", static_cast<int>(found), static_cast<int>(all),
              solved);
  EXPECT_GE(solved, at_least(3));
  EXPECT_GE(static_cast<double>(found), 0.98 * static_cast<double>(all));
}

/// Returns an arm whose joints of more than a turn have little room beyond it, so that some paths
/// do not fit.
ArmTable arm_with_tight_circles(bool seven, Random& random) {
  ArmTable table = seven ? arms_7r()[1] : arms_6r()[3];
  for (JointRow& joint : table.joints)
    if (joint.upper - joint.lower > 6.5) {
      joint.lower = -random.uniform(3.2, 3.8);
      joint.upper = random.uniform(3.2, 3.8);
    }
  return table;
}

/// Follows a random node of the first layer along its images; the path may end early.
std::vector<int> random_slots(const ArcLattice& lattice, Random& random) {
  std::vector<int> slots;
  for (int i = 0, slot = lattice.slots(0) > 0 ? random.below(lattice.slots(0)) : -1;
       i < lattice.layers() && slot >= 0; ++i) {
    slots.push_back(slot);
    slot = lattice.neighbour_along_path(i, slot, 1);
  }
  return slots;
}

/// Tells which circles keep their limits along the path, of all images of the first row, by brute
/// force.
std::array<bool, kDof> circles_that_fit(const ArcLattice& lattice, const std::vector<int>& slots) {
  const Chain& chain = lattice.chain();
  std::array<bool, kDof> fits{};
  for (std::size_t j = 0; j < kDof; ++j) {
    if (!lattice.circles()[j]) continue;
    const auto at = static_cast<Eigen::Index>(j);
    for (int turn = -2; turn <= 2; ++turn) {
      double q = lattice.point(0, slots[0]).q[at] + turn * kTwoPi;
      bool inside = true;
      for (std::size_t i = 0; i < slots.size(); ++i) {
        if (i > 0)
          q += std::remainder(lattice.point(static_cast<int>(i), slots[i]).q[at] -
                                  lattice.point(static_cast<int>(i) - 1, slots[i - 1]).q[at],
                              kTwoPi);
        inside = inside && q >= chain.limit[j].lower && q <= chain.limit[j].upper;
      }
      fits[j] = fits[j] || inside;
    }
  }
  return fits;
}

/// Checks that rows (rad) reach the poses of their layers and keep the limits.
void check_unwrapped_rows(const ArcLattice& lattice, const std::vector<Config>& rows) {
  const Chain& chain = lattice.chain();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_LT(
        (chain.tool(rows[i]).matrix() - lattice.path().layer(static_cast<int>(i)).tool.matrix())
            .norm(),
        1e-9);
    for (std::size_t j = 0; j < kDof; ++j) {
      const double q = rows[i][static_cast<Eigen::Index>(j)];
      EXPECT_TRUE(chain.limit[j].continuous ||
                  (q >= chain.limit[j].lower && q <= chain.limit[j].upper));
    }
  }
}

/// Checks that the one joint named is a circle that does not fit, and the lattice that tells its
/// turns apart.
void check_windings(const ArcLattice& lattice, const ArcLattice::Joints& joints,
                    const std::array<bool, kDof>& fits) {
  EXPECT_EQ(std::count(joints.begin(), joints.end(), true), 1);
  for (std::size_t j = 0; j < kDof; ++j)
    if (joints[j]) {
      EXPECT_TRUE(lattice.circles()[j] && !fits[j]);
    }
  const std::unique_ptr<Lattice> wound_lattice = lattice.with_windings(joints);
  for (std::size_t j = 0; j < kDof; ++j)
    EXPECT_EQ(wound_lattice->continuous()[j], lattice.continuous()[j] && !joints[j]);
  EXPECT_GE(wound_lattice->nodes(), lattice.nodes());
  const Found found = cheapest(*wound_lattice);
  EXPECT_GE(found.cost, cheapest(lattice).cost);  // also where there is none
}

TEST(ArcLattice, UnwrapsOrNamesTheJointFurthestOver) {
  Random random(seed("ArcLattice.UnwrapsOrNamesTheJointFurthestOver"));
  int unwrapped = 0, wound = 0;
  for (int trial = 0; trial < trials(12); ++trial) {
    const Chain chain = chain_of(arm_with_tight_circles(trial % 2 == 0, random));
    PathProblem problem = random_path(chain, 0.4, 0.02, random);
    const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
    const ArcLattice lattice(chain, lock_method(chain), path, problem);
    // Any path serves: it follows a random node along its images.
    for (int attempt = 0; attempt < 20; ++attempt) {
      const std::vector<int> slots = random_slots(lattice, random);
      if (static_cast<int>(slots.size()) != lattice.layers()) continue;
      const std::vector<Config> rows = lattice.path_joints(slots);
      const ArcLattice::Joints off = lattice.off_limits(slots);
      EXPECT_EQ(rows.empty(), off != ArcLattice::Joints{});
      if (!rows.empty()) {
        ++unwrapped;
        check_unwrapped_rows(lattice, rows);
      } else {
        ++wound;
        check_windings(lattice, off, circles_that_fit(lattice, slots));
      }
    }
  }
  std::printf("  %d paths unwrapped, %d did not fit\n", unwrapped, wound);
  EXPECT_GE(unwrapped, at_least(12));
  EXPECT_GE(wound, at_least(1));
}

TEST(ArcLattice, AStartIsTheOnlyFirstNodeAndIsTransported) {
  Random random(seed("ArcLattice.AStartIsTheOnlyFirstNodeAndIsTransported"));
  int tried = 0, continued = 0, reached = 0;
  for (const ArmTable& table : arms()) {
    const Chain chain = chain_of(table);
    const LockMethod method = lock_method(chain);
    for (int trial = 0; trial < trials(2); ++trial) {
      PathProblem problem = random_path(chain, 0.1, 0.02, random);
      const Config start = random_configuration(chain, random);
      Pose tool = chain.tool(start);
      problem.waypoints = {waypoint_of(tool)};
      tool.translation().z() -= 0.1;
      problem.waypoints.push_back(waypoint_of(tool));
      problem.start = start;
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const ArcLattice lattice(chain, method, path, problem);
      ASSERT_EQ(lattice.slots(0), 1);
      ++tried;
      if (const int next = lattice.neighbour_along_path(0, 0, 1); next >= 0) {
        ++continued;
        for (int j = 0; j < kDof; ++j)
          EXPECT_LT(std::abs(std::remainder(lattice.point(1, next).q[j] - start[j], kTwoPi)), 1.5);
      }
      const Found found = cheapest(lattice);
      if (found.cost == kNone) continue;
      ++reached;
      const std::vector<Config> rows = lattice.path_joints(found.slots);
      EXPECT_TRUE(rows.empty() || rows.front() == start);
    }
  }
  std::printf("  %d of %d, %d continued in the next layer\n", reached, tried, continued);
  EXPECT_GE(reached, at_least_among(tried / 3));
  EXPECT_GE(continued, at_least_among(2 * tried / 3));
}

}  // namespace
}  // namespace swivel
