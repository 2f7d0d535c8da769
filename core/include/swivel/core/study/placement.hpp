// SPDX-License-Identifier: BSD-3-Clause
// Where should the part, the path or the robot stand?
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// A move in the base frame of the problem: m along x, y, z, then a turn Rz(yaw) Ry(pitch) Rx(roll) about the thing's own origin,
/// rad.
using Offset = std::array<double, 6>;
inline constexpr std::array<const char*, 6> kCoordinates{"x", "y", "z", "roll", "pitch", "yaw"};

/// What is moved.
struct Movable {
  enum class Kind {
    kObject,  ///< an object of the scene, and the path where it is in its frame
    kPath,    ///< the path alone; its origin is that of its frame
    kBase,    ///< the robot: everything else moves the other way, as seen from it
  };
  Kind kind = Kind::kObject;
  std::string object;  ///< of kObject: its name
};

/// The problem with one thing moved. Coordinates that do not change keep their bits; those that do, of objects, are multiples of
/// 1e-12 m, and of 1e-12 rad as roll, pitch and yaw, so that a file can say them. Throws InvalidArgument for an unknown object.
[[nodiscard]] Problem placed_problem(const Problem& problem, const Movable& thing, const Offset& offset);

/// Roll, pitch and yaw of a rotation as multiples of 1e-12 rad. Of an object that placed_problem() has turned they give its
/// rotation bit for bit, read as a problem file's are.
[[nodiscard]] Vector3d written_rpy(const Matrix3d& rotation);

/// The values that one coordinate takes: `from` + k `step`, multiples of 1e-12.
struct PlacementAxis {
  int coordinate = 0;  ///< of kCoordinates
  double from = 0, to = 0, step = 0;
  int count = 1;  ///< 1 with a step of 0
  [[nodiscard]] double at(int k) const;
};

/// from, from + step, ... up to `to`; with a step of 0 `from` alone, or what a sample is drawn between. Throws InvalidArgument for
/// numbers beyond 1000, from > to, a negative step, and 2^31 values or more.
[[nodiscard]] PlacementAxis placement_axis(int coordinate, double from, double to, double step);

/// Cells in the order in which loops over the axes visit them, the last axis innermost.
class PlacementGrid {
 public:
  explicit PlacementGrid(std::vector<PlacementAxis> axes);
  [[nodiscard]] const std::vector<PlacementAxis>& axes() const { return axes_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Of a cell, along each axis.
  [[nodiscard]] std::vector<int> indices(std::uint64_t cell) const;
  [[nodiscard]] std::uint64_t cell(const std::vector<int>& indices) const;
  [[nodiscard]] Offset offset(std::uint64_t cell) const;

 private:
  std::vector<PlacementAxis> axes_;
  std::uint64_t size_ = 1;
};

/// The k-th placement drawn evenly between the ends of the axes, whatever their steps are: a function of seed and k alone.
[[nodiscard]] Offset sampled_offset(const std::vector<PlacementAxis>& axes, std::uint64_t seed, std::uint64_t k);

/// What became of one placement. A row of docs/formats.md "Placements, CSV".
struct PlacementRow {
  std::uint64_t cell = 0;
  Offset offset{};
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;              ///< set when solved
  std::optional<double> clearance;         ///< m, of the pair that comes nearest to what it must keep; none where nothing is near
  std::optional<double> clearance_margin;  ///< m, that clearance less what the pair must keep
  std::optional<double> joint_margin;      ///< rad, to the nearest limit; none where no joint has limits
  std::optional<double> tool_speed;        ///< m/s, highest constant speed of the tool
  std::optional<double> failed_s;          ///< m, furthest that a valid path comes; unset where not even the first layer has a node
  std::string cause;                       ///< to_string(Cause::Kind) of what ends paths there; empty when solved
  std::string by;      ///< the scene object in the way, else the joint or the two bodies; empty where the cause says it all
  std::string reason;  ///< the same for people, or the message of an internal error
};

/// The scene object that a cause is about, else its joint or its two bodies, else "".
[[nodiscard]] std::string subject_of(const Cause& cause, const Problem& problem);

/// By what placements are compared.
enum class PlacementCriterion { kClearance, kCost, kMargin, kSpeed };
/// "clearance" (least clearance less what must be kept), "cost", "margin" (to a joint limit), "speed" (top speed of the tool).
[[nodiscard]] const char* to_string(PlacementCriterion criterion);
/// Throws InputError for an unknown name.
[[nodiscard]] PlacementCriterion placement_criterion_from_string(const std::string& name);

/// What the criterion says of a placement: more is better, a multiple of 1e-9, so that rounding settles no order. None of one that
/// has no path, or where it is not known.
[[nodiscard]] std::optional<double> merit(const PlacementRow& row, PlacementCriterion criterion);
/// Whether one placement comes before the other: by the first criterion that tells them apart, else by the order of cells.
[[nodiscard]] bool better(const PlacementRow& a, const PlacementRow& b, const std::vector<PlacementCriterion>& criteria);
/// The best placements that have a path, the best first.
[[nodiscard]] std::vector<PlacementRow> best_placements(const std::vector<PlacementRow>& rows,
                                                        const std::vector<PlacementCriterion>& criteria, std::size_t most);

}  // namespace swivel
