// SPDX-License-Identifier: BSD-3-Clause
// Workcells of the two-armed robots of the data folder, drawn by chance.
#pragma once
#include <algorithm>
#include <array>
#include <string>

#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::test {

/// A rule of the caller's own, which two arms do not take.
class AllowsAll final : public StateCheck {
 public:
  [[nodiscard]] std::string name() const override { return "all"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    std::fill_n(allowed.begin(), states.size(), true);
  }
};

/// A straight run of a tool: from one place to another, without turning.
struct ToolRun {
  Vector3d from, to;
  Quaterniond orientation;
  /// Returns a place on the hand at a time, 0 to 1: so far behind the tool's origin, m.
  [[nodiscard]] Vector3d hand(double t, double behind) const {
    return from + t * (to - from) - behind * (orientation * Vector3d::UnitZ());
  }
};

/// Returns whether two hands that move at one time meet whatever the arms behind them do: their
/// last 0.26 m come within 0.13 m of each other.
inline bool hands_meet(const ToolRun& a, const ToolRun& b) {
  for (int k = 0; k <= 8; ++k)
    for (int i = 0; i <= 6; ++i)
      for (int j = 0; j <= 6; ++j)
        if ((a.hand(k / 8.0, 0.26 * i / 6) - b.hand(k / 8.0, 0.26 * j / 6)).norm() < 0.13)
          return true;
  return false;
}

/// Returns random straight runs of two tools that point forward about one place before the torso
/// and whose hands keep clear of each other. `reach`: from the base, m.
inline std::array<ToolRun, 2> random_runs(double least_reach, double most_reach, double height,
                                          Random& random) {
  for (;;) {
    const Vector3d centre(random.uniform(least_reach, most_reach), random.uniform(-0.05, 0.05),
                          height + random.uniform(-0.15, 0.15));
    std::array<ToolRun, 2> runs;
    for (std::size_t k = 0; k < 2; ++k) {
      const double side = k == 0 ? 1 : -1;
      const Eigen::AngleAxisd forward(kPi / 2, Vector3d::UnitY()),
          inward(-side * random.uniform(0, 0.5), Vector3d::UnitZ()),
          turn(random.uniform(-kPi, kPi), Vector3d::UnitZ());
      runs[k].orientation = Quaterniond(inward * forward * turn);
      const Vector3d way =
          Vector3d(random.uniform(-0.3, 0.3), random.uniform(-1, 1), random.uniform(-1, 1))
              .normalized();
      const double half = random.uniform(0.1, 0.2);
      const Vector3d middle =
          centre + Vector3d(random.uniform(-0.03, 0.03), side * random.uniform(-0.2, 0.1),
                            random.uniform(-0.15, 0.15));
      runs[k].from = middle - half * way;
      runs[k].to = middle + half * way;
    }
    if (!hands_meet(runs[0], runs[1])) return runs;
  }
}

/// Returns a workcell whose two tools follow random_runs(). `robot` is sda10f or sda5f.
inline Problem random_workcell(const TestRobot& robot, Random& random) {
  Problem cell = two_arms();
  cell.source = "random workcell";
  const bool large = robot.name == "sda10f";
  const auto runs =
      large ? random_runs(0.55, 0.75, 1.0, random) : random_runs(0.6, 0.75, 0.9, random);
  for (std::size_t k = 0; k < 2; ++k) {
    ArmTask& arm = cell.arms[k];
    arm.name = k == 0 ? "left" : "right";
    arm.model = robot.model;
    arm.base_link = robot.base_link;
    arm.tip_link = "arm_" + arm.name + "_link_tool0";
    arm.tool.translation() = Vector3d(0, 0, 0.10);
    arm.hold["torso_joint_b1"] = 0;
    AttachedBody tool;
    tool.name = arm.name + "_tool";
    tool.link = arm.tip_link;
    tool.shape = Capsule{0.025, 0.04};
    tool.pose.translation() = Vector3d(0, 0, 0.048);
    arm.attached.push_back(tool);
    for (const Vector3d& position : {runs[k].from, runs[k].to}) {
      Waypoint& waypoint = arm.path().waypoints.emplace_back();
      waypoint.position = position;
      waypoint.orientation = runs[k].orientation;
    }
    arm.path().resolution.ds = 0.03;
    arm.path().resolution.dphi = 0.25;
    arm.path().limits.tool_path_error = 0.01;
  }
  return cell;
}

}  // namespace swivel::test
