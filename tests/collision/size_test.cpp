// SPDX-License-Identifier: BSD-3-Clause
// Why sizes and coordinates end at kMostMetres: up to there the clearance from bodies is right,
// beyond 1e5 m it soon is not.
#include <gtest/gtest.h>

#include "random_problem.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/bounds.hpp"

namespace swivel {
namespace {

using namespace test;

struct Segment {
  Vector3d a, b;
  double radius;
};

/// The arm's capsules at q.
std::vector<Segment> capsules(const Chain& chain, const std::vector<RobotBody>& bodies,
                              const Config& q) {
  const auto G = chain.displacements(q);
  std::vector<Segment> result;
  for (const RobotBody& body : bodies) {
    const auto& capsule = std::get<Capsule>(body.shape);
    const Pose X = G[body.group] * body.pose;
    result.push_back({X * Vector3d(0, 0, capsule.length / 2),
                      X * Vector3d(0, 0, -capsule.length / 2), capsule.radius});
  }
  return result;
}

double to_point(const Segment& c, const Vector3d& p) {
  const Vector3d along = c.b - c.a;
  return (p - c.a - std::clamp((p - c.a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along)
             .norm() -
         c.radius;
}

/// A body of kMostMetres a little off the arm: a ball, and bodies whose flat end faces it.
TEST(Size, ClearanceFromTheLargestBodiesIsRight) {
  const TestRobot robot = continuous_robot();
  PathProblem problem = problem_for(robot);
  const ArmModel arm = arm_of(robot);
  const std::vector<RobotBody> bodies = robot_bodies(*robot.model, arm, {});
  Random random(seed("ClearanceFromTheLargestBodiesIsRight"));
  const double half = kMostMetres / 2;
  int compared = 0;
  double worst = 0;
  for (int trial = 0; trial < trials(50); ++trial)
    for (const Shape& shape :
         {Shape(Sphere{half}), Shape(Box{Vector3d::Constant(2 * half)}),
          Shape(Cylinder{half, 2 * half}), Shape(box_mesh(Vector3d::Constant(2 * half)))}) {
      const Config q = random_config(arm.chain, random);
      const std::vector<Segment> links = capsules(arm.chain, bodies, q);
      const Vector3d n =
          Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
              .normalized();
      double far = -1e9;
      for (const Segment& c : links)
        far = std::max({far, c.a.dot(n) + c.radius, c.b.dot(n) + c.radius});
      SceneObject object{"large", shape, Pose::Identity(), {}};
      object.pose.linear() = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), n).toRotationMatrix();
      object.pose.translation() = n * (far + random.uniform(0.001, 0.02) + half);
      double exact = 1e9;
      for (const Segment& c : links)
        exact = std::min(exact, std::holds_alternative<Sphere>(shape)
                                    ? to_point(c, object.pose.translation()) - half
                                    : (object.pose.translation() - c.a).dot(n) - half - c.radius);
      for (const Segment& c : links)
        if (!std::holds_alternative<Sphere>(shape))
          exact = std::min(exact, (object.pose.translation() - c.b).dot(n) - half - c.radius);
      problem.scene = {object};
      const World world(*robot.model, arm, problem);
      World::Query query(world);
      const auto clearance = query.clearance(q);
      ASSERT_TRUE(clearance);
      if (world.body_names()[clearance->pair.b] != "large")
        continue;  // the arm is nearer to itself
      worst = std::max(worst, std::abs(clearance->distance - exact));
      ++compared;
    }
  std::printf("%d compared, worst %.3g mm\n", compared, 1e3 * worst);
  EXPECT_GE(compared, at_least(101));
  EXPECT_LT(worst, 5e-5);
}

}  // namespace
}  // namespace swivel
