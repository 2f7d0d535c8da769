// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "shapes/fcl_shapes.hpp"
#include "swivel/collision/world/world.hpp"
#include "world/robot_pairs.hpp"

namespace swivel::detail {

/// The part of a World that depends on the robot but not on the scene, which worlds of one robot
/// share. Immutable. Every function that takes a budget throws Stopped once it is spent.
class RobotPart {
 public:
  /// Builds the shapes of the robot's bodies, with mesh models from `meshes`, and samples the robot
  /// pairs for which no SRDF speaks, up to the clearances that problem.limits need. Throws
  /// InputError for a mesh without a triangle that has an area.
  RobotPart(const RobotModel& robot, const ArmModel& arm, const PathProblem& problem,
            MeshStore& meshes, const Budget& budget);
  /// Returns `part` itself if its medians reach as far as these limits need, else a copy in which
  /// they do.
  [[nodiscard]] static std::shared_ptr<const RobotPart> for_limits(
      const std::shared_ptr<const RobotPart>& part, const Limits& limits, const Budget& budget);

  /// Returns the robot pairs by a problem's limits. The part must know the medians that these
  /// limits need.
  [[nodiscard]] std::vector<RobotPair> pairs(const Limits& limits) const {
    return pairs_.pairs(limits);
  }
  /// Returns the robot pairs by a problem's limits, with the median clearance of every sampled
  /// pair, however far, which is computed by this call.
  [[nodiscard]] std::vector<RobotPair> pairs_with_medians(const Limits& limits) const;
  /// Returns one warning for each joint of the arm that moves no collision shape.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  Chain chain;
  std::vector<RobotBody> bodies;
  std::vector<FclShape> shapes;
  FollowerMotion followers;

 private:
  [[nodiscard]] SampledBodies sampled() const;

  RobotPairs pairs_;
  std::vector<std::string> warnings_;
};

}  // namespace swivel::detail
