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

/// A link of a robot model.
struct Link {
  std::string name;
  std::vector<PlacedShape> collision;  ///< poses in the link's frame
  /// Index into RobotModel::joints of the joint that moves it, -1 for the root.
  int parent_joint = -1;
};

/// A joint of a robot model.
struct Joint {
  /// kFree is a floating or planar joint of a URDF: the model holds it at its origin, and no arm
  /// may lead through it.
  enum class Type { kFixed, kRevolute, kContinuous, kPrismatic, kFree };
  /// The joint's position is multiplier * position of `joint` + offset.
  struct Mimic {
    /// Index into RobotModel::joints.
    int joint = -1;
    double multiplier = 1, offset = 0;
  };
  /// Limits, rad or m.
  struct Range {
    double lower, upper;
  };
  std::string name;
  Type type = Type::kFixed;
  int parent_link = -1, child_link = -1;
  Pose origin = Pose::Identity();     ///< joint frame in the parent link, at position 0
  Vector3d axis = Vector3d::UnitX();  ///< unit vector, in the joint frame
  double lower = 0, upper = 0;        ///< limits, rad or m; not used for continuous joints
  double velocity = 0;                ///< largest, rad/s or m/s; 0 where no file gives one
  /// Largest, speeding up and braking, rad/s^2 or m/s^2; 0 where no file gives one.
  double acceleration = 0;
  double jerk = 0;  ///< largest, rad/s^3 or m/s^3; 0 where no file gives one
  std::optional<Mimic> mimic;
  /// The limits of the URDF's <limit>, where `lower` and `upper` are the narrower soft limits of
  /// its <safety_controller>.
  std::optional<Range> hard;
  bool passive = false;  ///< the SRDF says that no motor moves it
  int line = 0;          ///< line of the URDF that describes it; 0: unknown
  /// Returns true if the joint has a position: neither kFixed nor kFree.
  [[nodiscard]] bool movable() const { return type != Type::kFixed && type != Type::kFree; }
};

/// The files that a robot model was loaded from, and what it was told besides: what a problem file
/// says of the model. File names are absolute.
struct ModelFiles {
  std::string urdf;                             ///< empty: it comes from no file, or from a pipe
  std::string srdf;                             ///< empty: none
  std::map<std::string, std::string> packages;  ///< package -> folder
  std::vector<std::string> without;             ///< links that were left out
  bool soft_limits = true;   ///< joints keep the soft limits of their <safety_controller>
  std::string joint_limits;  ///< joint_limits.yaml of MoveIt; empty: none
  /// joint -> range that narrows that of the URDF, rad or m
  std::map<std::string, Joint::Range> limits;
  std::map<std::string, double> joint_margin;  ///< joint -> distance kept from its limits, rad or m
};

/// A robot as its URDF (and SRDF) describe it: a tree of links and joints. It does not change once
/// it is loaded. Source: io::load_robot.
struct RobotModel {
  std::string name;
  std::string source;  ///< URDF file, for messages
  std::vector<Link> links;
  std::vector<Joint> joints;
  int root_link = 0;
  bool has_srdf = false;
  /// Pairs of link names whose collisions the SRDF disables; links that the URDF lacks may be among
  /// them.
  std::vector<std::pair<std::string, std::string>> disabled_pairs;
  /// One sentence, with file and line, for everything in the files that the model leaves out.
  std::vector<std::string> warnings;
  ModelFiles files;

  /// Returns the index of a link by name, -1 if there is none.
  [[nodiscard]] int find_link(const std::string& link_name) const;
  /// Returns the index of a joint by name, -1 if there is none.
  [[nodiscard]] int find_joint(const std::string& joint_name) const;
};

}  // namespace swivel
