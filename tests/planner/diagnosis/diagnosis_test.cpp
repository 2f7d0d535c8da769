// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/diagnosis.hpp"
#include "diagnosis_of.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {
namespace {

using namespace test;

/// Everything that a problem's lattice needs.
struct Laid {
  PathProblem problem;
  PreparedRobot robot;
  ToolPath path;
  SrsLattice lattice;
  explicit Laid(const PathProblem& p)
      : problem(p),
        robot(problem),
        path(waypoints_in_base(problem), problem.resolution, problem.source),
        lattice(robot.arm().chain, robot.srs(), path, problem) {}
  /// Diagnoses as if all paths ended in layer `deepest`, which one reaches; -1: as if no path
  /// reached any.
  Diagnosis diagnose_from(int deepest) const {
    Diagnosis diagnosis;
    const EdgeRule rule = robot.world().edge_rule(robot.radii());
    const SlotPath path_there =
        deepest < 0 ? SlotPath{} : best_path_to(lattice, robot.world(), rule, deepest, {});
    diagnose(lattice, robot.world(), rule, path_there, true, {}, diagnosis);
    return diagnosis;
  }
};

/// What find_violating_pair says of every node of a layer, one by one: "" is counted where a node
/// is valid.
std::map<std::string, std::int64_t> plain_reasons(const Laid& laid, int layer) {
  World::Query query(laid.robot.world());
  std::map<std::string, std::int64_t> reasons;
  for (int slot = 0; slot < laid.lattice.width(); ++slot) {
    const auto q = laid.lattice.exact_config(layer, slot);
    if (!q) continue;
    const auto pair = query.find_violating_pair(*q, ClearanceRule::kNode);
    const auto& names = laid.robot.world().body_names();
    const auto name = [&](int body) { return names[static_cast<std::size_t>(body)]; };
    ++reasons[!laid.lattice.manipulable(*q) ? "manipulability"
              : pair                        ? name(pair->a) + " - " + name(pair->b)
                                            : ""];
  }
  return reasons;
}

/// An arm whose axes miss each other by what rounding in a file may do, so that joints are
/// corrected on the exact chain.
TestRobot inexact_robot() {
  TestRobot robot = data_robot("iiwa14");
  auto model = std::make_shared<RobotModel>(*robot.model);
  for (Joint& joint : model->joints) joint.origin.translation() += Vector3d(1e-5, -2e-5, 0);
  robot.name = "inexact";
  robot.model = model;
  return robot;
}

/// Verdicts are shared among nodes whose bodies have the same poses; the counts and the reason must
/// be those of asking about every node.
TEST(Diagnosis, CountsAreThoseOfAskingAboutEveryNode) {
  const std::uint64_t base = seed("Diagnosis");
  auto robots = all_robots();
  robots.push_back(inexact_robot());
  ASSERT_FALSE(fit_srs(arm_of(robots.back()).chain, "").exact);
  int layers = 0, empty = 0, blocked = 0;
  for (int trial = 0; trial < trials(300); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Laid laid(
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random));
    const int layer = 1 + random.below(laid.lattice.layers() - 1);
    const EdgeRule rule = laid.robot.world().edge_rule(laid.robot.radii());
    if (best_path_to(laid.lattice, laid.robot.world(), rule, layer - 1, {}).empty()) continue;
    auto plain = plain_reasons(laid, layer);
    const bool any_valid = plain.erase("") > 0;
    const Diagnosis diagnosis = laid.diagnose_from(layer - 1);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    ++layers;
    for (const auto& [reason, count] : plain) {
      const auto found =
          std::find_if(diagnosis.removed.begin(), diagnosis.removed.end(),
                       [&](const auto& removed) { return words(removed.cause) == reason; });
      ASSERT_TRUE(found != diagnosis.removed.end()) << what << ": " << reason;
      ASSERT_EQ(found->count, count) << what << ": " << reason;
      ++blocked;
    }
    if (any_valid || plain.empty()) continue;
    ++empty;
    const auto most =
        std::max_element(plain.begin(), plain.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    ASSERT_EQ(words(diagnosis.empty_layers.at(0).cause), most->first) << what;
    ASSERT_EQ(diagnosis.empty_layers.at(0).first, layer) << what;
  }
  std::printf("%d layers, %d pairs that block nodes, %d layers empty for them\n", layers, blocked,
              empty);
  EXPECT_GE(blocked, at_least(40));
  EXPECT_GE(empty, at_least(5));
}

/// What is shared there is the last link alone; every planner and FCL must say the same of what it
/// hides.
TEST(Diagnosis, AnArmThatIsNotExactGetsTheSameAnswers) {
  const std::uint64_t base = seed("Inexact");
  const TestRobot robot = inexact_robot();
  int solved = 0, infeasible = 0;
  std::int64_t asked = 0, asked_eagerly = 0;
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = random_problem(robot, random);
    problem.resolution.dphi *= 1.5;
    PlanOptions options;
    options.planner = PlannerKind::kEagerDp;
    options.evidence.layers = true;
    const PlanResult eager = plan(problem, options);
    options.planner = PlannerKind::kLazy;
    const PlanResult lazy = plan(problem, options);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    ASSERT_EQ(eager.status, lazy.status) << what;
    ASSERT_EQ(eager.cost, lazy.cost) << what;
    ASSERT_EQ(diagnosis_of(eager).reached_layer, diagnosis_of(lazy).reached_layer) << what;
    ASSERT_EQ(words(diagnosis_of(eager).cause), words(diagnosis_of(lazy).cause)) << what;
    (eager.status == PlanStatus::kSolved ? solved : infeasible) += 1;
    asked += lazy.counters.nodes_checked;
    asked_eagerly += eager.counters.nodes_checked;
  }
  std::printf("%d solved, %d infeasible, %lld nodes asked, by eager_dp %lld\n", solved, infeasible,
              static_cast<long long>(asked), static_cast<long long>(asked_eagerly));
  EXPECT_GE(solved, at_least(8));
  EXPECT_GE(infeasible, at_least(4));
  EXPECT_LT(asked, asked_eagerly);
}

/// A straight line that leaves the reach of the arm.
PathProblem leaving(double to) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_a.yaml");
  problem.waypoints[1].position = problem.waypoints[0].position + Vector3d(to, 0, 0);
  problem.resolution = {.ds = 0.02, .dphi = 0.2, .knot = 0};
  return problem;
}

TEST(Diagnosis, SaysByHowMuchAPoseIsOutOfReach) {
  PlanOptions options;
  options.evidence = Evidence::all();
  int checked = 0;
  for (const double to : {0.8, -0.8}) {
    const PathProblem problem = leaving(to);
    const Laid laid(problem);
    const PlanResult result = plan(laid.robot, problem, options);
    ASSERT_EQ(result.status, PlanStatus::kInfeasible);
    EXPECT_TRUE(diagnosis_of(result).complete);
    const SrsArm& arm = laid.robot.srs();
    for (const EmptyLayers& empty : diagnosis_of(result).empty_layers) {
      if (empty.cause.kind != Cause::Kind::kReach) continue;
      const bool far = empty.cause.side == Cause::Side::kUpper;
      double least = 1e9, most = 0;
      for (int layer = empty.first; layer <= empty.last; ++layer) {
        const double reach = (wrist_centre(arm, laid.path.layer(layer).tool) - arm.S).norm();
        const double by =
            far ? reach - arm.upper - arm.fore : std::abs(arm.upper - arm.fore) - reach;
        least = std::min(least, by);
        most = std::max(most, by);
      }
      ASSERT_TRUE(empty.cause.by().has_value()) << empty.first;
      EXPECT_NEAR(*empty.cause.by(), least, 1e-12);
      EXPECT_NEAR(*empty.most, most, 1e-12);
      EXPECT_GT(least, 0);
      checked += empty.last - empty.first;
      ++checked;
    }
  }
  EXPECT_GE(checked, 5);
}

/// Widening the joint named by what is missing lets the layer have a node; a little less does not.
TEST(Diagnosis, SaysByHowMuchAJointIsOutsideItsLimits) {
  PlanOptions options;
  options.evidence = Evidence::all();
  int checked = 0;
  for (const double to : {0.8, -0.3, -0.8}) {
    const PathProblem problem = leaving(to);
    const Laid laid(problem);
    const PlanResult result = plan(laid.robot, problem, options);
    if (result.status != PlanStatus::kInfeasible) continue;
    for (const EmptyLayers& empty : diagnosis_of(result).empty_layers) {
      const Cause& cause = empty.cause;
      if (cause.kind != Cause::Kind::kLimit || cause.other_joints || !cause.by()) continue;
      const auto exists_with = [&](double more) {
        Chain chain = laid.robot.arm().chain;
        for (std::size_t k = 0; k < kDof; ++k) {
          if (chain.joint_names[k] != cause.joint) continue;
          chain.limit[k].lower -= cause.side == Cause::Side::kLower ? more : 0;
          chain.limit[k].upper += cause.side == Cause::Side::kUpper ? more : 0;
        }
        const SrsLattice wider(chain, laid.robot.srs(), laid.path, problem);
        for (int layer = empty.first; layer <= empty.last; ++layer)
          for (int slot = 0; slot < wider.width(); ++slot)
            if (wider.exact_config(layer, slot)) return true;
        return false;
      };
      EXPECT_TRUE(exists_with(*cause.by() + 1e-8)) << empty.first << " " << words(cause);
      EXPECT_FALSE(exists_with(*cause.by() - 1e-8)) << empty.first << " " << words(cause);
      ++checked;
    }
  }
  std::printf("%d layers\n", checked);
  EXPECT_GE(checked, 3);
}

/// With nodes at every layer and at knots, on grids and on arcs.
TEST(Diagnosis, SaysHowFarAJointWouldMoveInOneLayer) {
  for (const char* const name : {"iiwa14_bench", "panda_weld_seam", "gen3_glue_bead"})
    for (const std::optional<double> knot : {std::optional<double>(), std::optional(0.0)}) {
      SCOPED_TRACE(std::string(name) + (knot ? " at every layer" : " at knots"));
      PathProblem problem =
          io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
      problem.limits.joint_step = 1e-4;
      problem.resolution.knot = knot;
      PlanOptions options;
      options.evidence = Evidence::all();
      const PlanResult result = plan(problem, options);
      ASSERT_EQ(result.status, PlanStatus::kInfeasible);
      const Cause& cause = diagnosis_of(result).cause;
      ASSERT_EQ(cause.kind, Cause::Kind::kJointStep) << words(cause);
      EXPECT_FALSE(cause.joint.empty());
      ASSERT_TRUE(cause.value && cause.limit);
      EXPECT_EQ(*cause.limit, 1e-4);
      EXPECT_GT(*cause.value, *cause.limit);
    }
}

/// The layers that are looked at end at a count, not at a clock, and the answer says where.
TEST(Diagnosis, EndsAtAFixedCountAndSaysSo) {
  PathProblem problem = leaving(0.8);
  problem.resolution = {.ds = 2e-5, .dphi = 1.0};
  auto model =
      std::make_shared<RobotModel>(*problem.model);  // with a mesh, whose questions count for more
  const auto shaped = std::find_if(model->links.begin(), model->links.end(),
                                   [](const Link& link) { return !link.collision.empty(); });
  shaped->collision[0].shape = box_mesh(Vector3d::Constant(0.05));
  problem.model = model;
  const Laid laid(problem);
  const Diagnosis first = laid.diagnose_from(0), again = laid.diagnose_from(0);
  EXPECT_FALSE(first.complete);
  EXPECT_GT(first.layers_known, 1000);
  EXPECT_LT(first.layers_known, laid.lattice.layers());
  EXPECT_EQ(first.layers_known, again.layers_known);
  EXPECT_EQ(first.empty_layers.size(), again.empty_layers.size());
}

}  // namespace
}  // namespace swivel
