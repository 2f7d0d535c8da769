// SPDX-License-Identifier: BSD-3-Clause
// Nearest points of every pair of kinds, against clearances that share nothing with FCL.
#include "exact/nearest_points.hpp"

#include <gtest/gtest.h>

#include <map>

#include "exact/pair_test.hpp"
#include "reference.hpp"
#include "seed.hpp"
#include "support.hpp"

namespace swivel {
namespace {

using namespace detail;
using namespace swivel::testing;

struct Tally {
  int asked = 0, answered = 0;
};

TEST(NearestPoints, LieOnTheBodiesAndAreAsFarApartAsTheyAre) {
  Random random(61);
  PairTest test;
  MeshStore store;
  std::map<std::pair<int, int>, Tally> tally;
  int touching = 0;
  const int kinds = static_cast<int>(kKinds.size());
  for (int ka = 0; ka < kinds; ++ka)
    for (int kb = 0; kb < kinds; ++kb)
      for (int k = 0; k < test::trials(8); ++k) {
        const Shape a = random_shape(ka, random), b = random_shape(kb, random);
        const Pose X_a = random.pose(0.05), X_b = random.pose(0.4);
        const FclShape fa = make_fcl_shape(a, store), fb = make_fcl_shape(b, store);
        const PlacedShapeRef pa{&fa, &X_a}, pb{&fb, &X_b};
        const auto points = nearest_points(pa, pb, test.clearance(pa, pb));
        const double truth = reference_clearance(a, X_a, b, X_b);
        const std::string what = kKinds[ka] + " / " + kKinds[kb] + ", reference " +
                                 std::to_string(truth) + ", case " + std::to_string(k);
        if (truth == 0) {
          ++touching;
          EXPECT_FALSE(points) << what;
          continue;
        }
        Tally& t = tally[{ka, kb}];
        ++t.asked;
        if (!points) continue;
        ++t.answered;
        constexpr double kSlack = 1.2e-4;  // the function's tolerance and the reference's error
        EXPECT_NEAR(((*points)[1] - (*points)[0]).norm(), truth, kSlack) << what;
        const Sphere dot{1e-6};
        EXPECT_LE(reference_clearance(dot, Pose(Eigen::Translation3d((*points)[0])), a, X_a),
                  kSlack)
            << what;
        EXPECT_LE(reference_clearance(dot, Pose(Eigen::Translation3d((*points)[1])), b, X_b),
                  kSlack)
            << what;
      }
  EXPECT_GE(touching, test::at_least(6));
  int apart = 0, answered = 0;
  for (const auto& [pair, t] : tally) {
    std::printf("%s / %s: %d of %d have points\n", kKinds[pair.first].c_str(),
                kKinds[pair.second].c_str(), t.answered, t.asked);
    apart += t.asked;
    answered += t.answered;
  }
  EXPECT_GE(apart, test::at_least(301));
  EXPECT_GT(answered, apart * 95 / 100);
}

TEST(CommonPoint, LiesInBothBodies) {
  Random random(62);
  MeshStore store;
  std::map<std::pair<int, int>, Tally> tally;
  int apart = 0;
  const int kinds = static_cast<int>(kKinds.size());
  for (int ka = 0; ka < kinds; ++ka)
    for (int kb = 0; kb < kinds; ++kb)
      for (int k = 0; k < test::trials(4); ++k) {
        const Shape a = random_shape(ka, random), b = random_shape(kb, random);
        const Pose X_a = random.pose(0.05), X_b = random.pose(0.1);
        const FclShape fa = make_fcl_shape(a, store), fb = make_fcl_shape(b, store);
        const auto point = common_point({&fa, &X_a}, {&fb, &X_b});
        const double truth = reference_clearance(a, X_a, b, X_b);
        const std::string what = kKinds[ka] + " / " + kKinds[kb] + ", reference " +
                                 std::to_string(truth) + ", case " + std::to_string(k);
        constexpr double kSlack = 1.2e-4;  // the function's tolerance and the reference's error
        if (truth > 2 * kSlack) {
          ++apart;
          EXPECT_FALSE(point) << what;
          continue;
        }
        Tally& t = tally[{ka, kb}];
        ++t.asked;
        if (!point) continue;
        ++t.answered;
        const Sphere dot{1e-6};
        const Pose at(Eigen::Translation3d{*point});
        EXPECT_LE(reference_clearance(dot, at, a, X_a), kSlack) << what;
        EXPECT_LE(reference_clearance(dot, at, b, X_b), kSlack) << what;
      }
  EXPECT_GE(apart, test::at_least(11));
  int touching = 0, answered = 0;
  for (const auto& [pair, t] : tally) touching += t.asked, answered += t.answered;
  std::printf("%d of %d have a point\n", answered, touching);
  EXPECT_GE(touching, test::at_least(101));
  EXPECT_GT(answered, touching * 95 / 100);
}

}  // namespace
}  // namespace swivel
