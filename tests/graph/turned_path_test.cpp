// SPDX-License-Identifier: BSD-3-Clause
// The search over labels, nodes with the turns of circles, against lattices that tell all turns
// apart.
#include "swivel/graph/search/turned_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "chance.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {
namespace {

using namespace test;

/// Lets some nodes and edges fail by chance, in all of their turns.
class ByChance final : public Validity {
 public:
  ByChance(const SrsLattice& lattice, std::uint64_t seed, double nodes, double edges)
      : lattice_(&lattice), seed_(seed), nodes_(nodes), edges_(edges) {}
  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const NodeQuestion& x = questions[k];
      answers[k].valid = lattice_->is_given(x.layer) ||
                         chance(seed_, static_cast<std::uint64_t>(x.layer), place(x.slot)) > nodes_;
    }
  }
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override {
    for (std::size_t k = 0; k < questions.size(); ++k) {
      const EdgeQuestion& x = questions[k];
      answers[k] =
          chance(seed_ + 1, static_cast<std::uint64_t>(x.layer), place(x.a), place(x.b)) > edges_;
    }
  }
  [[nodiscard]] bool asks_edges() const override { return true; }

 private:
  /// Returns the number of a slot's branch and arm angle, whatever its winding.
  [[nodiscard]] std::uint64_t place(int slot) const {
    return static_cast<std::uint64_t>(lattice_->branch_of(slot) * lattice_->angles() +
                                      lattice_->angle_of(slot));
  }
  const SrsLattice* lattice_;
  std::uint64_t seed_;
  double nodes_, edges_;
};

struct Met {
  int solved = 0, none = 0, off = 0, ended = 0, failures = 0;
  std::int64_t labels = 0;
};

/// Draws a path that begins in given joints of a random turn, and of which the wide joints turn by
/// up to two turns.
Problem winding_problem(const TestRobot& robot, Random& random) {
  Problem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  Config q = random_config(chain, random);
  for (const int j : {1, 3, 5}) q[j] *= 0.6;
  problem.start = q;
  const Pose tool = chain.tool(q);
  const Vector3d axis = random.coin() ? Vector3d(tool.linear().col(2)) : Vector3d::UnitZ();
  const double turn = random.uniform(-9, 9), way = random.uniform(0, 0.1);
  problem.waypoints = {waypoint_of(tool)};
  const int parts = static_cast<int>(std::ceil(std::abs(turn)));
  for (int k = 1; k <= parts; ++k) {
    Pose pose = tool;
    pose.linear() = Eigen::AngleAxisd(turn * k / parts, axis) * tool.linear();
    pose.translation() += way * k / parts * axis;
    problem.waypoints.push_back(waypoint_of(pose));
  }
  problem.resolution = {.ds = 0.05, .dphi = 0.5, .dalpha = 0.5};
  problem.limits.joint_step = 1.2;
  problem.limits.arm_slope = 25;
  return problem;
}

void compare(const Problem& problem, const TestRobot& robot, std::uint64_t seed,
             const std::string& what, Met& met) {
  const Chain chain = arm_of(robot).chain;
  const ArmClass arm = classify(chain, problem.source);
  const ToolPath path = problem_path(problem, chain);
  const SrsLattice wound(chain, *arm.srs, path, problem);
  const SrsLattice circles(chain, *arm.srs, path, problem, {}, {}, {},
                           SrsLattice::possible_circles(chain, *arm.srs, path, problem));
  const double nodes = seed % 2 ? 0.2 : 0, edges = seed % 4 > 1 ? 0.2 : 0;
  std::vector<CircleRange> ranges;
  for (int j = 0; j < kDof; ++j)
    if (circles.circles()[static_cast<std::size_t>(j)]) {
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
      ranges.push_back({j, limit.lower - kLimitTolerance, limit.upper + kLimitTolerance});
    }
  const auto swept = [&](const SrsLattice& lattice) {
    auto values = make_cost_to_go(lattice);
    values->sweep(lattice.layers() - 1);
    return values;
  };
  SearchCounters of_wound, of_labels, of_circles;
  ByChance for_wound(wound, seed, nodes, edges), for_labels(circles, seed, nodes, edges);
  const auto wound_values = swept(wound), label_values = swept(circles),
             circle_values = swept(circles);
  const SearchOutcome truth = path_first(*wound_values, for_wound, {.batch = 4}, of_wound);
  const auto found =
      path_first_within(*label_values, for_labels, ranges, {.batch = 4}, 1'000'000, of_labels);
  const SearchOutcome loose = path_first(*circle_values, for_labels, {.batch = 4}, of_circles);
  met.off += !loose.path.empty() && circles.off_limits(loose.path) != Lattice::Joints{};
  met.labels += of_labels.expansions;
  met.ended += problem.end.has_value();
  met.failures += label_values->verdicts().removed() > 0;
  ASSERT_EQ(found.has_value(), !truth.path.empty()) << what;
  if (!found) {
    ++met.none;
    return;
  }
  ++met.solved;
  ASSERT_NEAR(found->cost, truth.cost, 1e-9) << what;
  ASSERT_EQ(circles.off_limits(found->path), Lattice::Joints{}) << what;
  // a search with too few labels says nothing
  const auto few = path_first_within(*swept(circles), for_labels, ranges, {.batch = 4},
                                     circles.layers() - 2, of_labels);
  ASSERT_FALSE(few.has_value()) << what;
  if (problem.end || seed % 3 == 0) return;
  Problem ended = problem;
  ended.end = circles.path_joints(found->path).back();
  for (const CircleRange& range : ranges) {  // another turn of the end by chance
    double& x = (*ended.end)[range.joint];
    const double other = x > 0 ? x - kTwoPi : x + kTwoPi;
    if (chance(seed, static_cast<std::uint64_t>(range.joint), 7) < 0.2 && other > range.lower &&
        other < range.upper)
      x = other;
  }
  compare(ended, robot, seed, what + " with an end", met);
}

TEST(TurnedPath, CostsWhatTheLatticeWithAllTurnsToldApartSays) {
  const std::uint64_t base = seed("TurnedPath");
  const std::array<TestRobot, 3> robots{data_robot("iiwa14"), data_robot("sda5f"),
                                        continuous_robot()};
  Met met;
  const int count = trials(240);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const double limit = random.coin() ? kTwoPi : 4.5;
    const int narrow = 2 * random.below(5);  // 8: none
    const TestRobot robot =
        with_limits(robots[static_cast<std::size_t>(trial) % 3], [&](int number, Joint& joint) {
          if (number % 2 == 0) {
            joint.type = Joint::Type::kRevolute;
            joint.upper = number == narrow ? 3.1 : limit;
            joint.lower = -joint.upper;
          }
        });
    Problem problem = winding_problem(robot, random);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    compare(problem, robot, base + static_cast<std::uint64_t>(trial), what, met);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d without a path, %d whose best path on circles does not fit, %d "
      "with failures, %d with an end; %lld labels\n",
      count, met.solved, met.none, met.off, met.failures, met.ended,
      static_cast<long long>(met.labels));
  EXPECT_GE(met.solved, at_least_among(count / 8));
  EXPECT_GE(met.none, at_least_among(count / 8));
  EXPECT_GE(met.off, at_least_among(count / 8));
  EXPECT_GE(met.ended, at_least_among(count / 16));
  EXPECT_GE(met.failures, at_least_among(count / 8));
}

}  // namespace
}  // namespace swivel
