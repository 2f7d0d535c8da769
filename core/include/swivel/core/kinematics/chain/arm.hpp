// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/held_joint.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

inline constexpr int kMostTurns = 64;  ///< that a bounded joint may have

/// A bounded joint keeps lower <= q <= upper; a continuous one has neither.
struct JointLimit {
  double lower = -kPi, upper = kPi;  ///< rad
  double velocity = 0;               ///< rad/s, 0 where the file gives none
  bool continuous = false;
  double acceleration = 0, jerk = 0;  ///< rad/s^2 and rad/s^3, 0 where the file gives none
  /// Bounds that mean "unlimited": over 64 turns. Such a joint is planned as a continuous one.
  [[nodiscard]] bool wide() const { return !continuous && upper - lower > kMostTurns * kTwoPi; }
};

/// The seven-joint chain from base to tool, exactly as the URDF has it, as a product of exponentials in the base frame:
///   X_BT(q) = G_7(q) * home,   G_k(q) = exp([S_1] q_1) ... exp([S_k] q_k),   G_0 = 1.
/// S_j turns about the line through `point[j]` along `axis[j]` (at q = 0). A body that moves with joint k and has pose X at q = 0
/// has pose G_k(q) * X. Source: Lynch & Park, Modern Robotics, Eq. (4.14).
struct Chain {
  std::array<std::string, kDof> joint_names;
  std::array<Vector3d, kDof> axis;   ///< unit, base frame, q = 0
  std::array<Vector3d, kDof> point;  ///< on the axis, base frame, q = 0, m
  std::array<JointLimit, kDof> limit;
  Pose home = Pose::Identity();  ///< tool in base at q = 0
  /// The last joint is the roll: the arm's six joints have turned the tool by it about the tool's z axis, and tool(q) is the pose
  /// without that turn, the waypoint's.
  bool roll = false;
  /// Of seven joints whose tool may stand turned about its own z axis as well: within which rolls, rad. tool(q) is then the pose of
  /// the tool itself, turned.
  std::optional<Roll> free_roll;
  [[nodiscard]] bool tool_may_turn() const { return roll || free_roll; }
  /// exp([S] q) = still + cos(q) cosine + sin(q) sine, homogeneous matrices. Lynch & Park, Eq. (3.51) and (3.88).
  struct Turn {
    Eigen::Matrix4d still, cosine, sine;
  };
  std::array<Turn, kDof> turn;  ///< of `axis` and `point`, by build_arm

  /// A joint outside the chain that mimics one of the chain's, as those of a balancer's linkage do: the links behind it have pose
  /// G * motion * X, G the displacement of the group that carries them, `motion` a turn or a shift along a line of the base frame.
  struct Follower {
    std::string name;       ///< of the joint
    int parent = 0;         ///< group that carries it, of the chain or of another follower
    int root = 0;           ///< group of the chain, 0..7, that carries both
    int leader = 0;         ///< joint of the chain, from 0
    double multiplier = 1;  ///< rad or m of motion for 1 rad of the leader
    bool slides = false;    ///< along `axis`, else it turns about the line through `point` along `axis`
    Vector3d axis, point;   ///< unit; m; base frame, q = 0
    Turn turn;              ///< of `axis` and `point`
  };
  /// Parents first. Links behind followers[f] are group kDof + 1 + f.
  std::vector<Follower> followers;

  /// Displacement of a group from q = 0, given G_0 ... G_7 up to its root.
  [[nodiscard]] Pose displacement(int group, const Config& q, const std::array<Pose, kDof + 1>& G) const;
  /// Displacements of all groups, by number: G_0 ... G_7, then those of the followers.
  [[nodiscard]] std::vector<Pose> all_displacements(const Config& q) const;
  /// Group of the chain, 0..7, that carries a group: itself, or its follower's root.
  [[nodiscard]] int root_of(int group) const;
  /// Joints first ... last - 1 are all that move bodies of two groups against each other, and maybe some more.
  struct Joints {
    int first = 0, last = 0;
  };
  [[nodiscard]] Joints joints_between(int group_a, int group_b) const;

  /// G_0 ... G_7.
  [[nodiscard]] std::array<Pose, kDof + 1> displacements(const Config& q) const;
  /// G_first+1 ... G_last, from G_first.
  void displace(const Config& q, int first, int last, std::array<Pose, kDof + 1>& G) const;
  /// Tool in base.
  [[nodiscard]] Pose tool(const Config& q) const;
  /// Its origin, m; of the joints' cosines and sines.
  [[nodiscard]] Vector3d tool_point(const Config& cosine, const Config& sine) const;
  /// 6x7 geometric Jacobian at the tool origin, base frame: rows 0-2 linear, 3-5 angular.
  [[nodiscard]] Eigen::Matrix<double, 6, kDof> jacobian(const Config& q) const;
  /// Yoshikawa 1984: sqrt(max(0, det(J J^T))), J as above. Independent of the reference point.
  [[nodiscard]] double manipulability(const Config& q) const;
};

/// One line for every wide joint.
[[nodiscard]] std::vector<std::string> limit_warnings(const Chain& chain);
/// What a user should know of the files before the arm moves: RobotModel::warnings, and the arm's joints that keep soft limits.
[[nodiscard]] std::vector<std::string> file_warnings(const RobotModel& robot, const Chain& chain);
/// Says which joints of the arm cannot move: those that the SRDF calls passive, and those whose limits leave no range. Empty where
/// all can.
[[nodiscard]] std::string joints_at_rest(const RobotModel& robot, const Chain& chain);

/// Where every link of the robot is at q = 0, and which joint of the chain moves it.
struct LinkPlacement {
  /// 0: does not move; k = 1..7: moves with joints 1..k of the chain; beyond: with a follower of the chain
  int group = 0;
  Pose pose = Pose::Identity();  ///< link in base, q = 0, other joints held
};

/// The arm: the last seven movable joints before the tip that are not held by name; with `roll`, where no more than six of them
/// turn, these, of which the tool's roll makes seven. Every other joint is held at `hold` (default 0 or its nearest limit), but
/// those that mimic a joint of the arm follow it: what they carry moves (Chain::followers), and their limits and rates bound their
/// leader's. The tip need not hang from the base: where the part is in the hand and the tool stands, the hand is the base, and the
/// chain leads through the arm backwards.
/// Throws InputError for unknown names, a held joint outside its limits (or one that `hold` moves through its leader), fewer
/// joints, a prismatic joint among them, a joint between base and tip that mimics one of them, and a joint that mimics one with a
/// range of a turn or more other than by whole turns.
struct ArmModel {
  Chain chain;
  std::vector<LinkPlacement> links;  ///< by RobotModel link index
  std::vector<HeldJoint> held;       ///< those between base and tip, from the base on
};
[[nodiscard]] ArmModel build_arm(const RobotModel& robot, const std::string& base_link, const std::string& tip_link,
                                 const std::map<std::string, double>& hold, const Pose& tool, const std::optional<Roll>& roll = {});

/// One collision body of the robot: a link's shape or an attached body.
struct RobotBody {
  std::string name;  ///< link name, or the attached body's name
  int link = -1;     ///< RobotModel link that carries it
  bool attached = false;
  int group = 0;  ///< see LinkPlacement; Chain::displacement() places it
  Shape shape;
  Pose pose = Pose::Identity();  ///< of the shape in base at q = 0
};
/// Links in model order, shapes in file order, then attached bodies in problem order. A cylinder with two spheres of its radius at
/// its ends reads as one capsule. Throws InputError when an attached body names an unknown link or takes a link's name.
[[nodiscard]] std::vector<RobotBody> robot_bodies(const RobotModel& robot, const ArmModel& arm,
                                                  const std::vector<AttachedBody>& attached);

/// How far followers move what they carry, beside the chain.
struct FollowerMotion {
  /// By joint of the chain, m per rad: no two bodies of different groups are moved further together by the followers that it leads.
  std::array<double, kDof> reach{};
  /// By joint of the chain: the followers that carry a body, one behind the other, turn by so many rad (or slide by so many m) in
  /// all, at most, for 1 rad of the joint.
  std::array<double, kDof> turns{};
};
[[nodiscard]] FollowerMotion follower_motion(const Chain& chain, const std::vector<RobotBody>& bodies);

/// R_j: a bound on the distance from axis j of any point that joint j moves, over all configurations, metres; where followers mimic
/// joint j, their FollowerMotion::reach is added. By spheres about the points where neighbouring axes come closest, so it is tight
/// when the shoulder and the wrist are spherical. docs/model.md "Motions".
[[nodiscard]] std::array<double, kDof> motion_radii(const Chain& chain, const std::vector<RobotBody>& bodies);

}  // namespace swivel
