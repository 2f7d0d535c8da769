// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's compute_cartesian_path without any ROS: what a node of either ROS is made around. It is
// C++17 and includes the standard library alone, since the messages of some ROS 1 do not compile as
// C++20.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace swivel::ros {

/// MoveItErrorCodes that answers have.
enum Code : int {
  kSuccess = 1,
  kFailure = 99999,
  kInvalidGroupName = -15,
  kInvalidRobotState = -17,
  kInvalidLinkName = -18,
  kFrameTransformFailure = -21,
  kCollisionCheckingUnavailable = -22,
  kRobotStateStale = -23,
};

/// A pose: m, and a unit quaternion.
struct Pose7 {
  double x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0;
};

/// Positions of joints by name, rad or m.
struct JointValues {
  std::vector<std::string> names;
  std::vector<double> positions;
};

/// One shape of a body.
struct Solid {
  enum Kind : int { kMesh = 0, kBox = 1, kSphere = 2, kCylinder = 3, kCone = 4 };  // SolidPrimitive
  int kind = kBox;
  /// As in SolidPrimitive, m: x y z of a box; radius of a sphere; height and radius of the others.
  std::vector<double> dimensions;
  Pose7 pose;                       ///< in the body's frame
  std::vector<double> vertices;     ///< of a mesh: x y z of each, m
  std::vector<unsigned> triangles;  ///< of a mesh: three vertices each
};

/// A CollisionObject or an AttachedCollisionObject.
struct Body {
  enum Operation : int { kAdd = 0, kRemove = 1, kAppend = 2, kMove = 3 };
  std::string id;
  std::string frame;  ///< of `pose`; empty: the model's, or that of `link`
  std::string link;   ///< link that carries it; empty: it stands in the world
  Pose7 pose;
  std::vector<Solid> solids;
  std::vector<std::string> touch_links;  ///< links that it may touch
  int operation = kAdd;
  std::string unsupported;  ///< what of it is not understood, by name; empty: nothing
};

/// A request, in the words of GetCartesianPath.
struct Query {
  std::string frame;  ///< of the waypoints
  std::string group, link;
  JointValues start;
  bool start_is_diff = false;
  std::vector<Body> attached;  ///< of the start state
  std::vector<Pose7> waypoints;
  double max_step = 0;                             ///< m
  double jump_factor = 0, revolute_jump = 0;       ///< jump_threshold; rad
  double tool_speed = 0;                           ///< m/s; 0: as fast as the joints allow
  std::string speed_link;                          ///< cartesian_speed_limited_link
  double speed_scale = 0, acceleration_scale = 0;  ///< outside of 0..1, and 0: 1
  bool avoid_collisions = true;
  /// The joint stays within position - below and position + above, rad or m.
  struct JointBand {
    std::string joint;
    double position = 0, above = 0, below = 0;
  };
  std::vector<JointBand> bands;
  std::vector<std::string> unsupported;  ///< constraints and others that are refused, by name
};

/// One point of a trajectory. Without a motion in time there are positions alone.
struct Point {
  std::vector<double> positions, velocities, accelerations;  ///< rad, rad/s, rad/s^2
  double time = 0;                                           ///< s from the start
};

/// A response, in the words of GetCartesianPath.
struct Answer {
  int code = kFailure;
  double fraction = 0;
  std::string frame;  ///< the name of the model's frame
  JointValues start;  ///< all joints of the robot
  std::vector<std::string> joints;
  std::vector<Point> points;
  double plan_ms = 0;  ///< spent on the path and its motion
  std::string words;   ///< why, for people: lines without a break at the end
};

/// What a service is made with.
struct Settings {
  double deadline_s = 10;    ///< the most time an answer takes, s
  double clearance = 0.005;  ///< kept between all bodies, m
  double rate = 100;         ///< points a second of motions in time
  /// For groups of six joints: how far the tool may stand turned about its own z axis, rad, to
  /// either side; 0: it stands as it is asked.
  double roll = 0;
};

/// Which bodies may touch, as AllowedCollisionMatrix has it.
struct AllowedPairs {
  bool given = false;  ///< false: as before, at first as the SRDF says
  std::vector<std::pair<std::string, std::string>> pairs;
  std::vector<std::string> with_all;  ///< may touch everything but what `apart` says
  std::vector<std::pair<std::string, std::string>> apart;
};

/// Answers requests for straight lines of a robot's groups. All functions may be called from
/// several threads at once.
class PathService {
 public:
  /// Sets `pose`, given in the frame `from`, to that pose in the model's frame. Returns false if
  /// the frame is not known.
  using Transform = std::function<bool(const std::string& from, Pose7& pose)>;

  /// Makes the service of a robot from the texts of its URDF and SRDF. Throws std::runtime_error
  /// for texts that are not understood.
  PathService(const std::string& urdf, const std::string& srdf, const Settings& settings);
  ~PathService();
  PathService(const PathService&) = delete;
  PathService& operator=(const PathService&) = delete;

  /// Returns the name of the model's frame: the root link of the URDF.
  [[nodiscard]] const std::string& frame() const;
  /// Notes where joints are. Names that the robot does not have are passed over.
  void state(const JointValues& joints);
  /// Changes the scene: all of it, or, with `diff`, by what the bodies' operations say. Returns
  /// what was not understood, in one line for each body; these are left out.
  std::vector<std::string> world(const std::vector<Body>& bodies, bool diff,
                                 const AllowedPairs& allowed, const Transform& transform);
  /// Notes that the scene has something that is not checked, by name (an octomap), or no longer has
  /// (empty): requests that avoid collisions are then refused.
  void unchecked(const std::string& what);
  /// Answers a request. Throws nothing. Frames that are links of the robot are known from where it
  /// is; `transform` is asked for others.
  [[nodiscard]] Answer answer(const Query& query, const Transform& transform) const;
  /// Ends the answers that are being worked on, and all that are asked for from now on.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel::ros
