// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

#include <gtest/gtest.h>

#include "arms.hpp"

namespace swivel {
namespace {

using namespace test;

TEST(ArmClass, NamesKindMethodAndCompleteness) {
  int srs = 0, arcs = 0, sampled = 0;
  const auto count = [&](const ArmTable& table, ArmKind expected) {
    const ArmClass arm = classify(chain_of(table), table.name);
    EXPECT_EQ(arm.kind, expected) << table.name << ": " << arm.method();
    EXPECT_EQ(arm.srs.has_value(), expected == ArmKind::kSrs) << table.name;
    EXPECT_EQ(arm.not_srs.empty(), expected == ArmKind::kSrs) << table.name;
    EXPECT_EQ(arm.complete(), expected != ArmKind::kSampled) << table.name;
    EXPECT_EQ(arm.lock.best >= 0, expected == ArmKind::kArcs) << table.name;
    (expected == ArmKind::kSrs ? srs : expected == ArmKind::kArcs ? arcs : sampled) += 1;
  };
  for (const ArmTable& table : arms_7r())
    count(table, table.name == "iiwa7" ? ArmKind::kSrs : ArmKind::kArcs);
  for (const ArmTable& table : arms_6r()) count(table, ArmKind::kArcs);
  // An arm like Sawyer: every triple is 1 cm and more from a point.
  ArmTable none = arms_7r()[0];
  for (JointRow& joint : none.joints) joint.xyz += Vector3d(0.02, 0.03, 0.05);
  count(none, ArmKind::kSampled);
  EXPECT_EQ(srs, 1);
  EXPECT_EQ(arcs, static_cast<int>(arms_7r().size() + arms_6r().size()) - 1);
  EXPECT_EQ(sampled, 1);
  EXPECT_EQ(classify(chain_of(arms_7r()[0]), "panda").method(),
            "closed form: axes 1, 2 and 3 meet in a point; locks joint 5 (or 4, 6, 7); arcs of "
            "self-motion");
  EXPECT_EQ(classify(chain_of(none), "none").completeness(), std::string("sampled"));
}

/// An arm of six joints has no joint 7: what stands there is the roll of its tool.
TEST(ArmClass, NoArmOfSixJointsHasASeventh) {
  LockMethod lock;
  ClosedFormFit fit;
  fit.first = 3;  // of the six that are left: axes 4, 5 and 7
  fit.structure = Structure::kSphericalWrist;
  fit.exact = true;
  lock.by_joint[5] = lock.by_joint[6] = fit;
  lock.best = 5;
  EXPECT_EQ(lock.words(), "closed form: axes 4, 5 and 7 meet in a point; locks joint 6 (or 7)");
  lock.roll = true;
  EXPECT_EQ(
      lock.words(),
      "closed form: axes 4, 5 and that of the roll meet in a point; locks joint 6 (or the roll)");
  lock.best = 6;
  EXPECT_EQ(lock.words(),
            "closed form: axes 4, 5 and 6 meet in a point; locks the roll (or joint 6)");
}

}  // namespace
}  // namespace swivel
