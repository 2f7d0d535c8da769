// SPDX-License-Identifier: BSD-3-Clause
// Arms of six joints whose tool must stand as the waypoints have it: all solutions of each pose, in
// all turns of the joints, held against a plain program of its own inverse kinematics.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arms.hpp"
#include "planners.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr int kJoints = 6;
constexpr double kNone = std::numeric_limits<double>::infinity();

/// Arms whose wrist axes do not meet: none has a closed form.
std::vector<ArmTable> offset_wrists_6r() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  const auto v = arm_tables::v;
  return {
      // Fanuc's CRX has its wrist like this.
      {"offset-wrist",
       {{v(0, 0, 0.245), o, z, -3.1, 3.1},
        {o, o, y, -3.1, 3.1},
        {v(0, 0, 0.54), o, -y, -4.7, 4.7},
        {v(0.15, 0, 0), o, -x, -3.3, 3.3},
        {v(0.39, 0, 0), o, -y, -3.1, 3.1},
        {v(0.08, 0.15, 0), o, -x, -3.9, 3.9}},
       v(0.1, 0.02, 0.05),
       v(0, 1.1, 0.3)},
      {"skew-wrist",
       {{v(0, 0, 0.3), o, z, -3.1, 3.1},
        {v(0.05, 0, 0), o, y, -2.5, 2.5},
        {v(0, 0, 0.4), v(0, 0, 0.2), y, -2.5, 2.5},
        {v(0.05, 0.04, 0.1), v(0.3, 0, 0), x, -3.1, 3.1},
        {v(0.35, 0, 0.05), v(0, 0.2, 0), y, -2.1, 2.1},
        {v(0.07, 0.03, 0), o, x, -6.2, 6.2}},
       v(0.1, 0, 0.05),
       v(0, 0.8, 0)},
      // Three axes nearly parallel, as of a UR, but by 6 degrees.
      {"skew-shoulder",
       {{v(0, 0, 0.18), o, z, -3.1, 3.1},
        {v(0, 0.1, 0), v(0.1, 0, 0), y, -3.1, 3.1},
        {v(0.5, -0.05, 0), v(0, 0, 0.1), y, -2.8, 2.8},
        {v(0.45, 0, 0), v(0.1, 0, 0), y, -3.1, 3.1},
        {v(0, 0.12, 0), o, -z, -3.1, 3.1},
        {v(0, 0, -0.12), o, y, -6.2, 6.2}},
       v(0, 0.11, 0.03),
       v(-1.07, 0, 0)},
  };
}

/// The plain inverse kinematics: Newton with differences of forward kinematics, from many starts.
class PlainIk {
 public:
  explicit PlainIk(const Chain& chain) : chain_(chain) {}
  /// Moves q onto a tool pose. Returns false where Newton does not arrive.
  bool solve(const Pose& tool, Config& q) const {
    constexpr double kStep = 1e-6;
    for (int step = 0; step < 40; ++step) {
      const Vector6 miss = error(tool, q);
      if (miss.norm() < 1e-9) return true;
      Vector6 move = jacobian(tool, q, kStep).fullPivLu().solve(miss);
      if (!move.allFinite()) return false;
      if (move.norm() > 0.5) move *= 0.5 / move.norm();
      q.head<kJoints>() += move;
    }
    return false;
  }
  /// Returns the distinct solutions that starts lead to, joints in (-pi, pi].
  [[nodiscard]] std::vector<Config> solutions(const Pose& tool, const std::vector<Config>& near,
                                              int starts, Random& random) const {
    std::vector<Config> found;
    const auto add = [&](const Config& start) {
      Config q = start;
      if (!solve(tool, q)) return;
      for (int j = 0; j < kJoints; ++j) q[j] = wrap_angle(q[j]);
      if (std::none_of(found.begin(), found.end(), [&](const Config& other) {
            for (int j = 0; j < kJoints; ++j)
              if (std::abs(wrap_angle(q[j] - other[j])) > 1e-5) return false;
            return true;
          }))
        found.push_back(q);
    };
    for (const Config& q : near) add(q);
    for (int k = 0; k < starts; ++k) {
      Config q;
      for (int j = 0; j < kJoints; ++j) q[j] = random.uniform(-kPi, kPi);
      add(q);
    }
    return found;
  }

 private:
  using Vector6 = Eigen::Matrix<double, kJoints, 1>;
  [[nodiscard]] Vector6 error(const Pose& tool, const Config& q) const {
    const Pose here = chain_.tool(q);
    const Eigen::AngleAxisd turn(tool.linear() * here.linear().transpose());
    Vector6 miss;
    miss << tool.translation() - here.translation(), turn.angle() * turn.axis();
    return miss;
  }
  [[nodiscard]] Eigen::Matrix<double, kJoints, kJoints> jacobian(const Pose& tool, const Config& q,
                                                                 double step) const {
    Eigen::Matrix<double, kJoints, kJoints> J;
    for (int j = 0; j < kJoints; ++j) {
      Config more = q, less = q;
      more[j] += step, less[j] -= step;
      J.col(j) = (error(tool, less) - error(tool, more)) / (2 * step);
    }
    return J;
  }

  const Chain& chain_;
};

/// Returns whether a step of a path may lead from joints a to b, by tolerances that are `wider`
/// times those of the problem.
bool may_follow(const Chain& chain, const ToolPath& path, const PathProblem& problem, int layer,
                const Config& a, const Config& b, double wider) {
  constexpr int kMoments = 24;
  if (!((b - a).cwiseAbs().maxCoeff() <= wider * problem.limits.joint_step)) return false;
  const Pose &from = path.layer(layer).tool, &to = path.layer(layer + 1).tool;
  const Vector3d way = to.translation() - from.translation();
  for (int k = 1; k < kMoments; ++k) {
    const Pose tool = chain.tool(a + (static_cast<double>(k) / kMoments) * (b - a));
    const Vector3d off = tool.translation() - from.translation();
    const double t = std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((off - t * way).norm() > wider * *problem.limits.tool_path_error) return false;
  }
  return true;
}

/// One path of a plain program: its layers, and all solutions of each in all turns.
struct PlainPath {
  ToolPath path;
  std::vector<std::vector<Config>> nodes;
};

/// Runs the dynamic program over a path. `costs`: the least cost up to each node of the first
/// layer; becomes that up to each node of the last one.
void run_through(const Chain& chain, const PathProblem& problem, const PlainPath& plain,
                 double wider, std::vector<double>& costs) {
  for (std::size_t i = 1; i < plain.nodes.size(); ++i) {
    std::vector<double> next(plain.nodes[i].size(), kNone);
    for (std::size_t b = 0; b < next.size(); ++b)
      for (std::size_t a = 0; a < costs.size(); ++a) {
        const Config &from = plain.nodes[i - 1][a], &to = plain.nodes[i][b];
        const double cost = costs[a] + (to - from).norm();
        if (cost < next[b] &&
            may_follow(chain, plain.path, problem, static_cast<int>(i) - 1, from, to, wider))
          next[b] = cost;
      }
    costs = std::move(next);
  }
}

/// Returns the least cost of paths one after the other, between which joints move straight.
double plain_cost(const Chain& chain, const PathProblem& problem,
                  const std::vector<PlainPath>& paths, double wider) {
  std::vector<double> costs(paths.front().nodes.front().size(), 0);
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (k > 0) {
      const std::vector<Config>&last = paths[k - 1].nodes.back(), &first = paths[k].nodes.front();
      std::vector<double> next(first.size(), kNone);
      for (std::size_t b = 0; b < first.size(); ++b)
        for (std::size_t a = 0; a < last.size(); ++a)
          next[b] = std::min(next[b], costs[a] + (first[b] - last[a]).norm());
      costs = std::move(next);
    }
    run_through(chain, problem, paths[k], wider, costs);
  }
  return costs.empty() ? kNone : *std::min_element(costs.begin(), costs.end());
}

/// Returns all images of solutions that are within the limits.
std::vector<Config> in_all_turns(const Chain& chain, const std::vector<Config>& solutions) {
  std::vector<Config> all;
  for (const Config& solution : solutions) {
    std::vector<Config> images{solution};
    for (int j = 0; j < kJoints; ++j) {
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
      std::vector<Config> next;
      for (const Config& image : images)
        for (const double turns : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
          Config turned = image;
          turned[j] += turns * kTwoPi;
          if (turned[j] >= limit.lower && turned[j] <= limit.upper) next.push_back(turned);
        }
      images = std::move(next);
    }
    all.insert(all.end(), images.begin(), images.end());
  }
  return all;
}

/// Returns waypoints on an arc of a circle that begins at a pose, along which the tool turns.
std::vector<Waypoint> circle_from(const Pose& first, Random& random) {
  constexpr int kParts = 8;
  const double radius = random.uniform(0.05, 0.2), angle = random.uniform(0.3, 1.5),
               turn = random.uniform(-0.5, 0.5);
  const Matrix3d axes = Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1),
                                    random.uniform(-1, 1), random.uniform(-1, 1))
                            .normalized()
                            .toRotationMatrix();
  std::vector<Waypoint> waypoints;
  for (int k = 0; k <= kParts; ++k) {
    const double t = angle * k / kParts;
    Pose pose = first;
    pose.translation() += radius * ((std::cos(t) - 1) * axes.col(0) + std::sin(t) * axes.col(1));
    pose.linear() =
        Eigen::AngleAxisd(turn * k / kParts, axes.col(2)).toRotationMatrix() * first.linear();
    waypoints.push_back(waypoint_of(pose));
  }
  return waypoints;
}

PathProblem random_path(const ArmTable& table, Random& random) {
  PathProblem problem;
  auto model = std::make_shared<RobotModel>(
      model_of(table, table.joints, urdf_pose(table.tip_xyz, table.tip_rpy)));
  problem.base_link = "base", problem.tip_link = model->links.back().name;
  problem.model = std::move(model);
  problem.source = table.name;
  const Chain chain =
      build_arm(*problem.model, "base", problem.tip_link, {}, Pose::Identity()).chain;
  Config q;
  for (int j = 0; j < kJoints; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    q[j] = random.uniform(std::max(-kPi, limit.lower), std::min(kPi, limit.upper));
  }
  // A third are arcs of circles, the others lines and corners.
  const int waypoints = 1 + random.below(4);
  if (waypoints == 1) problem.waypoints = circle_from(chain.tool(q), random);
  for (int k = 0; waypoints > 1 && k < waypoints; ++k) {
    const Pose tool = chain.tool(q);
    problem.waypoints.push_back({tool.translation(), Quaterniond(tool.linear())});
    for (int j = 0; j < kJoints; ++j) q[j] += random.uniform(-0.25, 0.25);
  }
  problem.limits.joint_step = random.uniform(0.3, 1.2);
  problem.limits.tool_path_error = std::exp(random.uniform(std::log(0.004), std::log(0.05)));
  problem.resolution.ds = random.uniform(0.02, 0.06);
  problem.resolution.dalpha = 0.3;
  return problem;
}

/// Returns a problem's path with all solutions of each layer.
PlainPath plain_path(const Chain& chain, const PathProblem& problem, Random& random) {
  PlainPath plain{problem_path(problem, chain), {}};
  const PlainIk ik(chain);
  std::vector<Config> before;
  for (int i = 0; i < plain.path.size(); ++i) {
    before = ik.solutions(plain.path.layer(i).tool, before, i == 0 ? 400 : 60, random);
    plain.nodes.push_back(in_all_turns(chain, before));
  }
  return plain;
}

/// Counts the random paths and jobs by what they have.
struct PlainCounts {
  int solved = 0, none = 0, sampled = 0;
  std::size_t nodes = 0;
};

/// Expects the verdict and the cost of the plain program, whose cost is `tight` with tolerances a
/// little narrower than the problem's, and `wide` with wider ones.
void expect_plain(PlanStatus status, double cost, double tight, double wide,
                  const std::string& what) {
  if (status != PlanStatus::kSolved) {
    ASSERT_EQ(status, PlanStatus::kInfeasible) << what;
    ASSERT_TRUE(std::isinf(tight)) << what << ": none, the plain program's costs " << tight;
    return;
  }
  ASSERT_LE(cost, tight + 1e-6) << what;
  ASSERT_GE(cost, wide - 1e-6) << what;
}

TEST(FixedPose, EqualsAPlainProgramOfAllSolutions) {
  Random random(seed("FixedPose.EqualsAPlainProgramOfAllSolutions"));
  const std::vector<ArmTable> tables = concatenated({arms_6r(), offset_wrists_6r()});
  PlainCounts counts;
  const int count = trials(200);
  for (int trial = 0; trial < count; ++trial) {
    const ArmTable& table = tables[static_cast<std::size_t>(trial) % tables.size()];
    const std::string what = "trial " + std::to_string(trial) + ", " + table.name;
    const PathProblem problem = random_path(table, random);
    const PreparedRobot robot(problem);
    const Chain& chain = robot.arm().chain;
    ASSERT_TRUE(chain.roll_fixed && !robot.arm_class().redundant) << what;
    counts.sampled += !robot.arm_class().complete();
    const std::vector<PlainPath> plain{plain_path(chain, problem, random)};
    for (const auto& layer : plain.front().nodes) counts.nodes += layer.size();
    const double tight = plain_cost(chain, problem, plain, 1 - 1e-3),
                 wide = plain_cost(chain, problem, plain, 1 + 1e-3);
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options;
      options.planner = planner;
      options.check = true;
      const PlanResult result = plan(robot, problem, options);
      expect_plain(result.status, result.cost, tight, wide, what);
      if (::testing::Test::HasFatalFailure()) return;
      if (result.status != PlanStatus::kSolved) continue;
      ASSERT_EQ(static_cast<int>(result.trajectory.size()), plain.front().path.size()) << what;
      for (const TrajectoryRow& row : result.trajectory) ASSERT_EQ(row.q[kJoints], 0) << what;
      const CheckResult check = check_trajectory(robot, problem, result.trajectory);
      ASSERT_TRUE(check.passed) << what << ": "
                                << (check.failures.empty() ? "" : check.failures[0]);
      ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
    }
    ++(std::isinf(tight) ? counts.none : counts.solved);
  }
  std::printf(
      "%d paths: %d solved, %d without a path, %d of arms without a closed form, %zu nodes\n",
      count, counts.solved, counts.none, counts.sampled, counts.nodes);
  EXPECT_GE(counts.solved, at_least(60));
  EXPECT_GE(counts.none, at_least(10));
  EXPECT_GE(counts.sampled, at_least(30));
}

/// Two or three strokes in their order: the solution of each is chosen with the ways between them.
TEST(FixedPose, JobsEqualAPlainProgram) {
  Random random(seed("FixedPose.JobsEqualAPlainProgram"));
  const std::vector<ArmTable> tables = concatenated({arms_6r(), offset_wrists_6r()});
  PlainCounts counts;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const ArmTable& table = tables[static_cast<std::size_t>(trial) % tables.size()];
    const std::string what = "trial " + std::to_string(trial) + ", " + table.name;
    PathProblem problem = random_path(table, random);
    problem.limits.joint_step = std::max(0.6, problem.limits.joint_step);
    const PreparedRobot robot(problem);
    const Chain& chain = robot.arm().chain;
    counts.sampled += !robot.arm_class().complete();
    Problem job;
    job.source = problem.source;
    static_cast<Robot&>(job.arm()) = problem;
    job.arm().transition_limits = problem.limits;
    std::vector<PlainPath> plain;
    for (int k = 0; k < 2 + random.below(2); ++k) {
      PathProblem one = problem;
      one.waypoints = random_path(table, random).waypoints;
      Stroke& stroke = job.arm().strokes.emplace_back();
      static_cast<Task&>(stroke) = one;
      stroke.name = "stroke " + std::to_string(k);
      plain.push_back(plain_path(chain, one, random));
    }
    const double tight = plain_cost(chain, problem, plain, 1 - 1e-3),
                 wide = plain_cost(chain, problem, plain, 1 + 1e-3);
    const Answer answer = plan_job(robot, job);
    expect_plain(answer.status, answer.cost, tight, wide, what);
    if (::testing::Test::HasFatalFailure()) return;
    if (answer.status == PlanStatus::kSolved)
      ASSERT_TRUE(check_job(robot, job, answer.arm().parts).passed) << what;
    ++(std::isinf(tight) ? counts.none : counts.solved);
  }
  std::printf("%d jobs: %d solved, %d without one, %d of arms without a closed form\n", count,
              counts.solved, counts.none, counts.sampled);
  EXPECT_GE(counts.solved, at_least(30));
  EXPECT_GE(counts.sampled, at_least(8));
}

/// Motions of answers keep speeds, accelerations and jerks by differences of their samples.
TEST(FixedPose, MotionsKeepTheRatesOfJoints) {
  Random random(seed("FixedPose.MotionsKeepTheRatesOfJoints"));
  const std::vector<ArmTable> tables = concatenated({arms_6r(), offset_wrists_6r()});
  constexpr double kSpeed = 1.5, kAcceleration = 6, kJerk = 60, kRate = 250;
  int timed = 0, plans = 0;
  double most = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    PathProblem problem =
        random_path(tables[static_cast<std::size_t>(trial) % tables.size()], random);
    problem.limits.joint_speed.emplace().fill(kSpeed);
    problem.limits.joint_acceleration.emplace().fill(kAcceleration);
    problem.limits.joint_jerk.emplace().fill(kJerk);
    const PreparedRobot robot(problem);
    const PlanResult result = plan(robot, problem);
    if (result.status != PlanStatus::kSolved) continue;
    ++plans;
    TimingOptions options;
    options.speed = 0.1, options.rate = kRate;
    const MotionResult motion = time_trajectory(robot, problem, result.trajectory, options);
    if (!motion.motion) continue;
    ++timed;
    const std::vector<TimedRow>& rows = motion.motion->rows;
    const auto at = [&](std::ptrdiff_t k) -> const Config& {  // at rest before and after
      return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(rows) - 1))]
          .row.q;
    };
    for (std::ptrdiff_t k = 0; k + 1 < std::ssize(rows); ++k) {
      const Config v = kRate * (at(k + 1) - at(k)), before = kRate * (at(k) - at(k - 1)),
                   first = kRate * (at(k - 1) - at(k - 2));
      most = std::max({most, v.cwiseAbs().maxCoeff() / kSpeed,
                       kRate * (v - before).cwiseAbs().maxCoeff() / kAcceleration,
                       kRate * kRate * (v - 2 * before + first).cwiseAbs().maxCoeff() / kJerk});
    }
  }
  std::printf("%d of %d plans in time, rates at most %.4f of what joints can do\n", timed, plans,
              most);
  EXPECT_GE(timed, at_least(20));
  EXPECT_LE(most, 1 + 1e-3);
}

/// A straight path through a singular pose, at parameter 0 of -1 to 1, and joints along it.
struct SingularPath {
  Pose middle = Pose::Identity();
  Vector3d way, turn;           ///< of the whole half, m and rad
  std::vector<Config> witness;  ///< at even parameters from -1 to 1
  [[nodiscard]] Pose at(double t) const {
    Pose pose = middle;
    pose.translation() += t * way;
    if (const double angle = turn.norm(); angle > 0)
      pose.linear() = Eigen::AngleAxisd(t * angle, turn / angle).toRotationMatrix() * pose.linear();
    return pose;
  }
};

/// Returns a configuration at which the arm is singular, between two random ones; none where the
/// determinant of the Jacobian has one sign at both.
std::optional<Config> random_singular(const Chain& chain, Random& random) {
  const auto determinant = [&](const Config& q) {
    return chain.jacobian(q).leftCols<kJoints>().determinant();
  };
  Config low, high;
  for (int j = 0; j < kJoints; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double from = std::max(-kPi, limit.lower + 0.3), to = std::min(kPi, limit.upper - 0.3);
    low[j] = random.uniform(from, to),
    high[j] = std::clamp(low[j] + random.uniform(-1, 1), from, to);
  }
  const bool rises = determinant(low) < 0;
  if (rises == (determinant(high) < 0)) return std::nullopt;
  for (int step = 0; step < 60; ++step) {
    const Config middle = (low + high) / 2;
    ((determinant(middle) < 0) == rises ? low : high) = middle;
  }
  return low;
}

/// Returns a path that leads through a singular pose of the arm, with joints that follow it by
/// continuation; none where they do not.
std::optional<SingularPath> random_singular_path(const Chain& chain, Random& random) {
  constexpr int kHalf = 400;  // points of the witness on either side
  const auto singular = random_singular(chain, random);
  if (!singular) return std::nullopt;
  const Eigen::Matrix<double, 6, kJoints> J = chain.jacobian(*singular).leftCols<kJoints>();
  const Eigen::JacobiSVD<Eigen::Matrix<double, 6, kJoints>> svd(J, Eigen::ComputeFullV);
  if (svd.singularValues()[kJoints - 2] < 0.02) return std::nullopt;  // singular in two ways
  Config null, along;
  null.head<kJoints>() = svd.matrixV().col(kJoints - 1);
  for (int j = 0; j < kJoints; ++j) along[j] = random.uniform(-0.4, 0.4);
  const Eigen::Matrix<double, 6, 1> twist = J * along.head<kJoints>();
  SingularPath path{chain.tool(*singular), twist.head<3>(), twist.tail<3>(), {}};
  const PlainIk ik(chain);
  constexpr double kStep = 1.0 / kHalf;
  for (double more = -4; more <= 4; more += 0.25) {
    const Config direction = along + more * null;
    Config ahead = *singular + kStep * direction;
    if (!ik.solve(path.at(kStep), ahead)) continue;
    Config back = 2 * *singular - ahead;
    if (!ik.solve(path.at(-kStep), back)) continue;
    if ((ahead + back - 2 * *singular).norm() > 0.02 * (ahead - *singular).norm()) continue;
    std::vector<Config> forwards{*singular, ahead}, backwards{*singular, back};
    const auto follow = [&](std::vector<Config>& side, double sign) {
      while (static_cast<int>(side.size()) <= kHalf) {
        Config q = 2 * side.back() - side[side.size() - 2];
        const Config guess = q;
        if (!ik.solve(path.at(sign * kStep * static_cast<double>(side.size())), q)) return false;
        if ((q - guess).norm() > 0.02) return false;
        side.push_back(q);
      }
      return true;
    };
    if (!follow(forwards, 1) || !follow(backwards, -1)) continue;
    path.witness.assign(backwards.rbegin(), backwards.rend());
    path.witness.insert(path.witness.end(), forwards.begin() + 1, forwards.end());
    const bool inside = std::all_of(path.witness.begin(), path.witness.end(), [&](const Config& q) {
      for (int j = 0; j < kJoints; ++j) {
        const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
        if (!(q[j] > limit.lower + 1e-3 && q[j] < limit.upper - 1e-3)) return false;
      }
      return true;
    });
    if (inside) return path;
  }
  return std::nullopt;
}

/// What the witness of a path costs, and its largest move of a joint, rad.
struct Following {
  double cost = 0, most = 0;
};

/// Returns what the witness does at the layers of a problem's path; none where it does not follow
/// the path by moves of half of what is allowed.
std::optional<Following> following(const PreparedRobot& robot, const PathProblem& problem,
                                   const SingularPath& path) {
  const Chain& chain = robot.arm().chain;
  const ToolPath layers = problem_path(problem, chain);
  std::vector<TrajectoryRow> rows;
  Following made;
  for (int i = 0; i < layers.size(); ++i) {
    const double share = layers.layer(i).travel / layers.layer(layers.size() - 1).travel;
    Config q = path.witness[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(path.witness.size() - 1)))];
    if (std::abs(share - 0.5) > 1e-9) PlainIk(chain).solve(layers.layer(i).tool, q);
    if (i > 0) {
      const Config move = q - rows.back().q;
      made.cost += move.norm();
      made.most = std::max(made.most, move.cwiseAbs().maxCoeff());
    }
    rows.push_back({layers.layer(i).s, 0, arc_branch(chain, robot.arm_class().lock, q), q});
  }
  PathProblem strict = problem;
  strict.limits.joint_step /= 2, *strict.limits.tool_path_error /= 2;
  *strict.limits.tool_angle_error /= 2;
  strict.start.reset();
  if (!check_trajectory(robot, strict, rows).passed) return std::nullopt;
  return made;
}

/// Counts plans of paths through singular poses.
struct SingularCounts {
  int paths = 0, plans = 0, on = 0, started = 0, turning = 0, unsolved = 0, dear = 0;
};

/// Plans a path that a witness follows: the fixed tool must pass, also with steps that are hardly
/// longer than those of the witness; a tool that may turn a little or as it likes need not turn.
void pass(const PreparedRobot& robot, const PathProblem& problem, const Following& witness,
          const std::string& what, SingularCounts& counts) {
  const double cost = witness.cost;
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.check = true;
  const PlanResult result = plan(robot, problem, options);
  ASSERT_EQ(result.status, PlanStatus::kSolved)
      << what << ": " << (result.diagnosis ? words(result.diagnosis->cause) : "");
  ASSERT_LE(result.cost, 1.1 * cost) << what;
  ASSERT_TRUE(check_trajectory(robot, problem, result.trajectory).passed) << what;
  PathProblem tight = problem;
  tight.limits.joint_step = 1.25 * witness.most;
  const PlanResult short_steps = plan(robot, tight, options);
  ASSERT_EQ(short_steps.status, PlanStatus::kSolved)
      << what
      << ", short steps: " << (short_steps.diagnosis ? words(short_steps.diagnosis->cause) : "");
  ASSERT_LE(short_steps.cost, 1.02 * cost) << what;
  ++counts.plans;
  counts.started += problem.start.has_value();
  counts.on += result.trajectory.size() % 2;
  for (const Roll& roll : {Roll{-1e-3, 1e-3}, Roll{}}) {
    PathProblem turning = problem;
    turning.roll = roll;
    const PlanResult turned = plan(turning, options);
    ++counts.turning;
    counts.unsolved += turned.status != PlanStatus::kSolved;
    counts.dear += turned.status == PlanStatus::kSolved && turned.cost > 1.1 * cost;
  }
}

TEST(FixedPose, PassesSingularPosesAsContinuationDoes) {
  Random random(seed("FixedPose.PassesSingularPosesAsContinuationDoes"));
  const std::vector<ArmTable> tables = arms_6r();
  const int count = trials(60);
  SingularCounts counts;
  for (int trial = 0; counts.paths < count; ++trial) {
    const ArmTable& table = tables[static_cast<std::size_t>(trial) % tables.size()];
    PathProblem problem = random_path(table, random);
    const PreparedRobot robot(problem);
    const auto path = random_singular_path(robot.arm().chain, random);
    if (!path) continue;
    ++counts.paths;
    problem.waypoints = {waypoint_of(path->at(-1)), waypoint_of(path->at(1))};
    problem.limits.joint_step = 0.5;
    problem.limits.tool_path_error = 0.002, problem.limits.tool_angle_error = 0.02;
    const double half = std::max(path->way.norm(), path->turn.norm() * 0.05);
    // Odd numbers of layers have one on the singular pose.
    for (const double parts : {20.0, 25.0, 39.7, 50.0}) {
      problem.resolution.ds = 2 * half / parts;
      problem.resolution.dalpha = 20 * problem.resolution.ds;
      for (const bool given : {false, true}) {
        problem.start.reset();
        if (given) problem.start = path->witness.front();
        const auto witness = following(robot, problem, *path);
        if (!witness) continue;
        pass(robot, problem, *witness,
             "trial " + std::to_string(trial) + ", " + table.name +
                 formatted(", %.0f parts", parts) + (given ? ", from a start" : ""),
             counts);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
  std::printf(
      "%d paths through singular poses: %d plans, %d with a layer in the middle, %d from a "
      "start; %d of tools that may turn: %d without a path, %d dearer by over a tenth\n",
      counts.paths, counts.plans, counts.on, counts.started, counts.turning, counts.unsolved,
      counts.dear);
  EXPECT_GE(counts.plans, at_least(150));
  EXPECT_GE(counts.on, at_least(60));
  EXPECT_GE(counts.started, at_least(60));
  EXPECT_LE(counts.unsolved, counts.turning / 12);
  EXPECT_LE(counts.dear, counts.turning / 8);
}

}  // namespace
}  // namespace swivel
