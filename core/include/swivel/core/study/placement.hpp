// SPDX-License-Identifier: BSD-3-Clause
// Placement studies: where should the part, the path or the robot stand?
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/job.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/problem/workcell.hpp"

namespace swivel {

/// A move in the base frame of the problem: x, y, z (m), then roll, pitch, yaw (rad), a turn
/// Rz(yaw) Ry(pitch) Rx(roll) about the moved thing's own origin.
using Offset = std::array<double, 6>;
/// Names of an Offset's numbers.
inline constexpr std::array<const char*, 6> kCoordinates{"x", "y", "z", "roll", "pitch", "yaw"};

/// The thing that a placement study moves.
struct Movable {
  enum class Kind {
    kObject,  ///< an object of the scene, and the path if it is given in its frame
    kPath,    ///< the path alone, about the origin of its frame
    kBase,    ///< the robot: as seen from it everything else moves the other way
  };
  Kind kind = Kind::kObject;
  std::string object;  ///< for kObject: its name
};

/// Returns the problem with one thing moved. Coordinates that do not change keep their bits. Those
/// of objects that do are multiples of 1e-12 m, and of 1e-12 rad as roll, pitch and yaw, so that a
/// file can state them exactly. Throws InvalidArgument for an unknown object.
[[nodiscard]] Problem placed_problem(const Problem& problem, const Movable& thing,
                                     const Offset& offset);
/// Returns the job with one thing moved as by placed_problem(), for Movable::Kind::kPath the paths
/// of all strokes. Its home stays as it is, seven joints. Throws InvalidArgument for an unknown
/// object.
[[nodiscard]] Job placed_job(const Job& job, const Movable& thing, const Offset& offset);
/// Returns the workcell with one thing moved as by placed_problem(), for Movable::Kind::kPath the
/// paths of both arms alike. The path of a follower stays on its leader's tool; a given motion,
/// starts and ends stay as they are, joints. Throws InvalidArgument for an unknown object, for the
/// path of a follower whose leader's motion is given, and for paths that are turned alike and have
/// frames with an origin each.
[[nodiscard]] Workcell placed_workcell(const Workcell& cell, const Movable& thing,
                                       const Offset& offset);

/// Returns roll, pitch and yaw of a rotation as multiples of 1e-12 rad. For an object that
/// placed_problem() has turned, a problem file with these angles gives its rotation bit for bit.
[[nodiscard]] Vector3d written_rpy(const Matrix3d& rotation);

/// The values that one coordinate of a placement takes: `from` + k `step`, multiples of 1e-12.
/// Source: placement_axis().
struct PlacementAxis {
  int coordinate = 0;  ///< index into kCoordinates
  double from = 0, to = 0, step = 0;
  int count = 1;  ///< number of values; 1 with a step of 0
  /// Returns the k-th value.
  [[nodiscard]] double at(int k) const;
};

/// Returns the axis with the values from, from + step, ... up to `to`; with a step of 0 `from`
/// alone, or the range that samples are drawn from. Throws InvalidArgument for numbers beyond 1000,
/// from > to, a negative step, and 2^31 values or more.
[[nodiscard]] PlacementAxis placement_axis(int coordinate, double from, double to, double step);

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
  /// Returns the offset of a cell; coordinates without an axis are 0.
  [[nodiscard]] Offset offset(std::uint64_t cell) const;

 private:
  std::vector<PlacementAxis> axes_;
  std::uint64_t size_ = 1;
};

/// Returns the k-th random placement, uniform between the ends of the axes, whatever their steps
/// are. It depends on the seed and k alone.
[[nodiscard]] Offset sampled_offset(const std::vector<PlacementAxis>& axes, std::uint64_t seed,
                                    std::uint64_t k);

/// The result of planning one placement: a row of docs/formats.md "Placements, CSV".
struct PlacementRow {
  std::uint64_t cell = 0;
  Offset offset{};
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;  ///< set when solved
  /// Clearance of the pair that comes nearest to what it must keep, m; none where nothing is near.
  std::optional<double> clearance;
  std::optional<double> clearance_margin;  ///< that clearance less what the pair must keep, m
  /// Distance from the nearest joint limit, rad; none where no joint has limits.
  std::optional<double> joint_margin;
  std::optional<double> tool_speed;  ///< highest constant speed of the tool, m/s
  /// Furthest that a valid path comes, m along the path; none where not even the first layer has a
  /// node.
  std::optional<double> failed_s;
  std::string cause;  ///< to_string(Cause::Kind) of what ends paths there; empty when solved
  /// What that cause is about, see subject_of(); empty where the cause says it all.
  std::string by;
  std::string reason;  ///< the cause in words, or the message of an internal error
};

/// Returns what a cause is about: the scene object, else the two bodies, else the joint, else the
/// name of the check, else "".
[[nodiscard]] std::string subject_of(const Cause& cause, const std::vector<SceneObject>& scene);

/// A measure by which placements are compared.
enum class PlacementCriterion { kClearance, kCost, kMargin, kSpeed };
/// Returns the name: "clearance" (least clearance less what must be kept), "cost", "margin" (to a
/// joint limit) or "speed" (top speed of the tool).
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
