// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/split_mix.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel {

namespace {

/// Returns a value without the digits that rounding leaves behind, as 0.3 for 0.1 + 0.2, and never
/// -0.
double tidy(double value) {
  constexpr double kMost = 1e3;  // beyond it products lose the digits that are to stay
  return std::abs(value) > kMost ? value : std::round(value * 1e12) / 1e12 + 0.0;
}

/// A rigid motion of the base frame: a turn about its origin, then a shift.
struct RigidMotion {
  bool turns = false;
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
};

RigidMotion motion_of(const Offset& offset) {
  RigidMotion motion;
  motion.turns = offset[3] != 0 || offset[4] != 0 || offset[5] != 0;
  if (motion.turns) motion.turn = from_rpy({offset[3], offset[4], offset[5]}).toRotationMatrix();
  motion.shift = {offset[0], offset[1], offset[2]};
  return motion;
}

Matrix3d as_written(const Matrix3d& rotation) {
  return rotation_from_rpy(written_rpy(rotation));
}

Vector3d as_written(const Vector3d& position, const Vector3d& before) {
  Vector3d result = before;
  for (int k = 0; k < 3; ++k)
    if (position[k] != before[k]) result[k] = tidy(position[k]);
  return result;
}

void turn_and_shift(const Matrix3d& turn, const Vector3d& shift, bool turns,
                    std::vector<Waypoint>& waypoints) {
  for (Waypoint& waypoint : waypoints) {
    if (turns) {
      waypoint.position = turn * waypoint.position;
      waypoint.orientation = Quaterniond(turn) * waypoint.orientation;
    }
    waypoint.position += shift;
  }
}

bool in_base_frame(const PathProblem& problem) {
  return problem.path_frame.empty() || problem.path_frame == problem.base_link;
}

/// Throws InvalidArgument for an offset of nothing.
void require_thing(const Movable& thing, const Offset& offset) {
  if (thing.kind == Movable::Kind::kNothing && offset != Offset{})
    throw InvalidArgument("offset: nothing is moved: allowed is an offset of zeros");
}

/// Throws InvalidArgument for one arm of a problem or a job, which has no other.
void require_no_arm(const Movable& thing) {
  if (!thing.arm.empty())
    throw InvalidArgument("arm: '" + thing.arm + "': allowed is an arm of a workcell");
}

/// Returns the number of the arm whose path alone is moved. Throws InvalidArgument.
std::size_t moved_arm(const Problem& cell, const Movable& thing) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (cell.arms[k].name != thing.arm) continue;
    if (thing.kind != Movable::Kind::kPath)
      throw InvalidArgument("arm: both arms are of one robot: allowed is to move the path of one");
    if (!cell.arms[k].given.empty())
      throw InvalidArgument("arm: the motion of '" + thing.arm +
                            "' is given, it has no path: allowed is '" + cell.arms[1 - k].name +
                            "'");
    return k;
  }
  throw InvalidArgument("arm: unknown arm '" + thing.arm + "': allowed are '" + cell.arms[0].name +
                        "' and '" + cell.arms[1].name + "'");
}

/// Throws InvalidArgument for paths of a workcell that cannot be moved alike by `offset`.
void require_paths_move(const Problem& cell, const Offset& offset) {
  std::vector<std::string> frames;
  for (std::size_t k = 0; k < 2; ++k) {
    const ArmTask& arm = cell.arms[k];
    if (cell.leader_of(k) >= 0 && !cell.arms[1 - k].given.empty())
      throw InvalidArgument("path: that of '" + arm.name + "' is on the tool of '" +
                            cell.arms[1 - k].name +
                            "', whose motion is given: allowed is to move that of '" + arm.name +
                            "' alone, an object or the base");
    if (cell.leader_of(k) < 0 && arm.given.empty())
      frames.push_back(arm.path().path_frame.empty() ? arm.base_link : arm.path().path_frame);
  }
  if (frames.size() == 2 && frames[0] != frames[1] && motion_of(offset).turns)
    throw InvalidArgument(
        "path: roll, pitch and yaw turn paths about the origin of their frame, "
        "and those of '" +
        cell.arms[0].name + "' and '" + cell.arms[1].name + "' are in '" + frames[0] + "' and '" +
        frames[1] + "': allowed are x, y and z, one arm, or to move an object or the base");
}

/// Returns the waypoints of an arm's path, moved about the origin of its frame. That of a follower
/// is moved in the frame of its leader's tool, any other along the axes of the base frame.
std::vector<Waypoint> moved_path(const Problem& cell, std::size_t k, const Offset& offset) {
  PathProblem arm = problem_of_path(cell, cell.arms[k], cell.arms[k].path());
  if (cell.leader_of(k) >= 0) arm.path_frame.clear();
  return placed_problem(arm, {Movable::Kind::kPath, ""}, offset).waypoints;
}

/// Throws InvalidArgument for a joint that is not there, cannot be held, or is one of the planned.
void require_may_be_held(const RobotModel& model, const std::string& name,
                         const std::array<std::string, kDof>& planned) {
  const int number = model.find_joint(name);
  if (number < 0) {
    std::vector<std::string> names;
    for (const Joint& joint : model.joints)
      if (joint.movable() && !joint.mimic) names.push_back(joint.name);
    throw InvalidArgument(
        "unknown joint '" + name + "'" +
        (names.empty() ? "" : ", nearest is '" + nearest_name(name, names) + "'") +
        ": allowed are joints of the robot that are not planned");
  }
  const Joint& joint = model.joints[static_cast<std::size_t>(number)];
  if (!joint.movable())
    throw InvalidArgument("joint '" + name + "' is fixed: allowed are movable joints");
  if (joint.mimic)
    throw InvalidArgument("joint '" + name + "' mimics '" +
                          model.joints[static_cast<std::size_t>(joint.mimic->joint)].name +
                          "': allowed is that one, where it is not planned");
  if (std::find(planned.begin(), planned.end(), name) != planned.end())
    throw InvalidArgument("joint '" + name + "' is planned: allowed are joints that stand still");
}

const char* unit_of_position(const Joint& joint) {
  return joint.type == Joint::Type::kPrismatic ? "m" : "rad";
}

}  // namespace

Vector3d written_rpy(const Matrix3d& r) {
  const double pitch = tidy(std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)))),
               level = std::cos(pitch);
  // With a pitch of a quarter turn, roll and yaw turn about the same axis.
  if (level < 5e-13) return {0, pitch, tidy(std::atan2(-r(0, 1), r(1, 1)))};
  // The nearer the pitch is to a quarter turn, the less the rotation says of yaw, and the less yaw
  // says of it: roll makes up for what is rounded away.
  const double scale = std::min(1e12, std::pow(10, std::floor(std::log10(level * 1e14))));
  const double yaw = std::round(std::atan2(r(1, 0), r(0, 0)) * scale) / scale + 0.0;
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {tidy(std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1))), pitch, yaw};
}

void hold_joints(Robot& robot, const HeldPositions& positions) {
  if (positions.empty()) return;
  const RobotModel& model = *robot.model;
  const auto planned = [&] {
    return build_arm(model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll)
        .chain.joint_names;
  };
  const auto before = planned();
  for (const auto& [name, position] : positions) {
    require_may_be_held(model, name, before);
    const Joint& joint = model.joints[static_cast<std::size_t>(model.find_joint(name))];
    if (joint.type != Joint::Type::kContinuous &&
        !(position >= joint.lower && position <= joint.upper))
      throw InvalidArgument(
          formatted("joint '%s' at %.9g %s is outside its limits: allowed is "
                    "%.9g to %.9g",
                    name.c_str(), position, unit_of_position(joint), joint.lower, joint.upper));
    robot.hold[name] = position;
  }
  const auto after = planned();
  for (std::size_t k = 0; k < kDof; ++k)
    if (std::find(before.begin(), before.end(), after[k]) == before.end())
      throw InvalidArgument("joint '" + positions.begin()->first +
                            "': the arm would be planned with joint '" + after[k] +
                            "' where it is held: allowed is a problem that holds one of both");
}

void hold_joints(Problem& problem, const HeldPositions& positions) {
  for (ArmTask& arm : problem.arms) hold_joints(arm, positions);
}

PathProblem placed_problem(const PathProblem& problem, const Movable& thing, const Offset& offset) {
  require_no_arm(thing);
  require_thing(thing, offset);
  PathProblem result = problem;
  const RigidMotion motion = motion_of(offset);
  const auto named = [&](const std::string& name) {
    const auto found = std::find_if(result.scene.begin(), result.scene.end(),
                                    [&](const auto& o) { return o.name == name; });
    if (found == result.scene.end())
      throw InvalidArgument("'" + name + "': no such object: allowed are names of the scene");
    return found;
  };
  if (thing.kind == Movable::Kind::kObject) {
    Pose& pose = named(thing.object)->pose;
    pose.translation() = as_written(pose.translation() + motion.shift, pose.translation());
    if (motion.turns) pose.linear() = as_written(Matrix3d(motion.turn * pose.linear()));
  } else if (thing.kind == Movable::Kind::kPath) {
    const Matrix3d frame = in_base_frame(problem)
                               ? Matrix3d::Identity()
                               : Matrix3d(named(problem.path_frame)->pose.linear());
    turn_and_shift(frame.transpose() * motion.turn * frame, frame.transpose() * motion.shift,
                   motion.turns, result.waypoints);
  } else if (thing.kind == Movable::Kind::kBase) {
    const Matrix3d back = motion.turn.transpose();
    for (SceneObject& object : result.scene) {
      Pose& pose = object.pose;
      const Vector3d seen = pose.translation() - motion.shift;
      pose.translation() =
          as_written(motion.turns ? Vector3d(back * seen) : seen, pose.translation());
      if (motion.turns) pose.linear() = as_written(Matrix3d(back * pose.linear()));
    }
    if (in_base_frame(problem))
      turn_and_shift(back, -(back * motion.shift), motion.turns, result.waypoints);
  }
  return result;
}

Problem placed_problem(const Problem& problem, const Movable& thing, const Offset& offset) {
  require_thing(thing, offset);
  Problem result = problem;
  if (problem.arms.size() == 2 && !thing.arm.empty()) {
    const std::size_t k = moved_arm(problem, thing);
    result.arms[k].path().waypoints = moved_path(problem, k, offset);
    return result;
  }
  if (problem.arms.size() == 2 && thing.kind == Movable::Kind::kPath)
    require_paths_move(problem, offset);
  for (std::size_t k = 0; k < problem.arms.size(); ++k) {
    if (problem.leader_of(k) >= 0) continue;
    for (Stroke& stroke : result.arms[k].strokes) {
      PathProblem placed =
          placed_problem(problem_of_path(problem, problem.arms[k], stroke), thing, offset);
      stroke.waypoints = std::move(placed.waypoints);
      result.scene = std::move(placed.scene);
    }
  }
  return result;
}

double PlacementAxis::at(int k) const {
  return tidy(from + k * step);
}

std::string PlacementAxis::name() const {
  return joint.empty() ? kCoordinates[static_cast<std::size_t>(coordinate)] : joint;
}

namespace {

/// Returns the number of values of an axis. Throws InvalidArgument as placement_axis() does.
int count_of(const std::string& name, double from, double to, double step) {
  if (!(std::abs(from) <= kMostMetres && std::abs(to) <= kMostMetres && from <= to && step >= 0))
    throw InvalidArgument(name + ": allowed are from <= to, from -1000 to 1000, and step >= 0");
  const double steps = step > 0 ? (to - from) / step : 0;
  if (!(steps < std::numeric_limits<int>::max() - 1))
    throw InvalidArgument(name + ": too many values: allowed is a larger step");
  return static_cast<int>(steps + 1e-6) + 1;
}

/// Sets the coordinate of an axis, or the position of its joint, in a placement.
void set(const PlacementAxis& axis, double value, Placement& placement) {
  if (axis.joint.empty())
    placement.offset[static_cast<std::size_t>(axis.coordinate)] = value;
  else
    placement.hold[axis.joint] = value;
}

}  // namespace

PlacementAxis placement_axis(int coordinate, double from, double to, double step) {
  const std::string name = kCoordinates[static_cast<std::size_t>(coordinate)];
  return {coordinate, from, to, step, count_of(name, from, to, step)};
}

PlacementAxis held_axis(const std::string& joint, double from, double to, double step) {
  return {0, from, to, step, count_of("hold: '" + joint + "'", from, to, step), joint};
}

PlacementGrid::PlacementGrid(std::vector<PlacementAxis> axes) : axes_(std::move(axes)) {
  for (const PlacementAxis& axis : axes_) size_ *= static_cast<std::uint64_t>(axis.count);
}

std::vector<int> PlacementGrid::indices(std::uint64_t cell) const {
  std::vector<int> result(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0;) {
    const auto count = static_cast<std::uint64_t>(axes_[a].count);
    result[a] = static_cast<int>(cell % count);
    cell /= count;
  }
  return result;
}

std::uint64_t PlacementGrid::cell(const std::vector<int>& indices) const {
  std::uint64_t result = 0;
  for (std::size_t a = 0; a < axes_.size(); ++a)
    result = result * static_cast<std::uint64_t>(axes_[a].count) +
             static_cast<std::uint64_t>(indices[a]);
  return result;
}

Placement PlacementGrid::placement(std::uint64_t cell) const {
  Placement result;
  const std::vector<int> index = indices(cell);
  for (std::size_t a = 0; a < axes_.size(); ++a) set(axes_[a], axes_[a].at(index[a]), result);
  return result;
}

Placement sampled_placement(const std::vector<PlacementAxis>& axes, std::uint64_t seed,
                            std::uint64_t k) {
  Placement result;
  SplitMix64 random(seed, k);
  for (const PlacementAxis& axis : axes)
    set(axis, tidy(std::lerp(axis.from, axis.to, (random.symmetric() + 1) / 2)), result);
  return result;
}

std::string subject_of(const Cause& cause, const std::vector<SceneObject>& scene) {
  if (!cause.object.empty()) return cause.object;
  const auto is_object = [&](const std::string& name) {
    return std::any_of(scene.begin(), scene.end(),
                       [&](const auto& object) { return object.name == name; });
  };
  for (const std::string& body : cause.bodies)
    if (is_object(body)) return body;
  if (!cause.bodies[0].empty()) return cause.bodies[0] + " - " + cause.bodies[1];
  return cause.joint.empty() ? cause.check : cause.joint;
}

const char* to_string(PlacementCriterion criterion) {
  switch (criterion) {
    case PlacementCriterion::kClearance:
      return "clearance";
    case PlacementCriterion::kCost:
      return "cost";
    case PlacementCriterion::kMargin:
      return "margin";
    case PlacementCriterion::kSlide:
      return "slide";
    case PlacementCriterion::kSpeed:
      return "speed";
  }
  return "?";
}

PlacementCriterion placement_criterion_from_string(const std::string& name) {
  using enum PlacementCriterion;
  for (const PlacementCriterion criterion : {kClearance, kCost, kMargin, kSlide, kSpeed})
    if (name == to_string(criterion)) return criterion;
  throw InputError("unknown criterion '" + name +
                   "': allowed are clearance, cost, margin, slide, "
                   "speed");
}

std::optional<double> merit(const PlacementRow& row, PlacementCriterion criterion) {
  if (row.status != PlanStatus::kSolved) return std::nullopt;
  using enum PlacementCriterion;
  const std::optional<double> value = criterion == kClearance ? row.clearance_margin
                                      : criterion == kMargin  ? row.joint_margin
                                      : criterion == kSlide   ? row.slide_margin
                                      : criterion == kSpeed   ? row.tool_speed
                                                              : row.cost;
  if (!value) return std::nullopt;
  return std::round((criterion == kCost ? -*value : *value) * 1e9) / 1e9;
}

bool better(const PlacementRow& a, const PlacementRow& b,
            const std::vector<PlacementCriterion>& criteria) {
  for (const PlacementCriterion criterion : criteria) {
    constexpr double kWorst = -std::numeric_limits<double>::infinity();
    const double x = merit(a, criterion).value_or(kWorst), y = merit(b, criterion).value_or(kWorst);
    if (x != y) return x > y;
  }
  return a.cell < b.cell;
}

std::vector<PlacementRow> best_placements(const std::vector<PlacementRow>& rows,
                                          const std::vector<PlacementCriterion>& criteria,
                                          std::size_t most) {
  std::vector<const PlacementRow*> solved;
  for (const PlacementRow& row : rows)
    if (row.status == PlanStatus::kSolved) solved.push_back(&row);
  const auto end = solved.begin() + static_cast<std::ptrdiff_t>(std::min(most, solved.size()));
  std::partial_sort(solved.begin(), end, solved.end(),
                    [&](const auto* a, const auto* b) { return better(*a, *b, criteria); });
  std::vector<PlacementRow> best;
  for (auto row = solved.begin(); row != end; ++row) best.push_back(**row);
  return best;
}

}  // namespace swivel
