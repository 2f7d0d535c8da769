// SPDX-License-Identifier: BSD-3-Clause
// Arms of six joints that turn and one that slides: kinematics, bounds of motion, and self-motion.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "axes_robots.hpp"
#include "kinematics/kernels/newton.hpp"
#include "kinematics/newton/pose_newton.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns the pose of the tip from the joints of the model, one after the other, by their origins
/// and axes alone.
Pose plain_tip(const TestRobot& robot, const Chain& chain, const Config& q) {
  Pose tip = Pose::Identity();
  for (int link = robot.model->find_link(robot.tip_link);
       link != robot.model->find_link(robot.base_link);) {
    const Joint& joint = robot.model->joints[static_cast<std::size_t>(
        robot.model->links[static_cast<std::size_t>(link)].parent_joint)];
    Pose moved = joint.origin;
    for (std::size_t k = 0; k < kDof; ++k) {
      if (chain.joint_names[k] != joint.name) continue;
      const double x = q[static_cast<Eigen::Index>(k)];
      if (joint.type == Joint::Type::kPrismatic)
        moved.translate(x * joint.axis);
      else
        moved.rotate(Eigen::AngleAxisd(x, joint.axis));
    }
    tip = moved * tip;
    link = joint.parent_link;
  }
  return tip;
}

TEST(Slide, ToolAndJacobianAreThoseOfThePlainChain) {
  Random random(seed("Slide.ToolAndJacobian"));
  double worst = 0, worst_slope = 0;
  int compared = 0;
  for (const TestRobot& robot : slide_robots()) {
    const Chain chain = arm_of(robot).chain;
    ASSERT_GE(chain.slide(), 0) << robot.name;
    for (int trial = 0; trial < trials(200); ++trial, ++compared) {
      const Config q = random_config(chain, random);
      const Pose tool = chain.tool(q);
      worst = std::max(
          worst, (tool.matrix() - plain_tip(robot, chain, q).matrix()).lpNorm<Eigen::Infinity>());
      Config cosine = q.array().cos().matrix(), sine = q.array().sin().matrix();
      cosine[chain.slide()] = 0;
      sine[chain.slide()] = q[chain.slide()];
      worst = std::max(worst, (chain.tool_point(cosine, sine) - tool.translation()).norm());
      const auto J = chain.jacobian(q);
      for (int k = 0; k < kDof; ++k) {
        const double h = 1e-6;
        const Pose ahead = chain.tool(q + h * Config::Unit(k)),
                   behind = chain.tool(q - h * Config::Unit(k));
        const Vector3d linear = (ahead.translation() - behind.translation()) / (2 * h);
        const Eigen::AngleAxisd turn(ahead.linear() * behind.linear().transpose());
        worst_slope =
            std::max({worst_slope, (J.block<3, 1>(0, k) - linear).norm(),
                      (J.block<3, 1>(3, k) - turn.axis() * turn.angle() / (2 * h)).norm()});
      }
    }
  }
  std::printf("%d configurations, poses within %.1e, Jacobians within %.1e\n", compared, worst,
              worst_slope);
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(worst_slope, 1e-7);
}

TEST(Slide, MotionRadiiBoundEveryPointThatMoves) {
  Random random(seed("Slide.MotionRadii"));
  int moved = 0;
  double most = 0;
  for (const TestRobot& robot : slide_robots()) {
    const ArmModel arm = arm_of(robot);
    const auto bodies = robot_bodies(*robot.model, arm, {});
    const auto radii = motion_radii(arm.chain, bodies);
    for (int trial = 0; trial < trials(400); ++trial) {
      const Config q0 = random_config(arm.chain, random);
      Config q1 = q0;
      const int only = trial % 2 == 0 ? random.below(kDof) : -1;
      for (int j = 0; j < kDof; ++j)
        if (only < 0 || j == only) q1[j] += random.uniform(-0.3, 0.3);
      const JointLimit& limit = arm.chain.limit[static_cast<std::size_t>(arm.chain.slide())];
      q1[arm.chain.slide()] = std::clamp(q1[arm.chain.slide()], limit.lower, limit.upper);
      double bound = 0;
      for (int j = 0; j < kDof; ++j)
        bound += std::abs(q1[j] - q0[j]) * radii[static_cast<std::size_t>(j)];
      const auto G0 = arm.chain.displacements(q0), G1 = arm.chain.displacements(q1);
      for (const RobotBody& body : bodies)
        for (const Ball& ball : bounding_balls(body.shape))
          for (int k = 0; k < 6; ++k, ++moved) {
            const Vector3d x =
                body.pose * (ball.center + ball.radius * (k % 2 ? 1 : -1) * Vector3d::Unit(k / 2));
            const auto g = static_cast<std::size_t>(body.group);
            const double way = (G1[g] * x - G0[g] * x).norm();
            EXPECT_LE(way, bound + 1e-12) << robot.name;
            if (bound > 1e-9) most = std::max(most, way / bound);
          }
    }
  }
  std::printf("%d points moved, by at most %.3f of the bound\n", moved, most);
  EXPECT_GE(moved, at_least(10001));
  EXPECT_GT(most, 0.9);  // a slide alone moves what it carries by its own move
}

std::vector<const NewtonKernels*> newton_units() {
  std::vector<const NewtonKernels*> units{&scalar_newton_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_newton_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_newton_kernels());
#endif
  return units;
}

/// Points near a pose that is reached, asked of every vector unit at once: equal bits, on the pose.
TEST(Slide, NewtonStandsOnThePoseWithTheSameBitsOnEveryVectorUnit) {
  Random random(seed("Slide.Newton"));
  const auto units = newton_units();
  int found = 0, failed = 0;
  double worst = 0;
  for (const TestRobot& robot : slide_robots()) {
    const Chain chain = arm_of(robot).chain;
    const PoseNewton newton(chain);
    for (int trial = 0; trial < trials(200); ++trial) {
      const Config reached = random_config(chain, random);
      const Pose tool = chain.tool(reached);
      const bool locked = random.coin();
      NewtonTask task = newton.task(tool, locked ? NewtonMove::kLocked : NewtonMove::kNearest, 8);
      task.joint = random.coin() ? chain.slide() : random.below(kDof);
      std::vector<Config> starts(static_cast<std::size_t>(1 + random.below(20)), reached);
      std::vector<double> values;
      for (Config& start : starts) {
        for (double& x : start.coordinates()) x += random.uniform(-0.1, 0.1);
        values.push_back(start[task.joint]);
      }
      for (double& scale2 : task.scale2) scale2 = 1;
      task.n = static_cast<int>(starts.size());
      task.start = starts[0].data();
      task.value = values.data();
      std::vector<std::vector<Config>> q(units.size(), std::vector<Config>(starts.size()));
      std::vector<std::vector<unsigned char>> ok(units.size(),
                                                 std::vector<unsigned char>(starts.size(), 2));
      std::vector<Config> null(starts.size());
      for (std::size_t unit = 0; unit < units.size(); ++unit) {
        task.q = task.particular = q[unit][0].data();
        task.null = null[0].data();
        task.found = ok[unit].data();
        units[unit]->solve(task);
        ASSERT_EQ(ok[unit], ok[0]) << robot.name;
      }
      for (std::size_t k = 0; k < starts.size(); ++k) {
        (ok[0][k] != 0 ? found : failed) += 1;
        if (ok[0][k] == 0) continue;
        for (std::size_t unit = 1; unit < units.size(); ++unit)
          ASSERT_EQ(0, std::memcmp(q[unit][k].data(), q[0][k].data(), sizeof(Config)))
              << robot.name;
        worst =
            std::max(worst, (chain.tool(q[0][k]).matrix() - tool.matrix()).cwiseAbs().maxCoeff());
        if (locked) {
          ASSERT_EQ(q[0][k][task.joint], values[k]);
        }
      }
    }
  }
  std::printf("%zu units, %d points found, %d not, off the pose by up to %.1e\n", units.size(),
              found, failed, worst);
  EXPECT_GE(found, at_least(3000));
  EXPECT_LT(worst, 1e-9);
}

/// Closed forms of the six joints that turn, with the slide 1 mm further from one to the next, both
/// ends of its range included.
std::vector<std::pair<double, ClosedForm>> forms_every_millimetre(const Chain& chain) {
  const JointLimit& limit = chain.limit[static_cast<std::size_t>(chain.slide())];
  const int steps = static_cast<int>(std::ceil((limit.upper - limit.lower) / 0.001));
  std::vector<std::pair<double, ClosedForm>> forms;
  for (int k = 0; k <= steps; ++k) {
    const double value = k == steps ? limit.upper : limit.lower + 0.001 * k;
    forms.emplace_back(value, *ClosedForm::of(lock_joint(chain, chain.slide(), value)));
  }
  return forms;
}

/// Returns the joints at a pose with the slide at `value` that keep the limits.
std::vector<Config> solutions_at(const Chain& chain, const ClosedForm& form, const Pose& tool,
                                 double value) {
  std::vector<Config> kept;
  const int slide = chain.slide();
  for (const Config6& six : form.solve(tool)) {
    Config q;
    for (int j = 0; j < kDof; ++j) q[j] = j == slide ? value : six[j < slide ? j : j - 1];
    bool inside = true;
    for (int j = 0; j < kDof && inside; ++j) {
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
      if (j == slide || limit.upper - limit.lower >= kTwoPi) continue;
      const double middle = (limit.lower + limit.upper) / 2;
      q[j] = middle + std::remainder(q[j] - middle, kTwoPi);
      inside = q[j] > limit.lower && q[j] < limit.upper;
    }
    if (inside) kept.push_back(q);
  }
  return kept;
}

/// Returns how far q is from the nearest chord between four points of each cubic of the arcs.
double distance_to(const std::vector<SelfMotionArc>& arcs, const Config& q, int slide) {
  const auto way = [&](const Config& to, const Config& from) {
    Config d = to - from;
    for (int j = 0; j < kDof; ++j)
      if (j != slide) d[j] = std::remainder(d[j], kTwoPi);
    return d;
  };
  double least = 1e9;
  for (const SelfMotionArc& arc : arcs)
    for (int chord = 0; chord < arc.chords(); ++chord) {
      // A cubic leaves the range of its ends by less than this.
      constexpr double kBeyond = 0.1;  // m
      const double first = arc.q[static_cast<std::size_t>(chord)][slide],
                   last = arc.at(chord, 1)[slide];
      if (q[slide] < std::min(first, last) - kBeyond || q[slide] > std::max(first, last) + kBeyond)
        continue;
      for (int part = 0; part < 4; ++part) {
        const Config from = arc.at(chord, part / 4.0), d = way(q, from),
                     c = way(arc.at(chord, (part + 1) / 4.0), from);
        const double along = joint_dot(d, c) / std::max(joint_squared_norm(c), 1e-30);
        least = std::min(least, joint_norm(d - std::clamp(along, 0.0, 1.0) * c));
      }
    }
  return least;
}

/// Arcs of a pose against the closed form with the slide at values 1 mm apart.
TEST(Slide, MissesNoArcThatClosedFormsFindEveryMillimetre) {
  Random random(seed("Slide.Arcs"));
  for (const TestRobot& robot : slide_robots()) {
    const Chain chain = arm_of(robot).chain;
    const ArmClass kind = classify(chain, robot.name);
    ASSERT_EQ(kind.kind, ArmKind::kArcs) << robot.name;
    ASSERT_EQ(kind.lock.best, chain.slide()) << robot.name;
    const SelfMotion motion(chain, kind.lock, 0);
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(chain.slide())];
    const auto forms = forms_every_millimetre(chain);
    int arcs_found = 0, solutions = 0, missed = 0, ends = 0;
    double residual = 0, farthest = 0;
    const int poses = trials(limit.upper - limit.lower > 2 ? 4 : 20);
    for (int trial = 0; trial < poses; ++trial) {
      const Pose tool = chain.tool(random_config(chain, random));
      const auto arcs = motion.arcs(tool);
      arcs_found += static_cast<int>(arcs.size());
      for (const SelfMotionArc& arc : arcs) {
        EXPECT_EQ(arc.slide, chain.slide());
        for (std::size_t k = 0; k < arc.q.size(); ++k) {
          residual = std::max(
              residual, (chain.tool(arc.q[k]).matrix() - tool.matrix()).cwiseAbs().maxCoeff());
          for (int j = 0; j < kDof; ++j) {
            const JointLimit& of = chain.limit[static_cast<std::size_t>(j)];
            EXPECT_TRUE(of.continuous || (arc.q[k][j] >= of.lower && arc.q[k][j] <= of.upper))
                << robot.name << " joint " << j;
          }
        }
        ends += (arc.limit[0] >= 0) + (arc.limit[1] >= 0);
      }
      for (const auto& [value, form] : forms)
        for (const Config& q : solutions_at(chain, form, tool, value)) {
          ++solutions;
          const double off = distance_to(arcs, q, chain.slide());
          farthest = std::max(farthest, off);
          missed += off > 0.02;
        }
    }
    std::printf(
        "  %s: %d poses, %.2f arcs a pose, %d ends on limits, residual %.1e; %d solutions, "
        "%d off every arc, farthest %.4f\n",
        robot.name.c_str(), poses, static_cast<double>(arcs_found) / poses, ends, residual,
        solutions, missed, farthest);
    EXPECT_GE(solutions, at_least(poses * 100)) << robot.name;
    EXPECT_EQ(missed, 0) << robot.name;
    EXPECT_LE(residual, 1e-9) << robot.name;
  }
}

/// An arm with two sliding joints is refused, and the message names both joints.
TEST(Slide, RefusesTwoSlides) {
  const TestRobot one = slide_robots()[0];
  TestRobot two = one;
  auto model = std::make_shared<RobotModel>(*one.model);
  model->joints[static_cast<std::size_t>(model->find_joint("joint_1"))].type =
      Joint::Type::kPrismatic;
  two.model = model;
  const auto refusal = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal([&] { (void)arm_of(two); }).find("'slide' and 'joint_1' are prismatic"),
            std::string::npos);
}

/// Without a closed form of the six others arcs are sampled: they are exact, and few are missed.
TEST(Slide, FindsMostArcsWithoutAClosedForm) {
  Random random(seed("Slide.FindsMostArcsWithoutAClosedForm"));
  for (TestRobot robot : {slide_robots()[0], slide_robots()[2]}) {
    auto model = std::make_shared<RobotModel>(*robot.model);
    Joint& fifth = model->joints[static_cast<std::size_t>(model->find_joint("joint_5"))];
    fifth.origin.translation() += Vector3d(0.05, 0.02, 0.01);
    fifth.origin.rotate(Eigen::AngleAxisd(0.2, Vector3d(1, 2, 3).normalized()));
    robot.model = model;
    const Chain chain = arm_of(robot).chain;
    const ArmClass kind = classify(chain, robot.name);
    ASSERT_EQ(kind.kind, ArmKind::kSampled) << robot.name;
    const SelfMotion motion(chain, kind.lock, 0);
    const PoseNewton newton(chain);
    const int poses = trials(12);
    int sought = 0, missed = 0;
    double residual = 0;
    for (int trial = 0; trial < poses; ++trial) {
      const Pose tool = chain.tool(random_config(chain, random));
      const auto arcs = motion.arcs(tool);
      for (const SelfMotionArc& arc : arcs)
        for (const Config& q : arc.q)
          residual =
              std::max(residual, (chain.tool(q).matrix() - tool.matrix()).cwiseAbs().maxCoeff());
      for (int start = 0; start < 60; ++start) {
        auto found = newton.approach(random_config(chain, random), tool, 60);
        if (!found || !motion.canonical(found->q)) continue;
        ++sought;
        missed += distance_to(arcs, found->q, chain.slide()) > 0.02;
      }
    }
    std::printf(
        "  %s without a closed form: %d poses, residual %.1e; %d solutions sought, %d off "
        "every arc\n",
        robot.name.c_str(), poses, residual, sought, missed);
    EXPECT_LE(residual, 1e-9) << robot.name;
    EXPECT_GE(sought, at_least(poses * 5)) << robot.name;
    EXPECT_LE(missed, sought / 20) << robot.name;
  }
}

}  // namespace
}  // namespace swivel
