// SPDX-License-Identifier: BSD-3-Clause
// Trajectories and motions that planners made, ways to make them illegal, and ways to change them
// that stay legal. Each mutation proves by itself, or by its size, that what it makes is illegal.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "concatenated.hpp"
#include "motion_problem.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/newton/nearest_allowed_posture.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::test {

/// A trajectory or a motion in time, and the problem that it is to be checked against.
struct Judged {
  std::string what;
  PathProblem problem;
  std::shared_ptr<const PreparedRobot> robot;
  bool timed = false;          ///< else t, v and a of the rows mean nothing
  std::vector<TimedRow> rows;  ///< of a motion as planned: at equal steps of time

  [[nodiscard]] const Chain& chain() const { return robot->arm().chain; }
  [[nodiscard]] const Config& q(std::size_t k) const { return rows[k].row.q; }
  [[nodiscard]] double t(std::size_t k) const { return rows[k].t; }
  [[nodiscard]] JointRates rates() const {
    return joint_rates(chain(), problem.limits, problem.source);
  }
  /// Whether a joint of the chain is one of the robot: not the roll of the tool, which no
  /// controller moves.
  [[nodiscard]] bool is_joint(int j) const { return !chain().roll || j + 1 < kDof; }
};

inline std::vector<TrajectoryRow> rows_of(const Judged& judged) {
  std::vector<TrajectoryRow> rows;
  for (const TimedRow& row : judged.rows) rows.push_back(row.row);
  return rows;
}

/// Checks the rows in memory as `swivel check` checks a file.
inline CheckResult judge(const Judged& judged, const CheckOptions& options = {}) {
  return judged.timed ? check_motion(*judged.robot, judged.problem, judged.rows, options)
                      : check_trajectory(*judged.robot, judged.problem, rows_of(judged), options);
}

/// Plans problems of the data folder and `small_ones` small ones, drawn by the seed, for the
/// project's robots. Returns trajectories as planned, some of them on the path of motions; with
/// `timed`, motions at 20 to 250 samples a second.
inline std::vector<Judged> planned_cases(bool timed, std::uint64_t seed, int small_ones) {
  std::vector<Judged> found;
  const auto add = [&](const std::string& what, const PathProblem& problem, bool as_motion,
                       double rate, bool refined) {
    Judged judged{what, problem, nullptr, timed, {}};
    PlanOptions lazy;
    lazy.planner = PlannerKind::kLazy;
    Planner planner(as_motion ? with_motion_defaults(problem) : problem);
    std::optional<TimingOptions> timing;
    if (as_motion) timing = TimingOptions{.speed = 0.25, .turn_speed = 1.0, .rate = rate};
    const MotionPlan plan = plan_motion(planner, lazy, refined, timing);
    if (plan.result.status != PlanStatus::kSolved || (timed && !plan.motion->motion)) return;
    judged.robot = std::make_shared<const PreparedRobot>(problem);
    if (timed)
      judged.rows = plan.motion->motion->rows;
    else
      for (const TrajectoryRow& row : plan.result.trajectory) judged.rows.push_back({0, row});
    if (judged.rows.size() >= 8) found.push_back(std::move(judged));
  };
  const double rates[] = {20, 125, 50, 250};
  int number = 0;
  for (const char* name : {"iiwa14_bench", "iiwa14_deburr_in_hand", "kr6_weld_pipe",
                           "panda_weld_seam", "ur5e_deburr_edge"}) {
    const PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    add(name, problem, timed || number % 2 == 1, 25, false);
    ++number;
  }
  const std::vector<TestRobot> robots = all_robots();
  for (int trial = 0; trial < small_ones; ++trial) {
    Random random(seed + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        motion_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    // Corners are rounded as motions round them by default, or so little that the tool stops there.
    if (trial % 2 == 0)
      problem.smooth.reset();
    else if (timed)
      problem.smooth = PathSmoothing{1e-6, 1e-6};
    add(problem.source + " " + std::to_string(trial), problem, timed || trial % 3 > 0,
        rates[trial % 4], trial % 2 == 1);
  }
  return found;
}

/// What a file must hold for a mutation to be seen in it.
enum class Column {
  kJoints,  ///< joints and, of motions, times
  kRates,   ///< speeds and accelerations
  kPlace,   ///< s, phi, branch
};

/// Makes a legal trajectory or motion illegal. `mutate` says how, or nothing where this one cannot
/// be made so.
struct MotionMutation {
  std::string name;
  bool of_motions = true, of_trajectories = true;
  Column seen_in = Column::kJoints;
  std::function<std::string(Judged&, Random&)> mutate;
};

namespace detail {

constexpr double kSurely = 1.05;     // so many times what is allowed
constexpr double kAgesOfTime = 1e5;  // s: whatever moves within that moves slowly enough

inline std::string words(const char* format, double value, double allowed = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, value, allowed);
  return text;
}

inline std::size_t some(std::size_t from, std::size_t to, Random& random) {  // from <= k < to
  return from + static_cast<std::size_t>(random.below(static_cast<int>(to - from)));
}

/// Makes row k and all after it later by `by`, s.
inline void delay(Judged& judged, std::size_t k, double by) {
  for (; k < judged.rows.size(); ++k) judged.rows[k].t += by;
}

inline Config speed(const Judged& judged,
                    std::size_t k) {  // of the straight move from row k - 1 to row k
  return (judged.q(k) - judged.q(k - 1)) / (judged.t(k) - judged.t(k - 1));
}

/// Returns the larger of two ratios at row k, at its largest over the joints: the acceleration that
/// changes the speed there within h, s, over the limit; and the jerk that leads to it from the
/// acceleration one row before, over the limit. A controller moves joints straight from row to row.
inline double jolt(const Judged& judged, std::size_t k, double h) {
  if (k < 2 || k + 1 >= judged.rows.size()) return 0;
  const JointRates rates = judged.rates();
  const Config now = (speed(judged, k + 1) - speed(judged, k)) / h,
               before = (speed(judged, k) - speed(judged, k - 1)) / h;
  double most = 0;
  for (int j = 0; j < kDof; ++j)
    if (judged.is_joint(j))
      most = std::max({most, std::abs(now[j]) / rates.acceleration[j],
                       std::abs(now[j] - before[j]) / h / rates.jerk[j]});
  return most;
}

/// Returns a point inside a convex shape.
inline Vector3d inside(const Shape& shape) {
  const auto* mesh = std::get_if<MeshPtr>(&shape);
  if (!mesh) return Vector3d::Zero();
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& vertex : (*mesh)->vertices) sum += vertex;
  return sum / static_cast<double>((*mesh)->vertices.size());
}

/// Returns the row at another posture of its self-motion, where some joint has moved by `far`, rad;
/// nothing where the arm cannot move so far while the tool stands still.
inline std::optional<TimedRow> beside(const Judged& judged, std::size_t k, double far,
                                      Random& random) {
  const Chain& chain = judged.chain();
  const Config& q = judged.q(k);
  const int side = random.below(kDof);
  const double sign = random.coin() ? 1 : -1;
  const auto there = nearest_allowed_posture(chain, q, 20 * far, [&](const Config& other) {
    return (other - q).lpNorm<Eigen::Infinity>() >= far && sign * (other - q)[side] > 0;
  });
  if (!there) return std::nullopt;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double margin = judged.problem.limits.joint_margin + 1e-6;
    if (!limit.continuous &&
        !((*there)[j] > limit.lower + margin && (*there)[j] < limit.upper - margin))
      return std::nullopt;
  }
  TimedRow row = judged.rows[k];
  row.row.q = *there;
  row.v = row.a = Config::Zero();
  if (chain.roll) row.row.phi = (*there)[kDof - 1];
  if (const auto& arm = judged.robot->arm_class().srs) {
    const ArmPlane plane =
        first_plane(*arm, chain.tool(q));  // any plane tells the difference of two arm angles
    row.row.phi +=
        wrap_angle(plane.angle_of(arm->elbow_axis(*there)) - plane.angle_of(arm->elbow_axis(q)));
    row.row.branch = arm->branch(*there);
  }
  return row;
}

/// Returns how far the tool gets, m and rad, on a straight move of the joints between two postures
/// at which it has one and the same pose.
inline std::pair<double, double> sway(const Chain& chain, const Config& from, const Config& to) {
  const Pose at = chain.tool(from);
  std::pair<double, double> most{0, 0};
  for (int part = 1; part < 32; ++part) {
    const Pose tool = chain.tool(from + part / 32. * (to - from));
    most.first = std::max(most.first, (tool.translation() - at.translation()).norm());
    most.second =
        std::max(most.second, Eigen::AngleAxisd(at.linear().transpose() * tool.linear()).angle());
  }
  return most;
}

/// Returns the rows of a motion at which the tool stands at a corner that is not rounded.
inline std::vector<std::size_t> rows_at_corners(const Judged& judged) {
  const ToolPath path = problem_path(with_motion_defaults(judged.problem), judged.chain());
  std::vector<std::size_t> found;
  for (const ToolPath::Corner& corner : path.corners()) {
    if (corner.reach > 0 || judged.chain().tool_may_turn()) continue;
    const Pose& there = path.layer(corner.layer).tool;
    for (std::size_t k = 1; k + 1 < judged.rows.size(); ++k) {
      const Pose tool = judged.chain().tool(judged.q(k));
      if ((tool.translation() - there.translation()).norm() < 1e-6 &&
          (tool.linear() - there.linear()).norm() < 1e-6)
        found.push_back(k);
    }
  }
  return found;
}

/// A swing of the arm to another posture of its self-motion, with time enough: before the first
/// row, after the last, or at a corner, to the posture and back.
struct Swing {
  std::size_t row = 0;  // where the arm rests
  TimedRow other;
};
inline std::optional<Swing> some_swing(const Judged& judged, double far, Random& random) {
  Swing swing{judged.problem.start || random.coin() ? judged.rows.size() - 1 : 0, {}};
  if (const auto corners = rows_at_corners(judged); !corners.empty() && random.coin(0.7))
    swing.row = corners[some(0, corners.size(), random)];
  const auto other = beside(judged, swing.row, far, random);
  if (!other) return std::nullopt;
  swing.other = *other;
  return swing;
}
inline void insert(Judged& judged, Swing swing) {
  const std::size_t k = swing.row, last = judged.rows.size() - 1;
  swing.other.t = judged.t(k) + (k > 0 ? kAgesOfTime : -kAgesOfTime);
  const TimedRow back = judged.rows[k];
  judged.rows.insert(judged.rows.begin() + static_cast<std::ptrdiff_t>(k > 0 ? k + 1 : 0),
                     swing.other);
  if (k == 0 || k == last) return;
  judged.rows.insert(judged.rows.begin() + static_cast<std::ptrdiff_t>(k) + 2, back);
  delay(judged, k + 2, 2 * kAgesOfTime);
}
/// Says whether the arm rests at row k, where a swing begins: it leaves, and comes back, without a
/// jump of its speed.
inline bool can_leave(const Judged& judged, std::size_t k) {
  if (k < 2 || k + 2 >= judged.rows.size()) return true;
  const double h = judged.t(1) - judged.t(0);
  Judged resting = judged;
  resting.rows.insert(resting.rows.begin() + static_cast<std::ptrdiff_t>(k), resting.rows[k]);
  delay(resting, k + 1, kAgesOfTime);
  for (std::size_t i = k - 1; i <= k + 3; ++i)
    if (jolt(resting, i, h) > 0.9) return false;
  return true;
}

/// Widens the limits of the tool's error, so that arms may swing far: what limits a swing then is
/// that nothing may be met on the way.
inline void allow_swings(Judged& judged) {
  judged.problem.limits.tool_path_error = 0.3;
  judged.problem.limits.tool_angle_error = 0.6;
}

/// Says whether the straight move, ends included, keeps `more` clearance, m, than it must.
inline bool is_clear(const Judged& judged, World::Query& query, const Config& from,
                     const Config& to, double more) {
  constexpr int kParts = 64;
  (void)judged;
  for (int part = 0; part <= kParts; ++part)
    if (query.find_violating_pair(from + static_cast<double>(part) / kParts * (to - from),
                                  Threshold(ClearanceRule::kNode, more)))
      return false;
  return true;
}

inline PathProblem as_a_motion(const Judged& judged) {
  return judged.timed ? with_motion_defaults(judged.problem) : judged.problem;
}

/// Says whether the arm keeps 1 mm more clearance than it must, at both postures and at every fifth
/// row.
inline bool is_free_at_ends_and_rows(const Judged& m, World::Query& query, const Config& from,
                                     const Config& to) {
  if (query.find_violating_pair(from, Threshold(ClearanceRule::kNode, 1e-3)) ||
      query.find_violating_pair(to, Threshold(ClearanceRule::kNode, 1e-3)))
    return false;
  bool free_at_rows = true;
  for (std::size_t k = 0; k < m.rows.size() && free_at_rows; k += 5)
    free_at_rows =
        !query.find_violating_pair_incremental(m.q(k), Threshold(ClearanceRule::kNode, 1e-3));
  return free_at_rows;
}

/// Inserts a swing at rest, and a small ball that a body holds inside half way and that nothing
/// meets at the ends of the swing. Returns which body holds it, or nothing where no such ball is
/// found.
inline std::string meet_something_in_a_swing(Judged& m, Random& random) {
  if (m.problem.limits.edges != EdgeMode::kContinuous) return "";
  const auto swing = some_swing(m, random.uniform(0.4, 0.9) * m.problem.limits.joint_step, random);
  if (!swing) return "";
  allow_swings(m);
  const Config &from = m.q(swing->row), &to = swing->other.row.q, middle = (from + to) / 2;
  // A small ball that some body holds inside half way, and neither before nor behind.
  const auto G = m.chain().displacements(middle);
  std::vector<std::size_t> moving;
  const auto& bodies = m.robot->world().bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].group > 0 && std::holds_alternative<Capsule>(bodies[b].shape))
      moving.push_back(b);
  for (int trial = 0; trial < 200 && !moving.empty(); ++trial) {
    const RobotBody& body = bodies[moving[some(0, moving.size(), random)]];
    const auto& capsule = std::get<Capsule>(body.shape);
    const Vector3d in_body = Vector3d(0, 0, random.uniform(-0.5, 0.5) * capsule.length) +
                             random_vector(random, random.uniform(0.8, 0.95) * capsule.radius);
    Pose pose = Pose::Identity();
    pose.translation() = G[static_cast<std::size_t>(body.group)] * (body.pose * in_body);
    Judged other = m;
    other.problem.scene.push_back({"wire", Sphere{0.002}, pose, {}});
    const World world(m.robot->world(), as_a_motion(other));
    World::Query query(world);
    if (!is_free_at_ends_and_rows(m, query, from, to)) continue;
    m = std::move(other);
    insert(m, *swing);
    return "'" + body.name + "' holds it inside half way";
  }
  return "";
}

/// Returns the mutations of the times of rows: gaps, steps that are too short, and disorder.
inline std::vector<MotionMutation> mutations_of_times() {
  return {
      {"gap in time", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const std::size_t k = some(3, m.rows.size() - 1, random);
         const double gap = h * std::pow(10, random.uniform(0.3, 3));
         delay(m, k, gap);
         const double most = std::max(jolt(m, k - 1, h), jolt(m, k, h));
         return most > kSurely
                    ? words("of %.3g s: the speed jumps by %.3g times what can be", gap, most)
                    : "";
       }},
      {"time stands nearly still", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const std::size_t k = some(2, m.rows.size() - 1, random);
         const JointRates rates = m.rates();
         m.rows[k].t = m.t(k - 1) + h * random.uniform(1e-6, 0.3);
         double most = 0;
         for (int j = 0; j < kDof; ++j)
           if (m.is_joint(j))
             most = std::max(
                 most, std::abs(speed(m, k)[j] - speed(m, k - 1)[j]) / h / rates.acceleration[j]);
         return most > kSurely ? words("the speed jumps by %.3g times what can be", most) : "";
       }},
      {"times swapped", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const std::size_t k = some(1, m.rows.size(), random);
         std::swap(m.rows[k].t, m.rows[k - 1].t);
         return "time goes back";
       }},
      {"time stands still", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const std::size_t k = some(1, m.rows.size(), random);
         m.rows[k].t = m.t(k - 1);
         return "two rows at once";
       }},
      {"too fast", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const JointRates rates = m.rates();
         double most = 0;
         for (std::size_t k = 1; k < m.rows.size(); ++k)
           for (int j = 0; j < kDof; ++j)
             if (m.is_joint(j)) most = std::max(most, std::abs(speed(m, k)[j]) / rates.speed[j]);
         if (!(most > 0)) return "";
         const double factor = random.uniform(1.1, 3) / most;
         for (TimedRow& row : m.rows) row.t /= factor, row.v *= factor, row.a *= factor * factor;
         return words("a joint is at %.3g times its speed", most * factor);
       }},
  };
}

/// Returns the mutations that leave rows out.
inline std::vector<MotionMutation> mutations_that_leave_rows_out() {
  return {
      {"row left out, what follows sooner", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const std::size_t k = some(2, m.rows.size() - 2, random);
         m.rows.erase(m.rows.begin() + static_cast<std::ptrdiff_t>(k));
         delay(m, k, -h);
         const double most = std::max(jolt(m, k - 1, h), jolt(m, k, h));
         return most > kSurely ? words("the speed jumps by %.3g times what can be", most) : "";
       }},
      {"rows left out on a bend", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         if (!m.problem.limits.tool_path_error || m.rows.size() < 6) return "";
         const std::size_t a = some(0, m.rows.size() - 3, random),
                           b = some(a + 2, m.rows.size(), random);
         // The middle of the move is far from every pose that was left out, and these lie close
         // together.
         const auto tool = [&](const Config& q) -> Vector3d {
           return m.chain().tool(q).translation();
         };
         const Vector3d middle = tool((m.q(a) + m.q(b)) / 2);
         double least = 1e9, between = 0;
         for (std::size_t k = a; k <= b; ++k) {
           least = std::min(least, (tool(m.q(k)) - middle).norm());
           if (k > a) between = std::max(between, (tool(m.q(k)) - tool(m.q(k - 1))).norm());
         }
         const double off = least - between;
         if (!(off > 1.5 * *m.problem.limits.tool_path_error + 1e-4)) return "";
         m.rows.erase(m.rows.begin() + static_cast<std::ptrdiff_t>(a) + 1,
                      m.rows.begin() + static_cast<std::ptrdiff_t>(b));
         return words("the tool is off by %.3g m, allowed are %.3g", off,
                      *m.problem.limits.tool_path_error);
       }},
      {"beginning or end left out", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const bool end = random.coin();
         const std::size_t k = some(1, m.rows.size() - 2, random);
         const auto tool = [&](std::size_t row) { return m.chain().tool(m.q(row)); };
         const std::size_t kept = end ? m.rows.size() - 1 - k : k,
                           left = end ? m.rows.size() - 1 : 0;
         const double off = (tool(kept).translation() - tool(left).translation()).norm();
         if (!(off > 1e-4)) return "";
         if (end)
           m.rows.resize(kept + 1);
         else
           m.rows.erase(m.rows.begin(), m.rows.begin() + static_cast<std::ptrdiff_t>(k));
         return words("%.3g m of the path are missing", off);
       }},
  };
}

/// Returns the mutations that repeat rows or change their order.
inline std::vector<MotionMutation> mutations_of_order() {
  return {
      {"row doubled", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const std::size_t k = some(0, m.rows.size(), random);
         m.rows.insert(m.rows.begin() + static_cast<std::ptrdiff_t>(k), m.rows[k]);
         return m.timed ? "at the same time" : "the tool rests";
       }},
      {"rest on the way", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const std::size_t k = some(2, m.rows.size() - 1, random);
         m.rows.insert(m.rows.begin() + static_cast<std::ptrdiff_t>(k), m.rows[k]);
         delay(m, k + 1, h * (1 + random.below(20)));
         const double most = jolt(m, k, h);
         return most > kSurely ? words("the speed jumps by %.3g times what can be", most) : "";
       }},
      {"rows swapped", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         if (m.rows.size() < 4) return "";
         const std::size_t k = some(1, m.rows.size() - 2, random);
         const Pose a = m.chain().tool(m.q(k)), b = m.chain().tool(m.q(k + 1));
         const double way = (a.translation() - b.translation()).norm();
         if (!(way > 1e-4)) return "";
         std::swap(m.rows[k].row, m.rows[k + 1].row);
         return words("the tool goes back by %.3g m", way);
       }},
      {"order reversed", true, true, Column::kJoints,
       [](Judged& m, Random&) -> std::string {
         const double end = m.rows.back().t;
         if ((m.chain().tool(m.q(0)).translation() -
              m.chain().tool(m.rows.back().row.q).translation())
                 .norm() < 1e-3)
           return "";
         std::reverse(m.rows.begin(), m.rows.end());
         for (TimedRow& row : m.rows) row.t = end - row.t, row.v = -row.v;
         return "begins at the end";
       }},
  };
}

/// Returns the mutations that move the arm within its self-motion, and those that put a body in
/// its way.
inline std::vector<MotionMutation> mutations_of_self_motion_and_scene() {
  return {
      {"tool sways in a swing at rest", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const auto swing =
             some_swing(m, random.uniform(0.1, 0.9) * m.problem.limits.joint_step, random);
         if (!swing) return "";
         const auto [off, turned] = sway(m.chain(), m.q(swing->row), swing->other.row.q);
         const double allowed = m.problem.limits.tool_path_error.value_or(1e-3);
         if (!(off > 1.5 * allowed + 1e-4)) return "";
         insert(m, *swing);
         return words(swing->row > 0 && swing->row + 2 < m.rows.size()
                          ? "at a corner, by %.3g m, allowed are %.3g"
                          : "by %.3g m, allowed are %.3g",
                      off, allowed);
       }},
      {"something is met in a swing at rest", true, false, Column::kJoints,
       &meet_something_in_a_swing},
      {"row of another posture", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const std::size_t k = some(1, m.rows.size() - 1, random);
         const double far = m.timed ? 0.02 * std::pow(10, random.uniform(0, 2))
                                    : 2.2 * m.problem.limits.joint_step;
         const auto other = beside(m, k, far, random);
         if (!other) return "";
         m.rows[k].row = other->row;
         if (!m.timed)
           return words("a joint moves by %.3g rad, allowed are %.3g", far,
                        2 * m.problem.limits.joint_step);
         const double most = std::max(jolt(m, k - 1, m.t(1) - m.t(0)), jolt(m, k, m.t(1) - m.t(0)));
         return most > kSurely ? words("the speed jumps by %.3g times what can be", most) : "";
       }},
      {"body in the way", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         if (!m.problem.model->has_srdf)
           return "";  // else the pairs that count depend on clearances
         const auto G = m.chain().displacements(m.q(some(0, m.rows.size(), random)));
         const auto& bodies = m.robot->world().bodies();
         const RobotBody& body = bodies[some(0, bodies.size(), random)];
         if (body.group == 0) return "";
         Pose pose = Pose::Identity();
         pose.translation() =
             G[static_cast<std::size_t>(body.group)] * body.pose * inside(body.shape);
         m.problem.scene.push_back({"moved", Sphere{0.001}, pose, {}});
         return "inside '" + body.name + "'";
       }},
  };
}

/// Returns the mutations of joint positions and their limits, and of values that are no numbers.
inline std::vector<MotionMutation> mutations_of_joints() {
  return {
      {"joint beyond its limit", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const int j = random.below(kDof);
         const JointLimit& limit = m.chain().limit[static_cast<std::size_t>(j)];
         if (limit.continuous) return "";
         const double by = std::pow(10, random.uniform(-6, 0));
         m.rows[some(0, m.rows.size(), random)].row.q[j] =
             random.coin() ? limit.upper + by : limit.lower - by;
         return words("by %.3g rad", by);
       }},
      {"limits narrower", true, true, Column::kJoints,
       [](Judged& m, Random&) -> std::string {
         double least = 1e9;
         for (const TimedRow& row : m.rows)
           for (int j = 0; j < kDof; ++j) {
             const JointLimit& limit = m.chain().limit[static_cast<std::size_t>(j)];
             if (!limit.continuous)
               least = std::min({least, row.row.q[j] - limit.lower, limit.upper - row.row.q[j]});
           }
         if (least > 1) return "";
         m.problem.limits.joint_margin = least + 1e-7;
         return "1e-7 rad beyond a limit, allowed are 1e-9";
       }},
      {"tool turned", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         const int j = m.chain().roll ? kDof - 2 : kDof - 1;
         const double by = random.uniform(1e-4, 1e-2);
         m.rows[some(0, m.rows.size(), random)].row.q[j] += by;
         return words("by %.3g rad, allowed are 1e-6", by);
       }},
      {"not a number", true, true, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         TimedRow& row = m.rows[some(0, m.rows.size(), random)];
         const double bad =
             random.coin() ? std::nan("")
                           : std::numeric_limits<double>::infinity() * (random.coin() ? 1 : -1);
         (m.timed && random.coin(0.3) ? row.t : row.row.q[random.below(kDof)]) = bad;
         return "NaN or infinity";
       }},
  };
}

/// Returns the mutations of speeds and accelerations that rows state.
inline std::vector<MotionMutation> mutations_of_rates() {
  return {
      {"not a number among the rates", true, false, Column::kRates,
       [](Judged& m, Random& random) -> std::string {
         const std::size_t ends[] = {0, m.rows.size() - 1, some(0, m.rows.size(), random)};
         TimedRow& row = m.rows[ends[random.below(3)]];
         const double bad =
             random.coin() ? std::nan("")
                           : std::numeric_limits<double>::infinity() * (random.coin() ? 1 : -1);
         (random.coin() ? row.v : row.a)[random.below(kDof)] = bad;
         return "NaN or infinity";
       }},
      {"speed falsified at an end", true, false, Column::kRates,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const int j = random.below(kDof);
         if (!m.is_joint(j)) return "";
         const double by =
             (2.1 * m.rates().acceleration[j] * h + 1e-3) * std::pow(10, random.uniform(0, 4));
         (random.coin() ? m.rows.front() : m.rows.back()).v[j] += random.coin() ? by : -by;
         return words("by %.3g rad/s, more than it can change in two rows", by);
       }},
      {"acceleration falsified at an end", true, false, Column::kRates,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const int j = random.below(kDof);
         if (!m.is_joint(j)) return "";
         const double by = (2.1 * m.rates().jerk[j] * h + 0.1) * std::pow(10, random.uniform(0, 4));
         (random.coin() ? m.rows.front() : m.rows.back()).a[j] += random.coin() ? by : -by;
         return words("by %.3g rad/s^2, more than it can change in two rows", by);
       }},
      {"rates falsified on the way", true, false, Column::kRates,
       [](Judged& m, Random& random) -> std::string {
         const double h = m.t(1) - m.t(0);
         const int j = random.below(kDof);
         if (!m.is_joint(j)) return "";
         TimedRow& row = m.rows[some(1, m.rows.size() - 1, random)];
         const bool of_speed = random.coin();
         const double more = std::pow(10, random.uniform(0, 3));
         if (of_speed)
           row.v[j] += (2.1 * m.rates().acceleration[j] * h + 1e-3) * more;
         else
           row.a[j] -= (2.1 * m.rates().jerk[j] * h + 0.1) * more;
         return of_speed ? "a speed" : "an acceleration";
       }},
  };
}

/// Returns the mutations of s, phi and branch that rows state.
inline std::vector<MotionMutation> mutations_of_places() {
  return {
      {"place falsified", true, true, Column::kPlace,
       [](Judged& m, Random& random) -> std::string {
         TrajectoryRow& row = m.rows[some(0, m.rows.size(), random)].row;
         const auto& srs = m.robot->arm_class().srs;
         switch (random.below(3)) {
           case 0:
             if (m.chain().tool_may_turn()) return "";
             row.s += random.coin() ? 1e-3 : -1e-3;
             return "s by 1e-3 m";
           case 1:
             if (!srs && !m.chain().roll) return "";
             row.phi += random.coin() ? 0.02 : -0.02;
             return "phi by 0.02 rad, allowed are 0.001";
           default:
             if (!srs || std::abs(std::sin(srs->elbow_angle(row.q))) < 0.06) return "";
             row.branch ^= kElbowBit;
             return "branch";
         }
       }},
      {"place is no number", true, true, Column::kPlace,
       [](Judged& m, Random& random) -> std::string {
         TrajectoryRow& row = m.rows[some(0, m.rows.size(), random)].row;
         double* const value[] = {&row.s, &row.phi};
         *value[random.below(2)] =
             random.coin() ? std::nan("") : std::numeric_limits<double>::infinity();
         return "NaN or infinity";
       }},
  };
}

/// Returns the mutation of the pace of a motion: slow for most rows, then as planned.
inline std::vector<MotionMutation> mutations_of_pace() {
  return {
      {"crawls, then goes on", true, false, Column::kJoints,
       [](Judged& m, Random& random) -> std::string {
         // More than half of the rows stand far apart in time, so that the median of all steps is a
         // long one.
         const double h = m.t(1) - m.t(0), begin = m.t(0), factor = random.uniform(30, 300);
         const std::size_t k = some(m.rows.size() / 2 + 2, m.rows.size() - 2, random);
         const double shift = (m.t(k) - begin) * (factor - 1);
         for (std::size_t i = 0; i < m.rows.size(); ++i) {
           TimedRow& row = m.rows[i];
           row.t = i <= k ? begin + (row.t - begin) * factor : row.t + shift;
           if (i <= k) row.v /= factor, row.a /= factor * factor;
         }
         const double most = jolt(m, k, h);
         return most > kSurely ? words("the speed jumps by %.3g times what can be", most) : "";
       }},
  };
}

}  // namespace detail

/// Returns all mutations, in a fixed order.
inline const std::vector<MotionMutation>& motion_mutations() {
  using namespace detail;
  static const std::vector<MotionMutation> all = concatenated({
      mutations_of_times(),
      mutations_that_leave_rows_out(),
      mutations_of_order(),
      mutations_of_self_motion_and_scene(),
      mutations_of_joints(),
      mutations_of_rates(),
      mutations_of_places(),
      mutations_of_pace(),
  });
  return all;
}

/// Changes a legal trajectory or motion so that it stays legal. `change` says how, or nothing where
/// this one cannot be changed so.
struct LegalChange {
  std::string name;
  bool of_motions = true, of_trajectories = true;
  std::function<std::string(Judged&, Random&)> change;
};

namespace detail {

/// Returns the legal changes of times and whole turns of joints, and one that changes nothing.
inline std::vector<LegalChange> legal_changes_of_times_and_turns() {
  return {
      {"none", true, true, [](Judged&, Random&) -> std::string { return "as planned"; }},
      {"slower", true, false,
       [](Judged& m, Random& random) -> std::string {
         const double factor = 1 + random.uniform(0, 1) * random.uniform(0, 5);
         for (TimedRow& row : m.rows) row.t *= factor, row.v /= factor, row.a /= factor * factor;
         return words("by %.3g", factor);
       }},
      {"later", true, false,
       [](Judged& m, Random& random) -> std::string {
         const double by = random.uniform(-1, 1) * std::pow(10, random.uniform(0, 4));
         delay(m, 0, by);
         return words("by %.3g s", by);
       }},
      {"times of whole nanoseconds", true, false,
       [](Judged& m, Random&) -> std::string {
         for (TimedRow& row : m.rows) row.t = std::round(row.t * 1e9) / 1e9;
         return "as messages state them";
       }},
      {"rests longer at its end", true, false,
       [](Judged& m, Random& random) -> std::string {
         TimedRow last = m.rows.back();
         last.v = last.a = Config::Zero();
         double by = 0;
         for (int more = 1 + random.below(4); more > 0; --more) {
           by = random.coin() ? m.t(1) - m.t(0) : random.uniform(1e-3, 10);
           last.t += by;
           m.rows.push_back(last);
         }
         return words("the last time by %.3g s", by);
       }},
      {"whole turns", true, true,
       [](Judged& m, Random& random) -> std::string {
         bool turned = false;
         for (int j = 0; j < kDof; ++j) {
           if (!m.chain().limit[static_cast<std::size_t>(j)].continuous || m.problem.start ||
               !m.is_joint(j))
             continue;
           const double turns = kTwoPi * (random.below(7) - 3);
           for (TimedRow& row : m.rows) row.row.q[j] += turns;
           turned = turned || turns != 0;
         }
         return turned ? "of continuous joints" : "";
       }},
  };
}

/// Returns the legal swings of the arm at rest.
inline std::vector<LegalChange> legal_swings() {
  return {
      {"small swing at rest", true, false,
       [](Judged& m, Random& random) -> std::string {
         if (m.chain().tool_may_turn()) return "";
         const auto swing = some_swing(m, random.uniform(0.01, 0.1), random);
         if (!swing || !can_leave(m, swing->row)) return "";
         const auto [off, turned] = sway(m.chain(), m.q(swing->row), swing->other.row.q);
         if (off > 0.5 * m.problem.limits.tool_path_error.value_or(1e-3) ||
             turned > 0.5 * m.problem.limits.tool_angle_error.value_or(0.02))
           return "";
         const World world(m.robot->world(), as_a_motion(m));
         World::Query query(world);
         if (!is_clear(m, query, m.q(swing->row), swing->other.row.q, 2e-3)) return "";
         insert(m, *swing);
         return words(swing->row > 0 && swing->row + 2 < m.rows.size()
                          ? "at a corner, the tool sways by %.3g m"
                          : "the tool sways by %.3g m",
                      off);
       }},
      {"large swing at rest", true, false,
       [](Judged& m, Random& random) -> std::string {
         if (m.chain().tool_may_turn()) return "";
         const auto swing =
             some_swing(m, random.uniform(0.3, 0.9) * m.problem.limits.joint_step, random);
         if (!swing || !can_leave(m, swing->row) ||
             (swing->other.row.q - m.q(swing->row)).lpNorm<Eigen::Infinity>() >
                 0.95 * m.problem.limits.joint_step)
           return "";
         allow_swings(m);
         const auto [off, turned] = sway(m.chain(), m.q(swing->row), swing->other.row.q);
         if (off > 0.25 || turned > 0.5) return "";
         const World world(m.robot->world(), as_a_motion(m));
         World::Query query(world);
         if (!is_clear(m, query, m.q(swing->row), swing->other.row.q, 4e-3)) return "";
         insert(m, *swing);
         return words(swing->row > 0 && swing->row + 2 < m.rows.size()
                          ? "at a corner, the tool sways by %.3g m, which is allowed"
                          : "the tool sways by %.3g m, which is allowed",
                      off);
       }},
  };
}

/// Returns the legal change that leaves a row out.
inline std::vector<LegalChange> legal_omissions() {
  return {
      {"row left out where the speed is steady", true, false,
       [](Judged& m, Random& random) -> std::string {
         if (m.rows.size() < 12) return "";
         const double h = m.t(1) - m.t(0);
         const std::size_t k = some(4, m.rows.size() - 5, random);
         const Config from = m.q(k - 1), to = m.q(k + 1);
         m.rows.erase(m.rows.begin() + static_cast<std::ptrdiff_t>(k));
         for (std::size_t i = k - 3; i <= k + 2; ++i)
           if (jolt(m, i, h) > 0.95) return "";
         const World world(m.robot->world(), as_a_motion(m));
         World::Query query(world);
         if (!is_clear(m, query, from, to, 2e-3) || sway(m.chain(), from, to).first > 0.1)
           return "";
         const Pose middle = m.chain().tool((from + to) / 2), a = m.chain().tool(from),
                    b = m.chain().tool(to);
         if ((middle.translation() - (a.translation() + b.translation()) / 2).norm() > 1e-4)
           return "";
         return "joints go straight over two steps";
       }},
  };
}

}  // namespace detail

/// Returns all legal changes, in a fixed order.
inline const std::vector<LegalChange>& legal_changes() {
  using namespace detail;
  static const std::vector<LegalChange> all = concatenated({
      legal_changes_of_times_and_turns(),
      legal_swings(),
      legal_omissions(),
  });
  return all;
}

}  // namespace swivel::test
