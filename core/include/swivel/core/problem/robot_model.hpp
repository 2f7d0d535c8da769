// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel {

struct Link {
  std::string name;
  std::vector<PlacedShape> collision;  ///< poses in the link's frame
  int parent_joint = -1;               ///< index into RobotModel::joints, -1 for the root
};

struct Joint {
  /// kFree: a floating or planar joint of a URDF. The model holds it where its origin is, and no arm leads through it.
  enum class Type { kFixed, kRevolute, kContinuous, kPrismatic, kFree };
  struct Mimic {
    int joint = -1;
    double multiplier = 1, offset = 0;
  };
  struct Range {
    double lower, upper;
  };
  std::string name;
  Type type = Type::kFixed;
  int parent_link = -1, child_link = -1;
  Pose origin = Pose::Identity();     ///< of the joint frame in the parent link, at position 0
  Vector3d axis = Vector3d::UnitX();  ///< unit, in the joint frame
  double lower = 0, upper = 0;        ///< rad or m; unused for continuous joints
  double velocity = 0;                ///< rad/s or m/s; 0 where the file gives none
  double acceleration = 0;            ///< rad/s^2 or m/s^2, of speeding up and slowing down; 0 where the file gives none
  double jerk = 0;                    ///< rad/s^3 or m/s^3; 0 where the file gives none
  std::optional<Mimic> mimic;
  /// What the <limit> of the URDF has, where the soft limits of its <safety_controller> are narrower and are `lower` and `upper`.
  std::optional<Range> hard;
  bool passive = false;  ///< no motor moves it, says the SRDF
  int line = 0;          ///< where the URDF describes it; 0: nowhere
  [[nodiscard]] bool movable() const { return type != Type::kFixed && type != Type::kFree; }
};

/// A robot as its URDF (and SRDF) describe it: a tree of links. Immutable once loaded. Source: io::load_robot.
struct RobotModel {
  std::string name;
  std::string source;  ///< URDF file, for messages
  std::vector<Link> links;
  std::vector<Joint> joints;
  int root_link = 0;
  bool has_srdf = false;
  std::vector<std::pair<std::string, std::string>> disabled_pairs;  ///< link names, from the SRDF; may name absent links
  std::vector<std::string> warnings;  ///< what the files say and the model does not have, a sentence each, with file and line

  /// Index of a link or joint by name, -1 if there is none.
  [[nodiscard]] int find_link(const std::string& link_name) const;
  [[nodiscard]] int find_joint(const std::string& joint_name) const;
};

}  // namespace swivel
