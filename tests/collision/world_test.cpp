// SPDX-License-Identifier: BSD-3-Clause
// Worlds as planners use them: verdicts over all pairs, episodes, threads.
#include "swivel/collision/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "reference.hpp"
#include "seed.hpp"
#include "support.hpp"

namespace swivel {
namespace {

using namespace swivel::testing;

constexpr double kTau = 5e-5;

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3d(x, y, z);
  return pose;
}

/// One of every kind of shape, within reach.
std::vector<SceneObject> mixed_scene() {
  Pose upright = at(0.75, 0, 0.6);
  upright.linear() = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitY()).toRotationMatrix();
  return {{"panel", as_mesh(panel_mesh(1.0, 0.8, 0.04, 10), "panel"), upright, {}},
          {"ball", Sphere{0.15}, at(-0.5, 0.4, 0.7), {}},
          {"post", Capsule{0.05, 0.6}, at(-0.4, -0.5, 0.4), {}},
          {"crate", Box{Vector3d(0.3, 0.4, 0.2)}, at(0.1, 0.7, 0.3), {}},
          {"drum", Cylinder{0.12, 0.5}, at(0.2, -0.75, 0.5), {}},
          {"pipe", as_mesh(tube_mesh(0.05, 0.5, 12), "pipe"), at(-0.8, 0, 0.9), {}}};
}

/// The capsule arm with a box, a cylinder and a mesh among its bodies.
RobotModel mixed_arm() {
  RobotModel robot = capsule_arm();
  robot.links[5].collision[0].shape = Cylinder{0.065, 0.15};
  robot.links[6].collision[0].shape = as_mesh(sphere_mesh(0.07, 6), "wrist");
  robot.links[7].collision.push_back({Box{Vector3d(0.04, 0.06, 0.1)}, at(0, 0, 0.15)});
  return robot;
}

Pose pose_of(const World& world, const Chain& chain, const std::vector<SceneObject>& scene,
             int index, const Config& q) {
  const std::size_t i = static_cast<std::size_t>(index), robots = world.bodies().size();
  if (i >= robots) return scene[i - robots].pose;
  return chain.displacements(q)[world.bodies()[i].group] * world.bodies()[i].pose;
}

const Shape& shape_of(const World& world, const std::vector<SceneObject>& scene, int index) {
  const std::size_t i = static_cast<std::size_t>(index), robots = world.bodies().size();
  return i >= robots ? scene[i - robots].shape : world.bodies()[i].shape;
}

TEST(World, ClearanceAndFirstBelowAgreeWithTheReference) {
  const RobotModel robot = mixed_arm();
  const ArmModel arm = arm_of(robot);
  PathProblem problem = problem_for(robot);
  problem.scene = mixed_scene();
  problem.scene[0].shape =
      as_mesh(panel_mesh(1.0, 0.8, 0.04, 2), "panel");  // the reference is slow
  const World world(robot, arm, problem);
  World::Query query(world);
  Random random(31);
  int free = 0, touching = 0;
  for (int k = 0; k < test::trials(12); ++k) {
    const Config q = random.config(2.0);
    std::vector<double> truth;
    for (const BodyPair& p : world.pairs())
      truth.push_back(reference_clearance(
          shape_of(world, problem.scene, p.a), pose_of(world, arm.chain, problem.scene, p.a, q),
          shape_of(world, problem.scene, p.b), pose_of(world, arm.chain, problem.scene, p.b, q)));
    const double least = *std::min_element(truth.begin(), truth.end());
    const auto found = query.clearance(q);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, least, kTau);
    for (const double d : {0.0, 0.005, 0.05, least + 0.001, std::max(0.0, least - 0.001)}) {
      const auto first = query.find_violating_pair(q, d);
      std::size_t expected = 0;
      bool band = false;
      for (; expected < truth.size() && truth[expected] >= d && truth[expected] > 0; ++expected)
        band |= truth[expected] < d + kTau;
      if (band) continue;
      if (expected < truth.size() && truth[expected] > 0 && truth[expected] > d - kTau) continue;
      ASSERT_EQ(first.has_value(), expected < truth.size()) << least << " " << d;
      if (!first) continue;
      EXPECT_EQ(first->a, world.pairs()[expected].a);
      EXPECT_EQ(first->b, world.pairs()[expected].b);
    }
    ++(least > 0 ? free : touching);
  }
  EXPECT_GE(free, test::at_least(2));
  EXPECT_GE(touching, test::at_least(2));
  EXPECT_EQ(query.counters().fcl_failures, 0);
}

/// A likely pair changes who is named, not whether.
TEST(World, TheLikelyPairIsAskedFirst) {
  const RobotModel robot = mixed_arm();
  PathProblem problem = problem_for(robot);
  problem.scene = mixed_scene();
  const World world(robot, arm_of(robot), problem);
  World::Query query(world, DistanceProofs::kOn);
  Random random(34);
  int named = 0, others = 0, none = 0;
  for (int k = 0; k < test::trials(3000); ++k) {
    const Config q = random.config(2.5);
    const BodyPair suspected = world.pairs()[random.index(static_cast<int>(world.pairs().size()))];
    const bool guilty = query.pair_violates(q, suspected, 0.005);
    const auto plain = query.find_violating_pair(q, 0.005),
               found = query.find_violating_pair(q, 0.005, suspected);
    ASSERT_EQ(plain.has_value(), found.has_value());
    if (!found) {
      ++none;
    } else if (guilty) {
      ASSERT_EQ(*found, suspected);
      ++named;
    } else {
      ASSERT_EQ(*found, *plain);
      ++others;
    }
  }
  EXPECT_GE(named, test::at_least(31));
  EXPECT_GE(others, test::at_least(301));
  EXPECT_GE(none, test::at_least(301));
}

TEST(World, NothingToTouch) {
  RobotModel robot = capsule_arm();
  for (Link& link : robot.links) link.collision.clear();
  const World world(robot, arm_of(robot), problem_for(robot));
  World::Query query(world);
  EXPECT_TRUE(world.pairs().empty());
  EXPECT_FALSE(query.find_violating_pair(Config::Zero(), 1.0));
  EXPECT_FALSE(query.clearance(Config::Zero()));
  EXPECT_EQ(query.counters().fcl_calls, 0);
}

TEST(World, FarAwayCostsNoFclCall) {
  const RobotModel robot = capsule_arm();
  PathProblem problem = problem_for(robot);
  problem.scene.push_back({"far", Box{Vector3d(1, 1, 1)}, at(9, 0, 0), {}});
  const World world(robot, arm_of(robot), problem);
  World::Query query(world);
  EXPECT_FALSE(query.find_violating_pair(Config::Zero(), 0.005));
  const auto before = query.counters().fcl_calls;
  EXPECT_LE(before, 10);  // neighbours' neighbours of the arm itself at most
}

TEST(World, WarnsOfOpenMeshes) {
  const RobotModel robot = mixed_arm();
  PathProblem problem = problem_for(robot);
  problem.scene = mixed_scene();
  const World world(robot, arm_of(robot), problem);
  ASSERT_EQ(world.warnings().size(), 1u);
  EXPECT_NE(world.warnings()[0].find("pipe"), std::string::npos);
  EXPECT_EQ(world.body_names().size(), world.bodies().size() + 6);
}

TEST(World, AnEpisodeIsTheSameAsAFreshWorld) {
  const RobotModel robot = mixed_arm();
  const ArmModel arm = arm_of(robot);
  PathProblem problem = problem_for(robot);
  problem.scene = mixed_scene();
  const World base(robot, arm, problem);
  problem.scene[0].pose.translation().y() += 0.1;
  problem.scene.erase(problem.scene.begin() + 2);
  const World episode(base, problem.scene), fresh(robot, arm, problem);
  ASSERT_EQ(episode.body_names(), fresh.body_names());
  ASSERT_EQ(episode.pairs().size(), fresh.pairs().size());
  World::Query a(episode), b(fresh);
  Random random(32);
  for (int k = 0; k < test::trials(300); ++k) {
    const Config q = random.config(2.5);
    const auto x = a.find_violating_pair(q, 0.005), y = b.find_violating_pair(q, 0.005);
    ASSERT_EQ(x.has_value(), y.has_value());
    ASSERT_TRUE(!x || (x->a == y->a && x->b == y->b));
  }
}

TEST(World, ThreadsAndHistoryChangeNothing) {
  const RobotModel robot = mixed_arm();
  PathProblem problem = problem_for(robot);
  problem.scene = mixed_scene();
  const World world(robot, arm_of(robot), problem);
  struct Question {
    Config q;
    double d;
  };
  Random random(33);
  std::vector<Question> questions;
  for (int k = 0; k < 1000; ++k)
    questions.push_back({random.config(2.0), k % 3 == 0 ? 0.005 : random.uniform(0, 0.05)});
  using Answer = std::pair<int, int>;
  const auto ask = [&](World::Query& query, std::size_t k) {
    const auto pair = query.find_violating_pair(questions[k].q, questions[k].d);
    return pair ? Answer(pair->a, pair->b) : Answer(-1, -1);
  };
  std::vector<Answer> serial;
  World::Query query(world);
  for (std::size_t k = 0; k < questions.size(); ++k) serial.push_back(ask(query, k));
  const auto free = std::count(serial.begin(), serial.end(), Answer(-1, -1));
  EXPECT_GT(free, 50);
  EXPECT_LT(free, 950);

  // The trees of its meshes are built by whichever thread comes first.
  const World fresh(robot, arm_of(robot), problem);
  const std::size_t triangles = fresh.triangles_to_make_ready();
  EXPECT_GT(triangles, 200u);
  fresh.make_ready([] { return true; });
  EXPECT_EQ(fresh.triangles_to_make_ready(), triangles);
  std::vector<std::vector<Answer>> answers(4, std::vector<Answer>(questions.size()));
  std::vector<std::vector<double>> clearances(4);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      World::Query own(fresh, t < 2 ? DistanceProofs::kOff : DistanceProofs::kOn);
      const std::size_t n = questions.size();
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = t % 2 ? n - 1 - k : (k + t * n / 4) % n;
        answers[t][i] = ask(own, i);
      }
      for (std::size_t k = 0; k < 20; ++k)
        clearances[t].push_back(own.clearance(questions[k].q)->distance);  // builds the lazy trees
    });
  threads.emplace_back([&] { fresh.make_ready([] { return false; }); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(fresh.triangles_to_make_ready(), 0u);
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(answers[t], serial);
    EXPECT_EQ(clearances[t], clearances[0]);
  }
}

}  // namespace
}  // namespace swivel
