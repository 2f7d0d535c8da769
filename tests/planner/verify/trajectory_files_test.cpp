// SPDX-License-Identifier: BSD-3-Clause
// Trajectories and motions that went through files of every format that is read: what is legal
// passes the check, what is not fails, whether the file states s, arm angle, branch, roll and rates
// or the joints alone.
#include <gtest/gtest.h>

#include <sstream>

#include "../../io/io_support.hpp"
#include "motion_mutations.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/verify/complete_rows.hpp"

namespace swivel {
namespace {

using namespace test;
using io::test::TempFolder;

/// A way to write rows, and what can be seen in it: s, phi and branch; accelerations; the roll that
/// is an arm's last joint.
struct Format {
  const char* name;
  bool timed, places, rates, roll;
};
constexpr Format kFormats[] = {
    {"trajectory.csv", false, true, false, true},   {"s_and_joints.csv", false, false, false, true},
    {"joints.csv", false, false, false, true},      {"motion.csv", true, true, true, true},
    {"t_and_joints.csv", true, false, false, true}, {"motion.json", true, false, true, false},
    {"motion.yaml", true, false, true, false},      {"motion.mcap", true, false, false, false},
};

/// Columns by name, the last joint first.
std::string by_name(const std::vector<TimedRow>& rows, const io::JointNames& names, bool t,
                    bool s) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t j = kDof; j-- > 0;) text << names[j] << (j > 0 ? "," : "");
  text << (t ? ",t" : "") << (s ? ",s" : "");
  for (const TimedRow& row : rows) {
    text << '\n';
    for (int j = kDof; j-- > 0;) text << row.row.q[j] << (j > 0 ? "," : "");
    if (t) text << ',' << row.t;
    if (s) text << ',' << row.row.s;
  }
  return text.str() + '\n';
}

std::string text_of(const Format& format, const Judged& judged) {
  const io::JointNames& names = judged.chain().joint_names;
  const std::string name = format.name;
  PlanResult plan;
  plan.joint_names = names;
  plan.trajectory = rows_of(judged);
  if (name == "trajectory.csv") return io::to_csv(plan);
  if (name == "s_and_joints.csv") return by_name(judged.rows, names, false, true);
  if (name == "joints.csv") return by_name(judged.rows, names, false, false);
  if (name == "t_and_joints.csv") return by_name(judged.rows, names, true, false);
  TimedPath motion;
  motion.rows = judged.rows;
  motion.roll = judged.chain().roll;
  return io::motion_text(motion, names, "base", name);
}

/// Judges the file as `check` does; a refused file counts as failed.
CheckResult judge_file(const Format& format, const Judged& judged, const TempFolder& folder,
                       const CheckOptions& options = {}) {
  CheckResult result;
  try {
    const io::TrajectoryFile file = io::load_trajectory_file(
        folder.write(format.name, text_of(format, judged)), judged.chain().joint_names);
    EXPECT_EQ(file.timed.empty(), !judged.timed);
    if (judged.timed)
      return check_motion(*judged.robot, judged.problem,
                          complete_motion(*judged.robot, judged.problem, file.timed, file.stated),
                          options);
    return check_trajectory(*judged.robot, judged.problem,
                            complete_rows(*judged.robot, judged.problem, file.rows, file.stated),
                            options);
  } catch (const InputError& error) {
    result.failures = {error.what()};
    return result;
  }
}

std::string first_of(const CheckResult& check) {
  return check.failures.empty() ? "" : check.failures[0];
}

const std::vector<Judged>& cases(bool timed) {
  static const std::uint64_t base = seed("TrajectoryFiles");
  // Short ones: every file is written, read and checked a thousand times.
  const auto short_ones = [](bool with_time) {
    std::vector<Judged> all = planned_cases(with_time, base, 24);
    std::erase_if(all, [](const Judged& judged) { return judged.rows.size() > 150; });
    return all;
  };
  static const std::vector<Judged> trajectories = short_ones(false), motions = short_ones(true);
  return timed ? motions : trajectories;
}

/// What a planner found passes through every format; joints keep their bits, and what is worked out
/// is what the planner said.
TEST(TrajectoryFiles, PassAsTheyWereWritten) {
  const TempFolder folder;
  int passed = 0, rolls = 0, others = 0;
  for (const Format& format : kFormats)
    for (const Judged& judged : cases(format.timed)) {
      const std::string what = std::string(format.name) + ": " + judged.what;
      const auto& names = judged.chain().joint_names;
      const io::TrajectoryFile file =
          io::load_trajectory_file(folder.write(format.name, text_of(format, judged)), names);
      ASSERT_EQ(file.rows.size(), judged.rows.size()) << what;
      const PathProblem of_motions = with_motion_defaults(judged.problem);
      std::vector<TrajectoryRow> rows = file.rows;
      if (!judged.timed) rows = complete_rows(*judged.robot, judged.problem, rows, file.stated);
      if (judged.timed) {
        rows.clear();
        for (const TimedRow& row :
             complete_motion(*judged.robot, judged.problem, file.timed, file.stated))
          rows.push_back(row.row);
      }
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const TrajectoryRow &row = rows[k], &planned = judged.rows[k].row;
        const std::string where = what + ", row " + std::to_string(k);
        // The roll of an arm of six joints is counted from the path's own frames and back.
        const bool whole = file.stated.last_joint && !judged.robot->arm().chain.roll;
        const Eigen::Index joints = whole ? kDof : kDof - 1;
        ASSERT_EQ(row.q.head(joints), planned.q.head(joints)) << where;
        ASSERT_NEAR(row.s, planned.s, 1e-6) << where;
        ASSERT_NEAR(wrap_angle(row.roll - planned.roll), 0, 1e-6) << where;
        ASSERT_NEAR(wrap_angle(row.q[kDof - 1] - planned.q[kDof - 1]), 0, 1e-6) << where;
        const auto& arm = judged.robot->arm_class().srs;
        ASSERT_TRUE(!(arm || judged.chain().roll) ||
                    std::abs(wrap_angle(row.phi - planned.phi)) <= 1e-3)
            << where;
        ASSERT_TRUE(!arm || is_of_branch(*arm, planned.q, row.branch)) << where;
      }
      const CheckResult check = judge_file(format, judged, folder, {.margins = false}),
                        before = judge(judged);
      EXPECT_TRUE(check.passed) << what << ": " << first_of(check);
      EXPECT_NEAR(check.cost, before.cost, 1e-6) << what;
      passed += check.passed;
      rolls += judged.chain().tool_may_turn();
      others += !judged.robot->arm_class().srs;
    }
  std::printf("%d files, %d of tools that may turn, %d of arms that are not S-R-S\n", passed, rolls,
              others);
  EXPECT_GE(passed, 80);
  EXPECT_GE(rolls, 8);
  EXPECT_GE(others, 8);
}

/// Whether a format can hold what has changed: messages hold neither times that are no numbers nor
/// an arm's roll.
bool is_in_file(const Format& format, const Judged& before, const Judged& after) {
  for (const TimedRow& row : after.rows)
    if (!std::isfinite(row.t)) return false;
  if (format.roll || !after.chain().roll || before.rows.size() != after.rows.size()) return true;
  bool same = true, same_roll = true;
  for (std::size_t k = 0; k < after.rows.size(); ++k) {
    const TimedRow &a = before.rows[k], &b = after.rows[k];
    same = same && a.t == b.t;
    for (const auto& [one, other] :
         {std::pair(&a.row.q, &b.row.q), std::pair(&a.v, &b.v), std::pair(&a.a, &b.a)}) {
      same = same && one->head<kDof - 1>() == other->head<kDof - 1>();
      same_roll = same_roll && (*one)[kDof - 1] == (*other)[kDof - 1];
    }
  }
  return same_roll || !same;
}

/// In each format as many motions and trajectories that were made illegal fail, or are refused.
TEST(TrajectoryFiles, MutatedOnesFailInEveryFormat) {
  const std::uint64_t base = seed("TrajectoryFiles.Mutated");
  const TempFolder folder;
  const int each = trials(1000);
  for (const Format& format : kFormats) {
    const auto& good = cases(format.timed);
    std::vector<const MotionMutation*> kinds;
    for (const MotionMutation& mutation : motion_mutations())
      if ((format.timed ? mutation.of_motions : mutation.of_trajectories) &&
          (mutation.seen_in == Column::kJoints ||
           (mutation.seen_in == Column::kRates ? format.rates : format.places)))
        kinds.push_back(&mutation);
    int done = 0, refused = 0;
    for (int trial = 0; done < each && trial < 100 * each; ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial));
      const MotionMutation& mutation = *kinds[static_cast<std::size_t>(trial) % kinds.size()];
      const Judged& before =
          good[static_cast<std::size_t>(random.below(static_cast<int>(good.size())))];
      Judged bad = before;
      const std::string words = mutation.mutate(bad, random);
      if (words.empty() || !is_in_file(format, before, bad)) continue;
      ++done;
      const CheckResult result = judge_file(format, bad, folder, {.margins = false});
      EXPECT_FALSE(result.passed) << format.name << ": " << mutation.name << " (" << words << "), "
                                  << bad.what << ", trial " << trial;
      EXPECT_FALSE(result.failures.empty());
      refused += result.failure_count == 0;
    }
    std::printf("%s: %d of %zu kinds fail, %d of them refused as they are read\n", format.name,
                done, kinds.size(), refused);
    EXPECT_EQ(done, each) << format.name;
  }
}

/// What stays legal passes in every format.
TEST(TrajectoryFiles, LegalOnesPassInEveryFormat) {
  const std::uint64_t base = seed("TrajectoryFiles.Legal");
  const TempFolder folder;
  const int each = trials(300);
  for (const Format& format : kFormats) {
    const auto& good = cases(format.timed);
    int done = 0;
    for (int trial = 0; done < each && trial < 100 * each; ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial));
      const LegalChange& change =
          legal_changes()[static_cast<std::size_t>(trial) % legal_changes().size()];
      if (!(format.timed ? change.of_motions : change.of_trajectories)) continue;
      Judged other = good[static_cast<std::size_t>(random.below(static_cast<int>(good.size())))];
      const std::string words = change.change(other, random);
      if (words.empty()) continue;
      ++done;
      const CheckResult result = judge_file(format, other, folder, {.margins = false});
      EXPECT_TRUE(result.passed) << format.name << ": " << change.name << " (" << words << "), "
                                 << other.what << ", trial " << trial << ": " << first_of(result);
    }
    std::printf("%s: %d pass\n", format.name, done);
    EXPECT_EQ(done, each) << format.name;
  }
}

/// A path through these offsets from a pose well inside the limits of the iiwa14, and turns about
/// the tool's x axis.
struct Planned {
  PathProblem problem;
  std::shared_ptr<const PreparedRobot> robot;
  std::vector<TrajectoryRow> rows;
};
Planned along(const std::vector<std::pair<Vector3d, double>>& steps) {
  Planned planned{problem_for(data_robot("iiwa14")), nullptr, {}};
  Config q{0.2, 0.6, 0.1, -1.2, 0.2, 0.9, 0.3};
  const Chain chain = build_arm(*planned.problem.model, planned.problem.base_link,
                                planned.problem.tip_link, {}, Pose::Identity())
                          .chain;
  planned.problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  for (const auto& [by, turn] : steps) {
    Waypoint to = planned.problem.waypoints.back();
    to.position += by;
    to.orientation = to.orientation * Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitX()));
    planned.problem.waypoints.push_back(to);
  }
  planned.problem.resolution = {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1};
  planned.robot = std::make_shared<const PreparedRobot>(planned.problem);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  planned.rows = plan(*planned.robot, planned.problem, options).trajectory;
  EXPECT_FALSE(planned.rows.empty());
  return planned;
}
std::vector<TrajectoryRow> joints_alone(const std::vector<TrajectoryRow>& rows) {
  std::vector<TrajectoryRow> alone(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) alone[k].q = rows[k].q;
  return alone;
}
constexpr Stated kJointsAlone{.s = false,
                              .phi = false,
                              .branch = false,
                              .roll = false,
                              .last_joint = true,
                              .v = false,
                              .a = false};

/// Paths that come back to where they were: rows are matched to places in the order of the path.
TEST(CompleteRows, PathsThatMeetThemselves) {
  const Vector3d x = 0.04 * Vector3d::UnitX(), y = 0.04 * Vector3d::UnitY(), o = Vector3d::Zero();
  const std::vector<std::pair<const char*, std::vector<std::pair<Vector3d, double>>>> paths = {
      {"closed", {{x, 0}, {y, 0}, {-x, 0}, {-y, 0}}},
      {"there and back", {{x, 0}, {-x, 0}}},
      {"three times", {{x, 0}, {-x, 0}, {x, 0}, {-x, 0}, {x, 0}}},
      {"twice round", {{x, 0}, {y, 0}, {-x, 0}, {-y, 0}, {x, 0}, {y, 0}, {-x, 0}, {-y, 0}}},
      {"turning there and back", {{x, 0}, {o, 0.3}, {o, -0.3}, {x, 0}}},
      {"turning at the ends", {{o, 0.3}, {x, -0.2}, {o, 0.4}}},
      {"crossing itself", {{2 * x, 0}, {y, 0}, {-x, 0}, {-2 * y, 0}}},
  };
  for (const auto& [name, steps] : paths) {
    const Planned planned = along(steps);
    ASSERT_FALSE(planned.rows.empty()) << name;
    const auto rows =
        complete_rows(*planned.robot, planned.problem, joints_alone(planned.rows), kJointsAlone);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      EXPECT_NEAR(rows[k].s, planned.rows[k].s, 1e-9) << name << ", row " << k;
      EXPECT_NEAR(wrap_angle(rows[k].phi - planned.rows[k].phi), 0, 1e-6) << name << ", row " << k;
      EXPECT_EQ(rows[k].branch, planned.rows[k].branch) << name << ", row " << k;
    }
    const CheckResult check = check_trajectory(*planned.robot, planned.problem, rows);
    EXPECT_TRUE(check.passed) << name << ": " << first_of(check);
    // A motion along it rests and goes slowly at its corners.
    TimingOptions timing;
    timing.speed = 0.1;
    timing.turn_speed = 0.5;
    const MotionResult timed =
        time_trajectory(*planned.robot, planned.problem, planned.rows, timing);
    ASSERT_TRUE(timed.motion) << name << ": " << timed.failure->reason;
    std::vector<TimedRow> motion = timed.motion->rows;
    for (TimedRow& row : motion) row = {row.t, {.q = row.row.q}};
    motion = complete_motion(*planned.robot, planned.problem, motion, kJointsAlone);
    for (std::size_t k = 0; k < motion.size();
         ++k)  // about a turning back the tool has each pose twice
      EXPECT_NEAR(motion[k].row.s, timed.motion->rows[k].row.s, 5e-5) << name << ", sample " << k;
    const CheckResult of_motion =
        check_motion(*planned.robot, planned.problem, motion, {.margins = false});
    EXPECT_TRUE(of_motion.passed) << name << ": " << first_of(of_motion);
  }
}

/// A row off the path gets the nearest s between its neighbours, and the check says how far off it
/// is.
TEST(CompleteRows, RowsOffThePathAreNamed) {
  const Planned planned = along({{{0.05, 0, 0}, 0}, {{0, 0.05, 0}, 0.2}});
  for (const std::size_t k : {std::size_t{0}, std::size_t{3}, planned.rows.size() - 1}) {
    auto rows = joints_alone(planned.rows);
    rows[k].q[3] += 1e-3;
    rows = complete_rows(*planned.robot, planned.problem, rows, kJointsAlone);
    EXPECT_NEAR(rows[k].s, planned.rows[k].s, 2e-3);
    const CheckResult check = check_trajectory(*planned.robot, planned.problem, rows);
    ASSERT_EQ(check.failure_count, 1) << first_of(check);
    EXPECT_TRUE(check.failures[0].starts_with("row " + std::to_string(k) + ": the tool is "))
        << check.failures[0];
    EXPECT_THROW((void)rows_at_layers(*planned.robot, planned.problem, rows, {}), InputError);
  }
  // Two rows swapped: one of them is out of order.
  auto rows = joints_alone(planned.rows);
  std::swap(rows[3].q, rows[4].q);
  rows = complete_rows(*planned.robot, planned.problem, rows, kJointsAlone);
  const CheckResult check = check_trajectory(*planned.robot, planned.problem, rows);
  EXPECT_FALSE(check.passed);
  EXPECT_NE(first_of(check).find("goes back"), std::string::npos) << first_of(check);
}

/// Rows anywhere on the path become rows at its layers, of which a motion is made.
TEST(RowsAtLayers, OfOtherRowsMakeMotions) {
  const Planned planned = along({{{0.08, 0, 0}, 0.1}, {{0, 0.08, 0}, 0.2}});
  const auto same = rows_at_layers(*planned.robot, planned.problem, planned.rows, {});
  ASSERT_EQ(same.size(), planned.rows.size());
  for (std::size_t k = 0; k < same.size(); ++k) EXPECT_EQ(same[k].q, planned.rows[k].q);
  TimingOptions timing;
  timing.speed = 0.1;
  for (const double ds : {0.004, 0.0123, 0.03}) {
    PathProblem other = planned.problem;
    other.resolution.ds = ds;
    const auto rows =
        rows_at_layers(*planned.robot, other, joints_alone(planned.rows), kJointsAlone);
    const CheckResult check = check_trajectory(*planned.robot, other, rows);
    EXPECT_TRUE(check.passed) << ds << ": " << first_of(check);
    const MotionResult timed = time_trajectory(*planned.robot, other, rows, timing);
    ASSERT_TRUE(timed.motion) << ds << ": " << timed.failure->reason;
    // Layers are found in the rows of a motion as well, whose path is rounded.
    std::vector<TrajectoryRow> samples;
    for (const TimedRow& row : timed.motion->rows) samples.push_back({.q = row.row.q});
    const PathProblem rounded = with_motion_defaults(planned.problem);
    const auto again = rows_at_layers(*planned.robot, rounded, samples, kJointsAlone);
    EXPECT_EQ(again.size(), planned.rows.size());
    EXPECT_TRUE(check_trajectory(*planned.robot, rounded, again).passed) << ds;
  }
  auto half = planned.rows;
  half.resize(half.size() / 2);
  EXPECT_THROW((void)rows_at_layers(*planned.robot, planned.problem, half, {}), InputError);
}

}  // namespace
}  // namespace swivel
