// SPDX-License-Identifier: BSD-3-Clause
#include "refine/basins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "refine/basin_costs.hpp"
#include "refine/strided_solver.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// A path over the chosen layers, in one IK solution.
struct LatticeWay {
  int solution = 0;
  double cost = 0;
  std::vector<int> angle;  // number of the arm angle, by chosen layer
};

/// A local optimum over the chosen layers.
struct Basin {
  double cost = 0;
  std::vector<double> x;            // its coordinates, by chosen layer
  bool bounded = false;             // some coordinate is at an end of its interval
  std::vector<TrajectoryRow> rows;  // at all layers, their coordinates straight in between
};

/// Finds the basins of a lattice over every few layers of a path.
class BasinSearch {
 public:
  BasinSearch(const SrsLattice& lattice, const Redundancy& redundancy,
              const SmoothObjective& objective, double to_beat, const Budget& budget)
      : lattice_(lattice),
        redundancy_(redundancy),
        objective_(objective),
        to_beat_(to_beat),
        budget_(budget) {
    constexpr double kStep = 0.03, kMostTurn = 0.4;  // m, rad: of a step between chosen layers
    constexpr int kFewest = 8, kMost = 2000;         // steps
    const ToolPath& path = lattice.path();
    const int steps = path.size() - 1;
    const double travel = path.layer(steps).travel - path.layer(0).travel;
    stride_ = std::clamp(static_cast<int>(kStep * steps / travel + 0.5), 1 + steps / kMost,
                         std::max(1 + steps / kMost, steps / kFewest));
    for (int i = 0; i < steps; i += stride_) layer_.push_back(i);
    layer_.push_back(steps);
    const double turn = std::min(kMostTurn, lattice.limits().arm_slope * stride_ * travel / steps);
    window_ = std::clamp(static_cast<int>(turn * lattice.angles() / kTwoPi), 1,
                         std::max(1, lattice.angles() / 2 - 1));
    for (std::size_t k = 0; k < kDof; ++k)
      metric_.period[k] =
          lattice.continuous()[k] ? static_cast<float>(kTwoPi * objective.weights[k]) : 0;
    metric_.metric = lattice.cost().metric;
    objective_.most_change *= stride_;
    objective_.jumps.clear();  // no way changes its IK solution
    objective_.roll.clear();
  }

  /// Returns the basins that are cheap enough, the cheapest first.
  std::vector<Basin> find() {
    constexpr int kMostTried = 24;
    find_ways();
    std::stable_sort(ways_.begin(), ways_.end(),
                     [](const LatticeWay& a, const LatticeWay& b) { return a.cost < b.cost; });
    std::vector<Basin> basins;
    for (std::size_t k = 0; k < ways_.size() && k < kMostTried; ++k) {
      budget_.poll();
      auto rows = rows_of(ways_[k]);
      if (!rows) continue;
      const std::vector<CoordinateBox> boxes = boxes_about(ways_[k], *rows);
      Basin basin = mirrored(k, boxes).value_or(Basin{});
      if (basin.x.empty()) basin = optimum(*rows, boxes);
      optima_.push_back({k, basin});
      if (!(basin.cost < to_beat_) || !move_to(basin.x, *rows)) continue;
      basin.rows = std::move(*rows);
      if (std::none_of(basins.begin(), basins.end(),
                       [&](const Basin& other) { return same(basin, other); }))
        basins.push_back(std::move(basin));
    }
    std::stable_sort(basins.begin(), basins.end(),
                     [](const Basin& a, const Basin& b) { return a.cost < b.cost; });
    return basins;
  }

 private:
  // Paths of the lattice cost more than the smooth ones about them, by up to so much.
  static constexpr double kBias = 1.2;

  void find_ways() {
    const int layers = static_cast<int>(layer_.size());
    nodes_.resize(layer_.size());
    for (std::size_t k = 0; k < layer_.size(); ++k) {
      budget_.poll();
      lattice_.solve(layer_[k], nodes_[k]);
    }
    BasinCosts costs(layers, lattice_.angles(), window_);
    std::vector<BasinColumn> columns(layer_.size());
    for (int solution = 0; solution < lattice_.solutions(); ++solution) {
      if (!std::all_of(nodes_.begin(), nodes_.end(),
                       [&](const LayerNodes& layer) { return layer.alive(solution); }))
        continue;
      for (std::size_t k = 0; k < layer_.size(); ++k) fill(nodes_[k], solution, columns[k]);
      if (costs.compute(columns, metric_, budget_)) add_ways(solution, costs);
    }
  }
  void fill(const LayerNodes& nodes, int solution, BasinColumn& column) const {
    const int angles = lattice_.angles();
    const auto padded = static_cast<std::size_t>(angles + 2 * window_);
    column.mask.resize(padded);
    for (std::vector<float>& q : column.q) q.resize(padded);
    for (std::size_t i = 0; i < padded; ++i) {
      const int j = (static_cast<int>(i) - window_ + angles) % angles;
      const bool valid = nodes.valid(solution, j);
      column.mask[i] = valid ? 0 : std::numeric_limits<float>::infinity();
      for (std::size_t k = 0; k < kDof; ++k)  // what is no node may have no number
        column.q[k][i] = valid ? static_cast<float>(objective_.weights[k] *
                                                    nodes.q(solution, static_cast<int>(k))[j])
                               : 0;
    }
  }
  /// Adds the cheapest paths through local minima of five layers.
  void add_ways(int solution, const BasinCosts& costs) {
    constexpr double kApart = 0.2;  // rad
    const int layers = static_cast<int>(layer_.size()), angles = lattice_.angles(),
              apart = std::max(1, static_cast<int>(kApart * angles / kTwoPi));
    for (int part = 0; part <= 4; ++part) {
      const int k = part * (layers - 1) / 4;
      for (int j = 0; j < angles; ++j) {
        const float cost = costs.through(k, j);
        bool least = cost < kBias * to_beat_;
        for (int by = 1; by <= apart && least; ++by)
          least = cost < costs.through(k, costs.around(j - by)) &&
                  cost <= costs.through(k, costs.around(j + by));
        if (!least) continue;
        LatticeWay way{solution, cost, costs.trace(k, j)};
        if (std::none_of(ways_.begin(), ways_.end(), [&](const LatticeWay& other) {
              return other.solution == solution && near(way, other);
            }))
          ways_.push_back(std::move(way));
      }
    }
  }
  [[nodiscard]] bool near(const LatticeWay& a, const LatticeWay& b) const {
    constexpr double kNear = 0.15;  // rad
    const int angles = lattice_.angles();
    for (std::size_t k = 0; k < a.angle.size(); ++k) {
      const int by = std::abs(a.angle[k] - b.angle[k]);
      if (std::min(by, angles - by) > kNear * angles / kTwoPi) return false;
    }
    return true;
  }
  /// Returns whether two basins have the same optimum.
  static bool same(const Basin& a, const Basin& b) {
    constexpr double kSame = 0.02;  // rad
    if (a.rows[0].branch != b.rows[0].branch) return false;
    for (std::size_t i = 0; i < a.x.size(); ++i)
      if (std::abs(wrap_angle(a.x[i] - b.x[i])) > kSame) return false;
    return true;
  }
  /// Returns the optimum of a way that was tried and has the same arm angles and cost, since the
  /// branches of shoulder and wrist mirror each other; none if there is none, or if their limits
  /// matter.
  [[nodiscard]] std::optional<Basin> mirrored(std::size_t way,
                                              const std::vector<CoordinateBox>& boxes) const {
    constexpr double kSameCost = 1e-5;  // of the cost
    const auto fits = [&](const std::vector<double>& x) {
      for (std::size_t k = 0; k < x.size(); ++k)
        if (x[k] < boxes[k].low || x[k] > boxes[k].high) return false;
      return true;
    };
    for (const auto& [other, basin] : optima_)
      if (!basin.bounded && ways_[other].angle == ways_[way].angle &&
          ways_[way].cost - ways_[other].cost < kSameCost * ways_[way].cost && fits(basin.x))
        return basin;
    return std::nullopt;
  }
  /// Returns the arm angles about those of a way, by chosen layer, at which the lattice has nodes
  /// without a gap; as far as refinement moves a coordinate.
  [[nodiscard]] std::vector<CoordinateBox> boxes_about(
      const LatticeWay& way, const std::vector<TrajectoryRow>& rows) const {
    constexpr double kFarthest = 1;  // rad
    const int angles = lattice_.angles();
    const double step = kTwoPi / angles;
    std::vector<CoordinateBox> boxes;
    for (std::size_t k = 0; k < layer_.size(); ++k) {
      const double phi = rows[static_cast<std::size_t>(layer_[k])].phi;
      boxes.push_back({phi, phi});
      if (lattice_.is_given(layer_[k])) continue;
      const auto free = [&](int by) {
        return nodes_[k].valid(way.solution, ((way.angle[k] + by) % angles + angles) % angles);
      };
      int down = 0, up = 0;
      while (down * step < kFarthest && free(-down - 1)) ++down;
      while (up * step < kFarthest && free(up + 1)) ++up;
      boxes.back() = {phi - down * step, phi + up * step};
    }
    return boxes;
  }

  [[nodiscard]] int slot(const LatticeWay& way, std::size_t k) const {
    return way.solution * lattice_.angles() + way.angle[k];
  }
  /// Returns rows at all layers with the arm angles of a way, straight in between, but no joints.
  [[nodiscard]] std::vector<TrajectoryRow> angles_along(const LatticeWay& way) const {
    const ToolPath& path = lattice_.path();
    std::vector<TrajectoryRow> rows(static_cast<std::size_t>(path.size()));
    double phi = lattice_.phi(0, slot(way, 0));
    for (std::size_t k = 0; k + 1 < layer_.size(); ++k) {
      const double turn = wrap_angle(lattice_.phi(layer_[k + 1], slot(way, k + 1)) - phi),
                   begin = path.layer(layer_[k]).travel,
                   whole = path.layer(layer_[k + 1]).travel - begin;
      for (int i = layer_[k]; i <= layer_[k + 1]; ++i) {
        TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
        row.s = path.layer(i).s;
        row.phi = phi + turn * (path.layer(i).travel - begin) / whole;
        row.branch = lattice_.branch(0, slot(way, 0));
      }
      phi += turn;
    }
    return rows;
  }
  /// Returns the rows of a way at all layers; none if a layer has no joints there, or if it does
  /// not end in a given end.
  [[nodiscard]] std::optional<std::vector<TrajectoryRow>> rows_of(const LatticeWay& way) const {
    constexpr double kMet = 1e-6;  // rad
    std::vector<TrajectoryRow> rows = angles_along(way);
    const int last = lattice_.layers() - 1;
    const auto first = lattice_.exact_config(0, slot(way, 0));
    if (!first) return std::nullopt;
    for (TrajectoryRow& row : rows) row.q = *first;
    const auto solver = redundancy_.solver(rows);
    for (int i = 1; i <= last; ++i) {
      TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
      row.q = rows[static_cast<std::size_t>(i) - 1].q;
      const auto q = solver->joints(i, row.phi);
      if (!q) return std::nullopt;
      row.q = *q;
    }
    if (lattice_.is_given(last)) {
      const auto end = lattice_.exact_config(last, slot(way, layer_.size() - 1));
      if (!end) return std::nullopt;
      if (!lattice_.is_given(0)) turn_by(rows, *end - rows.back().q);
      if ((*end - rows.back().q).cwiseAbs().maxCoeff() > kMet) return std::nullopt;
      rows.back().q = *end;
    } else if (!lattice_.is_given(0)) {
      turn_by(rows, to_middle(rows));
    }
    return rows;
  }
  /// Turns the joints of all rows by the whole turns nearest to `by`, rad.
  static void turn_by(std::vector<TrajectoryRow>& rows, const Config& by) {
    for (TrajectoryRow& row : rows) row.q += kTwoPi * (by / kTwoPi).array().round().matrix();
  }
  /// Returns by how much the middles of what bounded circles move through are off the middles of
  /// their ranges, rad; 0 for other joints.
  [[nodiscard]] Config to_middle(const std::vector<TrajectoryRow>& rows) const {
    Config by = Config::Zero();
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = lattice_.chain().limit[static_cast<std::size_t>(j)];
      if (limit.continuous || !lattice_.continuous()[static_cast<std::size_t>(j)]) continue;
      double least = rows[0].q[j], most = least;
      for (const TrajectoryRow& row : rows)
        least = std::min(least, row.q[j]), most = std::max(most, row.q[j]);
      by[j] = (limit.lower + limit.upper - least - most) / 2;
    }
    return by;
  }
  /// Returns the optimum over the chosen layers near the rows, with an infinite cost where a layer
  /// has no joints.
  [[nodiscard]] Basin optimum(std::vector<TrajectoryRow>& rows,
                              const std::vector<CoordinateBox>& boxes) const {
    const auto solver = redundancy_.solver(rows);
    const StridedSolver few(*solver, stride_);
    Basin basin;
    for (const int layer : layer_) basin.x.push_back(rows[static_cast<std::size_t>(layer)].phi);
    basin.x = smooth_minimum(few, objective_, boxes, std::move(basin.x), budget_);
    std::optional<Config> before;
    for (int k = 0; k < few.layers(); ++k) {
      const double x = basin.x[static_cast<std::size_t>(k)];
      const CoordinateBox& box = boxes[static_cast<std::size_t>(k)];
      basin.bounded = basin.bounded || x == box.low || x == box.high;
      const auto q = few.joints(k, x);
      if (!q) {
        basin.cost = std::numeric_limits<double>::infinity();
        break;
      }
      if (before) basin.cost += lattice_.edge_cost(*q - *before);
      before = q;
    }
    return basin;
  }
  /// Moves rows to coordinates of the chosen layers, straight in between, but for given rows;
  /// returns false if a layer has no joints there.
  [[nodiscard]] bool move_to(const std::vector<double>& x, std::vector<TrajectoryRow>& rows) const {
    const auto solver = redundancy_.solver(rows);
    for (std::size_t k = 0; k + 1 < layer_.size(); ++k)
      for (int i = layer_[k]; i <= layer_[k + 1]; ++i) {
        TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
        if (lattice_.is_given(i)) continue;
        row.phi =
            i == layer_[k] ? x[k] : solver->between(i, layer_[k], x[k], layer_[k + 1], x[k + 1]);
        const auto q = solver->joints(i, row.phi);
        if (!q) return false;
        row.q = *q;
      }
    return true;
  }

  const SrsLattice& lattice_;
  const Redundancy& redundancy_;
  SmoothObjective objective_;  // over the chosen layers
  double to_beat_;
  const Budget& budget_;
  int stride_ = 1, window_ = 1;
  std::vector<int> layer_;         // the chosen layers
  std::vector<LayerNodes> nodes_;  // their nodes
  BasinMetric metric_;
  std::vector<LatticeWay> ways_;
  std::vector<std::pair<std::size_t, Basin>> optima_;  // of ways by their index, without rows
};

}  // namespace

std::vector<std::vector<TrajectoryRow>> basin_seeds(const SrsLattice& lattice,
                                                    const Redundancy& redundancy,
                                                    const SmoothObjective& objective,
                                                    double to_beat, const Budget& budget) {
  constexpr int kFewestLayers = 3, kMostSolutions = 64;
  const TraceSpan span("basins");
  std::vector<std::vector<TrajectoryRow>> seeds;
  if (lattice.layers() < kFewestLayers || lattice.solutions() > kMostSolutions) return seeds;
  for (Basin& basin : BasinSearch(lattice, redundancy, objective, to_beat, budget).find())
    seeds.push_back(std::move(basin.rows));
  return seeds;
}

}  // namespace swivel
