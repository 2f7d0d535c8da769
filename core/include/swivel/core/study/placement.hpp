// SPDX-License-Identifier: BSD-3-Clause
// Placement studies: where should the part, the path or the robot stand?
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// A move in the base frame of the problem: x, y, z (m), then roll, pitch, yaw (rad), a turn
/// Rz(yaw) Ry(pitch) Rx(roll) about the moved thing's own origin.
using Offset = std::array<double, 6>;
/// Names of an Offset's numbers.
inline constexpr std::array<const char*, 6> kCoordinates{"x", "y", "z", "roll", "pitch", "yaw"};

/// The thing that a placement study moves.
struct Movable {
  enum class Kind {
    kObject,   ///< an object of the scene, and the path if it is given in its frame
    kPath,     ///< the path alone, about the origin of its frame
    kBase,     ///< the robot: as seen from it everything else moves the other way
    kNothing,  ///< nothing: only joints that are held are varied
  };
  Kind kind = Kind::kObject;
  std::string object;  ///< for kObject: its name
  /// For kPath in a workcell: the name of the arm whose path alone is moved, about the origin of
  /// its frame, that of a follower in the frame of its leader's tool; empty: the paths of both
  /// arms.
  std::string arm = {};
};

/// Positions of joints that are held, by name: rad, or m of a prismatic one.
using HeldPositions = std::map<std::string, double>;

/// Holds joints of a robot at other positions, in Robot::hold. Throws InvalidArgument for a joint
/// that is unknown, fixed, planned or mimics another, for a position outside of its limits, and for
/// a position that makes another joint a planned one; InputError as build_arm() does.
void hold_joints(Robot& robot, const HeldPositions& positions);
/// Does so for each arm of a problem, whose robot is one.
void hold_joints(Problem& problem, const HeldPositions& positions);

/// Returns the problem with one thing moved. Coordinates that do not change keep their bits. Those
/// of objects that do are multiples of 1e-12 m, and of 1e-12 rad as roll, pitch and yaw, so that a
/// file can state them exactly. Throws InvalidArgument for an unknown object, for an arm, and for
/// an offset of kNothing.
[[nodiscard]] PathProblem placed_problem(const PathProblem& problem, const Movable& thing,
                                         const Offset& offset);
/// Returns the problem with one thing moved alike, for Movable::Kind::kPath the paths of all
/// strokes, or of both arms, or that of Movable::arm. The path of a follower stays on its leader's
/// tool, and homes, given motions, starts and ends stay as they are, joints. Throws InvalidArgument
/// as above, for an unknown arm, for an arm whose motion is given, and, where the paths of two arms
/// are moved, for that of a follower whose leader's motion is given and for paths that are turned
/// alike and have frames with an origin each.
[[nodiscard]] Problem placed_problem(const Problem& problem, const Movable& thing,
                                     const Offset& offset);

/// Returns roll, pitch and yaw of a rotation as multiples of 1e-12 rad. For an object that
/// placed_problem() has turned, a problem file with these angles gives its rotation bit for bit.
[[nodiscard]] Vector3d written_rpy(const Matrix3d& rotation);

/// The values that one coordinate of a placement takes, or the positions of a joint that is held:
/// `from` + k `step`, multiples of 1e-12. Source: placement_axis().
struct PlacementAxis {
  int coordinate = 0;  ///< index into kCoordinates; not used where `joint` is set
  double from = 0, to = 0, step = 0;
  int count = 1;           ///< number of values; 1 with a step of 0
  std::string joint = {};  ///< the held joint whose position is varied; empty: `coordinate` is
  bool slides = false;     ///< that joint is prismatic: its positions are in m, else rad
  /// Returns the k-th value.
  [[nodiscard]] double at(int k) const;
  /// Returns the name of the coordinate or of the joint.
  [[nodiscard]] std::string name() const;
};

/// Returns the axis with the values from, from + step, ... up to `to`; with a step of 0 `from`
/// alone, or the range that samples are drawn from. Throws InvalidArgument for numbers beyond 1000,
/// from > to, a negative step, and 2^31 values or more.
[[nodiscard]] PlacementAxis placement_axis(int coordinate, double from, double to, double step);
/// Returns the axis with such positions of a joint that is held. Throws InvalidArgument alike.
[[nodiscard]] PlacementAxis held_axis(const std::string& joint, double from, double to,
                                      double step);

/// By how much the thing of a placement is moved, and where joints are held.
struct Placement {
  Offset offset{};
  HeldPositions hold = {};
};

/// A grid of placements. Cells are numbered in the order in which nested loops over the axes visit
/// them, the last axis innermost.
class PlacementGrid {
 public:
  /// Makes the grid of all combinations of the axes' values.
  explicit PlacementGrid(std::vector<PlacementAxis> axes);
  [[nodiscard]] const std::vector<PlacementAxis>& axes() const { return axes_; }
  /// Returns the number of cells.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Returns the indices of a cell along each axis.
  [[nodiscard]] std::vector<int> indices(std::uint64_t cell) const;
  /// Returns the number of the cell with these indices along each axis.
  [[nodiscard]] std::uint64_t cell(const std::vector<int>& indices) const;
  /// Returns the placement of a cell; coordinates without an axis are 0.
  [[nodiscard]] Placement placement(std::uint64_t cell) const;

 private:
  std::vector<PlacementAxis> axes_;
  std::uint64_t size_ = 1;
};

/// Returns the k-th random placement, uniform between the ends of the axes, whatever their steps
/// are. It depends on the seed and k alone.
[[nodiscard]] Placement sampled_placement(const std::vector<PlacementAxis>& axes,
                                          std::uint64_t seed, std::uint64_t k);

/// The result of planning one placement: a row of docs/formats.md "Placements, CSV".
struct PlacementRow {
  std::uint64_t cell = 0;
  Offset offset{};
  HeldPositions hold = {};  ///< the joints that are varied; the same ones in all rows
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;  ///< set when solved
  /// Clearance of the pair that comes nearest to what it must keep, m; none where nothing is near.
  std::optional<double> clearance;
  std::optional<double> clearance_margin;  ///< that clearance less what the pair must keep, m
  /// Distance from the nearest limit of a joint that turns, rad; none where none has limits.
  std::optional<double> joint_margin;
  /// Distance of a joint that slides from its nearer limit, m; none where none slides.
  std::optional<double> slide_margin;
  std::optional<double> tool_speed;  ///< highest constant speed of the tool, m/s
  /// Furthest that a valid path comes, m along the path; none where not even the first layer has a
  /// node.
  std::optional<double> failed_s;
  std::string cause;  ///< to_string(Cause::Kind) of what ends paths there; empty when solved
  /// What that cause is about, see subject_of(); empty where the cause says it all.
  std::string by;
  std::string reason;                ///< the cause in words, or the message of an internal error
  std::optional<bool> checked = {};  ///< whether the answer was proved; none unless solved
};

/// Returns what a cause is about: the scene object, else the two bodies, else the joint, else the
/// name of the check, else "".
[[nodiscard]] std::string subject_of(const Cause& cause, const std::vector<SceneObject>& scene);

/// A measure by which placements are compared.
enum class PlacementCriterion { kClearance, kCost, kMargin, kSlide, kSpeed };
/// Returns the name: "clearance" (least clearance less what must be kept), "cost", "margin" (to a
/// limit of a joint that turns), "slide" (to a limit of a joint that slides) or "speed" (top speed
/// of the tool).
[[nodiscard]] const char* to_string(PlacementCriterion criterion);
/// Returns the criterion of a name that to_string() gives. Throws InputError for an unknown one.
[[nodiscard]] PlacementCriterion placement_criterion_from_string(const std::string& name);

/// Returns how good a placement is by a criterion: more is better; a multiple of 1e-9, so that
/// rounding decides no order. Returns none for a placement without a path, or where the measure is
/// not known.
[[nodiscard]] std::optional<double> merit(const PlacementRow& row, PlacementCriterion criterion);
/// Returns true if placement a comes before b: by the first criterion that tells them apart, else
/// by the order of cells.
[[nodiscard]] bool better(const PlacementRow& a, const PlacementRow& b,
                          const std::vector<PlacementCriterion>& criteria);
/// Returns the best placements that have a path, at most so many, the best first.
[[nodiscard]] std::vector<PlacementRow> best_placements(
    const std::vector<PlacementRow>& rows, const std::vector<PlacementCriterion>& criteria,
    std::size_t most);

}  // namespace swivel
