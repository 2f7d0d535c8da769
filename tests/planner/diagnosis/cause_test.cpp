// SPDX-License-Identifier: BSD-3-Clause
// The cause that a diagnosis names is what ends every path: without it, paths go on.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "diagnosis/diagnosis.hpp"
#include "random_problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "without.hpp"

namespace swivel {
namespace {

using namespace test;

/// Solved, or at least a twentieth of the path further than `reached`.
bool further(const PlanResult& result, const Diagnosis& than) {
  if (result.status == PlanStatus::kSolved) return true;
  const int steps = result.lattice.layers - 1,
            reached = std::max(0, than.reached_layer.value_or(0));
  return result.diagnosis->reached_layer.value_or(-1) >=
         std::min(steps, reached + std::max(1, static_cast<int>(std::ceil(0.05 * steps))));
}

/// Everything that can be taken away from a problem, one by one.
std::vector<Cause> all_causes(const PathProblem& problem, const World& world, const Chain& chain) {
  std::vector<Cause> causes;
  const auto add = [&](Cause::Kind kind) -> Cause& {
    causes.emplace_back().kind = kind;
    return causes.back();
  };
  for (std::size_t k = 0; k < kDof; ++k)
    for (const Cause::Side side : {Cause::Side::kLower, Cause::Side::kUpper}) {
      if (chain.limit[k].continuous) continue;
      Cause& cause = add(Cause::Kind::kLimit);
      cause.joint = chain.joint_names[k];
      cause.side = side;
    }
  for (const Cause::Kind kind :
       {Cause::Kind::kManipulability, Cause::Kind::kArmSlope, Cause::Kind::kRollSlope,
        Cause::Kind::kJointStep, Cause::Kind::kPathError, Cause::Kind::kAngleError,
        Cause::Kind::kStepError})
    add(kind);
  for (const SceneObject& object : problem.scene)
    add(Cause::Kind::kPair).object = object.name;  // more than any pair with it
  for (const BodyPair& pair : world.pairs())
    if (pair.b < static_cast<int>(world.bodies().size()))
      add(Cause::Kind::kPair).bodies = world.names(pair);
  return causes;
}

/// Counts the infeasible problems and what their diagnoses name.
struct CauseCounts {
  int infeasible = 0, started = 0, named = 0, confirmed = 0, none_named = 0, none_exists = 0,
      together = 0, together_confirmed = 0;
  std::map<std::string, std::array<int, 2>> kinds;  ///< how many are named, how many confirmed
};

/// Plans the problem without the one cause that is said to be enough, and counts whether it helps.
void check_single_cause(const PathProblem& problem, const Diagnosis& d, const std::string& what,
                        CauseCounts& counts) {
  EXPECT_TRUE(d.together.empty()) << what;
  const auto relaxed = without(d.cause, problem);
  const bool helps = relaxed && further(plan(*relaxed), d);
  ++counts.named;
  counts.confirmed += helps;
  auto& [count, good] = counts.kinds[to_string(d.cause.kind)];
  ++count;
  good += helps;
  if (!helps) std::printf("does not help: %s\n", what.c_str());
}

/// Plans the problem without each single thing, and without all that the diagnosis names together.
void check_several_causes(const PathProblem& problem, const PreparedRobot& robot,
                          const Diagnosis& d, const std::string& what, CauseCounts& counts) {
  ++counts.none_named;
  bool helps = false;
  for (const Cause& cause : all_causes(problem, robot.world(), robot.arm().chain)) {
    const auto relaxed = without(cause, problem);
    if (!relaxed || !further(plan(*relaxed), d)) continue;
    std::printf("would have helped: %s %s: %s\n", words(cause).c_str(), cause.object.c_str(),
                what.c_str());
    helps = true;
    break;
  }
  counts.none_exists += !helps;
  if (d.together.empty()) return;
  std::optional<PathProblem> relaxed = without(d.cause, problem);
  for (const Cause& cause : d.together)
    if (relaxed) relaxed = without(cause, *relaxed);
  ++counts.together;
  counts.together_confirmed += relaxed && further(plan(*relaxed), d);
}

/// Plans one problem and, where it is infeasible, checks the causes of its diagnosis.
void check_causes(const PathProblem& problem, const std::string& trial, CauseCounts& counts) {
  const PreparedRobot robot(problem);
  const PlanResult result = plan(robot, problem);
  if (result.status != PlanStatus::kInfeasible) return;
  ++counts.infeasible;
  counts.started += problem.start.has_value();
  const Diagnosis& d = *result.diagnosis;
  const std::string what = trial + " " + problem.source + " layer " +
                           std::to_string(d.reached_layer.value_or(-1)) + ": " + words(d.cause);
  ASSERT_NE(d.cause.kind, Cause::Kind::kNone) << what;
  if (d.without_it)
    check_single_cause(problem, d, what, counts);
  else
    check_several_causes(problem, robot, d, what, counts);
}

/// Random problems: what the diagnosis says to be enough is enough, and where it says that no
/// single thing is enough, none is.
TEST(Cause, WithoutItPathsGoOn) {
  const std::uint64_t base = seed("Cause");
  const auto robots = all_robots();
  const int wanted = trials(40);
  CauseCounts counts;
  for (int trial = 0; counts.infeasible < wanted; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    check_causes(random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random),
                 "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial),
                 counts);
    if (HasFatalFailure()) return;
  }
  for (const auto& [kind, numbers] : counts.kinds)
    std::printf("%s: %d named, %d confirmed\n", kind.c_str(), numbers[0], numbers[1]);
  std::printf(
      "%d infeasible, %d with a start; one thing named in %d, confirmed in %d; said to need "
      "several in %d, true of %d; what was "
      "named "
      "together helps in %d of %d\n",
      counts.infeasible, counts.started, counts.named, counts.confirmed, counts.none_named,
      counts.none_exists, counts.together_confirmed, counts.together);
  EXPECT_GE(counts.confirmed, 0.95 * counts.named);
  EXPECT_GE(counts.confirmed + counts.none_exists, 0.95 * counts.infeasible);
  EXPECT_GE(counts.together_confirmed, 0.9 * counts.together);
  EXPECT_GE(counts.named, wanted / 3);
}

/// A cause that was not found in time says so, and is not silent.
TEST(Cause, OfADiagnosisThatEndsBeforeItIsKnownSaysSo) {
  EXPECT_EQ(words(Cause{}), "not known: time was up");
  EXPECT_EQ(figures(Cause{}), "");
}

TEST(Cause, OfExperimentAFromItsGivenStartIsTheLimitOfJoint5) {
  const PathProblem problem =
      io::load_path_problem(data_dir() / "problems/experiment_a_start.yaml");
  const PlanResult result = plan(problem);
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  const Diagnosis& d = *result.diagnosis;
  EXPECT_EQ(d.cause.kind, Cause::Kind::kLimit) << words(d.cause);
  EXPECT_EQ(d.cause.joint, "arm_left_joint_5_r");
  EXPECT_EQ(d.cause.side, Cause::Side::kUpper);
  ASSERT_TRUE(d.without_it.has_value());
  const PlanResult after = plan(without(d.cause, problem).value());
  EXPECT_TRUE(further(after, d)) << to_string(after.status) << " "
                                 << after.diagnosis->reached_layer.value_or(-1);
}

}  // namespace
}  // namespace swivel
