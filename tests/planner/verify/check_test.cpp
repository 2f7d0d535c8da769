// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include "concatenated.hpp"
#include "inner_posture.hpp"
#include "plain_edge_rule.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {
namespace {

using namespace test;

/// The iiwa14 as a vendor might round it: up to 0.2 mm and 1 mrad off, so that its closed form must
/// be corrected on the exact chain.
TestRobot rounded_robot() {
  TestRobot robot = data_robot("iiwa14");
  auto model = std::make_shared<RobotModel>(*robot.model);
  Random random(7);
  for (Joint& joint : model->joints) {
    if (!joint.movable()) continue;
    const auto direction = [&] {
      return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
          .normalized();
    };
    joint.origin.translation() += 0.2e-3 * direction();
    joint.axis = (joint.axis + 1e-3 * direction()).normalized();
  }
  robot.model = model;
  robot.name = "rounded";
  return robot;
}

/// A trajectory that a planner found. A row's place on the path is its layer's number; rows between
/// layers have places between.
struct Good {
  std::string what;
  PathProblem problem;
  std::shared_ptr<const PreparedRobot> robot;
  std::shared_ptr<const ToolPath> path;
  std::vector<ArmPlane> planes;
  std::vector<TrajectoryRow> rows;

  [[nodiscard]] const Chain& chain() const { return robot->arm().chain; }
  [[nodiscard]] Pose pose(double place) const {
    const int layer = std::min(static_cast<int>(place), path->size() - 2);
    return path->at(layer, place - layer);
  }
};

/// Returns the largest path_deviation or angle_deviation over all moves of the rows.
template <class Deviation>
double largest(const Good& good, const Deviation& deviation) {
  double most = 0;
  for (std::size_t k = 1; k < good.rows.size(); ++k)
    for (const double error : deviation(good.chain(), *good.path, static_cast<int>(k) - 1,
                                        good.rows[k - 1].q, good.rows[k].q - good.rows[k - 1].q))
      most = std::max(most, error);
  return most;
}

std::optional<Good> solved(const std::string& what, const PathProblem& problem) {
  Good good{what, problem, std::make_shared<PreparedRobot>(problem), nullptr, {}, {}};
  good.path =
      std::make_shared<ToolPath>(waypoints_in_base(problem), problem.resolution, problem.source);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  good.rows = plan(*good.robot, problem, options).trajectory;
  if (good.rows.empty()) return std::nullopt;
  for (int i = 0; i < good.path->size(); ++i) {
    const Pose& tool = good.path->layer(i).tool;
    good.planes.push_back(i == 0 ? first_plane(good.robot->srs(), tool)
                                 : carry_plane(good.robot->srs(), good.planes.back(), tool));
  }
  return good;
}

Waypoint moved(const Waypoint& from, const Vector3d& by, const Vector3d& turn) {
  Waypoint to = from;
  to.position += by;
  if (turn.norm() > 0)
    to.orientation =
        to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  return to;
}

/// Three to five waypoints from a pose well inside the limits, straight and turning; every third
/// path turns on the spot once.
PathProblem some_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  const Config q = inner_posture(chain, random);
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  const int more = 2 + random.below(3),
            on_the_spot = random.below(3) == 0 ? random.below(more) : -1;
  for (int k = 0; k < more; ++k)
    problem.waypoints.push_back(moved(
        problem.waypoints.back(),
        k == on_the_spot ? Vector3d::Zero() : random_vector(random, random.uniform(0.04, 0.1)),
        random_vector(random, random.uniform(0.2, 0.5))));
  problem.resolution = {.ds = 0.01, .dphi = 0.2, .dalpha = 0.1};
  problem.limits.clearance = 0.002;
  problem.scene.push_back(
      {"ball",
       Sphere{0.05},
       random_config(chain, random).norm() > 0 ? chain.tool(random_config(chain, random)) : Pose(),
       {}});
  return problem;
}

/// Trajectories of seeded problems, of one robot after the other; solved once for all tests.
const std::vector<Good>& good_trajectories() {
  static const std::vector<Good> all = [] {
    std::vector<Good> found;
    const std::uint64_t base = seed("Check");
    std::vector<TestRobot> robots = all_robots();
    robots.push_back(rounded_robot());
    for (std::size_t r = 0; r < robots.size(); ++r)
      for (int trial = 0, left = 4; left > 0 && trial < 60; ++trial) {
        Random random(base + 1000 * r + static_cast<std::uint64_t>(trial));
        auto good =
            solved(robots[r].name + " " + std::to_string(trial), some_problem(robots[r], random));
        if (!good) continue;
        found.push_back(*good);
        --left;
      }
    return found;
  }();
  return all;
}

std::string first(const CheckResult& result) {
  return result.failures.empty() ? "no failure" : result.failures[0];
}

TEST(Check, PlannersTrajectoriesPass) {
  std::size_t rows = 0, inexact = 0;
  std::set<std::string> robots;
  for (const Good& good : good_trajectories()) {
    const CheckResult result = check_trajectory(*good.robot, good.problem, good.rows);
    EXPECT_TRUE(result.passed) << good.what << ": " << first(result);
    const CheckResult verdict =
        check_trajectory(*good.robot, good.problem, good.rows, {.margins = false});
    EXPECT_TRUE(verdict.passed) << good.what << ": " << first(verdict);
    EXPECT_EQ(verdict.rows_examined, result.rows_examined) << good.what;
    EXPECT_EQ(result.rows_examined, static_cast<std::int64_t>(good.rows.size())) << good.what;
    EXPECT_EQ(result.moves_examined, static_cast<std::int64_t>(good.rows.size()) - 1) << good.what;
    rows += good.rows.size();
    inexact += !good.robot->srs().exact;
    robots.insert(good.problem.source);
  }
  std::printf("%zu trajectories of %zu robots, %zu rows, %zu inexact\n", good_trajectories().size(),
              robots.size(), rows, inexact);
  EXPECT_GE(good_trajectories().size(), 20u);
  EXPECT_GE(robots.size(), 6u);
  EXPECT_GE(inexact, 3u);
}

/// Samples of a joint-linear move and of the path between two places: how far each is from the
/// nearest of the other, at most. Knows nothing of monotone matching. Position alone; or position
/// and angle as a share of what is given, whichever is larger.
double deviation(const Good& good, const Config& from, const Config& to, double begin, double end,
                 double position, double angle) {
  constexpr int kTool = 60;
  const int path_samples = std::max(60, static_cast<int>(30 * (end - begin)));
  std::vector<Pose> tool, path;
  for (int k = 0; k <= kTool; ++k)
    tool.push_back(good.chain().tool(from + static_cast<double>(k) / kTool * (to - from)));
  for (int k = 0; k <= path_samples; ++k)
    path.push_back(good.pose(begin + (end - begin) * k / path_samples));
  for (int layer = static_cast<int>(begin) + 1; layer < end; ++layer)
    path.push_back(good.path->layer(layer).tool);
  double worst = 0;
  const auto all_near = [&](const std::vector<Pose>& poses, const std::vector<Pose>& others) {
    for (const Pose& pose : poses) {
      double least = 1e9;
      for (const Pose& other : others) {
        const double turned =
            2 * std::asin(std::min(1.0, (pose.linear() - other.linear()).norm() / std::sqrt(8.0)));
        least = std::min(
            least,
            std::max((pose.translation() - other.translation()).norm() / position, turned / angle));
      }
      worst = std::max(worst, least);
    }
  };
  all_near(tool, path);
  all_near(path, tool);
  return worst;
}

double largest_move(const Good& good) {
  double most = 0;
  for (std::size_t k = 1; k < good.rows.size(); ++k)
    most = std::max(most, (good.rows[k].q - good.rows[k - 1].q).lpNorm<Eigen::Infinity>());
  return most;
}

/// A point inside a convex shape.
Vector3d centre(const Shape& shape) {
  const auto* mesh = std::get_if<MeshPtr>(&shape);
  if (!mesh) return Vector3d::Zero();
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& vertex : (*mesh)->vertices) sum += vertex;
  return sum / static_cast<double>((*mesh)->vertices.size());
}

/// Breaks one rule of a good trajectory, by an amount that the returned words state. No words:
/// nothing to break here.
using Mutation = std::function<std::string(Good&, Random&)>;

std::string amount(const char* format, double value) {
  char text[160];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

using NamedMutation = std::pair<std::string, Mutation>;

/// Draws the index of a row.
std::size_t some_row(const Good& good, Random& random) {
  return static_cast<std::size_t>(random.below(static_cast<int>(good.rows.size())));
}

/// Returns the mutations that leave rows out, reorder or repeat them, and those that turn joints
/// around.
std::vector<NamedMutation> mutations_of_order_and_turns() {
  return {
      {"stretch cut out",
       [](Good& good, Random& random) -> std::string {
         const int n = static_cast<int>(good.rows.size());
         for (int trial = 0; trial < 20; ++trial) {
           const int a = random.below(n - 2), b = std::min(n - 1, a + 3 + random.below(n));
           const double off = deviation(good, good.rows[static_cast<std::size_t>(a)].q,
                                        good.rows[static_cast<std::size_t>(b)].q, a, b, 1, 1e9);
           if (off < 1.5e-3) continue;
           good.rows.erase(good.rows.begin() + a + 1, good.rows.begin() + b);
           return amount("off by %.3g m, allowed is 1e-3", off);
         }
         return "";
       }},
      {"order reversed",
       [](Good& good, Random&) -> std::string {
         std::reverse(good.rows.begin(), good.rows.end());
         return "ends at the beginning";
       }},
      {"rows swapped",
       [](Good& good, Random& random) -> std::string {
         const std::size_t k = some_row(good, random);
         if (k + 2 >= good.rows.size() || k == 0) return "";
         std::swap(good.rows[k], good.rows[k + 1]);
         return "comes back by a step";
       }},
      {"row doubled",
       [](Good& good, Random& random) -> std::string {
         const std::size_t k = some_row(good, random);
         good.rows.insert(good.rows.begin() + static_cast<std::ptrdiff_t>(k), good.rows[k]);
         return "rests";
       }},
      {"joint moved by 2 pi",
       [](Good& good, Random& random) -> std::string {
         good.rows[some_row(good, random)].q[random.below(kDof)] +=
             random.coin() ? kTwoPi : -kTwoPi;
         return "a joint moves by 2 pi less or plus 0.5 rad, allowed is 0.5";
       }},
      {"continuous joints spinning",
       [](Good& good, Random& random) -> std::string {
         const std::size_t k = some_row(good, random);
         const int j = random.below(kDof), turns = (1 + random.below(4)) * (random.coin() ? 1 : -1);
         if (k == 0 || !good.chain().limit[static_cast<std::size_t>(j)].continuous) return "";
         for (std::size_t i = k; i < good.rows.size(); ++i) good.rows[i].q[j] += turns * kTwoPi;
         return amount("a joint moves by %.0f turns in a step", turns);
       }},
  };
}

/// Returns the mutations of the values of one row, and one that leaves out a row at an end.
std::vector<NamedMutation> mutations_of_row_values() {
  return {
      {"s",
       [](Good& good, Random& random) -> std::string {
         good.rows[some_row(good, random)].s += random.coin() ? 1e-5 : -1e-5;
         return "1e-5 m along the path, allowed are 1e-6";
       }},
      {"phi",
       [](Good& good, Random& random) -> std::string {
         good.rows[some_row(good, random)].phi += random.coin() ? 0.02 : -0.02;
         return "0.02 rad, allowed are 0.001";
       }},
      {"branch",
       [](Good& good, Random& random) -> std::string {
         TrajectoryRow& row = good.rows[some_row(good, random)];
         const SrsArm& arm = good.robot->srs();
         const double angles[] = {arm.shoulder_angle(row.q), arm.wrist_angle(row.q),
                                  arm.elbow_angle(row.q)};
         const int bit = random.below(3);
         if (std::abs(std::sin(angles[bit])) < 0.06) return "";
         row.branch ^= 1 << bit;
         return amount("sine %.3g of the other sign", std::sin(angles[bit]));
       }},
      {"tool turned",
       [](Good& good, Random& random) -> std::string {
         const double by = random.uniform(1e-5, 1e-2);
         good.rows[some_row(good, random)].q[6] += by;
         return amount("by %.3g rad, allowed are 1e-6", by);
       }},
      {"ends missing",
       [](Good& good, Random& random) -> std::string {
         if (random.coin())
           good.rows.erase(good.rows.begin());
         else
           good.rows.pop_back();
         return "a step is missing";
       }},
      {"not a number",
       [](Good& good, Random& random) -> std::string {
         TrajectoryRow& row = good.rows[some_row(good, random)];
         double* const value[] = {&row.s, &row.phi, &row.q[random.below(kDof)]};
         *value[random.below(3)] =
             random.coin() ? std::nan("") : std::numeric_limits<double>::infinity();
         return "NaN or infinity";
       }},
  };
}

/// Returns the mutations that narrow limits of the joints.
std::vector<NamedMutation> mutations_of_joint_limits() {
  return {
      {"joint_margin",
       [](Good& good, Random&) -> std::string {
         double least = 1e9;
         for (const TrajectoryRow& row : good.rows)
           for (int j = 0; j < kDof; ++j) {
             const JointLimit& limit = good.chain().limit[static_cast<std::size_t>(j)];
             if (!limit.continuous)
               least = std::min({least, row.q[j] - limit.lower, limit.upper - row.q[j]});
           }
         good.problem.limits.joint_margin = least + 1e-7;
         return "1e-7 rad beyond a limit, allowed are 1e-9";
       }},
      {"joint_step",
       [](Good& good, Random&) -> std::string {
         good.problem.limits.joint_step = 0.95 * largest_move(good);
         return "a move is 5 % too large";
       }},
      {"tool_speed",
       [](Good& good, Random&) -> std::string {
         double least = 1e9;  // that one of the moves allows
         for (std::size_t k = 1; k < good.rows.size(); ++k)
           for (int j = 0; j < kDof; ++j) {
             const double length = good.path->layer(static_cast<int>(k) - 1).step_length;
             const double move = std::abs(good.rows[k].q[j] - good.rows[k - 1].q[j]);
             if (length > 1e-6 && move > 0)
               least = std::min(
                   least, length * good.chain().limit[static_cast<std::size_t>(j)].velocity / move);
           }
         good.problem.limits.tool_speed = 1.05 * least;
         return "a joint must be 5 % too fast";
       }},
  };
}

/// Returns the mutations that narrow limits of errors and of manipulability.
std::vector<NamedMutation> mutations_of_error_limits() {
  return {
      {"tool_path_error",
       [](Good& good, Random&) -> std::string {
         const double most = largest(good, path_deviation);
         if (most < 1e-5) return "";
         good.problem.limits.tool_path_error = 0.8 * most;
         return amount("%.3g m, a quarter more than allowed", most);
       }},
      {"tool_angle_error",
       [](Good& good, Random&) -> std::string {
         const double most = largest(good, angle_deviation);
         if (most < 1e-5) return "";
         good.problem.limits.tool_angle_error = 0.8 * most;
         return amount("%.3g rad, a quarter more than allowed", most);
       }},
      {"step_error",
       [](Good& good, Random&) -> std::string {
         const SrsLattice lattice(good.chain(), good.robot->srs(), *good.path, good.problem);
         double most = 0;
         for (int k = 0; k + 1 < good.path->size(); ++k) {
           const TrajectoryRow &a = good.rows[static_cast<std::size_t>(k)],
                               &b = good.rows[static_cast<std::size_t>(k) + 1];
           most = std::max(most,
                           step_error(lattice, k, 0, a.branch, a.phi, wrap_angle(b.phi - a.phi)));
         }
         good.problem.limits.step_error = 0.9 * most;
         return amount("%.3g rad, a tenth more than allowed", most);
       }},
      {"manipulability",
       [](Good& good, Random&) -> std::string {
         double least = 1e9;
         for (const TrajectoryRow& row : good.rows)
           least = std::min(least, good.chain().manipulability(row.q));
         good.problem.limits.manipulability = 1.01 * least;
         return "1 % too small";
       }},
  };
}

/// Returns the mutations that ask for more clearance, and one that puts a ball inside a link.
std::vector<NamedMutation> mutations_of_clearance() {
  return {
      {"clearance",
       [](Good& good, Random&) -> std::string {
         if (!good.problem.model->has_srdf)
           return "";  // else the pairs that count depend on clearances
         const World world(good.robot->world(), good.problem.scene);
         World::Query query(world);
         double least = 1e9;
         for (const TrajectoryRow& row : good.rows)
           if (const auto clearance = query.clearance(row.q))
             least = std::min(least, clearance->distance);
         good.problem.limits.clearance = least + 0.1e-3;
         good.problem.limits.edge_clearance = 0;
         return "0.1 mm too near, FCL may err by 0.05";
       }},
      {"edge_clearance",  // a move begins nearer than that, so its first midpoint is too near by
                          // what it has moved there, at most h
       [](Good& good, Random&) -> std::string {
         if (!good.problem.model->has_srdf)
           return "";  // else the pairs that count depend on clearances
         const World world(good.robot->world(), good.problem.scene);
         World::Query query(world);
         double least = 1e9;
         for (const TrajectoryRow& row : good.rows)
           if (const auto clearance = query.clearance(row.q))
             least = std::min(least, clearance->distance);
         good.problem.limits.edge_clearance = least + 0.2e-3;
         return "0.2 mm too near";
       }},
      {"contact",
       [](Good& good, Random& random) -> std::string {
         if (!good.problem.model->has_srdf)
           return "";  // else the pairs that count depend on clearances
         const auto G = good.chain().displacements(good.rows[some_row(good, random)].q);
         const auto& bodies = good.robot->world().bodies();
         const RobotBody& body =
             bodies[static_cast<std::size_t>(random.below(static_cast<int>(bodies.size())))];
         if (body.group == 0) return "";
         Pose pose = Pose::Identity();
         pose.translation() =
             G[static_cast<std::size_t>(body.group)] * body.pose * centre(body.shape);
         good.problem.scene.push_back({"inside", Sphere{0.001}, pose, {}});
         good.problem.limits.clearance = 0;
         good.problem.limits.edges = EdgeMode::kNodes;
         return "a ball inside a link, with no clearance asked";
       }},
  };
}

/// Returns the mutations of the start and of waypoints.
std::vector<NamedMutation> mutations_of_start_and_waypoints() {
  return {
      {"start",
       [](Good& good, Random& random) -> std::string {
         good.problem.start = good.rows[0].q;
         (*good.problem.start)[random.below(kDof)] += 1e-4;
         return "1e-4 rad from the start, allowed are 1e-6";
       }},
      {"waypoint turned away",  // the waypoint that is skipped asks for an orientation that the
                                // tool never has
       [](Good& good, Random& random) -> std::string {
         const int n = good.path->size();
         const int layer = 2 + random.below(n - 4);
         const PathLayer& at = good.path->layer(layer);
         if (at.waypoint >= 0 || good.path->layer(layer - 1).waypoint >= 0 ||
             good.path->layer(layer + 1).waypoint >= 0)
           return "";
         // Waypoints at the layers around keep the rest of the path as it is; that between them
         // turns aside.
         std::vector<Waypoint> waypoints;
         for (int i = 0; i < n; ++i) waypoints.push_back(waypoint_of(good.path->layer(i).tool));
         const double turn = random.uniform(0.05, 0.9);
         Vector3d aside =
             at.step_rotation.norm() > 1e-9 ? at.step_rotation.unitOrthogonal() : Vector3d::UnitX();
         waypoints[static_cast<std::size_t>(layer)] =
             moved(waypoints[static_cast<std::size_t>(layer)], Vector3d::Zero(), turn * aside);
         good.problem.waypoints = waypoints;
         good.rows.erase(good.rows.begin() + layer);
         return amount("by %.3g rad, allowed are 0.02 at waypoints", turn);
       }},
  };
}

/// Returns all mutations, in a fixed order.
const std::vector<NamedMutation>& mutations() {
  static const std::vector<NamedMutation> all = concatenated({
      mutations_of_order_and_turns(),
      mutations_of_row_values(),
      mutations_of_joint_limits(),
      mutations_of_error_limits(),
      mutations_of_clearance(),
      mutations_of_start_and_waypoints(),
  });
  return all;
}

TEST(Check, MutationsFail) {
  const std::uint64_t base = seed("Mutations");
  const auto& good = good_trajectories();
  const int each = trials(15);
  int count = 0;
  for (std::size_t kind = 0; kind < mutations().size(); ++kind) {
    const auto& [name, mutate] = mutations()[kind];
    int done = 0;
    for (int trial = 0; done < each && trial < 100 * each; ++trial) {
      Random random(base + 100000 * kind + static_cast<std::uint64_t>(trial));
      Good bad = good[static_cast<std::size_t>(random.below(static_cast<int>(good.size())))];
      const std::string words = mutate(bad, random);
      if (words.empty()) continue;
      const CheckResult result = check_trajectory(*bad.robot, bad.problem, bad.rows);
      EXPECT_FALSE(result.passed) << name << " (" << words << "), " << bad.what << ", trial "
                                  << trial;
      EXPECT_GT(result.failure_count, 0);
      EXPECT_FALSE(result.failures.empty());
      const CheckResult verdict =
          check_trajectory(*bad.robot, bad.problem, bad.rows, {.margins = false});
      EXPECT_FALSE(verdict.passed) << name << " (" << words << "), " << bad.what << ", trial "
                                   << trial << ", without margins";
      EXPECT_FALSE(verdict.failures.empty());
      ++done;
    }
    EXPECT_EQ(done, each) << name;
    count += done;
  }
  std::printf("%d mutations of %zu kinds\n", count, mutations().size());
  EXPECT_GE(count, 20 * each);
}

/// Changes the problem under the planner's hands, once it plans: its lattice and its world know the
/// one before.
class Fault final : public StateCheck {
 public:
  explicit Fault(std::function<void()> strike) : strike_(std::move(strike)) {}
  [[nodiscard]] std::string name() const override { return "fault"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    std::fill_n(allowed.begin(), states.size(), true);
    if (strike_) std::exchange(strike_, nullptr)();
  }

 private:
  std::function<void()> strike_;
};

/// An answer that is wrong is an error of the program, never an answer; right ones are answers as
/// they were.
TEST(Check, WrongAnswersOfAPlannerAreRefused) {
  const std::uint64_t base = seed("Faults");
  const std::vector<std::function<void(PathProblem&, double)>> faults = {
      [](PathProblem& p, double) { p.limits.clearance = 1; },
      [](PathProblem& p, double) { p.limits.joint_step = 1e-6; },
      [](PathProblem& p, double) { p.limits.manipulability = 1e3; },
      [](PathProblem& p, double) { p.limits.joint_margin = 10; },
      [](PathProblem& p, double) { p.waypoints.back().position.x() += 1e-4; },
      [](PathProblem& p, double x) { p.start = Config::Constant(x); },
      [](PathProblem& p, double) { p.limits.tool_path_error = 1e-9; },
  };
  int refused = 0, right = 0;
  for (const Good& good : good_trajectories()) {
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    options.check = true;
    const PlanResult plain = plan(*good.robot, good.problem, options);
    ASSERT_EQ(plain.status, PlanStatus::kSolved) << good.what;
    EXPECT_TRUE(plain.checked && plain.time_ms.contains("check")) << good.what;
    ASSERT_EQ(plain.trajectory.size(), good.rows.size());
    for (std::size_t k = 0; k < good.rows.size(); ++k)
      ASSERT_EQ(plain.trajectory[k].q, good.rows[k].q) << good.what;
    ++right;
    Random random(base + static_cast<std::uint64_t>(right));
    for (std::size_t k = 0; k < faults.size(); ++k) {
      Planner planner(good.robot, good.problem);
      auto& problem = const_cast<PathProblem&>(planner.problem());
      const double x = random.uniform(0.1, 1);
      options.hooks.check = std::make_shared<Fault>([&] { faults[k](problem, x); });
      EXPECT_THROW(static_cast<void>(planner.plan(options)), std::logic_error)
          << good.what << ", fault " << k;
      options.hooks.check.reset();
      ++refused;
    }
  }
  std::printf("%d right answers, %d wrong ones refused\n", right, refused);
  EXPECT_GE(right, 20);
}

TEST(Check, StopsWhereItsTimeIsUp) {
  const Good& good = good_trajectories()[0];
  const std::atomic<bool> cancel{true};
  for (const bool margins : {true, false})
    EXPECT_THROW(static_cast<void>(check_trajectory(*good.robot, good.problem, good.rows,
                                                    {margins, Budget({}, &cancel)})),
                 Stopped);
}

/// A row at any place, by closed-form IK (solved on the exact chain of inexact arms), its joints
/// next to those given.
std::optional<TrajectoryRow> row_between(const Good& good, double place) {
  const int layer = std::min(static_cast<int>(place), good.path->size() - 2);
  const double t = place - layer;
  const TrajectoryRow &a = good.rows[static_cast<std::size_t>(layer)],
                      &b = good.rows[static_cast<std::size_t>(layer) + 1];
  if (a.branch != b.branch) return std::nullopt;
  const SrsArm& arm = good.robot->srs();
  const Pose tool = good.pose(place);
  const ArmPlane plane = carry_plane(arm, good.planes[static_cast<std::size_t>(layer)], tool);
  if (reach_status(arm, plane.reach) != ReachStatus::kReachable) return std::nullopt;
  TrajectoryRow row;
  row.s = good.path->layer(layer).s + t * good.path->layer(layer).step_length;
  row.phi = wrap_angle(a.phi + t * wrap_angle(b.phi - a.phi));
  row.branch = a.branch;
  const auto q =
      solve_exact_chain(good.chain(), arm, plane, tool, row.phi,
                        srs_ik(arm, elbow_circles(arm, plane, tool), row.phi, row.branch));
  if (!q) return std::nullopt;
  const Config straight = a.q + t * (b.q - a.q);
  for (int j = 0; j < kDof; ++j) row.q[j] = straight[j] + wrap_angle((*q)[j] - straight[j]);
  if ((row.q - straight).lpNorm<Eigen::Infinity>() > 0.05) return std::nullopt;
  return row;
}

/// Says by samples whether a move keeps all rules, with something to spare.
bool keeps_rules(const Good& good, const World& world, World::Query& query, const TrajectoryRow& a,
                 double begin, const TrajectoryRow& b, double end) {
  const Limits& limits = good.problem.limits;
  const Config move = b.q - a.q;
  const double steps = std::max(1.0, std::floor(end - begin + 1e-9));
  if (move.lpNorm<Eigen::Infinity>() > std::min(3.0, 0.9 * steps * limits.joint_step)) return false;
  if (deviation(good, a.q, b.q, begin, end, 0.5 * *limits.tool_path_error, 0.01) > 1) return false;
  return !query.find_violating_pair(b.q, ClearanceRule::kNode) &&
         !test::edge_blocked_plain(query, world.edge_rule(good.robot->radii()), a.q, b.q);
}

/// Counts the resamplings, and what was done to make them.
struct ResamplingCounts {
  int count = 0;     ///< resamplings that were checked
  int dropped = 0;   ///< layers left out
  int inserted = 0;  ///< rows between layers
  int inexact = 0;   ///< resamplings of inexact arms
  int turned = 0;    ///< joints turned
};

/// Draws places on the path, in order, from 0 to `last`: layers, some left out; rows between
/// layers, none or several in a step.
std::vector<double> draw_places(int trial, int last, Random& random) {
  const double keep = trial % 3 == 0 ? 1 : random.uniform(0.1, 1),
               insert = trial % 3 == 1 ? 0 : random.uniform(0, 1.5);
  std::vector<double> places{static_cast<double>(last)};
  for (int i = 0; i < last; ++i) {
    if (i == 0 || random.coin(keep)) places.push_back(i);
    for (double more = insert; random.coin(std::min(more, 1.0)); more /= 2)
      places.push_back(i + random.uniform(0.001, 0.999));
  }
  std::sort(places.begin(), places.end());
  return places;
}

/// Returns rows of the trajectory at the places, as far as each move keeps all rules; where a move
/// does not, rows at all layers on its way. Returns nothing where some move cannot be judged.
std::optional<std::vector<TrajectoryRow>> resampled(const Good& good,
                                                    const std::vector<double>& places,
                                                    ResamplingCounts& counts) {
  const World world(good.robot->world(), good.problem.scene);
  World::Query query(world);
  std::vector<TrajectoryRow> rows{good.rows[0]};
  double place = 0;
  const auto row_at = [&](double at) {
    return at == std::floor(at) ? std::optional(good.rows[static_cast<std::size_t>(at)])
                                : row_between(good, at);
  };
  for (std::size_t k = 1; k < places.size(); ++k) {
    const auto next = row_at(places[k]);
    if (!next) continue;
    if (!keeps_rules(good, world, query, rows.back(), place, *next, places[k])) {
      // All the layers on the way instead: the planner's own moves; from a row between layers to
      // the next layer.
      bool kept = true;
      for (double layer = std::floor(place) + 1; layer < places[k] && kept; ++layer) {
        const TrajectoryRow& row = good.rows[static_cast<std::size_t>(layer)];
        kept =
            place == layer - 1 || keeps_rules(good, world, query, rows.back(), place, row, layer);
        rows.push_back(row);
        place = layer;
      }
      if (!kept || (!(place == places[k] - 1 && places[k] == std::floor(places[k])) &&
                    !keeps_rules(good, world, query, rows.back(), place, *next, places[k])))
        break;
    } else {
      counts.dropped += static_cast<int>(std::ceil(places[k]) - std::floor(place)) - 1;
    }
    counts.inserted += places[k] != std::floor(places[k]);
    rows.push_back(*next);
    place = places[k];
  }
  if (place < good.path->size() - 1) return std::nullopt;  // some move could not be judged
  return rows;
}

/// Turns continuous joints of all rows by whole turns, from -3 to 3. Returns how many joints there
/// are.
int turn_continuous_joints(const Good& good, std::vector<TrajectoryRow>& rows, Random& random) {
  int turned = 0;
  for (int j = 0; j < kDof; ++j)  // other turns of continuous joints are as good
    if (good.chain().limit[static_cast<std::size_t>(j)].continuous) {
      const double turns = kTwoPi * (random.below(7) - 3);
      for (TrajectoryRow& row : rows) row.q[j] += turns;
      ++turned;
    }
  return turned;
}

TEST(Check, LegalResamplingsPass) {
  const std::uint64_t base = seed("Resamplings");
  const auto& all = good_trajectories();
  ResamplingCounts counts;
  for (int trial = 0; counts.count < trials(300) && trial < 1000; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Good& good = all[static_cast<std::size_t>(trial) % all.size()];
    auto rows = resampled(good, draw_places(trial, good.path->size() - 1, random), counts);
    if (!rows) continue;
    if (trial % 4 == 0) counts.turned += turn_continuous_joints(good, *rows, random);
    const CheckResult result = check_trajectory(*good.robot, good.problem, *rows);
    EXPECT_TRUE(result.passed) << good.what << ", trial " << trial << ": " << first(result);
    ++counts.count;
    counts.inexact += !good.robot->srs().exact;
  }
  std::printf(
      "%d resamplings: %d layers left out, %d rows between layers, %d of inexact arms, %d joints "
      "turned\n",
      counts.count, counts.dropped, counts.inserted, counts.inexact, counts.turned);
  EXPECT_GE(counts.count, trials(300));
  EXPECT_GE(counts.dropped, counts.count);
  EXPECT_GE(counts.inserted, counts.count);
  EXPECT_GE(counts.inexact, at_least_among(counts.count / 10));
  EXPECT_GE(counts.turned, at_least(10));
}

/// A closed path of the iiwa14 with corners that turn, as a user might write it.
PathProblem closed_problem() {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Quaterniond down(Eigen::AngleAxisd(3.0, Vector3d::UnitY()));
  const Quaterniond aside = Quaterniond(Eigen::AngleAxisd(0.9, Vector3d::UnitZ())) * down;
  problem.waypoints = {{{0.5, -0.1, 0.6}, down},
                       {{0.5, 0.2, 0.6}, down},
                       {{0.6, 0.2, 0.5}, aside},
                       {{0.5, -0.1, 0.6}, down}};
  problem.resolution = {.ds = 0.02, .dphi = 0.2, .dalpha = 0.1};
  return problem;
}

TEST(Check, TwoEqualRowsDoNotFollowAClosedPath) {
  const auto good = solved("closed", closed_problem());
  ASSERT_TRUE(good);
  TrajectoryRow end = good->rows[0];
  end.s = good->rows.back().s;
  EXPECT_FALSE(check_trajectory(good->problem, {good->rows[0], end}).passed);
  PathProblem unlimited = good->problem;
  unlimited.limits.tool_path_error = std::nullopt;  // waypoints are passed all the same
  EXPECT_FALSE(check_trajectory(unlimited, {good->rows[0], end}).passed);
}

TEST(Check, AWaypointThatTurnsIsNotSkipped) {
  PathProblem problem = closed_problem();
  problem.waypoints = {problem.waypoints[0], problem.waypoints[1], problem.waypoints[1]};
  problem.waypoints[1] = {
      {0.5, 0.05, 0.6},
      problem.waypoints[0].orientation * Quaterniond(Eigen::AngleAxisd(0.9, Vector3d::UnitX()))};
  // What it looks like without the turn is straight, so the tool is never off in position.
  PathProblem straight = problem;
  straight.waypoints.erase(straight.waypoints.begin() + 1);
  const auto good = solved("straight", straight);
  ASSERT_TRUE(good);
  ASSERT_TRUE(check_trajectory(straight, good->rows).passed);
  std::vector<TrajectoryRow> rows{good->rows.front(), good->rows.back()};
  problem.limits.tool_path_error = 0.1;
  problem.limits.joint_step = 2;
  straight.limits = problem.limits;
  for (const auto& angle_error : {std::optional<double>{}, std::optional<double>{0.5}}) {
    problem.limits.tool_angle_error = straight.limits.tool_angle_error = angle_error;
    const CheckResult result = check_trajectory(problem, rows);
    EXPECT_FALSE(result.passed);
    // It fails by more than the arm angle, which another path carries otherwise.
    EXPECT_TRUE(std::any_of(result.failures.begin(), result.failures.end(),
                            [](const std::string& line) {
                              return line.find("leaves the path") != std::string::npos &&
                                     line.find("rad: allowed are") != std::string::npos;
                            }))
        << first(result);
    EXPECT_TRUE(check_trajectory(straight, rows).passed) << first(check_trajectory(straight, rows));
  }
}

TEST(Check, PhiAndBranchAreThoseOfTheJoints) {
  const auto good = solved("closed", closed_problem());
  ASSERT_TRUE(good);
  ASSERT_TRUE(check_trajectory(good->problem, good->rows).passed);
  auto rows = good->rows;
  for (TrajectoryRow& row : rows) row.phi = 123;
  EXPECT_FALSE(check_trajectory(good->problem, rows).passed);
  rows = good->rows;
  for (TrajectoryRow& row : rows) row.branch ^= 7;
  EXPECT_FALSE(check_trajectory(good->problem, rows).passed);
}

TEST(Check, AJointThatSpinsWithinAStepFails) {
  int spins = 0;
  for (const Good& good : good_trajectories()) {
    if (good.problem.source != "continuous") continue;
    for (const int turns : {1, -1, 4}) {
      auto rows = good.rows;
      for (std::size_t k = rows.size() / 2; k < rows.size(); ++k) rows[k].q[0] += turns * kTwoPi;
      EXPECT_FALSE(check_trajectory(good.problem, rows).passed);
      ++spins;
    }
  }
  EXPECT_GE(spins, 6);
}

/// The elbow goes far around the tool inside one step, in many small moves of which each is
/// allowed.
TEST(Check, ManySmallMovesInOneStepDoNotAddUp) {
  int tried = 0;
  for (const Good& source : good_trajectories()) {
    if (source.problem.source != "continuous") continue;
    Good good = source;
    good.problem.limits.edges = EdgeMode::kNodes;
    good.problem.scene.clear();
    const SrsArm& arm = good.robot->srs();
    // Up and back within the first step.
    std::vector<TrajectoryRow> rows{good.rows[0]};
    constexpr int kMoves = 80;
    double far = 0;
    bool possible = good.path->layer(0).step_length > 1e-3;
    for (int k = 1; k < kMoves && possible; ++k) {
      const double t = static_cast<double>(k) / kMoves;
      const Pose tool = good.pose(t);
      const ArmPlane plane = carry_plane(arm, good.planes[0], tool);
      TrajectoryRow row = rows.back();
      row.s = t * good.path->layer(0).step_length;
      row.phi = wrap_angle(good.rows[0].phi + t * wrap_angle(good.rows[1].phi - good.rows[0].phi) +
                           2 * std::sin(t * kPi));
      const Config q = srs_ik(arm, elbow_circles(arm, plane, tool), row.phi, row.branch);
      for (int j = 0; j < kDof; ++j) row.q[j] += wrap_angle(q[j] - row.q[j]);
      possible = (row.q - rows.back().q).lpNorm<Eigen::Infinity>() < 0.4;
      far = std::max(far, (row.q - rows[0].q).lpNorm<Eigen::Infinity>());
      rows.push_back(row);
    }
    if (!possible || far < 2.2 * good.problem.limits.joint_step) continue;
    rows.insert(rows.end(), good.rows.begin() + 1, good.rows.end());
    const CheckResult result = check_trajectory(*good.robot, good.problem, rows);
    EXPECT_FALSE(result.passed) << good.what;
    tried += first(result).find("rad far") != std::string::npos;
  }
  EXPECT_GE(tried, 1);
}

/// 3 layers a waypoint, some apart by noise alone, so that 360 deg are made of 180 layers at one s.
PathProblem turning_problem(double noise, bool back) {
  PathProblem problem = problem_for(continuous_robot());
  Random random(seed("Turning"));
  Waypoint at{{0.5, 0.05, 0.5}, Quaterniond(Eigen::AngleAxisd(3.0, Vector3d::UnitY()))};
  problem.waypoints.push_back(at);
  for (int k = 0; k < 60; ++k) {
    const double turn = back && k % 6 > 2 ? -0.105 : 0.105;
    at = moved(
        at, noise * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)),
        turn * Vector3d::UnitZ());
    problem.waypoints.push_back(at);
  }
  problem.resolution = {.ds = 0.01, .dphi = 0.2, .dalpha = 0.035};
  problem.limits.edges = EdgeMode::kNodes;
  return problem;
}

TEST(Check, ManySmallTurnsOnTheSpotPass) {
  for (const bool back : {false, true})
    for (const double noise : {0.0, 3e-10, 3e-8}) {
      const auto good = solved("turning", turning_problem(noise, back));
      ASSERT_TRUE(good) << "back " << back << " noise " << noise;
      ASSERT_GE(good->rows.size(), 180u);
      const std::string what = "back " + std::to_string(back) + " noise " + std::to_string(noise);
      const CheckResult result = check_trajectory(*good->robot, good->problem, good->rows);
      EXPECT_TRUE(result.passed) << what << ": " << first(result);
      std::vector<TrajectoryRow> waypoints;  // two of three rows left out
      for (std::size_t k = 0; k < good->rows.size(); k += 3) waypoints.push_back(good->rows[k]);
      EXPECT_TRUE(check_trajectory(*good->robot, good->problem, waypoints).passed)
          << what << ": " << first(check_trajectory(*good->robot, good->problem, waypoints));
      if (back) {  // without one swing the tool has all the same poses at rows, and never makes it
        auto without = good->rows;
        without.erase(without.begin() + 19, without.begin() + 19 + 18);
        EXPECT_FALSE(check_trajectory(*good->robot, good->problem, without).passed) << what;
      } else {
        auto reversed = good->rows;
        std::reverse(reversed.begin(), reversed.end());
        EXPECT_FALSE(check_trajectory(*good->robot, good->problem, reversed).passed) << what;
      }
    }
}

TEST(Check, RowsThatFailAreNotExaminedFurther) {
  int bounded = 0, continuous = 0;
  for (const Good& good : good_trajectories()) {
    const CheckResult whole = check_trajectory(*good.robot, good.problem, good.rows);
    for (int j = 0; j < kDof; ++j) {
      auto rows = good.rows;
      const std::size_t k = rows.size() / 2;
      const bool turns = good.chain().limit[static_cast<std::size_t>(j)].continuous;
      rows[k].q[j] += turns ? 1e5 * kTwoPi : 1e6;
      const CheckResult result = check_trajectory(*good.robot, good.problem, rows);
      EXPECT_FALSE(result.passed) << good.what;
      EXPECT_LE(result.fcl_calls, whole.fcl_calls) << good.what << " joint " << j;
      EXPECT_LE(result.moves_examined, whole.moves_examined);
      if (!turns) {
        EXPECT_EQ(result.rows_examined, whole.rows_examined - 1);
        EXPECT_EQ(result.moves_examined, whole.moves_examined - 2);
      }
      ++(turns ? continuous : bounded);
    }
  }
  EXPECT_GE(bounded, 100);
  EXPECT_GE(continuous, 10);
}

TEST(Check, AllFailuresAreCounted) {
  const Good& good = good_trajectories()[0];
  auto rows = good.rows;
  for (TrajectoryRow& row : rows) row.phi += 1;
  const CheckResult result = check_trajectory(*good.robot, good.problem, rows);
  EXPECT_EQ(result.failure_count, static_cast<std::int64_t>(rows.size()));
  EXPECT_EQ(result.failures.size(), std::min<std::size_t>(20, rows.size()));
  for (const auto& few : {std::vector<TrajectoryRow>{}, std::vector<TrajectoryRow>{good.rows[0]}})
    EXPECT_FALSE(check_trajectory(*good.robot, good.problem, few).passed);
}

}  // namespace
}  // namespace swivel
