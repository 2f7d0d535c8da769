// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "robots.hpp"

namespace swivel {
namespace {

using namespace test;

double turn_distance(const Config& a, const Config& b) {
  double most = 0;
  for (int j = 0; j < kDof; ++j)
    most = std::max(most, std::abs(std::remainder(a[j] - b[j], kTwoPi)));
  return most;
}

double pose_distance(const Pose& a, const Pose& b) {
  return std::max((a.translation() - b.translation()).norm(),
                  Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle());
}

struct Tally {
  int tried = 0, found = 0, excused = 0, solutions = 0, unsolved = 0;
  double worst = 0;
};

/// Every configuration must be among the solutions of its own pose at its own arm angle; every
/// solution must reach the pose.
Tally round_trip(const Chain& chain, const SrsArm& srs, int trials, Random& random) {
  Tally tally;
  for (int trial = 0; trial < trials; ++trial) {
    const Config q = random_config(chain, random);
    ++tally.tried;
    Pose tool = chain.tool(q);
    const ArmPlane plane = first_plane(srs, tool);
    const double least_sine =
        std::min({std::abs(std::sin(srs.shoulder_angle(q))), std::abs(std::sin(srs.wrist_angle(q))),
                  std::abs(std::sin(srs.elbow_angle(q)))});
    if (reach_status(srs, plane.reach) != ReachStatus::kReachable || least_sine < 1e-6) {
      ++tally.excused;
      continue;
    }
    const auto circles = elbow_circles(srs, plane, tool);
    const double phi = plane.angle_of(srs.elbow_axis(q));
    bool found = false;
    for (int branch = 0; branch < kBranches; ++branch) {
      const auto solution =
          solve_exact_chain(chain, srs, plane, tool, phi, srs_ik(srs, circles, phi, branch));
      if (!solution) {
        ++tally.unsolved;
        continue;
      }
      ++tally.solutions;
      tally.worst = std::max(tally.worst, pose_distance(chain.tool(*solution), tool));
      if (branch == srs.branch(q)) found = turn_distance(*solution, q) < 1e-6;
    }
    tally.found += found;
  }
  return tally;
}

TEST(Ik, FindsEveryConfigurationAgain) {
  Random random(seed("Ik.FindsEveryConfigurationAgain"));
  const int count = trials(100000);
  for (const TestRobot& robot : all_robots()) {
    const Chain chain = arm_of(robot).chain;
    const SrsArm srs = fit_srs(chain, robot.name);
    EXPECT_TRUE(srs.exact) << robot.name << " offset " << srs.deviation.offset << " angle "
                           << srs.deviation.angle;
    const Tally tally = round_trip(chain, srs, count, random);
    std::printf("%-10s tried %d, found %d, excused %d, solutions %d, worst residual %.2e\n",
                robot.name.c_str(), tally.tried, tally.found, tally.excused, tally.solutions,
                tally.worst);
    EXPECT_EQ(tally.tried, count);
    EXPECT_EQ(tally.found + tally.excused, tally.tried) << robot.name;
    EXPECT_LT(tally.excused, count / 1000);
    EXPECT_LE(tally.worst, 1e-9) << robot.name;
  }
}

class RealSda5f : public testing::TestWithParam<const char*> {};

TEST_P(RealSda5f, PolishReachesTheExactChain) {
  const char* const folder = std::getenv("SWIVEL_SHARED");
  const std::filesystem::path file = std::filesystem::path(folder ? folder : "") /
                                     "data/motoman_sda5f/motoman_sda5f_support/urdf" / GetParam();
  if (!folder || !std::filesystem::exists(file))
    GTEST_SKIP() << "SWIVEL_SHARED names no folder with this robot";
  Random random(seed("RealSda5f.PolishReachesTheExactChain"));
  const auto model = io::load_robot(file);
  const Chain chain =
      build_arm(*model, "base_link", "arm_left_link_7_t", {}, Pose::Identity()).chain;
  const SrsArm srs = fit_srs(chain, file.string());
  const int count = trials(100000);
  const Tally tally = round_trip(chain, srs, count, random);
  const double share = static_cast<double>(tally.unsolved) / (8.0 * (tally.tried - tally.excused));
  std::printf(
      "%s: fit %.3g m %.3g rad, tried %d, found %d, excused %d, solutions %d, not converged %.4f "
      "%%, worst residual %.2e\n",
      GetParam(), srs.deviation.offset, srs.deviation.angle, tally.tried, tally.found,
      tally.excused, tally.solutions, 100 * share, tally.worst);
  EXPECT_LE(tally.worst, 1e-9);
  EXPECT_LT(share, 0.03);
  // Near singular poses the polish would have to move a joint by more than it may: those
  // configurations are lost, and counted above.
  EXPECT_GE(tally.found + tally.excused, static_cast<int>(0.95 * count));
}
INSTANTIATE_TEST_SUITE_P(Files, RealSda5f,
                         testing::Values("sda5f_expanded.urdf", "sda5f_checked_in.urdf"));

}  // namespace
}  // namespace swivel
