// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/motion/redundancy.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::bench {

/// A fine lattice about a refined path, with which the path is compared. It has the layers of the
/// path, and arm angles (or lengths along the self-motion) up to 0.5 rad from the path's, 0.0025
/// rad apart. Edges lead to the next layer, and straight over two and four, which gives directions
/// between those of the grid. The cheapest path found is valid by docs/model.md.
///
/// A dynamic program over all edges knows limits alone. Collisions and errors between layers are
/// then asked about its path only; what fails is removed, together with what fails beside it, and
/// the program runs again. The answer is the same as if all had been asked first.
class BasinLattice {
 public:
  struct Rules {
    /// Whether the coordinates of a layer are the path's own and multiples of the cell from there,
    /// so that the path is in the lattice; otherwise they are multiples of the cell.
    bool about_path = false;
    /// Whether nodes also keep what refinement keeps: RefineOptions::extra_clearance, what
    /// midpoints keep, and Refinement's margins.
    bool margins = false;
  };
  /// Builds the lattice about `rows`, the refined path. The other arguments must outlive it.
  BasinLattice(const PreparedRobot& robot, const PathProblem& problem, const Redundancy& redundancy,
               std::vector<TrajectoryRow> rows, const Rules& rules);

  struct Optimum {
    double cost = std::numeric_limits<double>::infinity();  ///< infinite if no path is left
    /// Whether the cost is that of a valid path; otherwise it is a bound below it, after too many
    /// rounds.
    bool valid = false;
    int rounds = 0;            ///< runs of the dynamic program
    double farthest = 0;       ///< rad, from the refined path
    double singular_sine = 1;  ///< least singular_sine() of the arm's redundancy on the path
  };
  [[nodiscard]] Optimum solve();

 private:
  static constexpr double kCell = 0.0025;  // rad
  static constexpr int kReach = 200;       // cells to both sides of the path
  static constexpr int kCells = 2 * kReach + 1;
  static constexpr int kParts =
      4;  // of a cell, at which edges over several layers cross those in between
  static constexpr int kPoints = kParts * 2 * kReach + 1;
  static constexpr std::array<int, 3> kStrides{1, 2, 4};
  static constexpr int kWindow =
      60;  // cells from a layer to the next: more than the lattice's own at its default slope

  enum class State : std::uint8_t { kUnknown, kGood, kBad };
  struct Point {
    State state = State::kBad;
    Config q = Config::Zero();
  };
  /// An edge from cell a of the layer that is kStrides[stride] before `layer` to its cell b.
  struct Edge {
    std::size_t stride = 0;
    int layer = 0, a = 0, b = 0;
  };
  struct From {
    std::size_t stride = 0;
    int cell = 0;
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  /// Returns the point of the j-th layer that an edge over `stride` layers meets.
  static int crossing(int a, int b, int j, int stride) {
    return kParts * a + kParts * (b - a) * j / stride;
  }
  static int width(std::size_t stride) { return kWindow * kStrides[stride]; }
  [[nodiscard]] double coordinate(int layer, int point) const {
    return first_[at(layer)] + kCell / kParts * point;
  }
  float& cost(const Edge& e) {
    return costs_[e.stride][at(e.layer)]
                 [at(e.b) * at(2 * width(e.stride) + 1) + at(e.a - e.b + width(e.stride))];
  }
  /// Calls each(edge) for the edges that end in a layer.
  template <class Each>
  void for_edges(std::size_t stride, int layer, const Each& each) const;

  [[nodiscard]] Point solved_point(int layer, int point) const;
  void price(std::size_t stride, int layer);
  void sweep(int first);
  /// Finds the cheapest path of the lattice as it is now: its points by layer, and its edges.
  void trace(std::vector<int>& points, std::vector<Edge>& edges) const;
  /// Asks whether a path is valid, and removes what fails. Returns the first layer at which
  /// something was removed; layers() if nothing was.
  int take_out(const std::vector<int>& points, const std::vector<Edge>& edges);
  bool node_good(int layer, int point);
  bool step_good(int layer, int a, int b);
  bool edge_good(const Edge& edge);
  void close(int layer);

  const PathProblem* problem_;
  const Redundancy* redundancy_;
  const Lattice* lattice_;
  std::vector<TrajectoryRow> rows_;
  std::unique_ptr<LayerSolver> solver_;
  Rules rules_;
  World world_;
  EdgeRule rule_;
  World::Query at_, between_;
  std::vector<double> first_;               // by layer: coordinate of point 0
  std::vector<std::vector<Point>> points_;  // by layer
  std::array<std::vector<std::vector<float>>, kStrides.size()> costs_;
  std::unordered_map<std::uint64_t, bool> steps_;  // asked
  std::vector<std::vector<double>> best_;          // by layer and cell
  std::vector<std::vector<From>> from_;
};

}  // namespace swivel::bench
