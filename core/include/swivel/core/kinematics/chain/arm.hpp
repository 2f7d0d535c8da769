// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/held_joint.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

inline constexpr int kMostTurns = 64;  ///< Most turns in the range of a bounded joint.
/// m of a slide for each rad of joints that turn, where one number is meant for joints of both
/// kinds: limits.joint_step, and accelerations and jerks that no file states.
inline constexpr double kSlideForTurn = 0.2;

/// The kind and the limits of one joint. It turns, or it slides (a prismatic joint, as of a rail):
/// then m stands for rad here and wherever a joint's position, speed or limit is meant. A bounded
/// joint keeps lower <= q <= upper; a continuous one has neither bound. A slide is bounded.
struct JointLimit {
  double lower = -kPi, upper = kPi;  ///< rad
  double velocity = 0;               ///< rad/s; 0: no file gives one
  bool continuous = false;
  bool slides = false;                ///< a prismatic joint
  double acceleration = 0, jerk = 0;  ///< rad/s^2 and rad/s^3; 0: no file gives one
  /// Returns true if the bounds are over 64 turns apart and so mean "unlimited": such a joint is
  /// planned as a continuous one.
  [[nodiscard]] bool wide() const {
    return !continuous && !slides && upper - lower > kMostTurns * kTwoPi;
  }
};

/// The seven-joint chain from base to tool, exactly as the URDF has it, as a product of
/// exponentials in the base frame:
///   X_BT(q) = G_7(q) * home,   G_k(q) = exp([S_1] q_1) ... exp([S_k] q_k),   G_0 = 1.
/// S_j turns about the line through `point[j]` along `axis[j]` (at q = 0), or, where
/// limit[j].slides, shifts along `axis[j]`. At most one joint slides. A body that moves with
/// joint k and has pose X at q = 0 has pose G_k(q) * X. Source: Lynch & Park, Modern Robotics, Eq.
/// (4.14).
struct Chain {
  std::array<std::string, kDof> joint_names;
  std::array<Vector3d, kDof> axis;   ///< unit vectors, base frame, q = 0
  std::array<Vector3d, kDof> point;  ///< a point on each axis, base frame, q = 0, m
  std::array<JointLimit, kDof> limit;
  Pose home = Pose::Identity();  ///< tool in base at q = 0
  /// True for an arm of six joints whose last "joint" is the roll: those six have turned the tool
  /// about its own z axis by it, and tool(q) is the pose without that turn, the waypoint's.
  bool roll = false;
  /// True for an arm of six joints whose tool must stand as the waypoints have it (`roll` is true
  /// besides): the roll is 0 in every configuration, its name is empty, its column of the Jacobian
  /// is zero, and no file has it.
  bool roll_fixed = false;
  /// The range of the roll of a seven-joint arm whose tool may be turned about its own z axis as
  /// well, rad; none: it may not. tool(q) is the pose of the tool itself, turned.
  std::optional<Roll> free_roll;
  /// Returns true if the tool may be turned about its own z axis from the waypoint's orientation.
  [[nodiscard]] bool tool_may_turn() const { return (roll && !roll_fixed) || free_roll; }
  /// Returns the number of coordinates that users know of: 6 where the roll is fixed, else 7. The
  /// others are 0.
  [[nodiscard]] std::size_t coordinates() const { return roll_fixed ? kDof - 1 : kDof; }
  /// Returns the joint (0-based) that slides; -1: all turn.
  [[nodiscard]] int slide() const;
  /// The constant matrices of exp([S] q) = still + cos(q) cosine + sin(q) sine (homogeneous); of a
  /// slide still + q sine, with `cosine` zero. Source: Lynch & Park, Modern Robotics, Eq. (3.51)
  /// and (3.88).
  struct Turn {
    Eigen::Matrix4d still, cosine, sine;
  };
  std::array<Turn, kDof> turn;  ///< of `axis` and `point`; build_arm() sets it

  /// A joint outside the chain that mimics one of the chain's, as those of a balancer's linkage do.
  /// Links behind it have pose G * motion * X: G is the displacement of the group that carries the
  /// joint, `motion` a turn or a shift along a line of the base frame, X the link's pose at q = 0.
  struct Follower {
    std::string name;       ///< name of the joint
    int parent = 0;         ///< group that carries it: of the chain, or of another follower
    int root = 0;           ///< group of the chain, 0..7, that carries `parent`
    int leader = 0;         ///< joint of the chain that it mimics, 0-based
    double multiplier = 1;  ///< rad or m of motion for 1 rad of the leader
    /// True: it slides along `axis`; false: it turns about the line through `point` along `axis`.
    bool slides = false;
    Vector3d axis, point;  ///< unit vector; m; base frame, q = 0
    Turn turn;             ///< of `axis` and `point`
  };
  /// Followers, parents first. Links behind followers[f] are group kDof + 1 + f.
  std::vector<Follower> followers;

  /// Returns the displacement of a group from q = 0, in the base frame, for joints q, rad. `G` must
  /// hold G_0 ... up to the root_of() the group.
  [[nodiscard]] Pose displacement(int group, const Config& q,
                                  const std::array<Pose, kDof + 1>& G) const;
  /// Returns the displacements of all groups from q = 0, by group number: G_0 ... G_7, then those
  /// of the followers. Joints q in rad.
  [[nodiscard]] std::vector<Pose> all_displacements(const Config& q) const;
  /// Returns the group of the chain, 0..7, that carries a group: itself, or its follower's root.
  [[nodiscard]] int root_of(int group) const;
  /// A range of joints, 0-based: first ... last - 1.
  struct Joints {
    int first = 0, last = 0;
  };
  /// Returns a range that contains every joint that moves bodies of two groups against each other,
  /// and maybe some more. It is empty (first = last) where none does.
  [[nodiscard]] Joints joints_between(int group_a, int group_b) const;

  /// Returns G_0 ... G_7, the displacements of the chain's groups from q = 0, for joints q, rad.
  [[nodiscard]] std::array<Pose, kDof + 1> displacements(const Config& q) const;
  /// Computes G[first + 1] ... G[last] from G[first], for joints q, rad.
  void displace(const Config& q, int first, int last, std::array<Pose, kDof + 1>& G) const;
  /// Returns the tool's pose in the base frame for joints q, rad.
  [[nodiscard]] Pose tool(const Config& q) const;
  /// Returns the origin of the tool in the base frame, m, from the joints' cosines and sines, which
  /// are 0 and q of a slide.
  [[nodiscard]] Vector3d tool_point(const Config& cosine, const Config& sine) const;
  /// Returns the 6x7 geometric Jacobian at the tool origin in the base frame: rows 0-2 linear (m),
  /// rows 3-5 angular; a slide's column is its direction and zero. Joints q in rad.
  [[nodiscard]] Eigen::Matrix<double, 6, kDof> jacobian(const Config& q) const;
  /// Returns the manipulability sqrt(max(0, det(J J^T))), J = jacobian(q); it does not depend on
  /// the reference point. Source: Yoshikawa 1984.
  [[nodiscard]] double manipulability(const Config& q) const;
};

/// Returns the weights that a cost gives the joints of an arm, base to tip: Cost::weights, or by
/// default 1 for each joint and 0 for the roll of a six-joint arm (Chain::roll).
[[nodiscard]] std::array<double, kDof> joint_weights(const Cost& cost, const Chain& chain);

/// Returns one line for every joint whose limits are so wide that it is planned as a continuous
/// one.
[[nodiscard]] std::vector<std::string> limit_warnings(const Chain& chain);
/// Returns what a user should know of the robot's files before the arm moves, one line each:
/// RobotModel::warnings, and joints of the arm that keep soft limits narrower than their hard ones.
[[nodiscard]] std::vector<std::string> file_warnings(const RobotModel& robot, const Chain& chain);
/// Returns a message that names the joints of the arm that cannot move: those that the SRDF calls
/// passive, or else those whose limits leave no range. Empty where all can.
[[nodiscard]] std::string joints_at_rest(const RobotModel& robot, const Chain& chain);

/// Where a link of the robot is at q = 0, and which group of the chain moves it.
struct LinkPlacement {
  /// 0: the link does not move; k = 1..7: it moves with joints 1..k of the chain; kDof + 1 + f: it
  /// moves with follower f of the chain.
  int group = 0;
  Pose pose = Pose::Identity();  ///< link in base at q = 0, joints outside the arm held
};

/// A robot's arm: its chain, the placement of every link, and the joints held between base and tip.
/// Source: build_arm().
struct ArmModel {
  Chain chain;
  std::vector<LinkPlacement> links;  ///< by link index of the RobotModel
  /// Movable joints between base and tip outside the arm, from the base on.
  std::vector<HeldJoint> held;
};
/// Builds the arm between two links. Its joints are the last seven movable joints before the tip
/// that `hold` does not name and that mimic none. Where there are six, or with `roll` where the
/// seventh is missing or prismatic, they are the last six, and the roll of the tool is the seventh:
/// free within `roll`, or fixed without it (Chain::roll_fixed). Every other joint is held
/// at its position in `hold` (by name, rad or m), by default at 0 or its limit nearest to 0. Where
/// only seven are there, one may be prismatic.
/// Joints that mimic a joint of the arm follow it: they move what they carry (Chain::followers),
/// and their limits and rates bound those of the joint they mimic. `tool` is the tool frame in the
/// tip link. The base need not be above the tip in the tree: where the part is in the hand and the
/// tool stands, the hand is the base, and the chain leads through the arm backwards.
///
/// Throws InputError for unknown names, a held joint outside its limits (or one that brings a joint
/// that mimics it outside its own), too few joints, a prismatic joint where none may be or with
/// limits over 1000 m apart, a floating or planar joint between base and tip, a joint between base
/// and tip that mimics one of the arm's,
/// and a joint that mimics one whose range is a turn or more, unless a whole turn of that one
/// leaves it in place.
[[nodiscard]] ArmModel build_arm(const RobotModel& robot, const std::string& base_link,
                                 const std::string& tip_link,
                                 const std::map<std::string, double>& hold, const Pose& tool,
                                 const std::optional<Roll>& roll = {});

/// One collision body of the robot: a shape of a link, or an attached body.
struct RobotBody {
  std::string name;  ///< name of the link or of the attached body
  int link = -1;     ///< index of the link that carries it
  bool attached = false;
  int group = 0;  ///< see LinkPlacement::group; Chain::displacement() places it
  Shape shape;
  Pose pose = Pose::Identity();  ///< shape in base at q = 0
};
/// Returns the collision bodies of the robot: links in model order, each link's shapes in file
/// order, then attached bodies in their order. A cylinder with two spheres of its radius at its
/// ends becomes one capsule. Throws InputError where an attached body names an unknown link or has
/// a link's name.
[[nodiscard]] std::vector<RobotBody> robot_bodies(const RobotModel& robot, const ArmModel& arm,
                                                  const std::vector<AttachedBody>& attached);

/// How far followers of the chain move what they carry, besides the chain's own motion.
struct FollowerMotion {
  /// By joint of the chain, m per rad: a bound on how far the followers that it leads move two
  /// bodies of different groups against each other, both bodies' shares added.
  std::array<double, kDof> reach{};
  /// By joint of the chain: how far the followers that carry one body turn (rad, or slide, m) in
  /// all for 1 rad of the joint, for the body where that is most.
  std::array<double, kDof> turns{};
};
/// Returns bounds on the motions that a chain's followers add; zero where the chain has none.
/// `bodies` are those of robot_bodies().
[[nodiscard]] FollowerMotion follower_motion(const Chain& chain,
                                             const std::vector<RobotBody>& bodies);

/// Returns for each joint j a bound on the distance from its axis of any point of a body that it
/// moves, over all configurations, m; 1 (m per m) for a slide that moves a body;
/// FollowerMotion::reach of the joint is added. The bound adds
/// up spheres about the points where neighbouring axes come closest, so it is tight where shoulder
/// and wrist are spherical. docs/model.md "Motions".
[[nodiscard]] std::array<double, kDof> motion_radii(const Chain& chain,
                                                    const std::vector<RobotBody>& bodies);

}  // namespace swivel
