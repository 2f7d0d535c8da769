// SPDX-License-Identifier: BSD-3-Clause
// An arm among its scene as the pages' view in three dimensions reads it (report/web/scene.js).
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::detail {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json vector_json(const Vector3d& v);
/// Writes the upper three rows of the pose's matrix, row by row.
[[nodiscard]] Json pose_json(const Pose& pose);
/// Writes the chain as the page's forward kinematics needs it (core/kinematics/chain/arm.hpp).
[[nodiscard]] Json chain_json(const Chain& chain);

/// Writes where the root of the robot's tree is, the link that stands on the ground: the group of
/// the chain that moves it, and its pose at q = 0 in the base frame. Null where it does not move
/// against the base, as it does where the part is in the hand.
[[nodiscard]] Json ground_json(const RobotModel& robot, const ArmModel& arm);

/// Bodies of the robot, what it carries, and the scene in its order. Meshes are written once,
/// however many bodies share one.
class Bodies {
 public:
  Bodies() = default;
  Bodies(const World& world, const std::vector<SceneObject>& scene);
  /// Adds the bodies of one of several arms: those that stand in the base frame where `standing`,
  /// and those that it moves, as bodies of the arm of that name. `groups`: the number that each of
  /// its groups has among those of all arms.
  void add_arm(const World& world, const std::string& name, const std::vector<int>& groups,
               bool standing);
  void add_scene(const std::vector<SceneObject>& scene);
  /// An arm whose links are drawn. Of one of several arms `name` and `groups` are as in add_arm().
  struct DrawnArm {
    const ArmModel& arm;
    std::string name = {};
    std::vector<int> groups = {};
  };
  /// Adds the visual shapes of a robot's links, which a model has in place of collision shapes. A
  /// link moves with the first of the arms that moves it. Meshes are drawn with fewer triangles
  /// where all together have more than 200,000.
  void add_visual(const RobotModel& shapes, const RobotModel& robot,
                  const std::vector<DrawnArm>& arms);
  Json bodies = Json::array(), meshes = Json::array(), visual = Json::array();

 private:
  [[nodiscard]] Json body(const std::string& name, const char* kind, int group, const Shape& shape,
                          const Pose& pose);
  void add(const std::string& name, const char* kind, int group, const Shape& shape,
           const Pose& pose);
  void add(const RobotBody& body, int group);
  std::size_t index_of(const TriangleMesh& mesh);
  std::map<const TriangleMesh*, std::size_t> index_;
  std::map<const TriangleMesh*, MeshPtr> thinned_;  ///< by mesh that has too many triangles
};

}  // namespace swivel::detail
