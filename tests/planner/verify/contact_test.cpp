// SPDX-License-Identifier: BSD-3-Clause
// How deep bodies that may touch are in each other: measured, and bounded in everything that judges
// nodes, edges and motions.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "robots.hpp"
#include "seed.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel {
namespace {

using namespace test;

/// A disc is led along a plate, `deep` beneath its surface.
PathProblem polishing(double deep, std::optional<double> allowed = {}) {
  static const PathProblem loaded =
      io::load_path_problem(data_dir() / "problems" / "xarm7_polish_raster.yaml");
  PathProblem problem = loaded;
  problem.waypoints.resize(2);
  problem.waypoints[1].position.y() = 0;
  problem.resolution.ds = 0.03;
  problem.resolution.arc = 0.4;
  problem.resolution.knot = 0;
  for (Waypoint& waypoint : problem.waypoints)
    waypoint.position.z() -= deep + 0.003;  // the disc ends 3 mm above the tool
  for (SceneObject& object : problem.scene)
    if (object.name == "plate") object.allow = {Allowed("disc", allowed)};
  return problem;
}
PlanResult planned(const PathProblem& problem, PlannerKind planner = PlannerKind::kLazy) {
  PlanOptions options;
  options.planner = planner;
  options.evidence = Evidence::all();
  return plan(problem, options);
}

TEST(Contact, IsMeasuredAndSaid) {
  for (const double deep : {-0.002, 0.001, 0.004}) {
    const PathProblem problem = polishing(deep);
    const PlanResult result = planned(problem);
    ASSERT_EQ(result.status, PlanStatus::kSolved);
    ASSERT_EQ(result.deepest_contact.has_value(), deep > 0);
    const CheckResult check = check_trajectory(problem, result.trajectory);
    EXPECT_TRUE(check.passed);
    ASSERT_EQ(check.deepest_contact.has_value(), deep > 0);
    const bool said = answer_text(result).find("contact") != std::string::npos;
    EXPECT_EQ(said, deep > 0) << answer_text(result);
    if (deep < 0) continue;
    for (const DeepestContact& contact : {*result.deepest_contact, *check.deepest_contact}) {
      // Between layers joints move straight: the tool leaves its path by up to a millimetre.
      EXPECT_GE(contact.depth, deep - 0.1e-3);
      EXPECT_LE(contact.depth, deep + 1.1e-3);
      ASSERT_TRUE(contact.at_most);
      EXPECT_GE(*contact.at_most, contact.depth);
      EXPECT_LE(*contact.at_most, contact.depth + 0.51e-3);
      EXPECT_EQ(contact.bodies, (std::array<std::string, 2>{"disc", "plate"}));
      EXPECT_FALSE(contact.allowed);
    }
  }
}

TEST(Contact, DeeperThanAllowedIsACollisionForEveryoneWhoJudges) {
  const double deep = 0.004;
  const PathProblem as_deep_as_it_likes = polishing(deep);
  const PlanResult free = planned(as_deep_as_it_likes);
  ASSERT_EQ(free.status, PlanStatus::kSolved);
  for (const PlannerKind planner :
       {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel}) {
    SCOPED_TRACE(to_string(planner));
    const PlanResult enough = planned(polishing(deep, 0.006), planner);
    ASSERT_EQ(enough.status, PlanStatus::kSolved);
    EXPECT_EQ(enough.cost, free.cost);
    ASSERT_TRUE(enough.deepest_contact);
    EXPECT_EQ(enough.deepest_contact->allowed, 0.006);

    const PlanResult little = planned(polishing(deep, 0.003), planner);
    ASSERT_EQ(little.status, PlanStatus::kInfeasible);
    const Cause& cause = little.diagnosis->cause;
    EXPECT_EQ(cause.kind, Cause::Kind::kPair);
    EXPECT_EQ(cause.bodies, (std::array<std::string, 2>{"disc", "plate"}));
    ASSERT_TRUE(cause.value && cause.limit);
    EXPECT_NEAR(*cause.value, -deep, 0.1e-3);
    EXPECT_DOUBLE_EQ(*cause.limit, -(0.003 - 2 * 0.003 / 32));
    EXPECT_EQ(cause.over, 0.003);
    EXPECT_NE(answer_text(little).find("4 mm deep, allowed 2.81 mm: 3 mm less what motions need"),
              std::string::npos)
        << answer_text(little);
  }
  const CheckResult check = check_trajectory(polishing(deep, 0.003), free.trajectory);
  EXPECT_FALSE(check.passed);
  EXPECT_NE(check.failures.at(0).find("deep in each other: allowed are 3.000 mm"),
            std::string::npos)
      << check.failures[0];
  CheckOptions quick;
  quick.margins = false;
  EXPECT_FALSE(check_trajectory(polishing(deep, 0.003), free.trajectory, quick).passed);
  EXPECT_TRUE(check_trajectory(polishing(deep, 0.006), free.trajectory, quick).passed);
}

TEST(Contact, ThatIsTooDeepHasACertificate) {
  const PathProblem problem = polishing(0.004, 0.003);
  Planner planner(problem);
  const PlanResult result = planner.plan();
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
  EXPECT_TRUE(std::any_of(certificate.witnesses.begin(), certificate.witnesses.end(),
                          [](const Cause& witness) {
                            return witness.bodies == std::array<std::string, 2>{"disc", "plate"};
                          }));
  const CertificateCheck check = verify_certificate(PreparedRobot(problem), problem, certificate);
  EXPECT_TRUE(check.passed) << check.failure;
  // For the same problem with a disc that may be so deep, the certificate proves nothing.
  EXPECT_FALSE(
      verify_certificate(PreparedRobot(problem), polishing(0.004, 0.006), certificate).passed);
}

TEST(Contact, BetweenLayersIsBoundedAsWell) {
  // At layers the disc is as deep as it may be; on the way from one to the next it swings deeper.
  PathProblem problem = polishing(0.003);
  problem.resolution.ds = 0.15;
  problem.limits.tool_path_error = 0.02;
  problem.limits.joint_step = 1.5;
  const PlanResult free = planned(problem);
  ASSERT_EQ(free.status, PlanStatus::kSolved);
  ASSERT_TRUE(free.deepest_contact);
  PathProblem bounded = problem;
  for (SceneObject& object : bounded.scene)
    if (object.name == "plate") object.allow = {Allowed("disc", 0.00302)};
  int deeper_at_rows = 0;
  const World planned_in(
      *bounded.model,
      build_arm(*bounded.model, bounded.base_link, bounded.tip_link, bounded.hold, bounded.tool),
      bounded);
  const World world(planned_in, bounded, {}, kVerdictBand);  // rows may be as deep as allowed
  World::Query query(world);
  for (const TrajectoryRow& row : free.trajectory)
    deeper_at_rows += query.find_violating_pair(row.q, ClearanceRule::kNode).has_value();
  EXPECT_EQ(deeper_at_rows, 0);
  EXPECT_FALSE(check_trajectory(bounded, free.trajectory).passed);
  const PlanResult result = planned(bounded);
  if (result.status == PlanStatus::kSolved) {
    ASSERT_TRUE(result.deepest_contact);
    EXPECT_LE(result.deepest_contact->depth, 0.00302 + 1e-6);
  }
}

/// A tool led nearly as deep as it may be is planned, or refused at its first row: no node is left
/// from which no motion is proved.
TEST(Contact, NearlyAsDeepAsAllowedIsPlannedOrRefusedAtOnce) {
  constexpr double kAllowed = 0.003;
  int solved = 0, refused = 0;
  for (const double deep : {0.0020, 0.0025, 0.0027, 0.0028, 0.00285, 0.0029, 0.00299}) {
    SCOPED_TRACE(deep);
    PathProblem problem = polishing(deep, kAllowed);
    problem.resolution.ds =
        0.005;  // straight joint motions leave the path by some 0.01 mm between layers
    problem.limits.joint_acceleration = std::array<double, kDof>{10, 10, 10, 10, 10, 10, 10};
    problem = with_motion_defaults(problem);
    const PlanResult result = planned(problem);
    EXPECT_LE(result.counters.edges_checked, 20 * result.lattice.layers);
    if (deep > kAllowed - 2 * kAllowed / 32) {
      ASSERT_EQ(result.status, PlanStatus::kInfeasible);
      const Cause& cause = result.diagnosis->cause;
      EXPECT_FALSE(cause.between_layers);
      ASSERT_TRUE(cause.value);
      EXPECT_NEAR(*cause.value, -deep, 0.03e-3);
      ++refused;
      continue;
    }
    ASSERT_EQ(result.status, PlanStatus::kSolved) << answer_text(result);
    ASSERT_TRUE(result.deepest_contact && result.deepest_contact->at_most);
    EXPECT_LE(*result.deepest_contact->at_most, kAllowed + 1e-12);
    const CheckResult check = check_trajectory(problem, result.trajectory);
    EXPECT_TRUE(check.passed) << check.failures.at(0);
    EXPECT_LE(*check.deepest_contact->at_most, kAllowed + 1e-12);
    TimingOptions timing;
    timing.speed = 0.05;
    const MotionResult motion =
        time_trajectory(PreparedRobot(problem), problem, result.trajectory, timing);
    ASSERT_TRUE(motion.motion) << (motion.failure ? motion.failure->reason : "");
    for (const std::size_t every : {1, 5, 25}) {  // the verdict is the same for rows further apart
      std::vector<TimedRow> rows;
      for (std::size_t k = 0; k < motion.motion->rows.size(); k += every)
        rows.push_back(motion.motion->rows[k]);
      if (rows.back().t != motion.motion->rows.back().t) rows.push_back(motion.motion->rows.back());
      const CheckResult check_of_rows = check_motion(PreparedRobot(problem), problem, rows);
      EXPECT_TRUE(std::none_of(
          check_of_rows.failures.begin(), check_of_rows.failures.end(),
          [](const std::string& line) { return line.find("deep") != std::string::npos; }))
          << every << ": " << check_of_rows.failures.at(0);
    }
    ++solved;
  }
  EXPECT_EQ(solved, 4);
  EXPECT_EQ(refused, 3);
}

/// What is too deep between layers alone is told with its depth, and deeper contact is among what
/// is advised.
TEST(Contact, ThatIsTooDeepIsToldWithItsDepthAndAdvised) {
  // A stylus of 8 mm is led past a pin of 12 mm, which it meets half-way between two layers.
  PathProblem problem = polishing(-0.05);
  Pose tip = Pose::Identity();
  tip.translation().z() = 0.145;
  problem.attached.push_back({"stylus", Sphere{0.004}, tip, problem.tip_link});
  Pose pin = Pose::Identity();
  pin.translation() = Vector3d(-0.08, -0.105, 0.042);
  const SceneObject plate = problem.scene[1];
  problem.scene.push_back({"pin", Sphere{0.006}, plate.pose * pin, {Allowed("stylus", 0.002)}});
  Planner between(problem);
  const PlanResult result = between.plan();
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  const Cause& cause = result.diagnosis->cause;
  EXPECT_TRUE(cause.between_layers);
  EXPECT_EQ(cause.bodies, (std::array<std::string, 2>{"stylus", "pin"}));
  ASSERT_TRUE(cause.value && cause.limit && cause.over);
  EXPECT_NEAR(*cause.value, -0.01, 2e-3);  // less where the stylus leaves its path
  EXPECT_DOUBLE_EQ(*cause.limit, -(0.002 - 0.002 / 32));
  EXPECT_EQ(*cause.over, 0.002);
  EXPECT_NE(answer_text(result).find(" mm deep, allowed 1.94 mm: 2 mm less what motions need"),
            std::string::npos)
      << answer_text(result);

  Planner planner(polishing(0.004, 0.003));
  PlanOptions options;
  options.timeout_s = 60;
  const std::vector<Advice> advice = advise(planner, planner.plan(), options);
  const auto deeper = std::find_if(advice.begin(), advice.end(), [](const Advice& one) {
    return one.change == Advice::Change::kDepth;
  });
  ASSERT_NE(deeper, advice.end());
  EXPECT_EQ(deeper->outcome, Advice::Outcome::kSolved);
  EXPECT_EQ(deeper->object, "plate");
  EXPECT_EQ(deeper->from, 0.003);
  ASSERT_TRUE(deeper->to);
  EXPECT_GT(*deeper->to, 0.004);
  EXPECT_LT(*deeper->to, 0.007);
  EXPECT_NE(advice_text(advice).find("contact with 'plate' up to"), std::string::npos)
      << advice_text(advice);
}

/// Plans with `plan`, cancelled when it measures for the `call`-th time. Returns its result; none
/// if it measures less often.
template <class Plan>
auto stopped_while_measuring(const Plan& plan, int call) {
  std::atomic<bool> cancel{false};
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.evidence = Evidence::all();
  options.cancel = &cancel;
  int heard = 0;
  options.progress = [&](const Progress& progress) {
    if (progress.stage == Stage::kMeasuring && heard++ == call) cancel = true;
  };
  auto result = plan(options);
  return cancel ? std::optional(std::move(result)) : std::nullopt;
}
bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Contact, ThatWasNotMeasuredIsToldFromContactThatIsNone) {
  const PathProblem touching = polishing(0.001), above = polishing(-0.002);
  const PlanResult whole = planned(touching), none = planned(above);
  EXPECT_EQ(whole.deepest_contact_status(), Known::kMeasured);
  EXPECT_EQ(none.deepest_contact_status(), Known::kNone);
  EXPECT_TRUE(says(io::to_json(none), "\"deepest_contact_status\": \"none\""));
  EXPECT_TRUE(says(io::to_json(whole), "\"min_clearance_status\": \"measured\""));
  EXPECT_FALSE(says(answer_text(whole), "not measured"));
  PlanOptions least;
  least.planner = PlannerKind::kLazy;
  const PlanResult unasked = plan(touching, least);
  EXPECT_EQ(unasked.deepest_contact_status(), Known::kNotMeasured);
  EXPECT_FALSE(says(answer_text(unasked), "not measured"));

  int without_either = 0, without_contact = 0, too_late = 0;
  for (int call = 0;; ++call) {
    const auto stopped = stopped_while_measuring(
        [&](const PlanOptions& options) { return plan(touching, options); }, call);
    if (!stopped) break;
    SCOPED_TRACE(call);
    ASSERT_EQ(stopped->status, PlanStatus::kSolved);
    if (stopped->deepest_contact_status() == Known::kMeasured) {  // asked at the last row
      ++too_late;
      continue;
    }
    const bool clearance = stopped->min_clearance_status() != Known::kNotMeasured;
    const std::string json = io::to_json(*stopped);
    EXPECT_EQ(stopped->deepest_contact_status(), Known::kNotMeasured);
    EXPECT_TRUE(says(answer_text(*stopped),
                     clearance ? "time ran out: depth of contact" : "clearance, depth of contact"))
        << answer_text(*stopped);
    EXPECT_TRUE(says(json, "\"deepest_contact_status\": \"not_measured\""));
    EXPECT_EQ(says(json, "\"min_clearance_status\": \"not_measured\""), !clearance);
    EXPECT_TRUE(stopped->min_clearance.has_value() == clearance && !stopped->deepest_contact);
    ++(clearance ? without_contact : without_either);
  }
  EXPECT_LE(too_late, 1);
  EXPECT_GE(without_either, 2);
  EXPECT_GE(without_contact, 2);

  const CheckResult check = check_trajectory(above, none.trajectory);
  EXPECT_EQ(check.deepest_contact_status, Known::kNone);
  EXPECT_EQ(check.min_clearance_status, Known::kMeasured);
  std::vector<TrajectoryRow> broken = none.trajectory;
  broken[0].q[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check_trajectory(above, broken).deepest_contact_status, Known::kNotMeasured);
}

TEST(Contact, ThatWasNotMeasuredOfAJobIsSaidOfEachRun) {
  const PathProblem problem = polishing(0.001);
  Problem job;
  static_cast<Robot&>(job.arm()) = problem;
  job.scene = problem.scene;
  job.arm().transition_limits = problem.limits;
  for (const char* const name : {"first", "second"}) {
    Stroke stroke;
    static_cast<Task&>(stroke) = problem;
    stroke.name = name;
    job.arm().strokes.push_back(stroke);
  }
  const auto stopped = stopped_while_measuring(
      [&](const PlanOptions& options) { return plan_job(job, options); }, 0);
  ASSERT_TRUE(stopped);
  ASSERT_EQ(stopped->status, PlanStatus::kSolved);
  ASSERT_EQ(stopped->arm().runs.size(), 2u);
  for (const RunAnswer& run : stopped->arm().runs) {
    EXPECT_EQ(run.deepest_contact_status(), Known::kNotMeasured);
    EXPECT_EQ(run.min_clearance_status(), Known::kNotMeasured);
  }
  const std::string text = answer_text(*stopped, job);
  EXPECT_TRUE(says(text, "depth of contact of 'first'") &&
              says(text, "depth of contact of 'second'"))
      << text;
  PlanOptions all;
  all.evidence = Evidence::all();
  const Answer whole = plan_job(job, all);
  for (const RunAnswer& run : whole.arm().runs) {
    ASSERT_TRUE(run.deepest_contact);
    EXPECT_NEAR(run.deepest_contact->depth, 0.001, 1.2e-3);
  }
}

TEST(Contact, ThatWasNotMeasuredOfTwoArmsIsSaidOfBoth) {
  Random random(71);
  for (int tried = 0; tried < 20; ++tried) {
    Problem cell = random_workcell(data_robot("sda10f"), random);
    const auto stopped = stopped_while_measuring(
        [&](const PlanOptions& options) { return plan_workcell(cell, options); }, 0);
    if (!stopped) continue;  // this one has no plan
    const std::string text = answer_text(*stopped, cell), json = io::to_json(*stopped, cell);
    for (const ArmAnswer& arm : stopped->arms)
      EXPECT_EQ(arm.run().min_clearance_status(), Known::kNotMeasured);
    EXPECT_EQ(stopped->pair.nearest_status(), Known::kNotMeasured);
    EXPECT_TRUE(says(text, "clearance between them not measured")) << text;
    EXPECT_TRUE(says(text, "not measured, for time ran out")) << text;
    EXPECT_TRUE(says(json, "\"between_arms_status\": \"not_measured\""));
    return;
  }
  FAIL() << "no workcell has a plan";
}

TEST(Contact, OfAPlannerThatMovesThePlateIsAskedAgain) {
  const auto led_in_base = [](PathProblem problem) {  // else the path goes with the plate
    problem.waypoints = waypoints_in_base(problem);
    problem.path_frame = problem.base_link;
    return problem;
  };
  Planner planner(led_in_base(polishing(0.001, 0.002)));
  int solved = 0, infeasible = 0;
  for (const double lift : {0.0, 0.003, 0.0, -0.002, 0.004, 0.0005}) {
    Pose pose = polishing(0).scene[1].pose;
    pose.translation() += lift * pose.linear().col(2);
    planner.move("plate", pose);
    PathProblem problem = planner.problem();
    const PlanResult again = planner.plan(), fresh = planned(problem);
    EXPECT_EQ(again.status, fresh.status) << lift;
    EXPECT_EQ(again.cost, fresh.cost) << lift;
    (fresh.status == PlanStatus::kSolved ? solved : infeasible) += 1;
  }
  EXPECT_GE(solved, 1);
  EXPECT_GE(infeasible, 1);
  std::printf("%d solved, %d infeasible\n", solved, infeasible);
}

TEST(Contact, OfMotionsIsBoundedAsWell) {
  PathProblem problem = polishing(0.001, 0.002);
  problem.limits.joint_acceleration = std::array<double, kDof>{10, 10, 10, 10, 10, 10, 10};
  problem = with_motion_defaults(problem);
  const PlanResult result = planned(problem);
  ASSERT_EQ(result.status, PlanStatus::kSolved);
  TimingOptions timing;
  timing.speed = 0.05;
  const MotionResult motion =
      time_trajectory(PreparedRobot(problem), problem, result.trajectory, timing);
  ASSERT_TRUE(motion.motion) << (motion.failure ? motion.failure->reason : "");
  EXPECT_TRUE(check_motion(PreparedRobot(problem), problem, motion.motion->rows).passed);
  PathProblem strict = problem;
  for (SceneObject& object : strict.scene)
    if (object.name == "plate") object.allow = {Allowed("disc", 0.0005)};
  EXPECT_FALSE(check_motion(PreparedRobot(strict), strict, motion.motion->rows).passed);
}

TEST(Contact, DepthsThatMeanNothingAreRefused) {
  const auto message = [](const Shape& object, std::optional<double> depth) {
    PathProblem problem = polishing(0.001, depth);
    problem.scene[1].shape = object;
    try {
      static_cast<void>(plan(problem));
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto mesh = [](bool closed) {
    TriangleMesh box;
    for (int k = 0; k < 8; ++k)
      box.vertices.push_back(0.1 * Vector3d(k & 1, k >> 1 & 1, k >> 2 & 1));
    box.triangles = {{0, 2, 1}, {1, 2, 3}};
    box.source = "part.stl";
    box.closed = closed;
    return std::make_shared<const TriangleMesh>(box);
  };
  EXPECT_NE(message(Box{{0.3, 0.4, 0.02}}, 0.0)
                .find("scene[1].allow[0].depth: is 0: allowed is a number > 0"),
            std::string::npos);
  EXPECT_NE(message(Box{{0.3, 0.4, 0.02}}, 0.015).find("at most 0.015 m deep"),
            std::string::npos);  // half of 10 mm, half of 20 mm
  EXPECT_NE(message(MeshPtr(mesh(false)), 0.001).find("part.stl is not closed"), std::string::npos);
  PathProblem problem = polishing(0.001, 0.002);
  problem.attached[1].shape = MeshPtr(mesh(true));
  problem.scene[1].shape = MeshPtr(mesh(true));
  EXPECT_THROW(static_cast<void>(plan(problem)), InvalidArgument);
}

}  // namespace
}  // namespace swivel
