// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/refine/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "refine/basins.hpp"
#include "refine/strided_solver.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/motion/redundancy.hpp"
#include "swivel/core/motion/smooth_path.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

namespace {

constexpr double kFarthest = 1;   // rad, the most that a coordinate may move
constexpr int kMostNodes = 1000;  // tested to move rows of seeds clear

/// Returns a start for the minimum over all layers: the minimum over every few of them, straight in
/// between. Paths of fine lattices are jagged, and Newton's method would have to smooth one tooth
/// after the other.
std::vector<double> coarse_minimum(const LayerSolver& solver, const SmoothObjective& objective,
                                   const std::vector<CoordinateBox>& boxes, std::vector<double> x,
                                   const Budget& budget) {
  constexpr double kStep = 0.005;  // m
  const int n = solver.layers(),
            stride =
                static_cast<int>(kStep * (n - 1) / (solver.travel(n - 1) - solver.travel(0)) + 0.5);
  if (stride < 2) return x;
  const StridedSolver few(solver, stride);
  SmoothObjective coarse = objective;
  coarse.most_change *= stride;
  for (int& jump : coarse.jumps) jump = few.no_later(jump);
  coarse.roll.clear();
  if (!objective.roll.empty())
    for (int k = 0; k < few.layers(); ++k)
      coarse.roll.push_back(stride * objective.roll[static_cast<std::size_t>(few.layer(k))]);
  std::vector<double> start;
  std::vector<CoordinateBox> inside;
  for (int k = 0; k < few.layers(); ++k) {
    start.push_back(x[static_cast<std::size_t>(few.layer(k))]);
    inside.push_back(boxes[static_cast<std::size_t>(few.layer(k))]);
  }
  start = smooth_minimum(few, coarse, inside, std::move(start), budget);
  for (int k = 0; k + 1 < few.layers(); ++k) {
    const double from = start[static_cast<std::size_t>(k)],
                 to = start[static_cast<std::size_t>(k) + 1];
    for (int i = few.layer(k); i <= few.layer(k + 1); ++i) {
      const CoordinateBox& box = boxes[static_cast<std::size_t>(i)];
      const double between =
          i == few.layer(k) ? from : solver.between(i, few.layer(k), from, few.layer(k + 1), to);
      x[static_cast<std::size_t>(i)] = std::clamp(between, box.low, box.high);
    }
  }
  return x;
}

/// Validates nodes and edges off the grid by the rules of docs/model.md and the additional margins
/// of refinement.
class RefinementChecker {
 public:
  RefinementChecker(const PreparedRobot& robot, const PathProblem& problem,
                    const Redundancy& redundancy, const RefineOptions& options,
                    const Budget& budget)
      : problem_(&problem),
        redundancy_(&redundancy),
        lattice_(&redundancy.lattice()),
        extra_(options.extra_clearance),
        check_(options.check, budget),
        by_layer_(options.by_layer),
        margin_inside_(problem.refinement.joint_margin + kBetween),
        margin_sine_(std::sin(problem.refinement.singular_margin)),
        least_inside_(margin_inside_),
        least_sine_(margin_sine_),
        world_(robot.world(), problem, budget),
        rule_(world_.edge_rule(robot.radii())),
        at_(world_, DistanceProofs::kOn),
        between_(world_, DistanceProofs::kOn),
        budget_(budget) {}

  /// Returns true if the node is valid with the margins of refinement. `given` holds the joints of
  /// the given path, whose distances from limits and singularities need not be exceeded; null:
  /// those of lower_margins() are kept. `jumps`: the path passes through a singularity at this
  /// node, so that it should be near one.
  [[nodiscard]] bool node(int layer, const Config& q, const Config* given, bool jumps = false) {
    if (!valid(layer, q, given, jumps) ||
        at_.find_violating_pair_incremental(q, Threshold(ClearanceRule::kNode, extra_)))
      return false;
    // The motions from and to the node will have to keep this: failing here, the node's bisection
    // ends at the right place, whereas a failing motion only shrinks roughly.
    if (problem_->limits.edges == EdgeMode::kContinuous &&
        at_.find_violating_pair_incremental(q, ClearanceRule::kMidpoint))
      return false;
    return check_.states({&q, 1})[0] && (by_layer_ == nullptr || by_layer_->node(layer, q, extra_));
  }
  /// Returns true if the node is valid without the margins of refinement.
  [[nodiscard]] bool bare_node(int layer, const Config& q) {
    return valid(layer, q, &q, false) &&
           !at_.find_violating_pair_incremental(q, ClearanceRule::kNode) &&
           check_.states({&q, 1})[0] && (by_layer_ == nullptr || by_layer_->node(layer, q, 0));
  }

  [[nodiscard]] bool edge(int layer, const TrajectoryRow& a, const TrajectoryRow& b) {
    budget_.poll();
    ++edges_asked;
    const Limits& limits = lattice_->limits();
    const Config move = b.q - a.q;
    if (!lattice_->step_allowed(layer, move) ||
        std::abs(b.phi - a.phi) > redundancy_->most_change_on(layer))
      return false;
    const Chain& chain = lattice_->chain();
    const ToolPath& path = lattice_->path();
    if (!keeps_path_error(chain, path, layer, a.q, move, limits.tool_path_error) ||
        !keeps_angle_error(chain, path, layer, a.q, move, limits.tool_angle_error))
      return false;
    if (limits.step_error && !(redundancy_->step_error(layer, a, b) <= *limits.step_error))
      return false;
    if (limits.edges == EdgeMode::kContinuous && edge_blocked(between_, rule_, a.q, b.q, budget_))
      return false;
    if (by_layer_ != nullptr && !by_layer_->edge(layer, a.q, b.q)) return false;
    if (!check_.checks_motions()) return true;
    const StateCheck::Motion motion{a.q, b.q};
    return check_.motions({&motion, 1})[0];
  }

  /// Lowers what nodes without a given path keep from limits and singularities to the least that
  /// the rows of a path keep, where that is less than the margins of refinement.
  void lower_margins(const std::vector<TrajectoryRow>& rows) {
    for (const TrajectoryRow& row : rows) {
      least_sine_ = std::min(least_sine_, redundancy_->singular_sine(row.q) - kRounding);
      for (std::size_t j = 0; j < kDof; ++j)
        least_inside_ = std::min(least_inside_, distance_inside(row.q, j));
    }
    least_inside_ = std::max(least_inside_, 0.0);
  }

  /// Returns true if all joints are within their limits; rows of seeds that no node replaces may
  /// be beyond them.
  [[nodiscard]] bool within_limits(const std::vector<TrajectoryRow>& rows) const {
    return std::all_of(rows.begin(), rows.end(), [this](const TrajectoryRow& row) {
      for (std::size_t j = 0; j < kDof; ++j)
        if (distance_inside(row.q, j) < -kRounding) return false;
      return true;
    });
  }

  std::int64_t nodes_asked = 0, edges_asked = 0;

 private:
  static constexpr double kRounding = 1e-9;  // rad
  static constexpr double kBetween = 1e-3;   // rad, by which a path along a limit may exceed it

  /// Returns true if the node is valid, apart from collisions and the user's check.
  [[nodiscard]] bool valid(int layer, const Config& q, const Config* given, bool jumps) {
    budget_.poll();
    ++nodes_asked;
    if (lattice_->chain().roll && !lattice_->path().layer(layer).in_window(q[kDof - 1]))
      return false;
    if (!inside(q, given)) return false;
    const double sine =
        given == nullptr ? least_sine_
                         : std::min(margin_sine_, redundancy_->singular_sine(*given) - kRounding);
    if (!jumps && redundancy_->singular_sine(q) < sine) return false;
    return lattice_->manipulable(q);
  }
  /// Returns by how much a joint is inside its limits less limits.joint_margin, rad.
  [[nodiscard]] double distance_inside(const Config& q, std::size_t j) const {
    const JointLimit& limit = lattice_->chain().limit[j];
    if (limit.continuous) return std::numeric_limits<double>::infinity();
    const double x = q[static_cast<Eigen::Index>(j)];
    return std::min(x - limit.lower, limit.upper - x) - lattice_->limits().joint_margin;
  }
  [[nodiscard]] bool inside(const Config& q, const Config* given) const {
    for (std::size_t j = 0; j < kDof; ++j) {
      const double keep =
          given == nullptr ? least_inside_ : std::min(distance_inside(*given, j), margin_inside_);
      if (distance_inside(q, j) < keep - kRounding) return false;
    }
    return true;
  }

  const PathProblem* problem_;
  const Redundancy* redundancy_;
  const Lattice* lattice_;
  double extra_;
  AskedCheck check_;
  LayerCheck* by_layer_;
  double margin_inside_, margin_sine_;  // what refinement keeps: rad, no unit
  double least_inside_, least_sine_;    // the same without a given path
  World world_;
  EdgeRule rule_;
  World::Query at_, between_;
  Budget budget_;
};

/// Returns the p of the norm by which a metric's moves are smoothed.
int power_of(CostMetric metric) {
  // A power of 32 would take twice as long for 0.2 % less.
  constexpr int kNearLargest = 16;
  return metric == CostMetric::kL2 ? 2 : metric == CostMetric::kL1 ? 1 : kNearLargest;
}

double cost_of(const Lattice& lattice, const std::vector<TrajectoryRow>& rows) {
  double sum = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) sum += lattice.edge_cost(rows[i].q - rows[i - 1].q);
  if (lattice.roll_costs())
    for (std::size_t i = 0; i < rows.size(); ++i)
      sum += lattice.roll_cost(static_cast<int>(i), roll_of(lattice.chain(), rows[i]));
  return sum;
}

/// Returns the largest norm of the second divided difference of the joints over the travel,
/// rad/m^2.
double largest_bend(const ToolPath& path, const std::vector<TrajectoryRow>& rows) {
  double most = 0;
  for (int i = 1; i + 1 < path.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double h0 = path.layer(i).travel - path.layer(i - 1).travel,
                 h1 = path.layer(i + 1).travel - path.layer(i).travel;
    most = std::max(
        most, joint_norm(2 / (h0 + h1) *
                         ((rows[k + 1].q - rows[k].q) / h1 - (rows[k].q - rows[k - 1].q) / h0)));
  }
  return most;
}

/// Which rows of a path keep their joints, since the problem gives them.
struct FixedRows {
  bool first = false, last = false;
  explicit FixedRows(const PathProblem& problem)
      : first(problem.start.has_value()), last(problem.end.has_value()) {}
  /// Returns whether row i of n keeps its joints.
  [[nodiscard]] bool row(std::size_t i, std::size_t n) const {
    return (first && i == 0) || (last && i + 1 == n);
  }
  /// Narrows the intervals of such rows to where they are.
  void narrow(const std::vector<double>& x, std::vector<CoordinateBox>& boxes) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (row(i, x.size())) boxes[i] = {x[i], x[i]};
  }
};

/// Refines one given path, whose nodes are valid, at one weight of smoothness.
class PathRefiner {
 public:
  /// Whether the edges of the given path are known to be valid too.
  enum class Edges { kValid, kUnknown };
  PathRefiner(const Redundancy& redundancy, RefinementChecker& checker,
              const std::vector<TrajectoryRow>& given, Edges edges, const FixedRows& fixed,
              const Budget& budget)
      : checker_(&checker),
        given_(given),
        solver_(redundancy.solver(given_)),
        edges_(edges),
        fixed_(fixed),
        redundancy_(&redundancy),
        jumps_(given.size()),
        budget_(budget) {
    for (const int jump : redundancy.jumps(given))
      jumps_[static_cast<std::size_t>(jump)] = jumps_[static_cast<std::size_t>(jump) + 1] = true;
  }

  /// Returns refined rows that are valid; none if the rounds do not suffice, a layer has no
  /// solution, or an edge of the given path is invalid and its nodes cannot move.
  std::optional<std::vector<TrajectoryRow>> run(const SmoothObjective& objective, int& rounds) {
    constexpr int kRounds = 40;
    const std::size_t n = given_.size();
    std::vector<double> x(n);
    std::vector<CoordinateBox> boxes(n);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = given_[i].phi;
      const Redundancy::Range range = redundancy_->range(static_cast<int>(i));
      boxes[i] = {std::max(x[i] - kFarthest, std::min(x[i], range.low)),
                  std::min(x[i] + kFarthest, std::max(x[i], range.high))};
    }
    fixed_.narrow(x, boxes);
    std::vector<double> node_known(n, std::nan(""));
    std::vector<std::array<double, 2>> edge_known(n, {std::nan(""), std::nan("")});
    for (int round = 0; round < kRounds; ++round) {
      ++rounds;
      x = coarse_minimum(*solver_, objective, boxes, std::move(x), budget_);
      x = smooth_minimum(*solver_, objective, boxes, std::move(x), budget_);
      std::vector<TrajectoryRow> rows = rows_at(x);
      if (rows.empty()) return std::nullopt;
      bool fails = false;
      for (std::size_t i = 0; i < n; ++i) {
        if (x[i] == given_[i].phi || x[i] == node_known[i]) continue;
        if (!checker_->node(static_cast<int>(i), rows[i].q, &given_[i].q, jumps_[i])) {
          x[i] = shrink(i, x[i], boxes[i]);
          fails = true;
        }
        node_known[i] = x[i];
      }
      if (fails) continue;
      for (std::size_t i = 0; i + 1 < n; ++i) {
        const bool verbatim = x[i] == given_[i].phi && x[i + 1] == given_[i + 1].phi;
        if ((verbatim && edges_ == Edges::kValid) ||
            (edge_known[i][0] == x[i] && edge_known[i][1] == x[i + 1]))
          continue;
        if (checker_->edge(static_cast<int>(i), rows[i], rows[i + 1])) {
          edge_known[i] = {x[i], x[i + 1]};
          continue;
        }
        if (verbatim) return std::nullopt;
        give_way(i, x, boxes);
        fails = true;
      }
      if (fails) continue;
      redundancy_->label(rows);
      return rows;
    }
    return std::nullopt;
  }

 private:
  std::vector<TrajectoryRow> rows_at(const std::vector<double>& x) const {
    std::vector<TrajectoryRow> rows = given_;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (x[i] == given_[i].phi) continue;  // unchanged
      const auto q = solver_->joints(static_cast<int>(i), x[i]);
      if (!q) return {};
      rows[i].phi = x[i];
      rows[i].q = *q;
    }
    return rows;
  }

  /// Ends the interval of a layer, whose node at x fails, at the furthest coordinate that is found
  /// valid, and returns that.
  double shrink(std::size_t i, double x, CoordinateBox& box) {
    constexpr int kQueries = 10;
    double good = given_[i].phi, bad = x;
    for (int k = 0; k < kQueries; ++k) {
      const double middle = (good + bad) / 2;
      const auto q = solver_->joints(static_cast<int>(i), middle);
      (q && checker_->node(static_cast<int>(i), *q, &given_[i].q, jumps_[i]) ? good : bad) = middle;
    }
    (x > given_[i].phi ? box.high : box.low) = good;
    return good;
  }

  /// Ends the intervals of layers i and i + 1, between whose nodes at x the motion fails, where a
  /// motion is found valid. Both nodes keep the same share of their way from the given path.
  void give_way(std::size_t i, const std::vector<double>& x, std::vector<CoordinateBox>& boxes) {
    constexpr int kQueries = 4;
    constexpr double kLeast = 1e-5;  // rad
    std::array<TrajectoryRow, 2> rows{given_[i], given_[i + 1]};
    const auto at = [&](std::size_t k, double share) {
      return given_[k].phi + share * (x[k] - given_[k].phi);
    };
    double good = 0, bad = 1;
    for (int query = 0; query < kQueries; ++query) {
      const double middle = (good + bad) / 2;
      bool valid = true;
      for (const std::size_t k : {i, i + 1}) {
        const auto q = solver_->joints(static_cast<int>(k), rows[k - i].phi = at(k, middle));
        valid = valid && q;
        if (q) rows[k - i].q = *q;
      }
      (valid && checker_->edge(static_cast<int>(i), rows[0], rows[1]) ? good : bad) = middle;
    }
    for (const std::size_t k : {i, i + 1}) {
      const double given = given_[k].phi,
                   bound = std::abs(x[k] - given) < kLeast ? given : at(k, good);
      (x[k] > given ? boxes[k].high : boxes[k].low) = bound;
    }
  }

  RefinementChecker* checker_;
  std::vector<TrajectoryRow> given_;  // phi holds the coordinate
  std::unique_ptr<LayerSolver> solver_;
  Edges edges_;
  FixedRows fixed_;
  const Redundancy* redundancy_;
  std::vector<bool> jumps_;  // by layer: the path jumps to it or from it
  Budget budget_;
};

/// How far rows must keep from limits and singularities to stay where they are: as
/// RefinementChecker::lower_margins() says, or however far they are.
enum class RowMargins { kWhole, kOwn };

/// Moves rows to the nearest nodes that keep the margins of refinement, or are at least valid;
/// returns false if a row has neither nearby. Edges are not tested. `left`: how many nodes that
/// are not rows may be tested, since in a narrow passage no layer has a valid one.
bool move_clear(const LayerSolver& solver, RefinementChecker& checker, const FixedRows& fixed,
                RowMargins margins, int& left, std::vector<TrajectoryRow>& rows) {
  constexpr double kNearby = 0.1;  // rad
  constexpr int kSteps = 20;
  const auto clear = [&](int layer, const Config& q) {
    return checker.node(layer, q, margins == RowMargins::kWhole ? nullptr : &q);
  };
  const auto moved_clear = [&](int layer, TrajectoryRow& row) {
    for (int step = 1; step <= kSteps; ++step)
      for (const double by : {step * kNearby / kSteps, -step * kNearby / kSteps}) {
        if (left-- <= 0) return false;
        const auto q = solver.joints(layer, row.phi + by);
        if (!q || !clear(layer, *q)) continue;
        row.phi += by;
        row.q = *q;
        return true;
      }
    return false;
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int layer = static_cast<int>(i);
    if (!fixed.row(i, rows.size()) && (clear(layer, rows[i].q) || moved_clear(layer, rows[i])))
      continue;
    if (!checker.bare_node(layer, rows[i].q)) return false;
  }
  return true;
}

/// Returns the problem on a lattice that is up to four times as coarse along the path and finer in
/// its coordinate; none if it would be hardly coarser.
std::optional<PathProblem> coarser(const PathProblem& problem) {
  PathProblem coarse = problem;
  // Steps longer than 20 mm reach so many angles that the search takes longer than it is worth.
  constexpr double kMostTimes = 4, kLongest = 0.02, kAngle = 0.02;
  const double times = std::min(kMostTimes, kLongest / problem.resolution.ds);
  if (times < 2) return std::nullopt;
  coarse.resolution.ds *= times;
  coarse.resolution.dalpha *= times;  // so that travels are the same
  coarse.resolution.dphi = std::min(problem.resolution.dphi, kAngle);
  // The path is only a seed, and is validated on the problem's own layers: validating motions
  // between the coarse layers would take most of the time.
  coarse.limits.edges = EdgeMode::kNodes;
  coarse.limits.tool_path_error.reset();
  coarse.limits.tool_angle_error.reset();
  coarse.limits.step_error.reset();
  coarse.limits.joint_step *= times;
  return coarse;
}

/// Plans the coarse problem and returns its path with a row at each layer of the redundancy's
/// lattice; none if there is no such path.
std::optional<std::vector<TrajectoryRow>> rows_of_coarse_plan(const PreparedRobot& robot,
                                                              const PathProblem& coarse,
                                                              const Redundancy& redundancy,
                                                              const ToolPath& path,
                                                              const Budget& budget) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.check = false;                               // a start of the refinement, not an answer
  options.progress = [&budget](const Progress& now) {  // Stopped ends the plan as a time-out does
    budget.poll();
    // there is no path: why does not matter
    if (now.stage == Stage::kReach || now.stage == Stage::kDiagnosis) throw Stopped();
  };
  const PlanResult found = plan(robot, coarse, options);
  budget.poll();
  if (found.status != PlanStatus::kSolved) return std::nullopt;
  const auto motion =
      make_path_motion(robot.arm().chain, robot.arm_class(), path, found.trajectory);
  if (!motion->jumps().empty()) return std::nullopt;
  const Lattice& lattice = redundancy.lattice();
  const bool ends_given = coarse.end.has_value();
  std::vector<TrajectoryRow> rows;
  for (int i = 0; i < lattice.layers(); ++i) {
    TrajectoryRow row;
    row.s = lattice.path().layer(i).s;
    const double travel = lattice.path().layer(i).travel;
    const auto found_joints = [&](const TrajectoryRow& one) {
      return counted_from_path(robot.arm().chain, lattice.path(), travel, one).q;
    };
    const auto q = i == 0 ? found_joints(found.trajectory.front())
                   : ends_given && i + 1 == lattice.layers() ? found_joints(found.trajectory.back())
                                                             : motion->joints(travel);
    if (!q) return std::nullopt;
    row.q = *q;
    row.phi = redundancy.coordinate(i, *q);
    row.branch = found.trajectory[0].branch;
    rows.push_back(row);
  }
  return rows;
}

/// Returns the smoothest path near the rows, obstacles aside.
std::vector<TrajectoryRow> smoothed_without_obstacles(const LayerSolver& solver,
                                                      const SmoothObjective& objective,
                                                      const FixedRows& fixed,
                                                      const std::vector<TrajectoryRow>& rows,
                                                      const Budget& budget) {
  std::vector<double> x;
  std::vector<CoordinateBox> boxes;
  for (const TrajectoryRow& row : rows) {
    x.push_back(row.phi);
    boxes.push_back({row.phi - kFarthest, row.phi + kFarthest});
  }
  fixed.narrow(x, boxes);
  x = smooth_minimum(solver, objective, boxes, std::move(x), budget);
  std::vector<TrajectoryRow> best = rows;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto q =
        fixed.row(i, rows.size()) ? std::nullopt : solver.joints(static_cast<int>(i), x[i]);
    if (!q) continue;
    best[i].phi = x[i];
    best[i].q = *q;
  }
  return best;
}

/// Returns a path of a lattice that is up to four times as coarse along the path and finer in its
/// coordinate, with a row at each layer of the problem; its nodes are valid, its edges need not be.
/// None if there is no such path, if even its optimum without obstacles is not cheaper than
/// `to_beat`, or if a layer has no valid node nearby.
std::optional<std::vector<TrajectoryRow>> second_path(const PreparedRobot& robot,
                                                      const PathProblem& problem,
                                                      const Redundancy& redundancy,
                                                      RefinementChecker& checker,
                                                      const SmoothObjective& objective,
                                                      double to_beat, const Budget& budget) {
  const auto coarse = coarser(problem);
  if (!coarse) return std::nullopt;
  const ToolPath path = problem_path(*coarse, robot.arm().chain, budget);
  // Each waypoint is a layer: where waypoints are dense, the nodes are those of the first path,
  // unless the grid is finer.
  if (!redundancy.has_grid() && 4 * path.size() > 3 * redundancy.lattice().layers())
    return std::nullopt;
  auto rows = rows_of_coarse_plan(robot, *coarse, redundancy, path, budget);
  if (!rows) return std::nullopt;
  const auto solver = redundancy.solver(*rows);
  const FixedRows fixed(problem);
  if (cost_of(redundancy.lattice(),
              smoothed_without_obstacles(*solver, objective, fixed, *rows, budget)) >= to_beat)
    return std::nullopt;
  int left = kMostNodes;
  if (!move_clear(*solver, checker, fixed, RowMargins::kOwn, left, *rows)) return std::nullopt;
  return rows;
}

/// Returns paths of an S-R-S arm through other basins whose optima cost less than `to_beat`,
/// obstacles aside, the cheapest first: basin_seeds() on a grid of arm angles of its own. None for
/// other arms.
std::vector<std::vector<TrajectoryRow>> other_basins(const PreparedRobot& robot,
                                                     const PathProblem& problem,
                                                     const ToolPath& path, const Lattice& lattice,
                                                     const SmoothObjective& objective,
                                                     double to_beat, const Budget& budget) {
  constexpr double kAngle = 0.03;  // rad
  const auto* grid = dynamic_cast<const SrsLattice*>(&lattice);
  const Chain& chain = robot.arm().chain;
  // A grid at knots is that of arm angles alone where no roll is free.
  if (grid == nullptr && (chain.free_roll || dynamic_cast<const KnotGrid*>(&lattice) == nullptr))
    return {};
  PathProblem coarse = problem;
  coarse.resolution.dphi = kAngle;
  coarse.resolution.arcs = false;
  const auto angles =
      grid && grid->last_joint()
          ? make_coaxial_redundancy(chain, robot.srs(), path, coarse, *grid->last_joint(), budget)
          : make_redundancy(chain, robot.arm_class(), path, coarse, budget);
  return basin_seeds(dynamic_cast<const SrsLattice&>(angles->lattice()), *angles, objective,
                     to_beat, budget);
}

/// Refines one path after the other, and keeps the cheapest result.
class Improver {
 public:
  Improver(const Redundancy& redundancy, RefinementChecker& checker, const PathProblem& problem,
           const Budget& budget, Refined& result)
      : redundancy_(redundancy),
        checker_(checker),
        fixed_(problem),
        budget_(budget),
        bending_(cube(problem.refinement.smoothing)),
        result_(result) {
    const Lattice& lattice = redundancy.lattice();
    objective_.weights = lattice.cost_scale();
    objective_.most_change = 0.98 * redundancy.most_change();
    objective_.power = power_of(lattice.cost().metric);
    objective_.roll_is_coordinate = redundancy.is_roll();
    // otherwise the rolls stay as they are
    if (lattice.roll_costs() && (lattice.chain().roll || redundancy.is_roll()))
      for (int i = 0; i < lattice.layers(); ++i) objective_.roll.push_back(lattice.roll_weight(i));
  }
  /// Returns the objective for paths that jump nowhere.
  const SmoothObjective& objective() {
    objective_.bending = bending_;
    objective_.jumps.clear();
    return objective_;
  }
  /// Returns the cost below which the optimum of another seed is worth refining it.
  [[nodiscard]] double to_beat() const {
    constexpr double kWorthIt = 1 - 1e-4;
    return kWorthIt * result_.cost;
  }
  /// Refines a path. `second`: it is a seed, whose edges need not be valid.
  void improve(const std::vector<TrajectoryRow>& from, bool second) {
    const Lattice& lattice = redundancy_.lattice();
    PathRefiner refiner(redundancy_, checker_, from,
                        second ? PathRefiner::Edges::kUnknown : PathRefiner::Edges::kValid, fixed_,
                        budget_);
    objective_.bending = bending_;
    objective_.jumps = redundancy_.jumps(from);
    // Try less smoothness if smoothness alone makes the path dearer than the lattice's.
    const int attempts = result_.refined ? 1 : 3;
    for (int attempt = 0; attempt < attempts; ++attempt, objective_.bending /= 10) {
      auto refined = refiner.run(objective_, result_.rounds);
      if (!refined) continue;
      const double cost = cost_of(lattice, *refined);
      if (!(cost <= result_.cost) || (second && !checker_.within_limits(*refined))) continue;
      result_.rows = std::move(*refined);
      result_.cost = cost;
      result_.refined = true;
      result_.from_second_seed = second;
      result_.reason.clear();
      return;
    }
  }
  /// Refines seeds of basins, which come in the order of their optima, until one ends at its
  /// optimum or there is no cheaper one.
  void improve_from(std::vector<std::vector<TrajectoryRow>> seeds) {
    constexpr std::size_t kMostSeeds = 16;
    constexpr int kMostRuns = 4;
    constexpr double kReached = 1 + 1e-4;  // of the optimum
    int left = kMostNodes, runs = 0;
    if (seeds.size() > kMostSeeds) seeds.resize(kMostSeeds);
    for (std::vector<TrajectoryRow>& seed : seeds) {
      const auto solver = redundancy_.solver(seed);
      std::vector<TrajectoryRow> smooth =
          smoothed_without_obstacles(*solver, objective(), fixed_, seed, budget_);
      const double optimum = cost_of(redundancy_.lattice(), smooth);
      if (!(optimum < to_beat())) return;  // those after it cost as much
      for (std::vector<TrajectoryRow>* from : {&smooth, &seed}) {
        const auto own = redundancy_.solver(*from);
        if (!move_clear(*own, checker_, fixed_, RowMargins::kWhole, left, *from)) continue;
        improve(*from, true);
        if (++runs == kMostRuns || result_.cost <= kReached * optimum) return;
      }
    }
  }

 private:
  static double cube(double x) { return x * x * x; }

  const Redundancy& redundancy_;
  RefinementChecker& checker_;
  FixedRows fixed_;
  const Budget& budget_;
  double bending_;
  SmoothObjective objective_;
  Refined& result_;
};

/// Refines a path along one coordinate.
Refined refine_along(const Redundancy& redundancy, const PreparedRobot& robot,
                     const PathProblem& problem, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, const RefineOptions& options,
                     bool second_seed, const Budget& budget) {
  const Lattice& lattice = redundancy.lattice();
  RefinementChecker checker(robot, problem, redundancy, options, budget);
  Refined result;
  result.rows = rows;
  result.cost_before = result.cost = cost_of(lattice, rows);
  result.bend_before = result.bend = largest_bend(path, rows);
  result.reason = "no valid path was found that is not dearer";
  Improver improver(redundancy, checker, problem, budget, result);
  improver.improve(rows, false);
  if (second_seed) {
    if (const auto second = second_path(robot, problem, redundancy, checker, improver.objective(),
                                        improver.to_beat(), budget))
      improver.improve(*second, true);
  }
  if (second_seed && options.other_basins) {
    checker.lower_margins(rows);
    improver.improve_from(other_basins(robot, problem, path, lattice, improver.objective(),
                                       improver.to_beat(), budget));
  }
  result.bend = largest_bend(path, result.rows);
  result.nodes_asked = checker.nodes_asked;
  result.edges_asked = checker.edges_asked;
  return result;
}

/// Returns true if the tool turns no faster along the rows of a path than limits.roll_slope allows.
bool keeps_roll_slope(const ToolPath& path, const std::vector<TrajectoryRow>& rows,
                      const Limits& limits) {
  const std::vector<double> rolls = rolls_of(rows);
  for (std::size_t i = 0; i + 1 < rolls.size(); ++i) {
    const double way =
        path.layer(static_cast<int>(i) + 1).travel - path.layer(static_cast<int>(i)).travel;
    if (!(std::abs(rolls[i + 1] - rolls[i]) <= limits.roll_slope * way)) return false;
  }
  return true;
}

/// Refines a path along which joint 7 rests, and keeps it at rest. None if joint 7 does not rest,
/// or if the tool would then turn faster than it may.
std::optional<Refined> refine_coaxial(const PreparedRobot& robot, const PathProblem& problem,
                                      const ToolPath& path, const std::vector<TrajectoryRow>& rows,
                                      const RefineOptions& options, const Budget& budget) {
  constexpr double kRests = 1e-3;  // rad; rows of arms that are not exact are not quite at rest
  const auto rest = last_joint_at_rest(robot.arm().chain, robot.arm_class(), problem);
  if (!rest || std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
        return std::abs(row.q[kDof - 1] - *rest) > kRests;
      }))
    return std::nullopt;
  const auto angles =
      make_coaxial_redundancy(robot.arm().chain, robot.srs(), path, problem, *rest, budget);
  Refined refined =
      refine_along(*angles, robot, problem, path, rows, options, options.second_seed, budget);
  return keeps_roll_slope(path, refined.rows, problem.limits) ? std::optional(std::move(refined))
                                                              : std::nullopt;
}

/// Refines a path of an arm with two coordinates: along one, then the other, for as long as that is
/// worth it.
Refined refine_by_turns(const PreparedRobot& robot, const PathProblem& problem,
                        const ToolPath& path, const std::vector<TrajectoryRow>& rows,
                        const RefineOptions& options, const Budget& budget) {
  constexpr int kMostTurns = 4;
  constexpr double kWorthIt = 1 - 1e-3;
  const Chain& chain = robot.arm().chain;
  const auto rolls = make_roll_redundancy(chain, robot.srs(), path, problem, budget);
  Refined result;
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const double before = turn == 0 ? std::numeric_limits<double>::infinity() : result.cost;
    for (const bool roll : {false, true}) {
      const std::vector<TrajectoryRow>& from = turn == 0 && !roll ? rows : result.rows;
      const auto turned = path.with_rolls(rolls_of(from));
      const auto angles = make_redundancy(chain, robot.arm_class(), turned, problem, budget);
      Refined found = refine_along(roll ? *rolls : *angles, robot, problem, roll ? path : turned,
                                   from, options, false, budget);
      if (turn == 0 && !roll) {
        result = std::move(found);
        continue;
      }
      result.rounds += found.rounds;
      result.nodes_asked += found.nodes_asked;
      result.edges_asked += found.edges_asked;
      if (!found.refined) continue;
      result.refined = true;
      result.reason.clear();
      result.rows = std::move(found.rows);
      result.cost = found.cost;
      result.bend = found.bend;
    }
    if (!(result.cost < kWorthIt * before)) break;
  }
  return result;
}

/// Refines rows whose roll is counted from the frames of the path (counted_from_path()).
Refined refine_counted(const PreparedRobot& robot, const PathProblem& problem, const ToolPath& path,
                       const std::vector<TrajectoryRow>& rows, const RefineOptions& options,
                       const Budget& budget) {
  if (robot.arm().chain.free_roll && problem.rolls.empty()) {
    auto coaxial = refine_coaxial(robot, problem, path, rows, options, budget);
    return coaxial ? *std::move(coaxial)
                   : refine_by_turns(robot, problem, path, rows, options, budget);
  }
  const auto redundancy =
      make_redundancy(robot.arm().chain, robot.arm_class(), path, problem, budget);
  return refine_along(*redundancy, robot, problem, path, rows, options,
                      options.second_seed && problem.rolls.empty(), budget);
}

/// Refines a path whose given ends, if any, stay as they are.
Refined refine_between_ends(const PreparedRobot& robot, const PathProblem& problem,
                            const std::vector<TrajectoryRow>& rows, const RefineOptions& options,
                            const Budget& budget) {
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget);
  if (rows.size() != static_cast<std::size_t>(path.size()))
    throw InvalidArgument("refine: " + std::to_string(rows.size()) +
                          " rows: allowed are those of plan(), " + std::to_string(path.size()) +
                          ", one for each layer");
  std::vector<TrajectoryRow> counted = rows;
  count_from_path(chain, path, counted);
  Refined refined = refine_counted(robot, problem, path, counted, options, budget);
  count_from_waypoints(chain, path, refined.rows);
  refined.rows_before = rows;
  return refined;
}

}  // namespace

Refined refine(const PreparedRobot& robot, const PathProblem& problem,
               const std::vector<TrajectoryRow>& rows, const RefineOptions& options,
               const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  const bool closes = problem.closed && !problem.start, keeps_begin = closes || options.keeps_begin,
             keeps_end = closes || options.keeps_end;
  if (rows.empty() || !(keeps_begin || keeps_end))
    return refine_between_ends(robot, problem, rows, options, budget);
  PathProblem pinned = problem;
  if (keeps_begin) pinned.start = rows.front().q;
  if (keeps_end) pinned.end = rows.back().q;
  // The rows of arms that are not exact come back to other joints, by a little.
  pinned.closed = problem.closed && pinned.start == pinned.end;
  return refine_between_ends(robot, pinned, rows, options, budget);
}

}  // namespace swivel
