// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/cause.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/held_joint.hpp"
#include "swivel/core/problem/stroke.hpp"

namespace swivel {

/// How a plan ended. kError stands in rows of campaigns and placements alone, for an internal
/// error, which plan() throws.
enum class PlanStatus { kSolved, kInfeasible, kTimeout, kCancelled, kError };
/// Returns "solved", "infeasible", "timeout", "cancelled" or "error".
[[nodiscard]] const char* to_string(PlanStatus status);

/// One layer of a solution: a row of docs/formats.md "Trajectory".
struct TrajectoryRow {
  double s = 0;  ///< m
  /// Arm angle, carried along the path, rad; a generalised one for arms that are not S-R-S.
  double phi = 0;
  /// IK branch of S-R-S arms, 0..7: bit 0 shoulder, bit 1 wrist, bit 2 elbow; set where the sine is
  /// negative.
  int branch = 0;
  Config q = Config::Zero();
  /// Roll of a seven-joint arm whose tool may be turned (Chain::free_roll), rad; else 0.
  double roll = 0;
};

/// Returns true if any row has a roll other than 0.
[[nodiscard]] bool any_rolls(const std::vector<TrajectoryRow>& rows);

/// Returns the rolls of rows, rad, without jumps of whole turns: as Task::rolls has them.
[[nodiscard]] std::vector<double> rolls_of(const std::vector<TrajectoryRow>& rows);

/// How much work a plan did.
struct Counters {
  std::int64_t ik_nodes = 0;       ///< nodes whose IK was solved (repeats counted)
  std::int64_t edges = 0;          ///< candidate edges compared (repeats counted)
  std::int64_t nodes_checked = 0;  ///< nodes whose clearance was asked
  std::int64_t edges_checked = 0;  ///< edges whose tool-path error or clearance was asked
  std::int64_t fcl_calls = 0;      ///< fcl::collide + fcl::distance
  /// Questions about a configuration's clearance answered without FCL: it is free, or too near.
  std::int64_t proved_free = 0;
  std::int64_t proved_colliding = 0;
  std::int64_t expansions = 0;  ///< vertices that the graph search expanded
  std::int64_t iterations = 0;  ///< candidate paths tried
};

/// What a plan's lattice is like.
struct LatticeInfo {
  int layers = 0;
  std::int64_t nodes = 0;
  /// Numbers of arm angles, branches, windings, cells of the arm-slope window between neighbours in
  /// successive layers.
  struct Grid {
    int phi = 0, branches = 8, windings = 1, window = 0;
    std::optional<int> rolls = {};  ///< number of rolls, of a tool that may be turned
  };
  std::optional<Grid> grid;          ///< for S-R-S arms
  std::optional<std::int64_t> arcs;  ///< for other arms: arcs of self-motion in all layers
  std::string method;                ///< how solutions are found: ArmClass::method()
  /// True: all IK solutions are known. False: only those that turned up, and "no path" means "none
  /// found".
  bool complete = true;
  int merged_waypoints = 0;
  /// What the search says of the knots of a lattice that has layers between them, and may have more
  /// knots (docs/model.md "Knots").
  struct Knots {
    /// What no path through nodes of the knots searched costs less than, whatever more knots there
    /// were besides; none where there is no path of valid nodes.
    std::optional<double> bound;
    /// By how much of `bound` the answer may be dearer than the best of those paths; none where
    /// there is no answer.
    std::optional<double> gap;
    /// An estimate: by what share of its cost the answer may be dearer than a path that changes its
    /// redundancy by any slope, docs/theory.md "As the resolution goes to zero"; none of metrics
    /// other than l2, of seven joints with a roll, and where there is no answer.
    std::optional<double> bias;
    /// False: time ended before steps that are worth it were halved.
    bool halved = true;
  };
  std::optional<Knots> knots;
  /// Cost that the search minimised and by which ties are settled, of solved problems: that of the
  /// nodes, not of the rows.
  double cost = 0;
};

/// A run of layers that have no node left, for one cause. docs/model.md.
struct EmptyLayers {
  int first = 0, last = 0;
  double first_s = 0, last_s = 0;  ///< m
  /// Rows of the path file, 0-based, that lie among these layers; -1: none.
  int first_waypoint = -1, last_waypoint = -1;
  Cause cause;                      ///< with the value of the layer that misses least
  std::optional<double> most = {};  ///< the most that one of these layers misses by
};

/// Why an infeasible problem has no path. docs/model.md.
struct Diagnosis {
  /// Furthest layer that a valid path from layer 0 reaches; none where layer 0 is empty.
  std::optional<int> reached_layer;
  std::optional<double> reached_s;
  /// The one cause that ends every path there: without it, paths would go on to `without_it`. Where
  /// no single cause explains it, it is the first of those that stand in the way, and `without_it`
  /// is none. Kind::kNone where it was not found in time, kNotAsked without Evidence::cause.
  Cause cause;
  /// m along the path, of the layer after the furthest one, where all paths have ended.
  std::optional<double> at_s;
  /// The last waypoint before that layer and the first from it on; -1: none.
  std::array<int, 2> waypoints{-1, -1};
  /// A layer that is reached if the cause alone is removed: at least this one. None if the problem
  /// has a StateCheck, unless that is the cause: it is not asked about what other rules refuse.
  std::optional<int> without_it;
  std::optional<double> without_it_s;
  std::vector<Cause> together;  ///< what must be removed besides, where no single cause explains it
  std::vector<EmptyLayers> empty_layers;
  struct Removed {
    Cause cause;
    std::int64_t count = 0;
    bool operator==(const Removed&) const = default;
  };
  /// Numbers of nodes and edges removed just past the furthest layer, in the order of words(cause).
  std::vector<Removed> removed;
  /// A layer at whose pose there are no joints within their limits, at any arm angle, by the closed
  /// form: the first of those at waypoints, else the first of all. Sought on exact S-R-S arms
  /// alone.
  struct Unreachable {
    int layer = 0;
    double s = 0;       ///< m
    int waypoint = -1;  ///< 0-based; -1: between waypoints
  };
  std::optional<Unreachable> unreachable;
  /// How far "no path" holds: at this resolution; at any resolution for a tool that is exactly on
  /// all of its path; or at any resolution for a tool that is exactly at its waypoints.
  enum class Holds { kThisResolution, kExactTool, kEveryResolution };
  /// Returns how far "no path" holds.
  [[nodiscard]] Holds holds() const {
    if (!unreachable) return Holds::kThisResolution;
    return unreachable->waypoint < 0 ? Holds::kExactTool : Holds::kEveryResolution;
  }
  /// False where time ran out, or where layers were too many or too costly to look at all of them.
  /// What the diagnosis says is true nevertheless.
  bool complete = true;
  int layers_known = 0;  ///< layers, from the first on, known to be empty or not
};

/// Returns "this_resolution", "exact_tool" or "every_resolution".
[[nodiscard]] const char* to_string(Diagnosis::Holds holds);

/// What a plan must find besides verdict, trajectory, counters, and where every path ends. Each
/// item costs time of its own.
struct Evidence {
  bool tool_path_error = false;  ///< PlanResult::tool_path_error_mm
  /// Exact clearances of all rows (which take more time than many a plan), manipulability, arm
  /// angle.
  bool postures = false;
  bool layers = false;   ///< Diagnosis::empty_layers and removed
  bool contact = false;  ///< Measures::deepest_contact
  /// Why every path ends there (Diagnosis::cause), which may take several times as long as finding
  /// that there is none. Not asked for, it is Cause::Kind::kNotAsked.
  bool cause = true;
  /// Returns the evidence that asks for everything.
  [[nodiscard]] static Evidence all() { return {true, true, true, true}; }
};

/// Whether a number about a trajectory is known. kNone: there is nothing of which it could be said,
/// such as a clearance where no pair is near. kNotMeasured: it was not asked for, or time ran out.
enum class Known { kMeasured, kNone, kNotMeasured };
/// Returns "measured", "none" or "not_measured".
[[nodiscard]] const char* to_string(Known known);
/// Returns whether a number is known that was or was not looked for, and was or was not there.
[[nodiscard]] inline Known known(bool looked_for, bool found) {
  if (!looked_for) return Known::kNotMeasured;
  return found ? Known::kMeasured : Known::kNone;
}

/// The row and pair of bodies that come nearest to the clearance that they must keep.
struct LeastMargin {
  double margin = 0;  ///< clearance - required, m
  /// Clearance of this pair, m; another pair that must keep less may be nearer.
  double clearance = 0;
  double required = 0;  ///< clearance that the pair must keep on layers, m
  std::array<std::string, 2> bodies;
  int row = 0;
};

/// The deepest contact of two bodies that may touch (SceneObject::allow). docs/model.md, "Contact".
struct DeepestContact {
  /// Depth found at a row, m: the depth is at least this.
  double depth = 0;
  /// Depth that the bodies do not exceed at any row, m; none where it is not known within 0.5 mm.
  /// Between rows, edges prove that a pair with an allowed depth keeps it; of others nothing is
  /// known.
  std::optional<double> at_most;
  std::array<std::string, 2> bodies;
  std::optional<double> allowed;  ///< Allowed::depth, m
  int row = 0;                    ///< index of the row
};

/// A pair of the robot's own bodies that is not kept apart as others are, though no SRDF disables
/// it.
struct SpecialPair {
  std::array<std::string, 2> bodies;
  double median = 0;  ///< median clearance over sampled postures, m
  /// What the pair must keep on layers and between them, m.
  double clearance = 0, edge_clearance = 0;
  bool operator==(const SpecialPair&) const = default;
};

/// How near the rows come to a joint's limit.
struct NearestLimit {
  double margin = 0;  ///< distance from the limit itself, rad; of a joint that slides m
  std::string joint;
  Cause::Side side = Cause::Side::kLower;
  int row = 0;
  bool slides = false;  ///< a joint that slides
};

/// The highest constant speed of the tool at which no joint need turn faster than it can.
struct TopToolSpeed {
  double speed = 0;   ///< m/s
  std::string joint;  ///< name of the joint that bounds it
  int row = 0;        ///< index of the row whose step to the next bounds it
};

/// What a trajectory comes near to, and how well it follows its path. Source: measure() in
/// planner/measure/measure.hpp.
struct Measures {
  std::optional<NearestLimit> nearest_limit;  ///< of joints that turn; none where none has limits
  std::optional<NearestLimit> nearest_slide_limit;  ///< of the joint that slides; none: none does
  /// None where the tool rests, or a joint's speed is not known.
  std::optional<TopToolSpeed> top_tool_speed;
  /// What was asked for, and is known: members below that it does not name mean nothing.
  Evidence evidence;
  Evidence asked;  ///< what was asked for; more than `evidence` where time ran out
  struct {
    double mean = 0, max = 0;
    int row = 0;                    ///< index of the row whose step has the largest
    std::optional<double> allowed;  ///< limits.tool_path_error
  } tool_path_error_mm;             ///< for Evidence::tool_path_error; below: postures
  /// Clearance of the nearest pair on any row, m; none where nothing is near.
  std::optional<double> min_clearance;
  std::optional<LeastMargin> min_margin;
  /// None where no allowed pair was found to touch, and unless Evidence::contact.
  std::optional<DeepestContact> deepest_contact;
  double min_manipulability = 0;
  std::vector<double> arm_angle;  ///< conventional arm angle of each row of S-R-S arms, rad
  /// Returns whether min_clearance and min_margin are known.
  [[nodiscard]] Known min_clearance_status() const {
    return known(evidence.postures, min_clearance.has_value());
  }
  /// Returns whether deepest_contact is known.
  [[nodiscard]] Known deepest_contact_status() const {
    return known(evidence.contact, deepest_contact.has_value());
  }
};

/// Returns the names of what was asked for and is not known, as "clearance, depth of contact"; ""
/// where all is known.
[[nodiscard]] std::string words_of_unmeasured(const Measures& measures);

/// What was found out about one run of a stroke. Its measures are those of its rows, where it has
/// some.
struct RunAnswer : Measures {
  StrokeRun run;  ///< of a problem of one path: its stroke, forwards
  /// How the plan of the run ended: of a run among others, of the run by itself.
  PlanStatus status = PlanStatus::kInfeasible;
  /// Cost in its lattice of the cheapest path of the run by itself; infinite where it has none. Not
  /// known of a problem of one path.
  double least_cost = 0;
  LatticeInfo lattice;
  std::optional<Diagnosis> diagnosis;  ///< of a run that has no path by itself
};

/// What the plan of one path found.
struct PlanResult : RunAnswer {
  double cost = 0;  ///< cost of the trajectory
  std::string planner;
  int threads = 1;
  Counters counters;
  /// By stage: load, prepare, plan, check, report and others.
  std::map<std::string, double> time_ms;
  std::vector<TrajectoryRow> trajectory;  ///< empty unless solved
  /// PlanOptions::check was given, and the trajectory and the motion made of it were verified.
  bool checked = false;
  /// Valid rows from the first layer on, as far as they are known, where there is no path; the
  /// trajectory that was not proved, where time was up before. Maybe none.
  std::vector<TrajectoryRow> partial;
  std::array<std::string, kDof> joint_names;
  std::vector<HeldJoint> held;  ///< joints between base and tip that are not planned
  /// Pairs that touch in every posture, which are not kept apart.
  std::vector<SpecialPair> dropped_pairs;
  /// Pairs near each other by design, which must keep less.
  std::vector<SpecialPair> reduced_pairs;
  std::vector<std::string> warnings;  ///< open meshes, merged waypoints, ...
};

}  // namespace swivel
