// SPDX-License-Identifier: BSD-3-Clause
// S-R-S arms on arcs of self-motion, too, as arms of any other class are: two ways to the same
// paths, which know nothing of each other, hold each other to account.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "motion_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

/// Rules of motions between layers alone: what nodes and steps must keep the lattice knows.
class FollowsPath final : public Validity {
 public:
  explicit FollowsPath(const Lattice& lattice) : lattice_(&lattice) {}
  void nodes(std::span<const NodeQuestion>, std::span<NodeAnswer> answers) override {
    for (NodeAnswer& answer : answers) answer.valid = true;
  }
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const EdgeQuestion& x = questions[k];
      answers[k] = lattice_->follows_path(x.layer, x.a, x.qa, x.b, x.qb);
    }
  }
  [[nodiscard]] bool asks_edges() const override { return lattice_->asks_path_error(); }

 private:
  const Lattice* lattice_;
};

struct Found {
  std::vector<Config> joints;  // empty: no path
  double cost = 0;
};

/// The least path of a lattice whose joints keep their limits.
Found least(std::unique_ptr<Lattice> lattice) {
  for (;;) {
    const auto cost_to_go = make_cost_to_go(*lattice);
    cost_to_go->sweep(lattice->layers() - 1);
    FollowsPath validity(*lattice);
    SearchCounters counters;
    const SearchOutcome found = path_first(*cost_to_go, validity, {}, counters, {});
    if (found.path.empty()) return {};
    std::vector<Config> joints = lattice->path_joints(found.path);
    if (!joints.empty()) return {std::move(joints), found.cost};
    lattice = lattice->with_windings(lattice->off_limits(found.path));
  }
}

/// Counts the paths of one arm that lattices solve, and keeps the ratios of their costs.
struct Counts {
  int solved = 0, both = 0, finer = 0, cheaper = 0, arcs_alone = 0;
  std::vector<double> ratios, others;  // cost along arcs over the grid's: of l2, of max and time
};

/// Makes a random path without obstacles, with nodes about as far apart on arcs as on the grid.
PathProblem free_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = motion_problem(robot, random);
  problem.scene.clear();
  problem.smooth.reset();
  problem.resolution.dphi = 0.05;
  problem.resolution.knot = 0;
  problem.resolution.arc = 0.1;  // about as far from node to node as that
  return problem;
}

/// Checks that the least path along arcs costs no more than the one over the grid of arm angles.
void compare_with_grid(PathProblem problem, const std::string& what, Counts& counts) {
  const PreparedRobot prepared(problem);
  const Chain& chain = prepared.arm().chain;
  ASSERT_EQ(prepared.arm_class().kind, ArmKind::kSrs) << what;
  ArmClass as_others;
  as_others.kind = ArmKind::kArcs;
  as_others.lock = lock_method(chain);
  ASSERT_GE(as_others.lock.best, 0) << what;
  const ToolPath path = problem_path(problem, chain);
  const Found grid = least(make_lattice(chain, prepared.arm_class(), path, problem));
  const Found arcs = least(make_lattice(chain, as_others, path, problem));
  counts.solved += !grid.joints.empty();
  if (grid.joints.empty()) {
    counts.arcs_alone += !arcs.joints.empty();
    return;
  }
  ASSERT_FALSE(arcs.joints.empty())
      << what << ": no path along arcs, of cost " << grid.cost << " over the grid";
  ++counts.both;
  const bool l2 = problem.cost.metric == CostMetric::kL2;
  (l2 ? counts.ratios : counts.others).push_back(arcs.cost / grid.cost);
  counts.cheaper += arcs.cost < grid.cost;
  if (arcs.cost > 1.01 * grid.cost) {
    ++counts.finer;
    *problem.resolution.arc /= 2;
    EXPECT_LE(least(make_lattice(chain, as_others, path, problem)).cost, 1.01 * grid.cost) << what;
  }
  for (std::size_t i = 0; i < arcs.joints.size(); ++i)
    ASSERT_TRUE(chain.tool(arcs.joints[i]).isApprox(path.layer(static_cast<int>(i)).tool, 1e-9))
        << what << " layer " << i;
}

/// Prints how many of `count` paths were found, and how their costs are spread.
void print_counts(std::uint64_t base, const std::string& robot, int count, Counts& counts) {
  std::printf(
      "seed %llu, %s: %d paths, %d over the grid, %d along arcs as well (%d cheaper, %d dearer "
      "by 1 %% but not along finer "
      "ones), %d "
      "along arcs alone\n",
      static_cast<unsigned long long>(base), robot.c_str(), count, counts.solved, counts.both,
      counts.cheaper, counts.finer, counts.arcs_alone);
  for (auto* const some : {&counts.ratios, &counts.others}) {
    std::sort(some->begin(), some->end());
    if (some->empty()) continue;
    std::printf("  %s: %zu, cost over the grid's %.4f in the median, %.4f to %.4f\n",
                some == &counts.ratios ? "l2" : "max and time", some->size(),
                (*some)[some->size() / 2], some->front(), some->back());
  }
}

TEST(SrsArcs, AreNoDearerThanTheGridOfArmAngles) {
  const std::uint64_t base = seed("SrsArcs");
  const std::vector<TestRobot> robots{data_robot("iiwa14"), data_robot("sda5f"),
                                      data_robot("sda10f"), continuous_robot()};
  const int count = trials(25);
  for (std::size_t which = 0; which < robots.size(); ++which) {
    const TestRobot& robot = robots[which];
    Counts counts;
    for (int trial = 0; trial < count; ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial) * robots.size() + which);
      compare_with_grid(free_problem(robot, random),
                        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                            std::to_string(trial) + " " + robot.name,
                        counts);
      if (HasFatalFailure()) return;
    }
    print_counts(base, robot.name, count, counts);
    EXPECT_GE(counts.both, at_least_among(count / 2)) << robot.name;
    EXPECT_LE(counts.finer, 1 + counts.both / 20) << robot.name;
    EXPECT_GE(counts.cheaper, at_least_among(count / 3)) << robot.name;
  }
}

}  // namespace
}  // namespace swivel
