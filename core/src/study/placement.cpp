// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/split_mix.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel {

namespace {

/// Returns a value without the digits that rounding leaves behind, as 0.3 for 0.1 + 0.2, and never
/// -0.
double tidy(double value) {
  constexpr double kMost = 1e3;  // beyond it products lose the digits that are to stay
  return std::abs(value) > kMost ? value : std::round(value * 1e12) / 1e12 + 0.0;
}

/// A rigid motion of the base frame: a turn about its origin, then a shift.
struct Motion {
  bool turns = false;
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
};

Motion motion_of(const Offset& offset) {
  Motion motion;
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

bool in_base_frame(const Problem& problem) {
  return problem.path_frame.empty() || problem.path_frame == problem.base_link;
}

/// Throws InvalidArgument for paths of a workcell that cannot be moved alike by `offset`.
void require_paths_move(const Workcell& cell, const Offset& offset) {
  std::vector<std::string> frames;
  for (std::size_t k = 0; k < 2; ++k) {
    const WorkcellArm& arm = cell.arms[k];
    if (cell.leader_of(k) >= 0 && !cell.arms[1 - k].given.empty())
      throw InvalidArgument("path: that of '" + arm.name + "' is on the tool of '" +
                            cell.arms[1 - k].name +
                            "', whose motion is given: allowed is to move an object or the base");
    if (cell.leader_of(k) < 0 && arm.given.empty())
      frames.push_back(arm.path_frame.empty() ? arm.base_link : arm.path_frame);
  }
  if (frames.size() == 2 && frames[0] != frames[1] && motion_of(offset).turns)
    throw InvalidArgument(
        "path: roll, pitch and yaw turn paths about the origin of their frame, "
        "and those of '" +
        cell.arms[0].name + "' and '" + cell.arms[1].name + "' are in '" + frames[0] + "' and '" +
        frames[1] + "': allowed are x, y and z, or to move an object or the base");
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

Problem placed_problem(const Problem& problem, const Movable& thing, const Offset& offset) {
  Problem result = problem;
  const Motion motion = motion_of(offset);
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
  } else {
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

Job placed_job(const Job& job, const Movable& thing, const Offset& offset) {
  Job result = job;
  for (std::size_t k = 0; k < job.strokes.size(); ++k) {
    Problem stroke;
    static_cast<Robot&>(stroke) = job;
    static_cast<Task&>(stroke) = job.strokes[k];
    stroke.scene = job.scene;
    Problem placed = placed_problem(stroke, thing, offset);
    result.strokes[k].waypoints = std::move(placed.waypoints);
    if (k == 0) result.scene = std::move(placed.scene);
  }
  return result;
}

Workcell placed_workcell(const Workcell& cell, const Movable& thing, const Offset& offset) {
  if (thing.kind == Movable::Kind::kPath) require_paths_move(cell, offset);
  Workcell result = cell;
  for (std::size_t k = 0; k < 2; ++k) {
    if (cell.leader_of(k) >= 0) continue;
    Problem arm;
    static_cast<Robot&>(arm) = cell.arms[k];
    static_cast<Task&>(arm) = cell.arms[k];
    arm.scene = cell.scene;
    Problem placed = placed_problem(arm, thing, offset);
    result.arms[k].waypoints = std::move(placed.waypoints);
    result.scene = std::move(placed.scene);
  }
  return result;
}

double PlacementAxis::at(int k) const {
  return tidy(from + k * step);
}

PlacementAxis placement_axis(int coordinate, double from, double to, double step) {
  const std::string name = kCoordinates[static_cast<std::size_t>(coordinate)];
  if (!(std::abs(from) <= kMostMetres && std::abs(to) <= kMostMetres && from <= to && step >= 0))
    throw InvalidArgument(name + ": allowed are from <= to, from -1000 to 1000, and step >= 0");
  const double steps = step > 0 ? (to - from) / step : 0;
  if (!(steps < std::numeric_limits<int>::max() - 1))
    throw InvalidArgument(name + ": too many values: allowed is a larger step");
  return {coordinate, from, to, step, static_cast<int>(steps + 1e-6) + 1};
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

Offset PlacementGrid::offset(std::uint64_t cell) const {
  Offset result{};
  const std::vector<int> index = indices(cell);
  for (std::size_t a = 0; a < axes_.size(); ++a)
    result[static_cast<std::size_t>(axes_[a].coordinate)] = axes_[a].at(index[a]);
  return result;
}

Offset sampled_offset(const std::vector<PlacementAxis>& axes, std::uint64_t seed, std::uint64_t k) {
  Offset result{};
  SplitMix64 random(seed, k);
  for (const PlacementAxis& axis : axes)
    result[static_cast<std::size_t>(axis.coordinate)] =
        tidy(std::lerp(axis.from, axis.to, (random.symmetric() + 1) / 2));
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
    case PlacementCriterion::kSpeed:
      return "speed";
  }
  return "?";
}

PlacementCriterion placement_criterion_from_string(const std::string& name) {
  using enum PlacementCriterion;
  for (const PlacementCriterion criterion : {kClearance, kCost, kMargin, kSpeed})
    if (name == to_string(criterion)) return criterion;
  throw InputError("unknown criterion '" + name + "': allowed are clearance, cost, margin, speed");
}

std::optional<double> merit(const PlacementRow& row, PlacementCriterion criterion) {
  if (row.status != PlanStatus::kSolved) return std::nullopt;
  using enum PlacementCriterion;
  const std::optional<double> value = criterion == kClearance ? row.clearance_margin
                                      : criterion == kMargin  ? row.joint_margin
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
