// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/lattice_map.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "diagnosis_of.hpp"
#include "robots.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/io/io.hpp"

namespace swivel {
namespace {

using namespace test;

struct Drawn {
  PathProblem problem;
  PlanResult result;
  LatticeMap map;
};

Drawn draw(const std::string& name, PlannerKind planner, bool full) {
  Drawn drawn;
  drawn.problem = io::load_path_problem(data_dir() / "problems" / (name + ".yaml"));
  drawn.problem.resolution.ds = 0.02;
  drawn.problem.resolution.dphi = 0.1;
  drawn.problem.limits.edges = EdgeMode::kNodes;
  PlanOptions options;
  options.planner = planner;
  Planner arm(drawn.problem);
  drawn.result = arm.plan(options);
  drawn.map = make_map(arm.view(), full);
  return drawn;
}

/// Returns the problem of a torch at a door, with windows of the roll that go along the path, or
/// with all rolls and a ball in the scene.
PathProblem problem_of_rolls(bool windows) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems" / "torch_door.yaml");
  problem.resolution.droll = 0.25;
  problem.resolution.dphi = 0.2;
  if (!windows)
    problem.scene.push_back({"ball", Sphere{0.03}, Pose(Eigen::Translation3d(0.6, 0.3, 1.0)), {}});
  const auto n = static_cast<double>(problem.waypoints.size() - 1);
  if (windows) problem.roll = Roll{-1, 0.8};
  for (std::size_t k = 0; windows && k < problem.waypoints.size(); ++k)
    problem.waypoints[k].roll =
        Roll{-1 + 0.6 * static_cast<double>(k) / n, 0.2 + 0.6 * static_cast<double>(k) / n};
  return problem;
}

/// The panel of rolls of a map, and what is asked about its nodes.
struct PanelOfRolls {
  const PlanView& view;
  const LatticeMap& map;
  LatticeInfo::Grid grid;
  double clearance;  ///< m
  bool windows;      ///< whether waypoints limit the roll
  World::Query query;
  std::map<NodeState, int> count;  ///< cells by their state

  /// Returns how many slots each roll has.
  [[nodiscard]] int width() const { return grid.branches * grid.windings * grid.phi; }
};

/// Checks cell k of a layer; `inner` is the place of the path's node within its roll.
void check_cell_of_rolls(PanelOfRolls& panel, int layer, int inner, int k) {
  const Lattice& lattice = panel.view.lattice;
  const LatticeMap& map = panel.map;
  const int width = panel.width();
  const Roll window = lattice.path().layer(layer).window;
  const double roll = k * (kTwoPi / map.angles) - kPi;
  const LatticeMap::Node& seen = map.at(layer, map.solutions(), k);
  ++panel.count[seen.state];
  int nearest = 0;
  double least = kPi;
  for (int rank = 0; rank < *panel.grid.rolls; ++rank) {
    const double away = std::abs(
        std::remainder(lattice.grid_place(layer, rank * width + inner).roll - roll, kTwoPi));
    if (away < least) least = away, nearest = rank;
  }
  if (panel.windows && (roll < window.lower - 0.13 || roll > window.upper + 0.13)) {
    ASSERT_EQ(seen.state, NodeState::kNoIk) << layer << ' ' << k;
    return;
  }
  if (least > 0.12) return;  // between two rolls either may be told
  const int slot = nearest * width + inner;
  const auto q = lattice.node(layer, slot);
  ASSERT_EQ(q.has_value(), seen.state >= NodeState::kNotLookedAt) << layer << ' ' << k;
  if (q) {
    ASSERT_EQ(seen.state, panel.query.find_violating_pair(*q, panel.clearance) ? NodeState::kBlocked
                                                                               : NodeState::kFree);
  } else {
    ASSERT_EQ(seen.state == NodeState::kJointLimit,
              lattice.fault(layer, slot).status == NodeStatus::kLimit);
  }
}

/// Checks the node of the path and all cells of a layer.
void check_layer_of_rolls(PanelOfRolls& panel, int layer) {
  const Lattice& lattice = panel.view.lattice;
  const LatticeMap& map = panel.map;
  const int on_path = panel.view.path[static_cast<std::size_t>(layer)],
            inner = lattice.grid_place(layer, on_path).cell;
  const int path_cell =
      map.path_of_rolls[static_cast<std::size_t>(layer)] - map.solutions() * map.angles;
  EXPECT_EQ(map.at(layer, map.solutions(), path_cell).state, NodeState::kFree) << layer;
  for (int k = 0; k < map.angles; ++k) {
    check_cell_of_rolls(panel, layer, inner, k);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// Checks how many cells are in each state, and that text and drawing name the panel.
void check_states_of_rolls(PanelOfRolls& panel) {
  const LatticeMap& map = panel.map;
  const bool windows = panel.windows;
  std::map<NodeState, int>& count = panel.count;
  std::printf("%s: %d free, %d blocked, %d beyond a limit, %d none\n",
              windows ? "windows" : "all rolls", count[NodeState::kFree],
              count[NodeState::kBlocked], count[NodeState::kJointLimit], count[NodeState::kNoIk]);
  EXPECT_GT(count[NodeState::kFree], 20);
  EXPECT_GT(count[NodeState::kBlocked] + count[NodeState::kJointLimit], windows ? 0 : 20);
  EXPECT_EQ(count[NodeState::kNoIk] > 20, windows);
  const std::string name = map.solution_name(map.solutions());
  EXPECT_NE(to_text(map, 80, false).find(name), std::string::npos);
  EXPECT_NE(to_svg(map).find(name), std::string::npos);
}

/// The panel of rolls: what plain questions say of the nodes at the path's branch and arm angle,
/// nothing outside the windows.
TEST(MapOfRolls, IsThatOfTheNodesWhereThePathIs) {
  for (const bool windows : {false, true}) {
    const PathProblem problem = problem_of_rolls(windows);
    Planner arm(problem);
    const PlanResult result = arm.plan({});
    ASSERT_EQ(result.status, PlanStatus::kSolved);
    const PlanView view = arm.view();
    const LatticeMap map = make_map(view, true);
    ASSERT_TRUE(map.turns);
    ASSERT_EQ(map.path_of_rolls.size(), view.path.size());
    PanelOfRolls panel{view,
                       map,
                       result.lattice.grid.value(),
                       problem.limits.clearance,
                       windows,
                       World::Query(view.world),
                       {}};
    for (int layer = 0; layer < map.layers; ++layer) {
      check_layer_of_rolls(panel, layer);
      if (::testing::Test::HasFatalFailure()) return;
    }
    check_states_of_rolls(panel);
  }
}

/// The cells of a layer, by branch and cell, that arcs pass through.
struct CellsOfArcs {
  std::map<std::pair<int, int>, std::vector<int>> of_cell;  ///< the slots that have the cell
  std::set<std::pair<int, int>> with_node;
  std::set<std::pair<int, int>> unsure;  ///< as near to one neighbour as to the other
};

/// Returns the value of a map's coordinate at a node, rad or m.
double value_of(const Lattice& lattice, const LatticeMap& map, int layer, int slot) {
  return map.value_at(lattice.phi(layer, slot), *lattice.node(layer, slot));
}

/// Finds the cells of a layer from its nodes and from the ways between neighbours on their arcs.
void find_cells_of_arcs(const Lattice& lattice, const LatticeMap& map, int layer,
                        CellsOfArcs& cells) {
  for (int slot = 0; slot < lattice.slots(layer); ++slot) {
    const double value = value_of(lattice, map, layer, slot), at = map.place(value);
    ASSERT_TRUE(map.closed ? at < map.angles - 0.5 + 1e-9 : at <= map.angles - 1 + 1e-6);
    ASSERT_GE(at, map.closed ? -0.5 : -1e-6);
    const std::pair cell(lattice.branch(layer, slot),
                         static_cast<int>(std::lround(at)) % map.angles);
    cells.of_cell[cell].push_back(slot);
    cells.with_node.insert(cell);
    const int next = lattice.next_on_arc(layer, slot);
    if (next < 0) continue;
    const auto from_value = [&](double to) {
      return map.slides ? to - value : std::remainder(to - value, kTwoPi);
    };
    const double way = from_value(value_of(lattice, map, layer, next));
    for (int k = 0; k < map.angles; ++k) {
      const double along = from_value(map.low + k * map.step);
      if (along * way < 0 || std::abs(along) > std::abs(way)) continue;
      const int nearer = std::abs(2 * along) < std::abs(way) ? slot : next;
      cells.of_cell[{lattice.branch(layer, nearer), k}].push_back(nearer);
      if (std::abs(std::abs(2 * along) - std::abs(way)) < 1e-9)
        for (const int either : {slot, next})
          cells.unsure.insert({lattice.branch(layer, either), k});
    }
  }
}

/// Counts cells of a map.
struct CellCounts {
  int filled = 0;  ///< cells between nodes of an arc
  int own = 0;     ///< cells with a node of their own
  int empty = 0;   ///< cells that no arc passes through
  int holes = 0;   ///< cells that show no node although an arc passes through
};

/// A map of arcs, and what is asked about its nodes.
struct ArcMap {
  const char* name;
  const PlanView& view;
  const LatticeMap& map;
  double clearance;  ///< m
  World::Query query;
  CellCounts counts;
};

/// Checks which slot a cell shows, and its state; `on_path` is the path's slot in the layer, -1
/// where it has none.
void check_cell_of_arcs(ArcMap& arcs, const CellsOfArcs& cells, int layer, int solution, int cell,
                        int on_path) {
  const Lattice& lattice = arcs.view.lattice;
  const LatticeMap& map = arcs.map;
  CellCounts& counts = arcs.counts;
  const std::size_t k = (static_cast<std::size_t>(layer * map.panels() + solution)) *
                            static_cast<std::size_t>(map.angles) +
                        static_cast<std::size_t>(cell);
  const auto found = cells.of_cell.find({solution, cell});
  if (cells.unsure.count({solution, cell})) return;
  if (found == cells.of_cell.end()) {
    ++counts.empty;
    EXPECT_EQ(map.slots[k], -1) << arcs.name << ' ' << layer << ' ' << solution << ' ' << cell;
    return;
  }
  const std::vector<int>& slots = found->second;
  (cells.with_node.count({solution, cell}) ? counts.own : counts.filled) += 1;
  counts.holes += map.slots[k] < 0;
  if (std::find(slots.begin(), slots.end(), on_path) != slots.end()) {
    EXPECT_EQ(map.slots[k], on_path);
    return;
  }
  EXPECT_NE(std::find(slots.begin(), slots.end(), map.slots[k]), slots.end())
      << layer << ' ' << cell;
  const bool blocked = std::any_of(slots.begin(), slots.end(), [&](int slot) {
    return arcs.query.find_violating_pair(*lattice.node(layer, slot), arcs.clearance).has_value();
  });
  EXPECT_EQ(map.nodes[k].state, blocked ? NodeState::kBlocked : NodeState::kFree)
      << arcs.name << ' ' << layer << ' ' << cell;
}

/// Checks all cells of a layer, and those of the path.
void check_layer_of_arcs(ArcMap& arcs, int layer) {
  const PlanView& view = arcs.view;
  const LatticeMap& map = arcs.map;
  CellsOfArcs cells;
  find_cells_of_arcs(view.lattice, map, layer, cells);
  if (::testing::Test::HasFatalFailure()) return;
  const int on_path =
      layer < static_cast<int>(view.path.size()) ? view.path[static_cast<std::size_t>(layer)] : -1;
  for (int solution = 0; solution < map.solutions(); ++solution)
    for (int cell = 0; cell < map.angles; ++cell)
      check_cell_of_arcs(arcs, cells, layer, solution, cell, on_path);
  if (layer >= static_cast<int>(view.path.size())) return;
  const int cell = map.path[static_cast<std::size_t>(layer)];  // the path shows itself
  EXPECT_EQ(map.slots[static_cast<std::size_t>(layer * map.panels() * map.angles + cell)],
            view.path[static_cast<std::size_t>(layer)]);
  EXPECT_EQ(map.at(layer, cell / map.angles, cell % map.angles).state, NodeState::kFree);
}

/// Checks what text and drawing say of the coordinate and of cells without a node.
void check_words_of_arcs(const LatticeMap& map) {
  const std::string text = to_text(map, 80, false), svg = to_svg(map),
                    words = map.coordinate_name();
  const bool of_joint = map.coordinate == LatticeMap::Coordinate::kJoint;
  EXPECT_NE(text.find("Rows are " + (of_joint ? "positions of " + words : words + "s") + ", " +
                      (map.slides ? "m." : "deg.")),
            std::string::npos);
  EXPECT_EQ(text.find("Rows are arm angles"), std::string::npos);
  EXPECT_NE(svg.find(map.letter(0) + ": " + (of_joint ? "position of the joint" : words)),
            std::string::npos);
  // The margin left of a panel has room for nine letters; a longer name stands above the panel.
  const std::string coordinate = map.letter(0) + ", " + map.unit();
  const auto drawn_at = [&](const char* x, const std::string& label) {
    const std::size_t label_at = svg.find(">" + label + "<");
    return label_at != std::string::npos && svg.rfind("<text x=\"" + std::string(x) + "\"",
                                                      label_at) == svg.rfind("<text ", label_at);
  };
  EXPECT_TRUE(coordinate.size() <= 9 ? drawn_at("46.00", coordinate)
                                     : drawn_at("672.00", "vertical: " + coordinate));
  const auto solutions = map.inhabited_solutions();
  const bool some_are_empty = std::any_of(solutions.begin(), solutions.end(), [&](int solution) {
    for (int layer = 0; layer < map.layers; ++layer)
      for (int cell = 0; cell < map.angles; ++cell)
        if (map.at(layer, solution, cell).state == NodeState::kNoIk) return true;
    return false;
  });
  EXPECT_EQ(svg.find("no node: out of reach, beyond a joint limit") != std::string::npos,
            some_are_empty);
}

/// Every cell that an arc passes through between two nodes shows a node, its own or the nearer
/// neighbour's; every other cell is empty. Checked against the arcs alone: each pair of neighbours
/// in each layer.
TEST(MapOfArcs, HasNoHolesBetweenNodesOfAnArc) {
  // The coordinate is what is free: of a turntable the table, of a rail the carriage, of other arms
  // the joint that the closed form locks, or the roll.
  for (const auto& [name, coordinate] : {std::pair{"panda_weld_seam", "joint_5"},
                                         {"gen3_glue_bead", "joint_3"},
                                         {"kr6_turntable_pipe", "table_joint"},
                                         {"ur10e_rail_seam", "rail"},
                                         {"ur5e_deburr_edge", "roll"},
                                         {"kr6_weld_pipe", "roll"}}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    problem.resolution.ds = 0.05;
    problem.resolution.knot = 0;
    Planner arm(problem);
    (void)arm.plan({});
    const PlanView view = arm.view();
    const LatticeMap map = make_map(view, true);
    EXPECT_EQ(map.coordinate_name(), coordinate);
    EXPECT_EQ(map.slides, std::string(name) == "ur10e_rail_seam");
    EXPECT_EQ(map.slots.size(), map.nodes.size());
    const double high = map.low + (map.angles - 1) * map.step;
    ArcMap arcs{name, view, map, problem.limits.clearance, World::Query(view.world), {}};
    for (int layer = 0; layer < map.layers; ++layer) {
      check_layer_of_arcs(arcs, layer);
      if (::testing::Test::HasFatalFailure()) return;
    }
    std::printf("%s: %d cells with nodes, %d between them, %d empty; %.2f to %.2f rad%s\n", name,
                arcs.counts.own, arcs.counts.filled, arcs.counts.empty, map.low, high,
                map.closed ? ", closed" : "");
    EXPECT_EQ(arcs.counts.holes, 0);
    EXPECT_GT(arcs.counts.filled, 100);
    EXPECT_GT(arcs.counts.own, 400);
    check_words_of_arcs(map);
  }
}

/// A value's cell stands for that value, wherever the range begins and however often the value has
/// gone around.
TEST(MapOfArcs, CellsStandForTheirValues) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-kPi, kPi), width(0.02, 5.4);
  std::uniform_int_distribution<int> turns(-3, 3), count(2, 120);
  for (int trial = 0; trial < 2000; ++trial) {
    LatticeMap map;
    map.closed = trial % 2 == 0;
    map.angles = count(random);
    map.low = map.closed ? -kPi : any(random);
    map.step = map.closed ? kTwoPi / map.angles : width(random) / (map.angles - 1);
    for (int cell = 0; cell < map.angles; ++cell) {
      ASSERT_NEAR(map.place(map.value(cell) + turns(random) * kTwoPi), cell, 1e-9) << trial;
      ASSERT_LE(std::abs(map.value(cell)), kPi + 1e-12);
    }
  }
}

class Maps : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Experiments, Maps,
                         ::testing::Values("experiment_a", "experiment_a_start", "experiment_b",
                                           "experiment_c"));

/// The maps of one problem: of a lazy search, of all its nodes, and of an eager plan.
struct ThreeMaps {
  Drawn lazy, full, eager;
};

/// Answers plain questions about the nodes of a lattice, and counts the answers.
struct PlainQuestions {
  const SrsLattice& lattice;
  const World& world;
  World::Query query{world}, quick{world, DistanceProofs::kOn};
  int proved = 0;                    ///< nodes that a distance proof alone proves
  std::map<NodeState, int> count{};  ///< nodes of the lazy map by their state
};

/// Checks the state of node k of the maps, which is at a layer and a slot of the lattice.
void check_state_of_node(const ThreeMaps& maps, PlainQuestions& plain, int layer, int slot,
                         std::size_t k) {
  const LatticeMap::Node seen = maps.lazy.map.nodes[k], known = maps.full.map.nodes[k];
  ++plain.count[seen.state];
  ASSERT_EQ(known.state, maps.eager.map.nodes[k].state);
  if (seen.state != NodeState::kNotLookedAt) {
    ASSERT_EQ(seen.state, known.state);
  }
  const auto q = plain.lattice.node(layer, slot);
  ASSERT_EQ(q.has_value(), known.state >= NodeState::kNotLookedAt);
  if (!q) {
    const SrsLattice::NodeFault fault = plain.lattice.fault(layer, slot);
    ASSERT_EQ(known.state == NodeState::kJointLimit, fault.status == NodeStatus::kLimit);
    if (fault.status == NodeStatus::kLimit) {
      ASSERT_TRUE(fault.joints >> known.cause & 1);
    }
    return;
  }
  const std::int64_t asked = plain.quick.counters().fcl_calls;
  (void)plain.quick.find_violating_pair(*q, maps.lazy.problem.limits.clearance);
  ASSERT_EQ(known.proved, plain.quick.counters().fcl_calls == asked);  // it took no FCL
  plain.proved += known.proved;
  if (seen.state != NodeState::kNotLookedAt) {
    ASSERT_EQ(seen.proved, known.proved);
  }
  const auto pair = plain.query.find_violating_pair(*q, maps.lazy.problem.limits.clearance);
  ASSERT_EQ(known.state, pair ? NodeState::kBlocked : NodeState::kFree);
  if (pair) {
    const auto& names = plain.world.body_names();
    ASSERT_EQ(maps.full.map.blockers[known.cause],
              std::pair(names[static_cast<std::size_t>(pair->a)],
                        names[static_cast<std::size_t>(pair->b)]));
  }
}

/// Checks that the path is free, and that it is the eager plan's, or as long as the diagnosis says.
void check_path_of_maps(const ThreeMaps& maps, const SrsLattice& lattice) {
  const Drawn &lazy = maps.lazy, &eager = maps.eager;
  for (std::size_t i = 0; i < lazy.map.path.size(); ++i)
    EXPECT_EQ(lazy.map
                  .nodes[i * static_cast<std::size_t>(lattice.width()) +
                         static_cast<std::size_t>(lazy.map.path[i])]
                  .state,
              NodeState::kFree);
  if (lazy.result.status == PlanStatus::kSolved) {
    EXPECT_EQ(static_cast<int>(lazy.map.path.size()), lattice.layers());
    EXPECT_EQ(lazy.map.path, eager.map.path);
  } else {
    EXPECT_EQ(static_cast<int>(lazy.map.path.size()),
              diagnosis_of(lazy.result).reached_layer.value_or(-1) + 1);
  }
}

TEST_P(Maps, StateOfEveryNodeIsThatOfPlainQuestions) {
  const ThreeMaps maps{draw(GetParam(), PlannerKind::kLazy, false),
                       draw(GetParam(), PlannerKind::kLazy, true),
                       draw(GetParam(), PlannerKind::kEagerDp, false)};
  const auto& [lazy, full, eager] = maps;
  EXPECT_FALSE(lazy.map.complete);
  EXPECT_TRUE(full.map.complete);
  EXPECT_TRUE(eager.map.complete);

  const PreparedRobot robot(lazy.problem);
  const ToolPath path(waypoints_in_base(lazy.problem), lazy.problem.resolution, "test");
  const SrsLattice lattice(robot.arm().chain, robot.srs(), path, lazy.problem);
  const World world(robot.world(), lazy.problem.scene);
  PlainQuestions plain{lattice, world};
  ASSERT_EQ(lazy.map.nodes.size(), static_cast<std::size_t>(lattice.nodes()));
  std::size_t k = 0;
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int slot = 0; slot < lattice.width(); ++slot, ++k) {
      check_state_of_node(maps, plain, layer, slot, k);
      if (::testing::Test::HasFatalFailure()) return;
    }
  std::map<NodeState, int>& count = plain.count;
  std::printf(
      "%s: %zu nodes: %d not looked at, %d free, %d blocked, %d beyond a limit, %d singular, %d "
      "out of reach\n",
      GetParam(), k, count[NodeState::kNotLookedAt], count[NodeState::kFree],
      count[NodeState::kBlocked], count[NodeState::kJointLimit], count[NodeState::kSingular],
      count[NodeState::kNoIk]);
  EXPECT_GT(count[NodeState::kNotLookedAt], count[NodeState::kFree]);  // or the search was not lazy
  EXPECT_GT(count[NodeState::kJointLimit], 0);
  const int exist = static_cast<int>(
      std::count_if(full.map.nodes.begin(), full.map.nodes.end(),
                    [](const auto& node) { return node.state >= NodeState::kFree; }));
  std::printf("%d of %d nodes certified\n", plain.proved, exist);
  EXPECT_GT(plain.proved, exist / 2);
  check_path_of_maps(maps, lattice);
}

TEST_P(Maps, TextFitsTheTerminalAndTellsThePath) {
  const Drawn lazy = draw(GetParam(), PlannerKind::kLazy, false);
  for (const int columns : {40, 80, 200}) {
    const std::string plain = to_text(lazy.map, columns, false);
    std::istringstream lines(plain);
    int stars = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.find("stands for") == std::string::npos && line.find(" of ") == std::string::npos &&
          line.find(" by ") == std::string::npos && line.find("path") == std::string::npos &&
          line.find("looked") == std::string::npos && line.find("shoulder") == std::string::npos) {
        EXPECT_LE(static_cast<int>(line.size()), columns) << line;
      }
      stars += static_cast<int>(std::count(line.begin(), line.end(), '*'));
    }
    EXPECT_GE(stars, std::min(columns - 8, static_cast<int>(lazy.map.path.size())) / 2);
    EXPECT_EQ(plain.find('\x1b'), std::string::npos);
    // Colour changes nothing else.
    std::string coloured = to_text(lazy.map, columns, true), stripped;
    EXPECT_NE(coloured.find('\x1b'), std::string::npos);
    for (std::size_t k = 0; k < coloured.size(); ++k) {
      if (coloured[k] == '\x1b')
        k = coloured.find('m', k);
      else
        stripped += coloured[k];
    }
    EXPECT_EQ(stripped, plain);
  }
}

TEST_P(Maps, SvgIsWellFormedAndCoversEveryPanel) {
  const Drawn lazy = draw(GetParam(), PlannerKind::kLazy, false);
  const std::string svg = to_svg(lazy.map);
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(svg.c_str()), tinyxml2::XML_SUCCESS);
  int lines = 0;
  for (auto* line = document.RootElement()->FirstChildElement("polyline"); line;
       line = line->NextSiblingElement("polyline"))
    ++lines;
  EXPECT_EQ(lines > 0, lazy.map.path.size() > 1);
  for (const int label : lazy.map.inhabited_solutions())
    EXPECT_NE(svg.find(lazy.map.solution_name(label)), std::string::npos);
  EXPECT_LT(svg.size(), 2'000'000U);
}

/// What a colour stands for: a state, whether a free node is proved, the object that blocks.
using ColourGroup = std::tuple<NodeState, bool, int>;

/// Returns the groups of the cells in a map's panels.
std::set<ColourGroup> colour_groups(const LatticeMap& map) {
  std::set<ColourGroup> groups;
  for (const int solution : map.inhabited_solutions())
    for (int layer = 0; layer < map.layers; ++layer)
      for (int angle = 0; angle < map.angles; ++angle) {
        const LatticeMap::Node& node = map.at(layer, solution, angle);
        groups.insert({node.state, node.state == NodeState::kFree && node.proved,
                       node.state == NodeState::kBlocked ? map.blocking_object(node) : 0});
      }
  return groups;
}

/// Returns what follows `mark` in a text, up to `end`, each text once.
std::set<std::string> all_after(const std::string& text, const std::string& mark, char end) {
  std::set<std::string> found;
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
    const std::size_t from = at + mark.size();
    found.insert(text.substr(from, text.find(end, from) - from));
  }
  return found;
}

/// Each group has a colour of its own in drawing and terminal; limits alone are hatched.
TEST_P(Maps, ColoursTellApartWhatEndsPaths) {
  const Drawn lazy = draw(GetParam(), PlannerKind::kLazy, false);
  const LatticeMap& map = lazy.map;
  std::set<ColourGroup> groups = colour_groups(map);
  const bool has_limits = std::any_of(groups.begin(), groups.end(), [](const auto& group) {
    return std::get<NodeState>(group) == NodeState::kJointLimit;
  });
  groups.insert({NodeState::kNoIk, false, 0});  // the ground
  const std::string svg = to_svg(map);
  std::set<std::string> fills = all_after(svg, " fill=\"", '"');
  EXPECT_EQ(fills.erase("url(#hatch-1d5e8a)"), has_limits ? 1U : 0U);
  fills.erase("none");
  EXPECT_EQ(fills.erase("#000000"), map.path.empty() ? 0U : 1U);
  EXPECT_EQ(fills.size(), groups.size()) << svg.substr(0, 200);
  // A column a layer and a row an angle: every cell is shown.
  const std::string text = to_text(map, map.layers + 8, true);
  const std::set<std::string> grounds = all_after(text, "\x1b[48;5;", ';');
  EXPECT_LE(grounds.size(), groups.size());
  EXPECT_GE(grounds.size() + 2, groups.size());  // those that cells of a row of several hide
  std::printf("%zu colours\n", groups.size());
  EXPECT_GE(groups.size(), 3U);
}

TEST(Maps, RecordingChangesNothingOfThePlan) {
  const Drawn with = draw("experiment_c", PlannerKind::kLazy, false);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const PlanResult without = plan(with.problem, options);
  EXPECT_EQ(with.result.cost, without.cost);
  EXPECT_EQ(with.result.counters.nodes_checked, without.counters.nodes_checked);
  EXPECT_EQ(with.result.counters.expansions, without.counters.expansions);
  EXPECT_EQ(with.result.counters.ik_nodes, without.counters.ik_nodes);
}

}  // namespace
}  // namespace swivel
