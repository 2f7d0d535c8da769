// SPDX-License-Identifier: BSD-3-Clause
// Clearances kept from one posture to the next, against questions that know nothing of each other.
#include <gtest/gtest.h>

#include <cmath>

#include "random_problem.hpp"
#include "shapes/bound.hpp"
#include "support.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using namespace detail;
using test::Random;

/// Postures of a walk: small and large steps, turns, stays and jumps.
class Walk {
 public:
  Walk(const Chain& chain, Random& random) : chain_(&chain), random_(&random) { jump(); }
  const Config& next() {
    if (random_->coin(0.01)) jump();
    if (random_->coin(0.05)) turn();
    if (!random_->coin(0.05)) q_ += step_;
    return q_;
  }

 private:
  void jump() {
    q_ = test::random_config(*chain_, *random_);
    turn();
  }
  void turn() {
    const double length = std::pow(10, random_->uniform(-4, -1));
    for (int j = 0; j < kDof; ++j)
      step_[j] = random_->coin(0.3) ? 0 : random_->uniform(-length, length);
  }
  const Chain* chain_;
  Random* random_;
  Config q_, step_;
};

/// Counts questions that were put to queries which keep clearances and to plain ones.
struct KeptCounts {
  std::int64_t questions = 0, pairs = 0, named = 0, turned = 0, scene_questions = 0, only_own = 0,
               reduced = 0;
};

/// Queries of one world: `kept` keeps clearances from posture to posture, `plain` knows nothing of
/// the posture before, and `fcl` asks FCL alone.
struct ComparedQueries {
  explicit ComparedQueries(const World& of)
      : world(of), kept(of, DistanceProofs::kOn), plain(of, DistanceProofs::kOn), fcl(of) {}
  const World& world;
  World::Query kept, plain, fcl;
};

/// A question about a posture (rad): d is a distance (m), and `by_rule` tells that the threshold
/// follows the clearances of the world instead.
struct Question {
  Config q;
  double d;
  bool by_rule;
  std::optional<BodyPair> suspected;
  Threshold threshold;
};

/// Draws the distance, the suspected pair and the threshold of a question about q.
Question random_question(const World& world, const Config& q, bool by_rule, Random& random) {
  const double d = random.coin(0.8) ? 0.005 : random.uniform(0, 0.05);
  std::optional<BodyPair> suspected;
  if (random.coin(0.2))
    suspected = world.pairs()[random.below(static_cast<int>(world.pairs().size()))];
  const Threshold threshold =
      by_rule ? Threshold(ClearanceRule::kNode, random.coin() ? 0 : random.uniform(-0.01, 0.01))
              : Threshold(d);
  return {q, d, by_rule, suspected, threshold};
}

/// Checks that a pair which was found by a proof violates its threshold, within the band in which
/// FCL alone decides.
void check_proved_pair(ComparedQueries& queries, const Question& asked, const BodyPair& found,
                       KeptCounts& counts) {
  const double node = queries.world.required_clearance(found).node;
  const double required = asked.by_rule ? node + asked.threshold.more : asked.d;
  ASSERT_TRUE(required <= kVerdictBand ||
              queries.plain.pair_violates(asked.q, found, required - kVerdictBand));
  counts.reduced += asked.by_rule && node < 0.04;
}

/// Returns the suspected pair, else the first pair of a body of the robot and one of the scene,
/// that violates the threshold by the plain query.
std::optional<BodyPair> plain_pair_with_scene(ComparedQueries& queries, const Question& asked) {
  const World& world = queries.world;
  World::Query& plain = queries.plain;
  if (asked.suspected && plain.pair_violates(asked.q, *asked.suspected, asked.threshold))
    return asked.suspected;
  for (const BodyPair& pair : world.pairs())
    if (pair.b >= static_cast<int>(world.bodies().size()) &&
        plain.pair_violates(asked.q, pair, asked.threshold))
      return pair;
  return std::nullopt;
}

/// Compares the answer about the scene alone with that of the plain query; `found` is the answer
/// about all pairs.
void check_scene_question(ComparedQueries& queries, const Question& asked,
                          const std::optional<BodyPair>& found, std::uint64_t base,
                          KeptCounts& counts) {
  const auto of_scene = plain_pair_with_scene(queries, asked);
  ASSERT_EQ(queries.kept.find_violating_pair_with_scene(asked.q, asked.threshold, asked.suspected),
            of_scene)
      << "SWIVEL_TEST_SEED=" << base;
  ++counts.scene_questions;
  counts.only_own += found && !of_scene;
}

/// Puts other questions to the queries after the one that was answered with `found`: now and then
/// about the scene alone and about another posture, and about single pairs where `each_pair`.
void check_other_questions(ComparedQueries& queries, const Question& asked,
                           const std::optional<BodyPair>& found, bool each_pair, const Chain& chain,
                           std::uint64_t base, Random& random, KeptCounts& counts) {
  World::Query &kept = queries.kept, &plain = queries.plain;
  if (random.coin(0.2)) {
    check_scene_question(queries, asked, found, base, counts);
    if (::testing::Test::HasFatalFailure()) return;
  }
  if (random.coin(0.1)) {  // other questions to the same query disturb nothing
    const Config elsewhere = test::random_config(chain, random);
    ASSERT_EQ(kept.find_violating_pair(elsewhere, asked.d),
              plain.find_violating_pair(elsewhere, asked.d));
  }
  if (!each_pair) return;
  for (const BodyPair& pair : queries.world.pairs())
    ASSERT_EQ(kept.pair_violates(asked.q, pair, asked.threshold),
              queries.fcl.pair_violates(asked.q, pair, asked.threshold));
}

/// Prints what was asked of a robot and how many FCL calls it took.
void print_counts(const std::string& robot, const KeptCounts& counts, const CollisionCounters& kept,
                  const CollisionCounters& plain) {
  const auto questions = static_cast<double>(counts.questions);
  std::printf(
      "%s: %lld questions (%lld answered by a pair, %lld turns from free to not or back), %.1f of "
      "%.1f pairs a question kept, "
      "%lld FCL calls for %lld\n",
      robot.c_str(), static_cast<long long>(counts.questions), static_cast<long long>(counts.named),
      static_cast<long long>(counts.turned), static_cast<double>(kept.pairs_kept) / questions,
      static_cast<double>(counts.pairs) / questions, static_cast<long long>(kept.fcl_calls),
      static_cast<long long>(plain.fcl_calls));
  std::printf(
      "%lld answers were reduced pairs; %lld questions about the scene alone, %lld of them at "
      "which only the robot's own were "
      "near\n",
      static_cast<long long>(counts.reduced), static_cast<long long>(counts.scene_questions),
      static_cast<long long>(counts.only_own));
}

class Kept : public ::testing::TestWithParam<int> {};

TEST_P(Kept, ClearancesChangeNoAnswer) {
  const std::uint64_t base = test::seed("KeptClearances");
  Random random(base * 64 + static_cast<std::uint64_t>(GetParam()));
  const auto robots = test::all_robots();
  const test::TestRobot& robot = robots[GetParam()];
  const ArmModel arm = test::arm_of(robot);
  // With its SRDF, and without one at a clearance that many pairs cannot keep.
  const World with_srdf(*robot.model, arm, test::problem_for(robot));
  const test::TestRobot bare = test::without_srdf(robot);
  PathProblem wide = test::problem_for(bare);
  wide.limits.clearance = 0.04;
  const World without(*bare.model, arm, wide);
  const MeshPtr panel = testing::as_mesh(testing::panel_mesh(1.0, 0.6, 0.04, 6), "panel");
  CollisionCounters kept_counters, plain_counters;
  KeptCounts counts;
  for (int s = 0; s < test::trials(40); ++s) {
    std::vector<SceneObject> scene = test::random_problem(robot, random).scene;
    scene.push_back({"panel", panel, test::random_pose(random, Vector3d(0, 0, 0.6), 0.8), {}});
    const bool special = s % 3 == 2;
    const World world(special ? without : with_srdf, scene);
    ComparedQueries queries(world);
    Walk walk(arm.chain, random);
    bool was_free = false;
    for (int k = 0; k < 500; ++k) {
      const Question asked = random_question(world, walk.next(), special, random);
      const auto& [q, d, by_rule, suspected, threshold] = asked;
      const auto expected = queries.plain.find_violating_pair(q, threshold, suspected),
                 found = queries.kept.find_violating_pair_incremental(q, threshold, suspected);
      ASSERT_EQ(found, expected) << "SWIVEL_TEST_SEED=" << base << " " << robot.name << " scene "
                                 << s << " posture " << k << " d " << d;
      if (found && queries.kept.violation_is_proved())
        check_proved_pair(queries, asked, *found, counts);
      if (HasFatalFailure()) return;
      check_other_questions(queries, asked, found, k < 50, arm.chain, base, random, counts);
      if (HasFatalFailure()) return;
      ++counts.questions;
      counts.pairs += static_cast<std::int64_t>(world.pairs().size());
      counts.named += found.has_value();
      counts.turned += k > 0 && was_free == found.has_value();
      was_free = !found;
    }
    kept_counters += queries.kept.counters();
    plain_counters += queries.plain.counters();
  }
  print_counts(robot.name, counts, kept_counters, plain_counters);
  EXPECT_GT(counts.scene_questions, counts.questions / 10);
  EXPECT_EQ(plain_counters.pairs_kept, 0);
  EXPECT_GT(kept_counters.pairs_kept, counts.pairs / 4);
  // A short search for a proof that begins elsewhere may miss one now and then.
  EXPECT_LE(kept_counters.fcl_calls, plain_counters.fcl_calls + 2);
  EXPECT_GE(counts.named, test::at_least_among(counts.questions / 50));
  EXPECT_GE(counts.turned, test::at_least_among(counts.questions / 400));
}
INSTANTIATE_TEST_SUITE_P(Robots, Kept, ::testing::Range(0, 5));

/// What proves_violation() says is so, and it misses little where violation_proof_is_cheap().
TEST(Query, ProvesSoonThatAMeshIsTooNearToABox) {
  const std::uint64_t base = test::seed("ProvesSoon");
  Random random(base);
  const test::TestRobot robot = test::all_robots()[0];
  const ArmModel arm = test::arm_of(robot);
  PathProblem problem = test::problem_for(robot);
  problem.attached.push_back({"block", Box{Vector3d(0.08, 0.06, 0.1)},
                              Pose(Eigen::Translation3d(0, 0, 0.1)), robot.tip_link});
  problem.attached.push_back(
      {"rod", Cylinder{0.03, 0.1}, Pose(Eigen::Translation3d(0, 0, 0.2)), robot.tip_link});
  const MeshPtr fine = testing::as_mesh(testing::panel_mesh(0.6, 0.4, 0.04, 30), "fine panel");
  const MeshPtr coarse = testing::as_mesh(testing::panel_mesh(0.6, 0.4, 0.04, 2), "coarse panel");
  int below = 0, proved = 0, soon = 0;
  for (int scene = 0; scene < test::trials(30); ++scene) {
    const Config start = test::random_config(arm.chain, random);
    const Pose near = arm.chain.tool(start) * test::random_pose(random, Vector3d(0, 0, 0.15), 0.1);
    problem.scene = {{"fine", fine, near, {}}, {"coarse", coarse, near, {}}};
    const World world(*robot.model, arm, problem);
    World::Query query(world, DistanceProofs::kOn), fcl(world);
    for (int k = 0; k < 50; ++k) {
      Config q = start;
      for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.2, 0.2);
      const double d = random.uniform(0, 0.03);
      for (const BodyPair& pair : world.pairs()) {
        const bool too_near = fcl.pair_violates(q, pair, d),
                   certain = query.proves_violation(q, pair, d);
        if (certain) {
          ASSERT_TRUE(too_near && query.violation_is_proved())
              << "SWIVEL_TEST_SEED=" << base << " scene " << scene << " posture " << k;
        }
        if (!query.violation_proof_is_cheap(pair)) continue;
        ASSERT_EQ(world.names(pair)[1], "fine");
        ASSERT_TRUE(world.names(pair)[0] == "block" || world.names(pair)[0] == "rod");
        ++soon;
        below += too_near;
        proved += certain;
      }
    }
  }
  std::printf("%d questions, %d too near, %d of them proved soon\n", soon, below, proved);
  EXPECT_GT(below, test::at_least(300));
  EXPECT_GE(proved, below * 3 / 4);
}

/// No point of a box moves further than the bound says, and for a turn about the box's own z axis a
/// rod on it does not move at all.
TEST(Motion, BoundsEveryPoint) {
  Random random(test::seed("Motion"));
  int points = 0;
  double tightest = 0;
  for (int k = 0; k < test::trials(20000); ++k) {
    Bound bound;
    bound.center =
        Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    bound.half = Vector3d(random.uniform(0, 0.2), random.coin() ? 0 : random.uniform(0, 0.2),
                          random.uniform(0, 0.5));
    const Pose from = test::random_pose(random, Vector3d::Zero(), 1);
    const Vector3d axis = test::random_pose(random, Vector3d::Zero(), 1).linear().col(0);
    Pose to = from * Eigen::AngleAxisd(std::pow(10, random.uniform(-4, 0.5)), axis);
    to.translation() +=
        random.coin(0.3) ? Vector3d(Vector3d::Zero()) : Vector3d(0.1 * random.uniform(0, 1) * axis);
    const double most = motion(bound, place(bound, from), place(bound, to));
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Vector3d x = bound.center + bound.half.cwiseProduct(sign);
      const double moved = (to * x - from * x).norm();
      ASSERT_LE(moved, most + 1e-12);
      tightest = std::max(tightest, moved / most);
      ++points;
    }
  }
  std::printf("%d points, the furthest at %.3f of the bound\n", points, tightest);
  EXPECT_GT(tightest, 0.95);
  Bound rod;
  rod.half.z() = 0.3;
  const Pose from = test::random_pose(random, Vector3d::Zero(), 1);
  EXPECT_LT(
      motion(rod, place(rod, from), place(rod, from * Eigen::AngleAxisd(1.0, Vector3d::UnitZ()))),
      1e-12);
}

}  // namespace
}  // namespace swivel
