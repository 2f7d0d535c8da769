// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>

#include "swivel/core/answer/cause.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::test {

/// Returns the problem without what the cause names; nothing where nothing can be taken away, as
/// with reach and singular poses.
inline std::optional<PathProblem> without(const Cause& cause, PathProblem problem) {
  Limits& limits = problem.limits;
  switch (cause.kind) {
    case Cause::Kind::kLimit: {
      auto model = std::make_shared<RobotModel>(*problem.model);
      Joint& joint = model->joints[static_cast<std::size_t>(model->find_joint(cause.joint))];
      constexpr double kWide = 2.5;  // rad
      (cause.side == Cause::Side::kLower ? joint.lower -= kWide : joint.upper += kWide);
      problem.model = model;
      return problem;
    }
    case Cause::Kind::kPair:
    case Cause::Kind::kContact: {
      if (!cause.object.empty()) {
        std::erase_if(problem.scene,
                      [&](const SceneObject& object) { return object.name == cause.object; });
        return problem;
      }
      for (SceneObject& object : problem.scene)
        for (const std::size_t k : {0u, 1u})
          if (object.name == cause.bodies[k]) {
            object.allow.push_back(cause.bodies[1 - k]);
            return problem;
          }
      auto model = std::make_shared<RobotModel>(*problem.model);
      model->disabled_pairs.emplace_back(cause.bodies[0], cause.bodies[1]);
      problem.model = model;
      return problem;
    }
    case Cause::Kind::kManipulability:
      limits.manipulability = 0;
      return problem;
    case Cause::Kind::kArmSlope:
      limits.arm_slope = 1e6;
      return problem;
    case Cause::Kind::kRollSlope:
      limits.roll_slope = 1e6;
      return problem;
    case Cause::Kind::kJointStep:
      limits.joint_step = 3;
      return problem;
    case Cause::Kind::kSpeed:
      limits.tool_speed.reset();
      limits.tool_turn_speed.reset();
      return problem;
    case Cause::Kind::kPathError:
      limits.tool_path_error.reset();
      return problem;
    case Cause::Kind::kAngleError:
      limits.tool_angle_error.reset();
      return problem;
    case Cause::Kind::kStepError:
      limits.step_error.reset();
      return problem;
    default:
      return std::nullopt;
  }
}

}  // namespace swivel::test
