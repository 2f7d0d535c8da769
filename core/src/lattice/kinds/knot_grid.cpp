// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/knot_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "kinematics/srs/exact_chain_turned.hpp"
#include "lattice/circle_turns.hpp"
#include "lattice/given_posture.hpp"
#include "lattice/knots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/memory.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

// in steps of dalpha: how far the path may turn from a knot to the next
constexpr double kMostTurning = 5;

/// Returns the planes of some layers for a tool that is turned: those of the tool that is not, each
/// under the smallest rotation.
std::vector<ArmPlane> planes_at(const SrsArm& arm, const std::vector<ArmPlane>& planes,
                                const std::vector<int>& layers, const ToolPath& turned) {
  std::vector<ArmPlane> found;
  found.reserve(layers.size());
  for (std::size_t k = 0; k < layers.size(); ++k)
    found.push_back(carry_plane(arm, planes[static_cast<std::size_t>(layers[k])],
                                turned.layer(static_cast<int>(k)).tool));
  return found;
}

/// Throws InputError where a lattice with so many nodes, and so many in a layer, needs more memory
/// than the machine has.
void require_memory(double nodes_of_layer, std::int64_t nodes, const std::string& source) {
  const double needed = 24.0 * static_cast<double>(nodes);
  if (nodes_of_layer > 1e9 || !fits_in_memory(needed))
    throw InputError(source, "resolution: " + std::to_string(nodes) +
                                 " nodes of roll and arm angle are more than this machine "
                                 "has memory for: allowed are larger droll, dphi or knot");
}

/// Returns by how many of `angles` cells of width dphi (rad) the arm angle may change on a step
/// that lets it change by `turn` (rad).
int cells_per_step(int angles, double turn, double dphi) {
  return static_cast<int>(std::min<double>(
      angles / 2, std::max<double>(std::min(1, angles / 2), std::floor(turn / dphi + 1e-9))));
}

}  // namespace

std::unique_ptr<KnotGrid> KnotGrid::make(const Chain& chain, const SrsArm& arm,
                                               const ToolPath& path, const PathProblem& problem,
                                               const Budget& budget,
                                               std::optional<double> last_joint, bool circles) {
  if (problem.limits.step_error)
    throw InputError(problem.source,
                     "limits.step_error: allowed without path.roll, or for arms of six joints");
  Joints wound;
  wound.fill(!circles);
  return std::unique_ptr<KnotGrid>(new KnotGrid(
      chain, arm, path, problem, budget, knots_along(path, problem.resolution), last_joint, wound));
}

KnotGrid::Knots KnotGrid::knots_along(const ToolPath& path, const Resolution& resolution) {
  Knots knots;
  knots.layers = swivel::knots_along(
      path, {resolution.knot.value_or(kKnotOfRolls), kMostTurning * resolution.dalpha});
  knots.path = std::make_unique<const ToolPath>(path.with_layers(knots.layers));
  return knots;
}

KnotGrid::KnotGrid(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                         const PathProblem& problem, const Budget& budget, Knots knots,
                         std::optional<double> last_joint, const Joints& wound)
    : Lattice(chain, *knots.path, problem, arm.fit_error),
      arm_(&arm),
      last_joint_(last_joint),
      whole_(&path),
      knots_(std::move(knots.layers)),
      knot_path_(std::move(knots.path)),
      planes_(carried_planes(arm, path, budget)),
      whole_step_bounds_(step_bounds_along(chain, path, problem.limits, problem.resolution)) {
  const TraceSpan span("rolls");
  const Resolution& resolution = problem.resolution;

  set_row_step_bounds(bounds_between_knots(knots_, whole_step_bounds_));
  circles_ = SrsLattice::possible_circles(chain, arm, problem,
                                          bounds_between_knots(knots_, whole_step_bounds_));
  for (std::size_t j = 0; j < kDof; ++j) {
    circles_[j] = circles_[j] && !wound[j] && !(last_joint_ && j + 1 == kDof);
    continuous_[j] = continuous_[j] || circles_[j];
  }
  if (circles_ != Joints{}) problem_ = problem;

  const Roll& range = *chain.free_roll;
  circle_ = range.circle();
  windows_of_roll_ = problem.waypoints.front().roll.has_value();
  double nominal = circle_ ? 0 : std::clamp(0.0, range.lower, range.upper);
  place_given(problem, budget);
  if (const Given* const first = start_ ? start_.get() : last_.get()) nominal = first->roll;
  if (last_joint_)
    value_of_ = rank_ = {0}, values_ = {0};
  else
    choose_rolls(nominal, resolution.droll);

  PathProblem of_nodes = problem;
  of_nodes.start.reset();
  of_nodes.end.reset();
  for (const int value : value_of_) {
    budget.poll();
    std::vector<double> rolls = rolls_along(value);
    ToolPath turned = knot_path_->with_rolls(rolls);
    std::vector<ArmPlane> planes = planes_at(arm, planes_, knots_, turned);
    turned_.push_back(std::make_unique<Turned>(std::move(rolls), std::move(turned), chain, arm,
                                               of_nodes, budget, std::move(planes), last_joint_,
                                               circles_));
  }
  width_ = at_roll(0).width();
  require_memory(static_cast<double>(rolls()) * width_, nodes(), problem.source);

  for (int k = 0; k + 1 < layers(); ++k) {
    Window& window = windows_.emplace_back();
    window.phi = cells_per_step(at_roll(0).angles(), limits_.arm_slope * way(k), resolution.dphi);
    widest_ = std::max(widest_, window.phi);
  }
  find_near(problem);
}

void KnotGrid::place_given(const PathProblem& problem, const Budget& budget) {
  const auto place = [&](PathEnd which, PathProblem only) {
    const double roll = roll_of_given(which, problem, *chain_, *whole_, *chain_->free_roll);
    ToolPath turned =
        knot_path_->with_rolls(std::vector<double>(static_cast<std::size_t>(layers()), roll));
    std::vector<ArmPlane> planes = planes_at(*arm_, planes_, knots_, turned);
    return std::make_unique<const Given>(roll, std::move(turned), *chain_, *arm_, only, budget,
                                         std::move(planes), circles_);
  };
  PathProblem only = problem;
  only.end.reset();
  if (problem.start) start_ = place(PathEnd::kFirst, only);
  only.end = end_;
  only.start.reset();
  if (end_) last_ = place(PathEnd::kLast, only);
}

/// Returns the travel from the knot at which a step starts to that at which it ends, m.
double KnotGrid::way(int step) const {
  return path_->layer(step + 1).travel - path_->layer(step).travel;
}

void KnotGrid::find_near(const PathProblem& problem) {
  const double droll = problem.resolution.droll;
  const int values = rolls(), most = circle_ ? (values - 1) / 2 : values - 1;
  bool turns = values == 1;
  std::vector<int> of_cells(static_cast<std::size_t>(most) + 1,
                            -1);  // which lists, where all layers have the same rolls
  for (int step = 0; step + 1 < layers(); ++step) {
    const double reach = limits_.roll_slope * way(step);
    const int cells = static_cast<int>(std::min<double>(most, std::floor(reach / droll + 1e-9)));
    turns = turns || cells > 0;
    // The end may stand turned as no other node does. A start stands turned as rank 0.
    const bool to_end = step + 2 == layers() && last_, alike = !windows_of_roll_ && !to_end;
    if (alike && of_cells[static_cast<std::size_t>(cells)] >= 0) {
      windows_[static_cast<std::size_t>(step)].near = of_cells[static_cast<std::size_t>(cells)];
      continue;
    }
    windows_[static_cast<std::size_t>(step)].near = static_cast<int>(near_.size());
    if (alike) of_cells[static_cast<std::size_t>(cells)] = static_cast<int>(near_.size());
    Near& lists = near_.emplace_back();
    lists.after.resize(static_cast<std::size_t>(values));
    lists.before.resize(static_cast<std::size_t>(values));
    const auto join = [&](int a, int b) {
      lists.after[static_cast<std::size_t>(a)].push_back(b);
      lists.before[static_cast<std::size_t>(b)].push_back(a);
    };
    for (int rank = 0; rank < values; ++rank)
      if (to_end) {
        if (may_end_from(rank)) join(rank, 0);
      } else if (alike) {
        for (int by = -cells; by <= cells; ++by) {
          const int value = value_of_[static_cast<std::size_t>(rank)] + by;
          if (circle_ || (value >= 0 && value < values))
            join(rank, rank_[static_cast<std::size_t>((value + values) % values)]);
        }
      } else {
        const double from = step == 0 && start_ ? start_->roll : roll_of_rank(step, rank);
        for (int other = 0; other < values; ++other)
          if (std::abs(roll_of_rank(step + 1, other) - from) <= reach + 1e-9) join(rank, other);
      }
    for (auto* all : {&lists.after, &lists.before})
      for (auto& list : *all) std::sort(list.begin(), list.end());
  }
  const double knot =
      std::max(problem.resolution.ds, problem.resolution.knot.value_or(kKnotOfRolls));
  if (!turns && !windows_of_roll_ && limits_.roll_slope * knot < droll) {
    const std::string text = formatted(
        "limits.roll_slope: is less than a step of resolution.droll from knot to knot: allowed is "
        "at least %.6g rad/m",
        droll / knot);
    throw InputError(problem.source, text);
  }
}

bool KnotGrid::may_end_from(int rank) const {
  const int step = layers() - 2;
  const double turn = last_->roll - (step == 0 && start_ ? start_->roll : roll_of_rank(step, rank));
  return std::abs(circle_ ? wrap_angle(turn) : turn) <= limits_.roll_slope * way(step) + 1e-9;
}

int KnotGrid::rank_beside(int layer) const {
  if (layer == 0 && start_) return 0;
  int nearest = 0;
  const auto away = [&](int rank) {
    const double turn = roll_of_rank(layer - 1, rank) - last_->roll;
    return std::abs(circle_ ? wrap_angle(turn) : turn);
  };
  for (int rank = 1; rank < rolls(); ++rank)
    if (away(rank) < away(nearest)) nearest = rank;
  return nearest;
}

std::vector<double> KnotGrid::rolls_along(int value) const {
  const double part = values_[static_cast<std::size_t>(value)];
  std::vector<double> rolls;
  for (int layer = 0; layer < layers(); ++layer) {
    const Roll& window = path_->layer(layer).window;
    rolls.push_back(windows_of_roll_ ? window.lower + part * (window.upper - window.lower) : part);
  }
  return rolls;
}

void KnotGrid::choose_rolls(double nominal, double droll) {
  const Roll& range = *chain_->free_roll;
  std::vector<double> away;  // from the nominal roll, in the mean, by value
  if (windows_of_roll_) {
    double widest = 0;
    for (int layer = 0; layer < layers(); ++layer)
      widest =
          std::max(widest, path_->layer(layer).window.upper - path_->layer(layer).window.lower);
    const int n = static_cast<int>(std::ceil(widest / droll - 1e-9));
    for (int k = 0; k <= n; ++k) values_.push_back(n > 0 ? static_cast<double>(k) / n : 0);
  } else if (circle_) {
    const int n = std::max(1, static_cast<int>(std::ceil(kTwoPi / droll - 1e-9)));
    for (int k = 0; k < n; ++k)
      values_.push_back(k == 0 ? nominal : wrap_angle(nominal + kTwoPi * k / n));
  } else {
    const auto below = static_cast<int>(std::floor((nominal - range.lower) / droll + 1e-9));
    const auto above = static_cast<int>(std::floor((range.upper - nominal) / droll + 1e-9));
    constexpr double kApart =
        1e-3;  // of a step: an end of the range that is no further from a cell is that cell
    if (nominal - below * droll - range.lower > kApart * droll) values_.push_back(range.lower);
    for (int k = -below; k <= above; ++k)
      values_.push_back(std::clamp(nominal + k * droll, range.lower, range.upper));
    if (range.upper - (nominal + above * droll) > kApart * droll) values_.push_back(range.upper);
  }
  value_of_.resize(values_.size());
  std::iota(value_of_.begin(), value_of_.end(), 0);
  for (const int value : value_of_) {
    double& sum = away.emplace_back(0);
    for (const double roll : rolls_along(value))
      sum += std::abs(circle_ ? wrap_angle(roll - nominal) : roll - nominal) / layers();
  }
  std::stable_sort(value_of_.begin(), value_of_.end(), [&](int a, int b) {
    return away[static_cast<std::size_t>(a)] < away[static_cast<std::size_t>(b)] - 1e-9;
  });
  rank_.resize(values_.size());
  for (std::size_t rank = 0; rank < value_of_.size(); ++rank)
    rank_[static_cast<std::size_t>(value_of_[rank])] = static_cast<int>(rank);
}

std::int64_t KnotGrid::nodes() const {
  return static_cast<std::int64_t>(layers() - 2) * rolls() * width_ + slots(0) +
         slots(layers() - 1);
}

void KnotGrid::layer_nodes(int layer, std::vector<Node>& out) const {
  out.clear();
  if (given(layer)) {
    if (const auto q = node(layer, 0)) out.push_back({0, *q});
    return;
  }
  std::vector<Node> nodes;
  for (int rank = 0; rank < rolls(); ++rank) {
    at_roll(rank).layer_nodes(layer, nodes);
    for (const Node& node : nodes) out.push_back({slot_of(rank, node.slot), node.q});
  }
}

std::optional<Lattice::Reach> KnotGrid::out_of_reach(int layer) const {
  if (const Given* const only = given(layer)) return only->lattice.out_of_reach(layer);
  std::optional<Reach> nearest;
  for (int rank = 0; rank < rolls(); ++rank) {
    const auto reach = at_roll(rank).out_of_reach(layer);
    if (!reach) return std::nullopt;
    if (!nearest ||
        std::abs(reach->distance - reach->limit) < std::abs(nearest->distance - nearest->limit))
      nearest = reach;
  }
  return nearest;
}

int KnotGrid::neighbour_in_redundancy(int layer, int slot, int by) const {
  if (given(layer)) return -1;
  return slot_of(slot / width_, at_roll(0).neighbour_in_redundancy(layer, slot % width_, by));
}

int KnotGrid::neighbour_in_roll(int layer, int slot, int by) const {
  if (given(layer)) return -1;
  const int values = rolls(), value = value_of_[static_cast<std::size_t>(slot / width_)] + by;
  if (!circle_ && (value < 0 || value >= values)) return -1;
  return slot_of(rank_[static_cast<std::size_t>((value + values) % values)], slot % width_);
}

int KnotGrid::neighbour_along_path(int layer, int slot, int by) const {
  if (layer + by < 0 || layer + by >= layers()) return -1;
  if (given(layer + by))
    return (by < 0 ? in_window(layer - 1, 0, slot) : in_window(layer, slot, 0)) ? 0 : -1;
  if (given(layer)) return slot_of(rank_beside(layer), inner(layer, 0));
  return slot;
}

void KnotGrid::slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                             std::vector<int>& out) const {
  if (is_approximate() || given(layer)) {
    out.assign(1, slot);
    return;
  }
  at_roll(slot / width_).slots_with_same_body_poses(layer, slot % width_, groups, out);
  for (int& other : out) other = slot_of(slot / width_, other);
}

PoseErrorBound KnotGrid::pose_error_of_node(int layer, int group, const Config& q) const {
  return is_approximate()
             ? PoseErrorBound::unknown(at_roll(0).pose_error_of_node(layer, group, q).about)
             : PoseErrorBound{};
}

PoseErrorBound KnotGrid::pose_error_between(int layer, int group, const Config& q) const {
  return pose_error_of_node(layer, group, q);
}

bool KnotGrid::in_window(int layer, int a, int b) const {
  const std::vector<int>& rolls = near(layer, rank_of(layer, a), true);
  return std::binary_search(rolls.begin(), rolls.end(), rank_of(layer + 1, b)) &&
         in_arm_window(layer, a, b);
}

std::optional<Lattice::RollStep> KnotGrid::roll_step(int layer, int a, const Config&, int b,
                                                        const Config&) const {
  const std::vector<int>& rolls = near(layer, rank_of(layer, a), true);
  const double change = roll(layer + 1, b) - roll(layer, a);
  return RollStep{std::abs(circle_ ? wrap_angle(change) : change), limits_.roll_slope * way(layer),
                  way(layer),
                  std::binary_search(rolls.begin(), rolls.end(), rank_of(layer + 1, b))};
}

bool KnotGrid::in_arm_window(int layer, int a, int b) const {
  if (branch(layer, a) != branch(layer + 1, b)) return false;
  const int angles = at_roll(0).angles(), window = phi_window(layer),
            to = at_roll(0).angle_of(inner(layer + 1, b));
  if (layer == 0 && start_) {
    const double cell = -kPi + kTwoPi * to / angles;
    return std::abs(wrap_angle(cell - phi(0, 0))) <= window * kTwoPi / angles + 1e-9;
  }
  const int apart = std::abs(at_roll(0).angle_of(a % width_) - to);
  return std::min(apart, angles - apart) <= window;
}

void KnotGrid::successors(int layer, int a, std::vector<SlotRun>& out) const {
  out.clear();
  if (given(layer + 1)) {
    if (in_window(layer, a, 0)) out.push_back({0, 1});
    return;
  }
  const int angles = at_roll(0).angles(), window = phi_window(layer),
            windings = at_roll(0).windings();
  int first = 0, count = std::min(2 * window + 1, angles);
  if (layer == 0 && start_) {
    const double step = kTwoPi / angles, from = (phi(0, 0) + kPi) / step;
    const auto low = static_cast<long long>(std::ceil(from - window - 1e-9 / step));
    const auto high = static_cast<long long>(std::floor(from + window + 1e-9 / step));
    first = static_cast<int>(((low % angles) + angles) % angles);
    count = static_cast<int>(std::min<long long>(high - low + 1, angles));
  } else {
    first = (at_roll(0).angle_of(a % width_) - window + angles) % angles;
  }
  const int solution = branch(layer, a) * windings, end = first + count;
  for (const int rank : near(layer, rank_of(layer, a), true))
    for (int winding = 0; winding < windings; ++winding) {
      const int zero = slot_of(rank, (solution + winding) * angles);
      if (end > angles) out.push_back({zero, zero + end - angles});
      out.push_back({zero + first, zero + std::min(end, angles)});
    }
}

std::optional<Config> KnotGrid::solve(int i, double roll, double phi, int branch,
                                         const Config& near, InterpolatedEdge& fault) const {
  const Pose tool = rolled(whole_->layer(i).tool, roll);
  const ArmPlane plane = carry_plane(*arm_, planes_[static_cast<std::size_t>(i)], tool);
  const ReachStatus reach = reach_status(*arm_, plane.reach);
  if (reach != ReachStatus::kReachable) {
    fault.fault = reach == ReachStatus::kSingular ? InterpolatedEdge::Fault::kSingular
                                                  : InterpolatedEdge::Fault::kNoIk;
    return std::nullopt;
  }
  Config q = srs_ik(*arm_, elbow_circles(*arm_, plane, tool), phi, branch);
  if (std::abs(std::sin(arm_->shoulder_angle(q))) < kSingularSine ||
      std::abs(std::sin(arm_->wrist_angle(q))) < kSingularSine) {
    fault.fault = InterpolatedEdge::Fault::kSingular;
    return std::nullopt;
  }
  for (int j = 0; j < kDof; ++j) q[j] = near[j] + wrap_angle(q[j] - near[j]);
  if (last_joint_) q[kDof - 1] = *last_joint_;
  if (!arm_->exact) {
    const auto row = last_joint_ ? solve_exact_chain_turned(*chain_, *arm_, plane, tool, phi, q)
                                 : solve_exact_chain(*chain_, *arm_, plane, tool, phi, q);
    if (!row) {
      fault.fault = InterpolatedEdge::Fault::kNoIk;
      return std::nullopt;
    }
    q = *row;
  }
  fault.q = q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain_->limit[static_cast<std::size_t>(j)];
    const double margin = limits_.joint_margin - kLimitTolerance;
    if (!continuous_[static_cast<std::size_t>(j)] &&
        !(q[j] >= limit.lower + margin && q[j] <= limit.upper - margin))
      fault.joints |= static_cast<std::uint8_t>(1u << j);
  }
  if (fault.joints) fault.fault = InterpolatedEdge::Fault::kLimit;
  if (fault.fault == InterpolatedEdge::Fault::kNone && !manipulable(q))
    fault.fault = InterpolatedEdge::Fault::kManipulability;
  return fault.fault == InterpolatedEdge::Fault::kNone ? std::optional(q) : std::nullopt;
}

double KnotGrid::roll_at(int i, const Config& q, double chosen) const {
  return last_joint_ ? roll_between(whole_->layer(i).tool, chain_->tool(q)) : chosen;
}

template <class Visit>
Lattice::InterpolatedEdge KnotGrid::walk(int layer, int a, const Config& qa, int b,
                                            const Config& qb, const Visit& visit) const {
  InterpolatedEdge interpolated;
  const int first = knots_[static_cast<std::size_t>(layer)],
            last = knots_[static_cast<std::size_t>(layer) + 1];
  const double roll = this->roll(layer, a), phi = this->phi(layer, a);
  const double roll_change = this->roll(layer + 1, b) - roll;
  const double dphi = wrap_angle(this->phi(layer + 1, b) - phi),
               droll = circle_ ? wrap_angle(roll_change) : roll_change;
  const int branch = this->branch(layer, a);
  const double begin = whole_->layer(first).travel, way = whole_->layer(last).travel - begin;
  // Where a window narrows between two knots the roll follows its end.
  const auto chosen = [&](int i, double t) {
    const Roll& window = whole_->layer(i).window;
    return std::clamp(roll + t * droll, window.lower, std::max(window.lower, window.upper));
  };
  Config from = qa;
  double from_roll = roll_at(first, qa, roll);
  for (int i = first; i < last; ++i) {
    const double t = (whole_->layer(i + 1).travel - begin) / way;
    std::optional<Config> to;
    if (i + 1 == last)
      to = from + delta(from, qb);
    else
      to = solve(i + 1, chosen(i + 1, t), phi + t * dphi, branch, from, interpolated);
    if (!to) return interpolated;
    interpolated.q = *to;
    const Config move = *to - from;
    const double to_roll = roll_at(i + 1, *to, i + 1 == last ? roll + droll : chosen(i + 1, t));
    const double travel = whole_->layer(i + 1).travel - whole_->layer(i).travel,
                 most_turn = limits_.roll_slope * travel;
    const double turned = std::abs(wrap_angle(to_roll - from_roll));
    const Config& bound =
        whole_step_bounds_[whole_step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(i)];
    if (!((move.cwiseAbs().array() <= bound.array()).all())) {
      interpolated.fault = InterpolatedEdge::Fault::kStep;
    } else if ((last_joint_ || windows_of_roll_) && !(turned <= most_turn + 1e-9)) {
      interpolated.fault = InterpolatedEdge::Fault::kRollSlope;
      interpolated.roll = {turned, most_turn, travel, false};
    } else if (!keeps_path_error(*chain_, *whole_, i, from, move, limits_.tool_path_error)) {
      interpolated.fault = InterpolatedEdge::Fault::kPathError;
    } else if (!keeps_angle_error(*chain_, *whole_, i, from, move, limits_.tool_angle_error)) {
      interpolated.fault = InterpolatedEdge::Fault::kAngleError;
    }
    if (interpolated.fault != InterpolatedEdge::Fault::kNone) return interpolated;
    if (i + 1 < last) {
      interpolated.rows.push_back(*to);
      visit(TrajectoryRow{whole_->layer(i + 1).s, wrap_angle(phi + t * dphi), branch, *to,
                          circle_ ? wrap_angle(to_roll) : to_roll});
    }
    from = *to;
    from_roll = to_roll;
  }
  return interpolated;
}

Lattice::InterpolatedEdge KnotGrid::interpolate_edge(int layer, int a, const Config& qa, int b,
                                                        const Config& qb) const {
  return walk(layer, a, qa, b, qb, [](const TrajectoryRow&) {});
}

LatticeInfo KnotGrid::describe() const {
  LatticeInfo info = Lattice::describe();
  const SrsLattice& one = at_roll(0);
  info.grid =
      LatticeInfo::Grid{one.angles(), kBranches, one.windings(), widest_phi_window(), rolls()};
  return info;
}

std::vector<TrajectoryRow> KnotGrid::followed(const std::vector<int>& slots) const {
  std::vector<TrajectoryRow> rows;
  for (int k = 0; k < static_cast<int>(slots.size()); ++k) {
    const int slot = slots[static_cast<std::size_t>(k)];
    Config q = *exact_config(k, slot);
    if (k > 0) {
      const Config before = rows.back().q;  // of the knot before
      static_cast<void>(walk(k - 1, slots[static_cast<std::size_t>(k) - 1], before, slot, q,
                             [&](const TrajectoryRow& row) { rows.push_back(row); }));
      q = rows.back().q + delta(rows.back().q, q);
    }
    rows.push_back({path_->layer(k).s, phi(k, slot), branch(k, slot), q,
                    roll_at(knots_[static_cast<std::size_t>(k)], q, roll(k, slot))});
  }
  if (static_cast<int>(slots.size()) < layers()) return rows;
  std::vector<Config> joints;
  for (const TrajectoryRow& row : rows) joints.push_back(row.q);
  turn_to_end(joints);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].q = joints[k];
  return rows;
}

CircleTurns KnotGrid::turns_along(const std::vector<TrajectoryRow>& rows,
                                     std::size_t slots) const {
  std::vector<Config> joints;
  for (const TrajectoryRow& row : rows) joints.push_back(row.q);
  const bool ends = end_ && static_cast<int>(slots) == layers();
  return circle_turns(*this, circles_, joints, starts_given_, ends ? &*end_ : nullptr);
}

std::vector<TrajectoryRow> KnotGrid::path_rows(const std::vector<int>& slots) const {
  std::vector<TrajectoryRow> rows = followed(slots);
  count_from_waypoints(*chain_, *whole_, rows);
  if (circles_ == Joints{}) return rows;
  const CircleTurns turns = turns_along(rows, slots.size());
  if (!turns.fit()) return {};
  for (TrajectoryRow& row : rows) row.q += turns.turn;
  return rows;
}

Lattice::Joints KnotGrid::off_limits(const std::vector<int>& slots) const {
  if (circles_ == Joints{}) return {};
  return turns_along(followed(slots), slots.size()).furthest_over();
}

std::unique_ptr<Lattice> KnotGrid::with_windings(const Joints& joints) const {
  if (!problem_) return nullptr;
  Joints wound{};
  std::vector<Joints> told_apart = told_apart_;
  told_apart.push_back(joints);
  for (const Joints& told : told_apart)
    for (std::size_t j = 0; j < kDof; ++j) wound[j] = wound[j] || told[j];
  std::unique_ptr<KnotGrid> lattice(new KnotGrid(*chain_, *arm_, *whole_, *problem_, {},
                                                       knots_along(*whole_, problem_->resolution),
                                                       last_joint_, wound));
  lattice->told_apart_ = std::move(told_apart);
  lattice->take_clearances(limits_);
  return lattice;
}

}  // namespace swivel
