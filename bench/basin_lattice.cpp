// SPDX-License-Identifier: BSD-3-Clause
#include "basin_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "swivel/planner/refine/refine.hpp"

namespace swivel::bench {

namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

}  // namespace

template <class Each>
void BasinLattice::for_edges(std::size_t stride, int layer, const Each& each) const {
  const int w = width(stride);
  for (int b = 0; b < kCells; ++b)
    for (int a = std::max(0, b - w); a <= std::min(kCells - 1, b + w); ++a)
      each(Edge{stride, layer, a, b});
}

BasinLattice::BasinLattice(const PreparedRobot& robot, const PathProblem& problem,
                           const Redundancy& redundancy, std::vector<TrajectoryRow> rows,
                           const Rules& rules)
    : problem_(&problem),
      redundancy_(&redundancy),
      lattice_(&redundancy.lattice()),
      rows_(std::move(rows)),
      solver_(redundancy.solver(rows_)),
      rules_(rules),
      world_(robot.world(), problem),
      rule_(world_.edge_rule(robot.radii())),
      at_(world_, DistanceProofs::kOn),
      between_(world_, DistanceProofs::kOn) {
  const int n = lattice_->layers();
  points_.resize(at(n));
  for (int i = 0; i < n; ++i) {
    const double here = rows_[at(i)].phi;
    first_.push_back((rules.about_path ? here : kCell * std::round(here / kCell)) - kReach * kCell);
    for (int m = 0; m < kPoints; ++m) points_[at(i)].push_back(solved_point(i, m));
  }
  if (problem.start) {  // the start is the only node of its layer
    for (Point& point : points_[0]) point.state = State::kBad;
    points_[0][kParts * kReach] = {State::kUnknown, rows_[0].q};
  }
  for (std::size_t s = 0; s < kStrides.size(); ++s) {
    costs_[s].resize(at(n));
    for (int i = kStrides[s]; i < n; ++i) price(s, i);
  }
}

BasinLattice::Point BasinLattice::solved_point(int layer, int point) const {
  constexpr double kLimit = 1e-9, kBetween = 1e-3;  // rad; as planner/src/refine/refine.cpp
  Point p;
  const auto q = solver_->joints(layer, coordinate(layer, point));
  if (!q) return p;
  p.q = *q;
  const Config& given = rows_[at(layer)].q;
  const double margin = rules_.margins ? problem_->refinement.joint_margin + kBetween : 0;
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = lattice_->chain().limit[j];
    if (limit.continuous) continue;
    const auto room = [&](const Config& joints) {
      const double value = joints[static_cast<Eigen::Index>(j)];
      return std::min(value - limit.lower, limit.upper - value) - lattice_->limits().joint_margin;
    };
    if (room(*q) < std::min(margin, room(given)) - kLimit) return p;
  }
  const double sine = redundancy_->singular_sine(*q);
  if (rules_.margins && sine < std::min(std::sin(problem_->refinement.singular_margin),
                                        redundancy_->singular_sine(given) - 1e-9))
    return p;
  if (sine < 1e-6 || !lattice_->manipulable(*q)) return p;
  p.state = State::kUnknown;
  return p;
}

void BasinLattice::price(std::size_t stride, int layer) {
  const int over = kStrides[stride];
  costs_[stride][at(layer)].assign(at(kCells) * at(2 * width(stride) + 1), kNever);
  for_edges(stride, layer, [&](const Edge& e) {
    double sum = 0;
    for (int j = 0; j < over; ++j) {
      const int from = layer - over + j, a = crossing(e.a, e.b, j, over),
                b = crossing(e.a, e.b, j + 1, over);
      const Point &p = points_[at(from)][at(a)], &q = points_[at(from + 1)][at(b)];
      if (p.state == State::kBad || q.state == State::kBad ||
          std::abs(coordinate(from + 1, b) - coordinate(from, a)) > redundancy_->most_change())
        return;
      sum += lattice_->edge_cost(q.q - p.q);
    }
    cost(e) = static_cast<float>(sum);
  });
}

void BasinLattice::sweep(int first) {
  for (int i = first; i < lattice_->layers(); ++i)
    for (int b = 0; b < kCells; ++b) {
      double least = kNever;
      From from;
      for (std::size_t s = 0; s < kStrides.size() && kStrides[s] <= i; ++s) {
        const int low = std::max(0, b - width(s)), high = std::min(kCells - 1, b + width(s));
        const std::vector<double>& before = best_[at(i - kStrides[s])];
        const float* row = &cost({s, i, low, b});
        for (int a = low; a <= high; ++a) {
          const double sum = before[at(a)] + static_cast<double>(row[a - low]);
          if (sum < least) least = sum, from = {s, a};
        }
      }
      best_[at(i)][at(b)] = least;
      from_[at(i)][at(b)] = from;
    }
}

void BasinLattice::trace(std::vector<int>& points, std::vector<Edge>& edges) const {
  const int n = lattice_->layers();
  points.assign(at(n), 0);
  edges.clear();
  const std::vector<double>& last = best_[at(n - 1)];
  int cell = static_cast<int>(std::min_element(last.begin(), last.end()) - last.begin());
  for (int i = n - 1; i > 0;) {
    const From& from = from_[at(i)][at(cell)];
    const int over = kStrides[from.stride];
    for (int j = 0; j <= over; ++j) points[at(i - over + j)] = crossing(from.cell, cell, j, over);
    edges.push_back({from.stride, i, from.cell, cell});
    i -= over;
    cell = from.cell;
  }
}

bool BasinLattice::node_good(int layer, int point) {
  Point& p = points_[at(layer)][at(point)];
  if (p.state == State::kUnknown) {
    const bool too_near =
        at_.find_violating_pair_incremental(
            p.q, Threshold(ClearanceRule::kNode,
                           rules_.margins ? RefineOptions().extra_clearance : 0)) ||
        (rules_.margins && at_.find_violating_pair_incremental(p.q, ClearanceRule::kMidpoint));
    p.state = too_near ? State::kBad : State::kGood;
  }
  return p.state == State::kGood;
}

bool BasinLattice::step_good(int layer, int a, int b) {
  const std::uint64_t key = (at(layer) * kPoints + at(a)) * kPoints + at(b);
  if (const auto known = steps_.find(key); known != steps_.end()) return known->second;
  const Config &p = points_[at(layer)][at(a)].q, &q = points_[at(layer + 1)][at(b)].q, move = q - p;
  const Limits& limits = lattice_->limits();
  const Chain& chain = lattice_->chain();
  const ToolPath& path = lattice_->path();
  bool good = lattice_->step_allowed(layer, move) &&
              keeps_path_error(chain, path, layer, p, move, limits.tool_path_error) &&
              keeps_angle_error(chain, path, layer, p, move, limits.tool_angle_error);
  if (limits.edges == EdgeMode::kContinuous) good = good && !edge_blocked(between_, rule_, p, q);
  return steps_[key] = good;
}

bool BasinLattice::edge_good(const Edge& e) {
  const int over = kStrides[e.stride];
  for (int j = 0; j < over; ++j) {
    const int from = e.layer - over + j, a = crossing(e.a, e.b, j, over),
              b = crossing(e.a, e.b, j + 1, over);
    if (!node_good(from, a) || !node_good(from + 1, b) || !step_good(from, a, b)) return false;
  }
  return true;
}

void BasinLattice::close(int layer) {
  for (std::size_t s = 0; s < kStrides.size(); ++s) {
    const int over = kStrides[s];
    for (int j = 0; j <= over; ++j) {
      const int end = layer + over - j;
      if (end < over || end >= lattice_->layers()) continue;
      for_edges(s, end, [&](const Edge& e) {
        if (points_[at(layer)][at(crossing(e.a, e.b, j, over))].state == State::kBad)
          cost(e) = kNever;
      });
    }
  }
}

int BasinLattice::take_out(const std::vector<int>& points, const std::vector<Edge>& edges) {
  constexpr int kPointsBeside = 64, kEdgesBeside = 20;
  const int n = lattice_->layers();
  int first = n;
  for (int i = 0; i < n; ++i) {
    const int here = points[at(i)];
    if (node_good(i, here)) continue;
    for (const int by : {-1, 1})
      for (int m = here + by;
           m >= 0 && m < kPoints && std::abs(m - here) < kPointsBeside && !node_good(i, m);
           m += by) {
      }
    close(i);
    first = std::min(first, std::max(i, 1));
  }
  if (first < n) return first;
  for (const Edge& edge : edges) {
    if (edge_good(edge)) continue;
    cost(edge) = kNever;
    first = std::min(first, edge.layer);
    for (const int by : {-1, 1})
      for (int d = by; std::abs(d) < kEdgesBeside; d += by) {
        const Edge beside{edge.stride, edge.layer, edge.a + d, edge.b + d};
        if (std::min(beside.a, beside.b) < 0 || std::max(beside.a, beside.b) >= kCells ||
            edge_good(beside))
          break;
        cost(beside) = kNever;
      }
  }
  return first;
}

BasinLattice::Optimum BasinLattice::solve() {
  constexpr int kRounds = 3000;
  const int n = lattice_->layers();
  best_.assign(at(n), std::vector<double>(kCells, 0));
  from_.assign(at(n), std::vector<From>(kCells));
  Optimum found;
  std::vector<int> points;
  std::vector<Edge> edges;
  for (int first = 1; first < n && found.rounds < kRounds; ++found.rounds) {
    sweep(first);
    found.cost = *std::min_element(best_[at(n - 1)].begin(), best_[at(n - 1)].end());
    if (!(found.cost < kNever)) return found;
    trace(points, edges);
    first = take_out(points, edges);
    found.valid = first == n;
  }
  if (!found.valid) return found;
  found.cost = 0;
  for (int i = 0; i < n; ++i) {
    const int m = points[at(i)];
    const Config& q = points_[at(i)][at(m)].q;
    found.farthest = std::max(found.farthest, std::abs(coordinate(i, m) - rows_[at(i)].phi));
    found.singular_sine = std::min(found.singular_sine, redundancy_->singular_sine(q));
    if (i > 0) found.cost += lattice_->edge_cost(q - points_[at(i - 1)][at(points[at(i - 1)])].q);
  }
  return found;
}

}  // namespace swivel::bench
