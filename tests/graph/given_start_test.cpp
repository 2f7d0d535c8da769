// SPDX-License-Identifier: BSD-3-Clause
// The cost-to-go of a lattice with a given start, bounded by what its nodes cost from there,
// against the whole one; and answers of circles against those of turns that are told apart.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "chance.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {
namespace {

using namespace test;

/// Lets some nodes and edges fail by chance: on a grid in all of their turns.
class ByChance final : public Validity {
 public:
  ByChance(const Lattice& lattice, std::uint64_t seed, double nodes, double edges)
      : lattice_(&lattice),
        grid_(dynamic_cast<const SrsLattice*>(&lattice)),
        seed_(seed),
        nodes_(nodes),
        edges_(edges) {}
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
  /// Returns the number of a slot's branch and arm angle on a grid, whatever its winding.
  [[nodiscard]] std::uint64_t place(int slot) const {
    return static_cast<std::uint64_t>(
        grid_ ? grid_->branch_of(slot) * grid_->angles() + grid_->angle_of(slot) : slot);
  }
  const Lattice* lattice_;
  const SrsLattice* grid_;
  std::uint64_t seed_;
  double nodes_, edges_;
};

struct Met {
  int solved = 0, none = 0, off = 0, ended = 0, failures = 0;
};

/// Draws a path that begins in given joints of a random turn, and of which the wide joints turn by
/// up to two turns.
PathProblem winding_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = problem_for(robot);
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

/// The answer of one search of a lattice.
struct Answer {
  SlotPath path;  // if there is none: the path to the deepest layer
  double cost = 0;
  int deepest = -1;
  bool removed = false;  // some node or edge
};

/// Searches for the cheapest path, or else the deepest layer, twice with one cost-to-go. `circles`:
/// that of the lattice whose turns are told apart, if any.
Answer answer_of(const Lattice& lattice, Pruning pruning, std::uint64_t seed,
                 const std::string& what, const CostToGo* circles = nullptr) {
  const double nodes = seed % 2 ? 0.2 : 0, edges = seed % 4 > 1 ? 0.2 : 0;
  const auto values = make_cost_to_go(lattice, pruning);
  if (circles) values->bound_by(*circles);
  std::array<Answer, 2> answers;
  for (Answer& answer : answers) {
    ByChance validity(lattice, seed, nodes, edges);
    SearchCounters counters;
    if (!values->restart({})) values->sweep(lattice.layers() - 1);
    const SearchOutcome outcome = path_first(*values, validity, {.batch = 4}, counters);
    answer.path = outcome.path;
    answer.cost = outcome.cost;
    answer.deepest = lattice.layers() - 1;
    if (outcome.path.empty()) {
      answer.deepest = deepest_valid_layer(*values, validity, {.batch = 4}, counters);
      if (answer.deepest >= 0) answer.path = counters.candidate;
    }
    answer.removed = values->verdicts().removed() > 0;
  }
  EXPECT_EQ(answers[0].path, answers[1].path) << what << ", searched again";
  return answers[0];
}

/// Checks that bounded values give the answer of whole ones, and returns it.
Answer same_answer(const Lattice& lattice, std::uint64_t seed, const std::string& what) {
  Answer truth = answer_of(lattice, Pruning::kNone, seed, what);
  const Answer bounded = answer_of(lattice, Pruning::kByBound, seed, what + ", bounded");
  EXPECT_EQ(bounded.deepest, truth.deepest) << what;
  EXPECT_EQ(bounded.path, truth.path) << what;
  EXPECT_EQ(bounded.cost, truth.cost) << what;
  return truth;
}

/// Tells whether there are rows, and none is nearer to a limit than the tolerance of limits.
bool keeps_limits(const Lattice& lattice, const std::vector<Config>& rows) {
  for (const Config& q : rows)
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = lattice.chain().limit[j];
      const double x = q[static_cast<Eigen::Index>(j)];
      if (!limit.continuous &&
          (x < limit.lower + kLimitTolerance || x > limit.upper - kLimitTolerance))
        return false;
    }
  return !rows.empty();
}

void compare(const PathProblem& problem, const TestRobot& robot, std::uint64_t seed,
             const std::string& what, Met& met) {
  const Chain chain = arm_of(robot).chain;
  const ArmClass arm = classify(chain, problem.source);
  const ToolPath path = problem_path(problem, chain);
  const SrsLattice wound(chain, *arm.srs, path, problem);
  const SrsLattice circles(chain, *arm.srs, path, problem, {}, {}, {},
                           SrsLattice::possible_circles(chain, *arm.srs, path, problem));
  Answer truth;
  for (const SrsLattice* lattice : {&circles, &wound}) truth = same_answer(*lattice, seed, what);
  if (::testing::Test::HasFailure()) return;
  const auto of_circles = make_cost_to_go(circles, Pruning::kByBound);
  of_circles->sweep(circles.layers() - 1);
  const auto told = circles.with_windings(circles.circles());
  const Answer bound =
      answer_of(*told, Pruning::kByBound, seed, what + ", bound by circles", of_circles.get());
  ASSERT_EQ(bound.deepest, truth.deepest) << what;
  ASSERT_EQ(bound.cost, truth.cost) << what;
  const Answer loose = answer_of(circles, Pruning::kByBound, seed, what);
  const bool reaches = loose.deepest + 1 == circles.layers(),
             solved = truth.deepest + 1 == wound.layers();
  met.off += reaches && circles.off_limits(loose.path) != Lattice::Joints{};
  met.ended += problem.end.has_value();
  met.failures += truth.removed;
  ++(solved ? met.solved : met.none);
  if (!solved) return;
  ASSERT_TRUE(reaches) << what;
  ASSERT_LE(loose.cost, truth.cost + 1e-9) << what;
  if (keeps_limits(circles, circles.path_joints(loose.path))) {
    ASSERT_NEAR(loose.cost, truth.cost, 1e-9) << what;
  }
  if (problem.end || seed % 3 == 0) return;
  PathProblem ended = problem;
  ended.end = wound.path_joints(truth.path).back();
  for (int j = 0; j < kDof; ++j) {  // another turn of the end by chance
    double& x = (*ended.end)[j];
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double other = x > 0 ? x - kTwoPi : x + kTwoPi;
    if (chance(seed, static_cast<std::uint64_t>(j), 7) < 0.2 && other > limit.lower &&
        other < limit.upper)
      x = other;
  }
  compare(ended, robot, seed, what + " with an end", met);
}

TEST(GivenStart, BoundedValuesGiveTheAnswersOfWholeOnes) {
  const std::uint64_t base = seed("GivenStart");
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
    PathProblem problem = winding_problem(robot, random);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    compare(problem, robot, base + static_cast<std::uint64_t>(trial), what, met);
    if (HasFailure()) return;
    if (trial % 2 == 0) continue;
    problem.start.reset();
    compare(problem, robot, base + static_cast<std::uint64_t>(trial), what + " without start", met);
    if (HasFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d without a path, %d whose best path on circles does not fit, %d "
      "with failures, %d with an end\n",
      count, met.solved, met.none, met.off, met.failures, met.ended);
  EXPECT_GE(met.solved, at_least_among(count / 8));
  EXPECT_GE(met.none, at_least_among(count / 8));
  EXPECT_GE(met.off, at_least_among(count / 8));
  EXPECT_GE(met.ended, at_least_among(count / 16));
  EXPECT_GE(met.failures, at_least_among(count / 8));
}

TEST(GivenStart, BoundedValuesGiveTheAnswersOfWholeOnesOnArcs) {
  const std::uint64_t base = seed("GivenStart.OnArcs");
  std::array<TestRobot, 2> robots{data_robot("xarm7_like"), data_robot("gen3_like")};
  robots[0].tip_link = "flange";
  robots[1].tip_link = "flange";
  int solved = 0, none = 0, wound = 0, failures = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot robot =
        with_limits(robots[static_cast<std::size_t>(trial) % 2], [&](int number, Joint& joint) {
          if (number % 2 != 0) return;
          joint.type = Joint::Type::kRevolute;
          joint.upper = kTwoPi;
          joint.lower = -joint.upper;
        });
    PathProblem problem = winding_problem(robot, random);
    problem.resolution = {.ds = 0.05, .dalpha = 0.5, .arc = 0.6};
    problem.limits.arm_slope = Limits().arm_slope;
    const Chain chain = arm_of(robot).chain;
    const ArmClass arm = classify(chain, problem.source);
    const ToolPath path = problem_path(problem, chain);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const auto circles = make_lattice(chain, arm, path, problem);
    const std::uint64_t chances = base + static_cast<std::uint64_t>(trial);
    const Answer loose = same_answer(*circles, chances, what);
    if (loose.path.empty()) continue;
    const Lattice::Joints off = circles->off_limits(loose.path);
    wound += off != Lattice::Joints{};
    const auto told =
        circles->with_windings(off == Lattice::Joints{} ? Lattice::Joints{true} : off);
    const Answer answer = same_answer(*told, chances, what + ", turns told apart");
    ++(answer.deepest + 1 == told->layers() ? solved : none);
    failures += answer.removed;
    if (HasFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d without a path, %d with turns told apart for cause, %d "
      "with failures\n",
      count, solved, none, wound, failures);
  EXPECT_GE(solved, at_least_among(count / 8));
  EXPECT_GE(none, at_least_among(count / 8));
  EXPECT_GE(wound, at_least_among(count / 10));
  EXPECT_GE(failures, at_least_among(count / 8));
}

}  // namespace
}  // namespace swivel
