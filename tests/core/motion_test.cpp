// SPDX-License-Identifier: BSD-3-Clause
// Smooth tool paths, splines, motions in time, and the smooth minimum, each against what is plainly
// right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "inner_posture.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/cubic_spline.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/motion/smooth_path.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/core/timing/shared_travel.hpp"
#include "swivel/core/timing/time_arms.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "worst_rates.hpp"

namespace swivel {
namespace {

using namespace test;

Waypoint moved(const Waypoint& from, const Vector3d& by, const Vector3d& turn) {
  Waypoint to = from;
  to.position += by;
  if (turn.norm() > 0)
    to.orientation =
        (to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())))
            .normalized();
  return to;
}

/// Straight and turning segments of 0.2 mm to 60 mm; some only turn, some only move.
std::vector<Waypoint> random_waypoints(Random& random, const Waypoint& first) {
  std::vector<Waypoint> waypoints{first};
  const int more = 2 + random.below(5);
  for (int k = 0; k < more; ++k) {
    const int kind = random.below(5);
    const double length = kind == 0   ? 0
                          : kind == 1 ? random.uniform(0.2e-3, 2e-3)
                                      : random.uniform(0.01, 0.06);
    const double angle = kind == 0   ? random.uniform(0.05, 0.3)
                         : kind == 2 ? 0
                                     : random.uniform(0.01, 0.3);
    waypoints.push_back(
        moved(waypoints.back(), random_vector(random, length), random_vector(random, angle)));
  }
  return waypoints;
}

double angle_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// Checks how far a curve leaves the polyline at a rounded corner, and that it bends without a jump
/// about it.
void check_rounded_corner(const ToolPath& plain, const ToolPath& curve,
                          const ToolPath::Corner& corner, int trial) {
  // The most it leaves the polyline is at the corner, and told.
  EXPECT_NEAR(
      (plain.layer(corner.layer).tool.translation() - curve.layer(corner.layer).tool.translation())
          .norm(),
      corner.position, 1e-12);
  EXPECT_NEAR(angle_between(plain.layer(corner.layer).tool, curve.layer(corner.layer).tool),
              corner.angle, 1e-7);
  // Second differences on both sides of where the curve begins to bend come together as the
  // step shrinks.
  const double x = curve.layer(corner.layer).travel;
  for (const double joint : {x - corner.reach, x, x + corner.reach}) {
    const auto second = [&](double at, double h) -> Eigen::Matrix4d {
      return ((curve.at_travel(at + h).matrix() - curve.at_travel(at).matrix()) -
              (curve.at_travel(at).matrix() - curve.at_travel(at - h).matrix())) /
             (h * h);
    };
    const auto jump = [&](double h) {
      return (second(joint + h, h) - second(joint - h, h)).norm();
    };
    const double h = corner.reach / 8, bend = second(x, h).norm();
    EXPECT_LT(jump(h / 4), 0.4 * jump(h) + 0.02 * bend + 1e-3) << "trial " << trial;
  }
}

TEST(SmoothToolPath, StaysNearThePolylineAndIsTwiceDifferentiable) {
  const std::uint64_t base = seed("SmoothToolPath");
  const Resolution resolution{.ds = 0.005, .dphi = 0.1, .dalpha = 0.1};
  int rounded = 0, sharp = 0;
  for (int trial = 0; trial < trials(60); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathSmoothing smooth{random.coin(0.1) ? 0 : random.uniform(0.02e-3, 0.3e-3),
                               random.uniform(0.2e-3, 3e-3)};
    const auto waypoints =
        random_waypoints(random, {Vector3d(0.4, 0, 0.3), Quaterniond(0.5, 0.5, -0.5, 0.5)});
    const ToolPath plain(waypoints, resolution, "test"),
        curve(waypoints, resolution, "test", {}, smooth);
    ASSERT_EQ(plain.size(), curve.size());
    for (int i = 0; i < plain.size(); ++i) {
      EXPECT_EQ(plain.layer(i).s, curve.layer(i).s);
      EXPECT_EQ(plain.layer(i).travel, curve.layer(i).travel);
      EXPECT_LE((plain.layer(i).tool.translation() - curve.layer(i).tool.translation()).norm(),
                smooth.position + 1e-12);
      EXPECT_LE(angle_between(plain.layer(i).tool, curve.layer(i).tool), smooth.angle + 1e-7);
    }
    const double length = curve.layer(curve.size() - 1).travel;
    for (double x = 0; x < length; x += 0.31e-3) {
      const int i = curve.step_at(x);
      const double t =
          (x - curve.layer(i).travel) / (curve.layer(i + 1).travel - curve.layer(i).travel);
      const Pose there = curve.at_travel(x), line = plain.at(i, t), same = curve.at(i, t);
      EXPECT_LE((there.translation() - line.translation()).norm(), smooth.position + 1e-12)
          << trial << " at " << x;
      EXPECT_LE(angle_between(there, line), smooth.angle + 1e-7) << trial << " at " << x;
      EXPECT_LE((there.translation() - same.translation()).norm(), 1e-12);
    }
    for (const ToolPath::Corner& corner : curve.corners()) {
      if (corner.reach == 0) {
        ++sharp;
        continue;
      }
      ++rounded;
      check_rounded_corner(plain, curve, corner, trial);
    }
  }
  std::printf("%d corners rounded, %d sharp\n", rounded, sharp);
  EXPECT_GE(rounded, at_least(101));
  EXPECT_GE(sharp, at_least(6));
}

/// A winding curve, read off as densely as programs that make tool paths do.
std::vector<Waypoint> dense_waypoints(Random& random, const Waypoint& first, int count,
                                      double length) {
  const Vector3d along = random_vector(random, length),
                 across = random_vector(random, 0.1 * length), axis = random_vector(random, 1);
  const double turns = random.uniform(0.5, 2), angle = random.uniform(0, 0.4);
  std::vector<Waypoint> waypoints;
  for (int k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / (count - 1), wave = std::sin(kTwoPi * turns * t);
    waypoints.push_back(moved(first, t * along + wave * across, Vector3d(angle * wave * axis)));
  }
  return waypoints;
}

TEST(SmoothToolPath, DenseWaypointsAreNoCorners) {
  const std::uint64_t base = seed("DenseWaypoints");
  const Resolution resolution{.ds = 0.005, .dphi = 0.1, .dalpha = 0.1};
  int waypoints_met = 0, corners_met = 0;
  for (int trial = 0; trial < trials(30); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathSmoothing smooth{random.uniform(0.02e-3, 0.3e-3),
                               random.coin(0.2) ? 0.1 : random.uniform(0.2e-3, 3e-3)};
    const int count = 200 + random.below(3000);
    const auto waypoints =
        dense_waypoints(random, {Vector3d(0.4, 0, 0.3), Quaterniond(0.5, 0.5, -0.5, 0.5)}, count,
                        random.uniform(0.05, 0.4));
    const ToolPath plain(waypoints, resolution, "test"),
        curve(waypoints, resolution, "test", {}, smooth);
    ASSERT_EQ(plain.size(), curve.size());
    double worst = 0;
    for (int i = 0; i + 1 < plain.size(); ++i) {
      EXPECT_EQ(plain.layer(i).s, curve.layer(i).s);
      for (const double t : {0.0, 0.3, 0.7}) {
        const double off = (plain.at(i, t).translation() - curve.at(i, t).translation()).norm();
        EXPECT_LE(off, smooth.position + 1e-12) << trial;
        EXPECT_LE(angle_between(plain.at(i, t), curve.at(i, t)), smooth.angle + 1e-6) << trial;
        worst = std::max(worst, off);
      }
    }
    EXPECT_LE((plain.layer(plain.size() - 1).tool.translation() -
               curve.layer(plain.size() - 1).tool.translation())
                  .norm(),
              1e-12);
    for (const ToolPath::Corner& corner : curve.corners()) EXPECT_GT(corner.reach, 0) << trial;
    waypoints_met += count;
    corners_met += static_cast<int>(curve.corners().size());
  }
  std::printf("%d waypoints, %d corners\n", waypoints_met, corners_met);
  EXPECT_LT(10 * corners_met, waypoints_met);
  EXPECT_GT(corners_met, at_least(100));
}

TEST(CubicSpline, SolvesTheEquationsOfTheNaturalSpline) {
  Random random(seed("CubicSpline"));
  for (int trial = 0; trial < trials(50); ++trial) {
    const int n = 2 + random.below(12);
    std::vector<double> x{random.uniform(-1, 1)}, y{random.uniform(-3, 3)};
    for (int k = 1; k < n; ++k)
      x.push_back(x.back() + random.uniform(0.1, 2)), y.push_back(random.uniform(-3, 3));
    const CubicSpline spline(x, y);
    for (int k = 0; k < n; ++k)
      EXPECT_NEAR(spline.at(x[static_cast<std::size_t>(k)]), y[static_cast<std::size_t>(k)], 1e-12);
    const auto slope = [&](double at, double h) { return (spline.at(at + h) - spline.at(at)) / h; };
    const auto bend = [&](double at, double h) {
      return (spline.at(at + 2 * h) - 2 * spline.at(at + h) + spline.at(at)) / (h * h);
    };
    for (int k = 1; k + 1 < n; ++k) {
      const double at = x[static_cast<std::size_t>(k)];
      EXPECT_NEAR(slope(at, 1e-6), slope(at, -1e-6), 1e-2);
      EXPECT_NEAR(bend(at, 1e-5), bend(at, -1e-5), 0.5);
    }
    EXPECT_NEAR(bend(x.front(), 1e-5), 0, 0.5);
    EXPECT_NEAR(bend(x.back(), -1e-5), 0, 0.5);
    EXPECT_NEAR(bend(x.back() + 1, 1e-3), 0, 1e-6);
  }
}

/// Joints that any coordinate has, curved, and different from layer to layer.
class Waves final : public LayerSolver {
 public:
  Waves(Random& random, int layers) {
    for (int i = 0; i < layers; ++i) {
      travel_.push_back(i == 0 ? 0 : travel_.back() + random.uniform(0.5, 1.5));
      Config phase;
      for (double& value : phase.coordinates()) value = random.uniform(0, 0.3);
      phase_.push_back(phase);
    }
  }
  [[nodiscard]] int layers() const override { return static_cast<int>(travel_.size()); }
  [[nodiscard]] double travel(int layer) const override {
    return travel_[static_cast<std::size_t>(layer)];
  }
  [[nodiscard]] std::optional<Config> joints(int layer, double x) const override {
    Config q;
    for (int j = 0; j < kDof; ++j)
      q[j] = std::sin(x + j + phase_[static_cast<std::size_t>(layer)][j] + 0.1 * layer);
    return q;
  }

 private:
  std::vector<double> travel_;
  std::vector<Config> phase_;
};

TEST(SmoothMinimum, NoSmallMoveInsideTheBoxesIsBetter) {
  const std::uint64_t base = seed("SmoothMinimum");
  int at_bounds = 0, inside = 0;
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const int n = 3 + random.below(12);
    const Waves waves(random, n);
    SmoothObjective objective;
    for (double& weight : objective.weights) weight = random.uniform(0.2, 2);
    objective.bending = random.coin() ? 0.1 : 1e-3;
    objective.most_change = random.coin() ? 0.15 : 10;
    objective.power = random.one_of({1, 2, 16});
    if (trial % 2 == 1)
      for (int i = 0; i < n; ++i) objective.roll.push_back(random.uniform(0, 0.5));
    std::vector<double> x;
    std::vector<CoordinateBox> boxes;
    for (int i = 0; i < n; ++i) {
      x.push_back(random.uniform(-0.4, 0.4));
      const double width = random.coin(0.2) ? 0 : random.uniform(0.01, 0.6);
      boxes.push_back({x.back() - width, x.back() + width});
    }
    const std::vector<double> found = smooth_minimum(waves, objective, boxes, x);
    const double least = smooth_cost(waves, objective, found);
    // sums of magnitudes have tips, which are rounded off while the minimum is sought
    const double rounding = objective.power == 1 ? 1e-5 : 1e-7;
    EXPECT_LE(least, smooth_cost(waves, objective, x));
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_GE(found[k], boxes[k].low);
      EXPECT_LE(found[k], boxes[k].high);
      (found[k] > boxes[k].low && found[k] < boxes[k].high ? inside : at_bounds)++;
    }
    // Coordinate by coordinate and in random directions.
    for (int move = 0; move < 4 * n; ++move) {
      std::vector<double> other = found;
      for (int i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double by = move < 2 * n ? (i == move / 2 ? (move % 2 == 0 ? 1e-3 : -1e-3) : 0)
                                       : random.uniform(-1e-3, 1e-3);
        other[k] = std::clamp(found[k] + by, boxes[k].low, boxes[k].high);
      }
      EXPECT_GE(smooth_cost(waves, objective, other), least - rounding) << "trial " << trial;
    }
  }
  std::printf("%d coordinates inside their boxes, %d at bounds\n", inside, at_bounds);
  EXPECT_GE(inside, at_least(51));
  EXPECT_GE(at_bounds, at_least(21));
}

/// The plane: travel along one joint, the coordinate along another.
class Plane final : public LayerSolver {
 public:
  explicit Plane(int layers) : layers_(layers) {}
  [[nodiscard]] int layers() const override { return layers_; }
  [[nodiscard]] double travel(int layer) const override { return 0.1 * layer; }
  [[nodiscard]] std::optional<Config> joints(int layer, double x) const override {
    Config q = Config::Zero();
    q[0] = travel(layer);
    q[1] = x;
    return q;
  }

 private:
  int layers_;
};

/// A path that lies on its bounds from end to end comes off them: the shortest way between two
/// points past walls.
TEST(SmoothMinimum, LongPathsComeOffTheirBounds) {
  constexpr int kLayers = 201;
  const Plane plane(kLayers);
  SmoothObjective objective;
  objective.weights.fill(1);
  objective.bending = 1e-6;
  objective.most_change = 1;
  std::vector<CoordinateBox> boxes(kLayers, {-1, 1});
  boxes.front() = {-1, -1};
  boxes.back() = {0.5, 0.5};
  // One wall that stands in the straight way, and one that does not.
  for (std::size_t i = 95; i <= 105; ++i) boxes[i].low = 0;
  for (std::size_t i = 45; i <= 55; ++i) boxes[i].high = 0.6;
  const std::vector<double> found =
      smooth_minimum(plane, objective, boxes, std::vector<double>(kLayers, -1));
  for (std::size_t i = 0; i < kLayers; ++i) {
    const double k = static_cast<double>(i);
    const double taut = i <= 95 ? -1 + k / 95 : 0.5 * (k - 95) / 105;
    EXPECT_NEAR(found[i], taut, 2e-3) << i;
  }
}

/// A path from a posture well inside the limits, and rows with arm angles that wander on a grid, as
/// a lattice has them.
struct Followed {
  Chain chain;
  ArmClass kind;
  std::optional<ToolPath> path;
  std::vector<TrajectoryRow> rows;
};
std::optional<Followed> followed(const TestRobot& robot, Random& random,
                                 const PathSmoothing& smooth) {
  Followed f;
  f.chain = arm_of(robot).chain;
  f.kind = classify(f.chain, robot.name);
  const SrsArm& arm = *f.kind.srs;
  Config q = inner_posture(f.chain, random);
  f.path.emplace(random_waypoints(random, waypoint_of(f.chain.tool(q))),
                 Resolution{.ds = 0.01, .dphi = 0.05, .dalpha = 0.1}, "test", Budget(), smooth);
  ArmPlane plane;
  double phi = 0;
  const int branch = arm.branch(q);
  for (int i = 0; i < f.path->size(); ++i) {
    const Pose& tool = f.path->layer(i).tool;
    plane = i == 0 ? first_plane(arm, tool) : carry_plane(arm, plane, tool);
    if (reach_status(arm, plane.reach) != ReachStatus::kReachable) return std::nullopt;
    phi = i == 0 ? plane.angle_of(arm.elbow_axis(q)) : phi + 0.05 * (random.below(3) - 1);
    Config next = srs_ik(arm, elbow_circles(arm, plane, tool), phi, branch);
    for (int j = 0; j < kDof; ++j) next[j] = q[j] + wrap_angle(next[j] - q[j]);
    if (i > 0 && (next - q).lpNorm<Eigen::Infinity>() > 0.3) return std::nullopt;
    q = next;
    f.rows.push_back({f.path->layer(i).s, phi, branch, q});
  }
  return f;
}

/// Checks that the k-th row, k > 0, has the tool on its path at no more than the speed asked for
/// (m/s). Returns 1 if it did, and 0 where the path only turns.
int check_tool(const Followed& f, const std::vector<TimedRow>& rows, std::size_t k, double dt,
               double speed, int trial) {
  const TrajectoryRow& row = rows[k].row;
  const Pose tool = f.chain.tool(row.q);
  // Its place on the path, by s: where the path only turns, s does not tell.
  int i = 0;
  while (i + 2 < f.path->size() && f.path->layer(i + 1).s <= row.s) ++i;
  const bool turns =
      f.path->layer(i).step_length == 0 ||
      (i > 0 && f.path->layer(i - 1).step_length == 0 && row.s == f.path->layer(i).s);
  if (turns) return 0;
  const Pose there = f.path->at(i, (row.s - f.path->layer(i).s) / f.path->layer(i).step_length);
  EXPECT_LE((tool.translation() - there.translation()).norm(), 1e-8)
      << "trial " << trial << " row " << k;
  EXPECT_LE(angle_between(tool, there), 1e-6);
  const double moved = (tool.translation() - f.chain.tool(rows[k - 1].row.q).translation()).norm();
  EXPECT_LE(moved / dt, speed * (1 + 1e-3) + 1e-6);
  return 1;
}

/// Checks the times, places and speeds of the rows. Returns how many have the tool at a place that
/// their s tells.
int check_rows(const Followed& f, const std::vector<TimedRow>& rows, double dt, double speed,
               const JointRates& rates, int trial) {
  int samples = 0;
  const std::size_t n = rows.size();
  for (std::size_t k = 0; k < n; ++k) {
    const TimedRow& row = rows[k];
    EXPECT_NEAR(row.t, static_cast<double>(k) * dt, 1e-9);
    if (k > 0) samples += check_tool(f, rows, k, dt, speed, trial);
    if (k > 0 && k + 1 < n) {
      const Config v = (rows[k + 1].row.q - rows[k - 1].row.q) / (2 * dt);
      EXPECT_LE((v - row.v).lpNorm<Eigen::Infinity>(),
                1e-6 + 0.1 * rates.acceleration.maxCoeff() * dt);
    }
  }
  EXPECT_LE((rows.front().row.q - f.rows.front().q).lpNorm<Eigen::Infinity>(), 1e-8);
  EXPECT_LE((rows.back().row.q - f.rows.back().q).lpNorm<Eigen::Infinity>(), 1e-8);
  return samples;
}

TEST(TimePath, KeepsTheRatesOfTheJointsAndTheToolOnItsPath) {
  const std::uint64_t base = seed("TimePath");
  int timed = 0, stops = 0, slow = 0, samples = 0;
  double worst[3] = {0, 0, 0};
  const std::vector<TestRobot> robots = all_robots();
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathSmoothing smooth = random.coin(0.2) ? PathSmoothing{0, 0} : PathSmoothing{};
    const auto f =
        followed(robots[static_cast<std::size_t>(trial) % robots.size()], random, smooth);
    if (!f) continue;
    Limits limits;
    limits.joint_acceleration.emplace().fill(random.uniform(2, 15));
    limits.joint_jerk.emplace().fill(random.uniform(20, 300));
    const JointRates rates = joint_rates(f->chain, limits, "test");
    TimingOptions options;
    options.speed = random.coin() ? 0.05 : 0.25;
    options.rate = random.coin() ? 250 : 1000;
    if (random.coin()) options.turn_speed = 0.5;
    const auto motion = make_path_motion(f->chain, f->kind, *f->path, f->rows);
    const TimingResult result = time_path(*motion, rates, options);
    if (!result.motion) continue;
    ++timed;
    const TimedPath& out = *result.motion;
    ASSERT_GE(out.rows.size(), 2u);
    const double dt = 1 / options.rate;
    keep_worst_rates(out.rows, dt, rates, worst);
    samples += check_rows(*f, out.rows, dt, options.speed, rates, trial);
    EXPECT_GE(out.duration, out.ideal * (1 - 1e-6));
    int sharp = 0;
    for (const ToolPath::Corner& corner : f->path->corners()) sharp += corner.reach == 0;
    EXPECT_EQ(out.stops.size(), static_cast<std::size_t>(sharp));
    stops += sharp;
    slow += static_cast<int>(out.slow.size());
  }
  std::printf("%d motions, %d stops, %d slow stretches, %d samples; worst ratios %.4f %.4f %.4f\n",
              timed, stops, slow, samples, worst[0], worst[1], worst[2]);
  for (const double ratio : worst) EXPECT_LE(ratio, 1 + 1e-9);
  EXPECT_GT(worst[2], 0.8);
  EXPECT_GE(timed, at_least(20));
  EXPECT_GE(stops, at_least(6));
  EXPECT_GE(samples, at_least(5001));
}

TEST(TimeArms, TwoArmsAlikeMoveAsOne) {
  const std::uint64_t base = seed("TimeArms.TwoArmsAlikeMoveAsOne");
  int timed = 0, stops = 0;
  double apart = 0;
  const std::vector<TestRobot> robots = all_robots();
  for (int trial = 0; trial < trials(24); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathSmoothing smooth = random.coin(0.2) ? PathSmoothing{0, 0} : PathSmoothing{};
    const auto f =
        followed(robots[static_cast<std::size_t>(trial) % robots.size()], random, smooth);
    if (!f) continue;
    const JointRates rates = joint_rates(f->chain, Limits{}, "test");
    const TimingOptions options{.speed = random.coin() ? 0.05 : 0.25};
    const auto motion = make_path_motion(f->chain, f->kind, *f->path, f->rows);
    const TimingResult one = time_path(*motion, rates, options);
    const CommonParameter common = common_parameter({&*f->path, &*f->path}, -1, 0.02);
    std::array<TimedArm, 2> arms;
    for (std::size_t k = 0; k < 2; ++k)
      arms[k] = {motion.get(), &rates, &options, &common.travel[k]};
    const ArmsTiming two = time_arms(arms, common.rests);
    ASSERT_EQ(one.motion.has_value(), !two.failure.has_value());
    if (!one.motion) continue;
    ++timed;
    stops += static_cast<int>(one.motion->stops.size());
    EXPECT_TRUE(common.blended.empty());
    for (const TimedPath& out : two.motions) {
      ASSERT_EQ(out.rows.size(), one.motion->rows.size());
      EXPECT_NEAR(out.duration, one.motion->duration, 1e-6 * out.duration);
      EXPECT_NEAR(out.ideal, one.motion->ideal, 1e-9);
      EXPECT_EQ(out.stops.size(), one.motion->stops.size());
      for (std::size_t row = 0; row < out.rows.size(); ++row)
        apart = std::max(
            apart, (out.rows[row].row.q - one.motion->rows[row].row.q).lpNorm<Eigen::Infinity>());
    }
  }
  std::printf("%d motions, %d stops: rows within %.2g rad\n", timed, stops, apart);
  EXPECT_LE(apart, 1e-6);
  EXPECT_GE(timed, at_least(10));
}

TEST(TimePath, StartsAsBrisklyOnCoarseLayers) {
  const Chain chain = arm_of(data_robot("iiwa14")).chain;
  const ArmClass kind = classify(chain, "iiwa14");
  const SrsArm& arm = *kind.srs;
  const Config q = {0.2, 0.6, -0.3, -1.2, 0.4, 0.9, 0.1};
  const Waypoint first = waypoint_of(chain.tool(q));
  Limits limits;
  limits.joint_acceleration.emplace().fill(10);
  limits.joint_jerk.emplace().fill(100);
  const JointRates rates = joint_rates(chain, limits, "test");
  std::vector<double> durations;
  for (const double ds : {0.002, 0.005, 0.02}) {
    const ToolPath path({first, moved(first, Vector3d(0, 0.12, 0.05), Vector3d::Zero())},
                        {.ds = ds, .dphi = 0.05, .dalpha = 0.1}, "test");
    std::vector<TrajectoryRow> rows;
    const std::vector<ArmPlane> planes = carried_planes(arm, path);
    const double phi = planes[0].angle_of(arm.elbow_axis(q));
    for (int i = 0; i < path.size(); ++i)
      rows.push_back(
          {path.layer(i).s, phi, arm.branch(q),
           srs_ik(arm, elbow_circles(arm, planes[static_cast<std::size_t>(i)], path.layer(i).tool),
                  phi, arm.branch(q))});
    const TimingResult result = time_path(*make_path_motion(chain, kind, path, rows), rates,
                                          {.speed = 0.05, .turn_speed = {}, .rate = 250});
    ASSERT_TRUE(result.motion);
    durations.push_back(result.motion->duration);
  }
  std::printf("%.3f, %.3f and %.3f s\n", durations[0], durations[1], durations[2]);
  for (const double duration : durations) EXPECT_NEAR(duration, durations[0], 0.02);
}

TEST(TimePath, SaysWhatIsAssumedAndWhatIsMissing) {
  const Chain chain = arm_of(data_robot("iiwa14")).chain;
  Limits limits;
  EXPECT_EQ(joint_rates(chain, limits, "test").assumed.size(), 2u);
  limits.joint_acceleration.emplace().fill(3);
  limits.joint_jerk.emplace().fill(4);
  limits.joint_speed.emplace().fill(2);
  const JointRates rates = joint_rates(chain, limits, "test");
  EXPECT_TRUE(rates.assumed.empty());
  EXPECT_EQ(rates.speed[3], 2);
  EXPECT_EQ(rates.acceleration[3], 3);
  EXPECT_EQ(rates.jerk[3], 4);
  Chain without = chain;
  without.limit[2].velocity = 0;
  EXPECT_EQ(joint_rates(without, limits, "test").speed[2], 2);
  EXPECT_THROW(joint_rates(without, {}, "test"), InputError);
  without.limit[2].acceleration = 5;
  EXPECT_EQ(joint_rates(chain, {}, "test").acceleration[2], 10);
}

}  // namespace
}  // namespace swivel
