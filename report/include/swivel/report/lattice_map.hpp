// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/planner/plan/plan_view.hpp"

namespace swivel {

class Lattice;

/// What is known of a node of the (s, phi) lattice. The states are listed by importance, the least
/// important first: a drawn cell that stands for several nodes shows the most important state.
enum class NodeState : std::uint8_t {
  kNoIk,         ///< out of reach; in the first and the last layer also: not the given posture
  kSingular,     ///< a singular pose, or less manipulability than asked for
  kJointLimit,   ///< cause: the joint, 0..6, the first that is outside
  kNotLookedAt,  ///< exists in closed form; the search had no reason to ask about its clearance
  kFree,         ///< asked, and found to keep the clearance
  kBlocked,      ///< cause: index into LatticeMap::blockers
};

/// Shows the task submanifold of the paper's Fig. 5, node by node. Arms without a grid of arm
/// angles (ExplicitLattice) have cells of their redundancy coordinate, over the range in which
/// their nodes lie. A node has its own cell and those up to half the way to its neighbours on its
/// arc of self-motion; a cell that belongs to several nodes shows that of the path, or the most
/// important.
struct LatticeMap {
  struct Node {
    NodeState state = NodeState::kNoIk;
    std::uint8_t cause = 0;
    bool proved = false;  ///< of free and blocked nodes: a distance proof alone proves it, FCL need
                          ///< not be asked
    bool operator==(const Node&) const = default;
  };
  enum class Coordinate : std::uint8_t {
    kArmAngle,             ///< carried, of S-R-S arms
    kGeneralisedArmAngle,  ///< of arms without a closed form: arc_angle()
    kJoint,  ///< of other arms of seven joints: the position of the joint that is free, `joint`
    kRoll,   ///< of the tool: of arms of six joints
  };
  Coordinate coordinate = Coordinate::kArmAngle;
  /// The joint that a map of kJoint shows, 0-based: the one that slides, that of a turntable, or
  /// the one that the closed form locks.
  int joint = -1;
  bool slides = false;  ///< that joint slides: m stands for rad in `low`, `step` and values
  int layers = 0, angles = 0, windings = 1;
  double low = -kPi,
         step = 0;          ///< rad: cell k of a panel stands for low + k step of the coordinate
  bool closed = true;       ///< the cells go once around: the first is the last one's neighbour
  std::vector<double> s;    ///< m, of each layer
  std::vector<Node> nodes;  ///< [layer][panel][angle], panel = branch * windings + winding
  std::vector<int> slots;   ///< of each of `nodes`: whose it is, -1: none; empty of a grid
  std::vector<std::pair<std::string, std::string>>
      blockers;                      ///< two bodies each, in the order of their names
  std::vector<std::string> objects;  ///< of the scene, in its order, each once
  std::array<std::string, kDof> joint_names;
  std::vector<int> path;  ///< one cell in each layer, IK solution * angles + angle: the answer, or
                          ///< a way to the furthest layer reached
  bool complete = false;  ///< clearance was asked of every node, not only by the search
  /// True where the tool may stand turned: the branches are drawn at the path's rolls, and the last
  /// panel shows the rolls from -pi to pi at the branch and arm angle that the path has in each
  /// layer, where there is a path.
  bool turns = false;
  std::vector<int> path_of_rolls;  ///< one cell in each layer

  [[nodiscard]] bool grid() const {
    return coordinate == Coordinate::kArmAngle;
  }  ///< a cell is a node
  /// Returns where a value of the coordinate lies, in cells: k at the middle of cell k. Where cells
  /// are closed, the result is at least -0.5 and less than angles - 0.5.
  [[nodiscard]] double place(double value) const;
  /// Returns the value that cell k stands for, rad, in [-pi, pi], or m.
  [[nodiscard]] double value(double k) const;
  /// Returns the value of the coordinate, rad or m, at a row or a node with angle phi, rad, and
  /// joints q.
  [[nodiscard]] double value_at(double phi, const Config& q) const;
  /// Returns "arm angle", "generalised arm angle", "roll", or the joint's name; letter() returns
  /// its letter, or the joint's name.
  [[nodiscard]] std::string coordinate_name() const;
  [[nodiscard]] std::string letter(int panel) const;
  /// Returns "deg" or "m", and what a value is multiplied with to have that unit.
  [[nodiscard]] const char* unit() const { return slides ? "m" : "deg"; }
  [[nodiscard]] double scale() const { return slides ? 1 : 180 / kPi; }
  /// Says what it means that a cell has no node.
  [[nodiscard]] const char* emptiness() const;
  [[nodiscard]] int solutions() const;
  [[nodiscard]] int panels() const { return solutions() + (turns ? 1 : 0); }
  [[nodiscard]] bool shows_rolls(int panel) const { return panel == solutions(); }
  [[nodiscard]] const std::vector<int>& path_in(int panel) const {
    return shows_rolls(panel) ? path_of_rolls : path;
  }
  [[nodiscard]] const Node& at(int layer, int solution, int angle) const {
    return nodes[(static_cast<std::size_t>(layer) * static_cast<std::size_t>(panels()) +
                  static_cast<std::size_t>(solution)) *
                     static_cast<std::size_t>(angles) +
                 static_cast<std::size_t>(angle)];
  }
  /// Returns the panels that have a node, or the path.
  [[nodiscard]] std::vector<int> inhabited_solutions() const;
  /// Returns what blocks a blocked node, in words.
  [[nodiscard]] std::string blocker_name(const Node& node) const;
  /// Returns the object of the scene that blocks a blocked node, as an index into `objects`; -1
  /// where the robot is in its own way.
  [[nodiscard]] int blocking_object(const Node& node) const;
  /// Names an IK solution: "shoulder +, wrist -, elbow +", with the winding where there are
  /// several.
  [[nodiscard]] std::string solution_name(int solution) const;
};

/// Returns for each of `cells` cells of roll, from -pi on, the slot of the layer with the nearest
/// roll, -1 where there is none. Only slots at the branch and arm angle of `like`, a slot of the
/// layer, are considered. The lattice must be one of rolls.
[[nodiscard]] std::vector<int> slots_of_rolls(const Lattice& lattice, int layer, int like,
                                              int cells);

/// Returns the cell of a node in its layer: in a grid that of its slot, in other lattices that of
/// its branch and coordinate.
[[nodiscard]] int map_cell(const LatticeMap& map, const Lattice& lattice, int layer, int slot);

/// Makes the map after the plan, and evaluates the reasons again: about a microsecond for a node,
/// and a question of clearance for each node that the search asked about; with `full`, or where the
/// planner was eager, for every node. Throws Stopped.
[[nodiscard]] LatticeMap make_map(const PlanView& view, bool full, const Budget& budget = {});

/// Draws the map as text, one panel per inhabited IK solution: s to the right, the coordinate
/// in degrees from its largest value at the top, the path on it. A cell stands for as many
/// nodes as it takes to fit into `columns`, and shows the most important (NodeState).
/// `coloured`: ANSI 256 colours.
[[nodiscard]] std::string to_text(const LatticeMap& map, int columns, bool coloured);

/// Draws the map as SVG for papers, with axes and a legend.
[[nodiscard]] std::string to_svg(const LatticeMap& map);

}  // namespace swivel
