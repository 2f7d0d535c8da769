// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "robots.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::test {

/// Returns the robot with its arm's joint origins changed by change(origin).
template <class Change>
TestRobot with_origins(const TestRobot& robot, const std::string& name, const Change& change) {
  TestRobot changed = with_limits(robot, [&](int, Joint& joint) { change(joint.origin); });
  changed.name = name;
  return changed;
}

/// Returns the robot as a file has it that writes 1.5708 for pi/2: roll, pitch and yaw are rounded
/// to `step`, rad.
inline TestRobot rounded(const TestRobot& robot, double step) {
  return with_origins(robot, robot.name + " rounded", [&](Pose& origin) {
    const Vector3d rpy = origin.linear().eulerAngles(2, 1, 0).reverse();
    const auto turn = [&](int k, const Vector3d& axis) {
      return Eigen::AngleAxisd(step * std::round(rpy[k] / step), axis);
    };
    origin.linear() =
        (turn(2, Vector3d::UnitZ()) * turn(1, Vector3d::UnitY()) * turn(0, Vector3d::UnitX()))
            .toRotationMatrix();
  });
}

/// Returns the robot with origins shifted and turned at random, so that it misses the ideal arm by
/// at least half of `share` of what is tolerated, 1 mm and 10 mrad, and by no more than that.
inline TestRobot perturbed(const TestRobot& robot, double share, Random& random) {
  for (;;) {
    const auto vector = [&](double most) {
      return Vector3d(random.uniform(-most, most), random.uniform(-most, most),
                      random.uniform(-most, most));
    };
    const TestRobot tried = with_origins(robot, robot.name + " perturbed", [&](Pose& origin) {
      const Vector3d turn = vector(3e-3 * share);
      origin.translation() += vector(0.3e-3 * share);
      origin.linear() =
          origin.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    });
    try {
      const FitDeviation deviation = fit_srs(arm_of(tried).chain, tried.name).deviation;
      const double reached = std::max(deviation.offset / 1e-3, deviation.angle / 1e-2);
      if (reached >= share / 2 && reached <= share) return tried;
    } catch (const InputError&) {  // too far from an S-R-S arm
    }
  }
}

/// Returns five arms that are not exactly S-R-S: they miss it by as much as the tolerance at most.
inline std::vector<TestRobot> inexact_robots(Random& random) {
  return {rounded(data_robot("sda5f"), 1e-4), perturbed(data_robot("iiwa14"), 1, random),
          perturbed(data_robot("sda10f"), 0.1, random), perturbed(continuous_robot(), 1, random),
          perturbed(windings_robot(), 0.3, random)};
}

}  // namespace swivel::test
