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

namespace swivel {

/// kError is of episodes of a campaign alone: an internal error, which plan() throws.
enum class PlanStatus { kSolved, kInfeasible, kTimeout, kCancelled, kError };
[[nodiscard]] const char* to_string(PlanStatus status);

/// One layer of a solution: a row of docs/formats.md "Trajectory".
struct TrajectoryRow {
  double s = 0;    ///< m along the path
  double phi = 0;  ///< carried arm angle, rad; of arms that are not S-R-S a generalised one, for reports
  int branch = 0;  ///< of S-R-S arms 0..7: bit 0 shoulder, bit 1 wrist, bit 2 elbow; set where the sine is negative
  Config q = Config::Zero();
  double roll = 0;  ///< of seven joints whose tool may stand turned (Chain::free_roll): by how much it does, rad
};

/// Whether any of them says that the tool stands turned.
[[nodiscard]] bool any_rolls(const std::vector<TrajectoryRow>& rows);

/// Task::rolls that rows say, without jumps of whole turns.
[[nodiscard]] std::vector<double> rolls_of(const std::vector<TrajectoryRow>& rows);

/// Work done, counted by the one that did it.
struct Counters {
  std::int64_t ik_nodes = 0;        ///< nodes whose IK was solved (repeats counted)
  std::int64_t edges = 0;           ///< candidate edges whose joint steps were compared (repeats counted)
  std::int64_t nodes_checked = 0;   ///< nodes whose clearance was asked
  std::int64_t edges_checked = 0;   ///< edges whose tool-path error or clearance was asked
  std::int64_t fcl_calls = 0;       ///< fcl::collide + fcl::distance
  std::int64_t certified_free = 0;  ///< questions about a configuration's clearance answered without FCL
  std::int64_t certified_colliding = 0;
  std::int64_t expansions = 0;  ///< vertices popped by the graph search
  std::int64_t iterations = 0;  ///< candidate paths tried
};

struct LatticeInfo {
  int layers = 0;
  std::int64_t nodes = 0;
  struct Grid {
    int phi = 0, branches = 8, windings = 1, window = 0;
    std::optional<int> rolls = {};  ///< of a tool that may stand turned
  };
  std::optional<Grid> grid;          ///< of S-R-S arms: arm angles, and cells between neighbours in successive layers
  std::optional<std::int64_t> arcs;  ///< of other arms: arcs of self-motion in all layers
  std::string method;                ///< how solutions are found: ArmClass::method()
  bool complete = true;              ///< all solutions are known; else only those that turned up, and "no path" means "none found"
  int merged_waypoints = 0;
  double cost = 0;  ///< what the search minimised and ties are settled by, of solved problems: of the nodes, not of the rows
};

/// Layers, one after the other, that have no node left for one cause. docs/model.md.
struct EmptyLayers {
  int first = 0, last = 0;
  double first_s = 0, last_s = 0;               ///< m
  int first_waypoint = -1, last_waypoint = -1;  ///< 0-based rows of the path file among these layers; -1: none
  Cause cause;                                  ///< as at the layer that misses least
  std::optional<double> most = {};              ///< the most that one of these layers misses by
};

/// Why an infeasible problem has no path. docs/model.md.
struct Diagnosis {
  std::optional<int> reached_layer;  ///< furthest layer that a valid path from layer 0 reaches; null where layer 0 is empty
  std::optional<double> reached_s;
  /// The one thing that ends every path there: without it, paths would go on to `without_it`. Where no single thing helps, it is
  /// the first of those that stand in the way, and `without_it` is none. Kind::kNone where it was not found in time.
  Cause cause;
  std::optional<double> at_s;            ///< of the layer just past the furthest one, where all paths have ended
  std::array<int, 2> waypoints{-1, -1};  ///< the last waypoint before that layer and the first from it on; -1: none
  /// A layer that is reached if this thing alone is removed: at least this. None beside a StateCheck, unless that is the cause: it
  /// is not asked about what other rules refuse.
  std::optional<int> without_it;
  std::optional<double> without_it_s;
  std::vector<Cause> together;  ///< what must go besides, where no single thing helps
  std::vector<EmptyLayers> empty_layers;
  struct Removed {
    Cause cause;
    std::int64_t count = 0;
    bool operator==(const Removed&) const = default;
  };
  std::vector<Removed> removed;  ///< nodes and edges removed just past the furthest layer, in the order of words(cause)
  /// A layer at whose pose no joints within their limits are, at any arm angle, by the closed form: of those at waypoints the
  /// first, else of all. Looked for on exact S-R-S arms alone.
  struct Unreachable {
    int layer = 0;
    double s = 0;       ///< m
    int waypoint = -1;  ///< 0-based; -1: between waypoints
  };
  std::optional<Unreachable> unreachable;
  /// How much further than this resolution "no path" goes: whatever the resolution, for a tool that stands exactly at its
  /// waypoints, or exactly on all of its path.
  enum class Holds { kThisResolution, kExactTool, kEveryResolution };
  [[nodiscard]] Holds holds() const {
    if (!unreachable) return Holds::kThisResolution;
    return unreachable->waypoint < 0 ? Holds::kExactTool : Holds::kEveryResolution;
  }
  /// False where time ran out, or the layers were too many or too costly to look at all. What is said is true nevertheless.
  bool complete = true;
  int layers_known = 0;  ///< layers, from the first on, of which it is known whether they are empty
};

[[nodiscard]] const char* to_string(Diagnosis::Holds holds);

/// What a plan is to find besides verdict, trajectory, counters, and where and why every path ends. Each costs time of its own.
struct Evidence {
  bool tool_path_error = false;  ///< PlanResult::tool_path_error_mm
  bool postures = false;         ///< exact clearances of all rows (more time than many a plan), manipulability, arm angle
  bool layers = false;           ///< Diagnosis::empty_layers and removed
  [[nodiscard]] static Evidence all() { return {true, true, true}; }
};

/// The row and pair that come nearest to what must be kept there.
struct LeastMargin {
  double margin = 0;     ///< clearance - required, m
  double clearance = 0;  ///< of this pair; another may be nearer that must keep less
  double required = 0;   ///< what the pair must keep on layers
  std::array<std::string, 2> bodies;
  int row = 0;
};

/// The deepest contact of bodies that a scene object allows to touch it (SceneObject::allow). docs/model.md, "Contact".
struct DeepestContact {
  double depth = 0;               ///< m, found: at a row or at a posture between two rows; the depth is at least this
  std::optional<double> at_most;  ///< m, proved for all rows and all moves between them; unset where the shapes leave it open
  std::array<std::string, 2> bodies;
  std::optional<double> allowed;  ///< Allowed::depth, m
  int row = 0;                    ///< at it, or on the way from it to the next
};

/// A robot pair without an SRDF's word that is not kept apart as others are.
struct SpecialPair {
  std::array<std::string, 2> bodies;
  double median = 0;                         ///< clearance over sampled postures, m
  double clearance = 0, edge_clearance = 0;  ///< what it keeps on layers and between them, m
};

/// How near the rows come to a joint's limit.
struct NearestLimit {
  double margin = 0;  ///< rad, to the limit itself
  std::string joint;
  Cause::Side side = Cause::Side::kLower;
  int row = 0;
};

/// The highest constant speed of the tool at which no joint need turn faster than it can.
struct TopToolSpeed {
  double speed = 0;   ///< m/s
  std::string joint;  ///< that bounds it
  int row = 0;        ///< on the step from it
};

/// What a trajectory comes near to, and how well it follows its path: measure() in planner/measure/measure.hpp.
struct Measures {
  std::optional<NearestLimit> nearest_limit;   ///< null where no joint has limits
  std::optional<TopToolSpeed> top_tool_speed;  ///< null where the tool rests, or a joint's speed is not known
  Evidence evidence;                           ///< what was asked for, and is known; the rest of what follows means nothing
  struct {
    double mean = 0, max = 0;
    int row = 0;                        ///< the step from it has the largest
    std::optional<double> allowed;      ///< limits.tool_path_error
  } tool_path_error_mm;                 ///< Evidence::tool_path_error; the others: Evidence::postures
  std::optional<double> min_clearance;  ///< of the nearest pair on any row, m; null when nothing is near
  std::optional<LeastMargin> min_margin;
  std::optional<DeepestContact> deepest_contact;  ///< null where no allowed pair was found to touch
  double min_manipulability = 0;
  std::vector<double> arm_angle;  ///< conventional arm angle of each row of S-R-S arms, rad
};

/// The measures are those of the trajectory, where there is one.
struct PlanResult : Measures {
  PlanStatus status = PlanStatus::kInfeasible;
  double cost = 0;  ///< of the rows
  std::string planner;
  int threads = 1;
  LatticeInfo lattice;
  Counters counters;
  std::map<std::string, double> time_ms;  ///< load, prepare, plan, check, report, and stages
  std::vector<TrajectoryRow> trajectory;  ///< empty unless solved
  bool checked = false;                   ///< PlanOptions::check: it was proved, and the motion that was made of it
  /// Where there is no answer: rows from the first layer on that are valid, as far as they are known; maybe none.
  std::vector<TrajectoryRow> partial;
  std::array<std::string, kDof> joint_names;
  std::vector<HeldJoint> held;             ///< joints between base and tip that are not planned
  Diagnosis diagnosis;                     ///< filled when infeasible
  std::vector<SpecialPair> dropped_pairs;  ///< touch in every posture: not kept apart
  std::vector<SpecialPair> reduced_pairs;  ///< near by design: keep less
  std::vector<std::string> warnings;       ///< open meshes, merged waypoints, ...
};

}  // namespace swivel
