// SPDX-License-Identifier: BSD-3-Clause
// What the pages of answers say of one path: rows, motion, map, and where it ends.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "page/scene_json.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/page.hpp"

namespace swivel::detail {

/// A row of a trajectory, and where it is in the map.
struct PageRow {
  TrajectoryRow at;
  /// Layer of the lattice. Not a whole number for a row between two layers of the lattice, where
  /// the path has more layers than the lattice.
  double layer = 0;
  int solution = 0;
  double angle = 0;               ///< in cells
  std::optional<double> joint{};  ///< rad or m: of the joint that is the map's coordinate
  std::optional<double> roll{};   ///< rad
};

/// Returns true if the tool may stand turned, so that nodes have rolls.
[[nodiscard]] bool may_turn(const Lattice& lattice);

/// Returns the rows with their places in the map. `rows` are those of the path's layers, from the
/// first on; `slots` is the lattice's path. A row has the IK solution of the lattice's path if it
/// is on that branch, else the solution of the nearest node of its own branch.
[[nodiscard]] std::vector<PageRow> placed(const Lattice& lattice, const LatticeMap& map,
                                          const std::vector<TrajectoryRow>& rows,
                                          const std::vector<int>& slots);
/// Returns the rows of a path that may end anywhere, as far as its joints stay within their limits.
[[nodiscard]] std::vector<TrajectoryRow> rows_of(const Lattice& lattice, std::vector<int> slots);

/// Returns the place of a row in the map.
[[nodiscard]] Json place_json(const PageRow& row);
/// Returns the rows with their clearances, which it asks for. Throws Stopped.
[[nodiscard]] Json rows_json(const World& world, const Lattice& lattice,
                             const std::vector<PageRow>& shown, const Budget& budget);

/// How near bodies are to those that they must keep clear of, by name. Bodies without pairs are not
/// there; bodies of one name are as near as the nearest of them.
struct NearBodies {
  struct Nearest {
    double distance;  ///< m
    std::string other;
  };
  /// Adds one body, or keeps the nearer one.
  void add(const std::string& name, double distance, const std::string& other);
  /// Adds all bodies of a world at joints q. `query`: of that world.
  void add(const World& world, World::Query& query, const Config& q);
  std::map<std::string, Nearest> by_name;
};
/// Writes how near bodies are, row by row, at rows that have the same bodies: `names` of bodies;
/// `distance` to the nearest other one, in um, and `other`, the index of its name, of all names at
/// one row after the other, as encode_samples() writes them.
[[nodiscard]] Json near_json(const std::vector<NearBodies>& rows);
/// Writes how near the bodies of a world are at each row of a path. Throws Stopped.
[[nodiscard]] Json near_json(const World& world, const std::vector<PageRow>& rows,
                             const Budget& budget);

/// Returns a path that is drawn beside the rows that are shown; empty where they have its joints
/// but for whole turns.
[[nodiscard]] Json beside_json(const std::vector<PageRow>& path, const std::vector<PageRow>& shown);
/// Returns the points of the tool in each layer.
[[nodiscard]] Json tool_path_json(const ToolPath& path);
/// Returns what was asked of a path, for the page's table and the bounds in its plots.
[[nodiscard]] Json settings_json(const PathProblem& problem, const Lattice& lattice);

/// Returns the place of each sample of a motion in the rows of the path that it executes.
[[nodiscard]] std::vector<double> places_of(std::span<const TimedRow> samples,
                                            const std::vector<TrajectoryRow>& rows,
                                            const ToolPath* path);
/// Returns the rows of a path with the joints, arm angles and rolls that its motion has where it
/// passes them; a row that differs from these by less than is seen stays as it is. `places`: of the
/// motion's samples, as places_of() returns them.
[[nodiscard]] std::vector<TrajectoryRow> passed_rows(std::vector<TrajectoryRow> rows,
                                                     std::span<const TimedRow> samples,
                                                     const std::vector<double>& places);

/// Returns a motion over time at as many samples as a plot has room for: the place, of `places`,
/// one for each sample; the tool's speed; and for speed, acceleration and jerk, the largest share
/// of a joint's limit since the sample before that is shown, in percent. With them come the joints
/// of all samples, or of 20,000 that follow each other evenly.
[[nodiscard]] Json motion_json(const std::vector<TimedRow>& samples, double rate,
                               const JointRates& rates, const Chain& chain,
                               const std::vector<double>& places);

/// Returns a node's joints `q`, turned by whole turns to come nearest to a row of the path, as the
/// trajectory has them. A joint that such a turn would take out of its limits stays as it is.
[[nodiscard]] Config turned_towards(const Lattice& lattice, const Config& q,
                                    const std::vector<PageRow>& rows, std::size_t row);

/// Returns the place where every path has ended, and what keeps it from going on: the node past it,
/// of the same solution, that the path's last node would have moved to; the last row (`is_row`) if
/// there is no such node, or a joint limit ends all paths. Null if there is neither, or the problem
/// is solved.
[[nodiscard]] Json cut_json(const LatticeMap& map, const Lattice& lattice, const World& world,
                            const std::vector<int>& path, const std::vector<PageRow>& rows,
                            const Json& diagnosis);

/// Returns the map for the page, of at most about `most_cells` cells: the state of each cell and
/// the posture of one node for each. `path`: slots of the lattice's path; `rows`: of the path that
/// is shown, towards which postures turn their joints. Throws Stopped.
[[nodiscard]] Json map_json(const LatticeMap& map, const Lattice& lattice, const World& world,
                            const std::vector<int>& path, const std::vector<PageRow>& rows,
                            std::size_t most_cells, const Budget& budget);
/// The cells of the map of a page with one map.
inline constexpr std::size_t kMostCells = 200'000;

/// Returns the page of an answer. `source`: the problem's file; `data`: what the page says besides
/// `words`; `maps`: as HTML, for a page without JavaScript.
[[nodiscard]] std::string filled_page(const std::string& source, const PageWords& words, Json data,
                                      const std::string& maps);

}  // namespace swivel::detail
