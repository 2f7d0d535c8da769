// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "robot_state.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/ros/path_service.hpp"

namespace swivel::ros {

/// The bodies of a planning scene and what may touch what.
class Scene {
 public:
  /// Applies one body, which is where `state` has its link, or in a frame that `transform` knows.
  /// Returns what was not understood, "" if all was.
  std::string apply(const Body& body, const RobotModel& model, const RobotState& state,
                    const PathService::Transform& transform);
  /// Removes all bodies, and what may touch what.
  void clear() { *this = {}; }
  /// Removes the bodies that links carry.
  void clear_attached() { attached_.clear(); }
  void allow(const AllowedPairs& allowed) { allowed_ = allowed; }

  /// Returns a robot with the bodies that its links carry and the pairs that may touch.
  [[nodiscard]] Robot robot_with_bodies(Robot robot) const;
  /// Returns the objects of the world, for a robot that robot_with_bodies() returned.
  [[nodiscard]] std::vector<SceneObject> objects(const Robot& robot) const;
  /// Returns everything that robot_with_bodies() depends on, as a text of bytes.
  [[nodiscard]] std::string key() const;

 private:
  [[nodiscard]] bool allows(const std::string& a, const std::string& b) const;
  std::vector<Body> world_;     // poses in the model's frame
  std::vector<Body> attached_;  // poses in the frame of the link
  AllowedPairs allowed_;
};

/// Sets a pose to what it is in the model's frame: known are the frames of all links, as `state`
/// has them, and what `transform` knows. Returns false for an unknown frame.
[[nodiscard]] bool to_model_frame(const std::string& frame, Pose7& pose, const RobotModel& model,
                                  const RobotState& state, const PathService::Transform& transform);

}  // namespace swivel::ros
