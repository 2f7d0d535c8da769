// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/knot_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "kinematics/newton/pose_newton.hpp"
#include "lattice/given_posture.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/memory.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Returns the planes of some layers: `planes`, and for a path whose tool is turned each under the
/// smallest rotation that takes the tool that is not there.
std::vector<ArmPlane> planes_at(const SrsArm& arm, const std::vector<ArmPlane>& planes,
                                const std::vector<int>& layers, const ToolPath& turned) {
  std::vector<ArmPlane> found;
  found.reserve(layers.size());
  for (std::size_t k = 0; k < layers.size(); ++k)
    found.push_back(turned.unturned()
                        ? carry_plane(arm, planes[static_cast<std::size_t>(layers[k])],
                                      turned.layer(static_cast<int>(k)).tool)
                        : planes[static_cast<std::size_t>(layers[k])]);
  return found;
}

/// Throws InputError where a lattice with so many nodes, and so many in a layer, needs more memory
/// than the machine has.
void require_memory(double nodes_of_layer, std::int64_t nodes, const PathProblem& problem) {
  const double needed = 24.0 * static_cast<double>(nodes);
  const char* const what = problem.roll ? "roll and arm angle" : "arm angle";
  const char* const larger = problem.roll ? "droll, dphi or knot" : "dphi or knot";
  if (nodes_of_layer > 1e9 || !fits_in_memory(needed))
    throw InputError(problem.source, "resolution: " + std::to_string(nodes) + " nodes of " + what +
                                         " are more than this machine has memory for: allowed are "
                                         "larger " +
                                         larger);
}

/// Returns the squares of the weights by which Newton steps between knots are least: those of the
/// metric over the largest, a hundredth at least.
Config squared_weights(const std::array<double, kDof>& cost_scale) {
  constexpr double kLeastWeight = 1e-2;
  const double largest = *std::max_element(cost_scale.begin(), cost_scale.end());
  Config squares;
  for (std::size_t j = 0; j < kDof; ++j) {
    const double weight = largest > 0 ? std::max(kLeastWeight, cost_scale[j] / largest) : 1;
    squares[static_cast<Eigen::Index>(j)] = weight * weight;
  }
  return squares;
}

}  // namespace

KnotGrid::~KnotGrid() = default;

std::unique_ptr<KnotGrid> KnotGrid::make(const Chain& chain, const SrsArm& arm,
                                         const ToolPath& path, const PathProblem& problem,
                                         const Budget& budget, std::optional<double> last_joint,
                                         bool circles) {
  if (problem.limits.step_error)
    throw InputError(problem.source,
                     "limits.step_error: allowed without path.roll, or for arms of six joints");
  Layout layout{Knots(path, knots_along(path, problem.resolution.knot_of_grids())), last_joint};
  layout.wound.fill(!circles);
  return std::unique_ptr<KnotGrid>(new KnotGrid(chain, arm, problem, budget, std::move(layout)));
}

KnotGrid::KnotGrid(const Chain& chain, const SrsArm& arm, const PathProblem& problem,
                   const Budget& budget, Layout layout)
    : Lattice(chain, layout.knots, problem, arm.fit_error),
      arm_(&arm),
      layout_(std::move(layout)),
      problem_(problem),
      planes_(carried_planes(arm, path_of_rows(), budget)),
      newton_(std::make_unique<const PoseNewton>(chain)),
      scale2_(squared_weights(cost_scale())) {
  const TraceSpan span("knots");
  lay_out_circles();
  circle_ = chain.free_roll && chain.free_roll->circle();
  windows_of_roll_ = chain.free_roll && problem.waypoints.front().roll.has_value();
  place_given(problem, budget);
  if (layout_.rolls.values.empty()) choose_rolls(problem.resolution.droll);

  PathProblem of_nodes = problem;
  of_nodes.start.reset();
  of_nodes.end.reset();
  for (const int value : layout_.rolls.value_of) {
    budget.poll();
    std::vector<double> rolls = rolls_along(value);
    ToolPath turned = at_rolls(rolls);
    std::vector<ArmPlane> planes = planes_at(arm, planes_, knots().layers(), turned);
    turned_.push_back(std::make_unique<Turned>(std::move(rolls), std::move(turned), chain, arm,
                                               of_nodes, budget, std::move(planes), last_joint(),
                                               circles_));
  }
  width_ = at_roll(0).width();
  require_memory(static_cast<double>(rolls()) * width_, nodes(), problem);

  // As far as the steps between allow together, so that more knots allow no more.
  const SrsLattice& one = at_roll(0);
  for (int k = 0; k + 1 < layers(); ++k) {
    Window& window = windows_.emplace_back();
    window.phi = static_cast<int>(std::min<std::int64_t>(
        one.angles() / 2, std::int64_t{one.window()} * (layer_of_rows(k + 1) - layer_of_rows(k))));
    widest_ = std::max(widest_, window.phi);
  }
  find_near(problem);
}

void KnotGrid::lay_out_circles() {
  constexpr double kLess = 1e-6;  // rad
  Joints circles = SrsLattice::possible_circles(*chain_, *arm_, problem_, {});
  std::vector<Config> bounds;
  for (int step = 0; step + 1 < layers(); ++step) {
    Config& bound = bounds.emplace_back(row_step_bound(step));
    for (int j = 0; j < kDof; ++j)
      if (circles[static_cast<std::size_t>(j)])
        bound[j] = std::min(bound[j], kPi - 2 * arm_->fit_error[j] - kLess);
  }
  set_row_step_bounds(std::move(bounds));
  for (std::size_t j = 0; j < kDof; ++j) {
    circles[j] = circles[j] && !layout_.wound[j] && !(last_joint() && j + 1 == kDof);
    layout_.wound[j] = !circles[j];
  }
  treat_as_circles(circles);
}

ToolPath KnotGrid::at_rolls(const std::vector<double>& rolls) const {
  return chain_->free_roll ? path_->with_rolls(rolls) : *path_;
}

void KnotGrid::place_given(const PathProblem& problem, const Budget& budget) {
  const auto place = [&](PathEnd which, PathProblem only) {
    const double roll = chain_->free_roll ? roll_of_given(which, problem, *chain_, path_of_rows(),
                                                          *chain_->free_roll)
                                          : 0;
    ToolPath turned = at_rolls(std::vector<double>(static_cast<std::size_t>(layers()), roll));
    std::vector<ArmPlane> planes = planes_at(*arm_, planes_, knots().layers(), turned);
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
          const int value = layout_.rolls.value_of[static_cast<std::size_t>(rank)] + by;
          if (circle_ || (value >= 0 && value < values))
            join(rank, layout_.rolls.rank[static_cast<std::size_t>((value + values) % values)]);
        }
      } else {
        const double from = step == 0 && start_ ? start_->roll : roll_of_rank(step, rank);
        for (int other = 0; other < values; ++other)
          if (std::abs(roll_of_rank(step + 1, other) - from) <= reach + 1e-9) join(rank, other);
      }
    for (auto* all : {&lists.after, &lists.before})
      for (auto& list : *all) std::sort(list.begin(), list.end());
  }
  const double knot = std::max(problem.resolution.ds, problem.resolution.knot_of_grids());
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
  const double part = layout_.rolls.values[static_cast<std::size_t>(value)];
  std::vector<double> rolls;
  for (int layer = 0; layer < layers(); ++layer) {
    const Roll& window = path_->layer(layer).window;
    rolls.push_back(windows_of_roll_ ? window.lower + part * (window.upper - window.lower) : part);
  }
  return rolls;
}

void KnotGrid::choose_rolls(double droll) {
  auto& [values, rank, value_of] = layout_.rolls;
  if (last_joint() || !chain_->free_roll) {
    values = {0};
    rank = value_of = {0};
    return;
  }
  const Roll& range = *chain_->free_roll;
  const Given* const first = start_ ? start_.get() : last_.get();
  const double nominal = first     ? first->roll
                         : circle_ ? 0
                                   : std::clamp(0.0, range.lower, range.upper);
  if (windows_of_roll_) {
    double widest = 0;
    for (int layer = 0; layer < layers(); ++layer)
      widest =
          std::max(widest, path_->layer(layer).window.upper - path_->layer(layer).window.lower);
    const int n = static_cast<int>(std::ceil(widest / droll - 1e-9));
    for (int k = 0; k <= n; ++k) values.push_back(n > 0 ? static_cast<double>(k) / n : 0);
  } else if (circle_) {
    const int n = std::max(1, static_cast<int>(std::ceil(kTwoPi / droll - 1e-9)));
    for (int k = 0; k < n; ++k)
      values.push_back(k == 0 ? nominal : wrap_angle(nominal + kTwoPi * k / n));
  } else {
    const auto below = static_cast<int>(std::floor((nominal - range.lower) / droll + 1e-9));
    const auto above = static_cast<int>(std::floor((range.upper - nominal) / droll + 1e-9));
    constexpr double kApart =
        1e-3;  // of a step: an end of the range that is no further from a cell is that cell
    if (nominal - below * droll - range.lower > kApart * droll) values.push_back(range.lower);
    for (int k = -below; k <= above; ++k)
      values.push_back(std::clamp(nominal + k * droll, range.lower, range.upper));
    if (range.upper - (nominal + above * droll) > kApart * droll) values.push_back(range.upper);
  }
  value_of.resize(values.size());
  std::iota(value_of.begin(), value_of.end(), 0);
  std::vector<double> away;  // from the nominal roll, in the mean, by value
  for (const int value : value_of) {
    double& sum = away.emplace_back(0);
    for (const double roll : rolls_along(value))
      sum += std::abs(circle_ ? wrap_angle(roll - nominal) : roll - nominal) / layers();
  }
  std::stable_sort(value_of.begin(), value_of.end(), [&](int a, int b) {
    return away[static_cast<std::size_t>(a)] < away[static_cast<std::size_t>(b)] - 1e-9;
  });
  rank.resize(values.size());
  for (std::size_t k = 0; k < value_of.size(); ++k)
    rank[static_cast<std::size_t>(value_of[k])] = static_cast<int>(k);
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

bool KnotGrid::proved_unreachable(int layer) const {
  return !chain_->free_roll && !given(layer) && at_roll(0).proved_unreachable(layer);
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
  const int values = rolls(),
            value = layout_.rolls.value_of[static_cast<std::size_t>(slot / width_)] + by;
  if (!circle_ && (value < 0 || value >= values)) return -1;
  return slot_of(layout_.rolls.rank[static_cast<std::size_t>((value + values) % values)],
                 slot % width_);
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
  if (!chain_->free_roll) return std::nullopt;
  const std::vector<int>& rolls = near(layer, rank_of(layer, a), true);
  const double change = roll(layer + 1, b) - roll(layer, a);
  return RollStep{std::abs(circle_ ? wrap_angle(change) : change), limits_.roll_slope * way(layer),
                  way(layer),
                  std::binary_search(rolls.begin(), rolls.end(), rank_of(layer + 1, b))};
}

bool KnotGrid::in_arm_window(int layer, int a, int b) const {
  const int flip = branch(layer, a) ^ branch(layer + 1, b);
  if (flip != 0 && std::find(kFlips.begin(), kFlips.end(), flip) == kFlips.end()) return false;
  const int angles = at_roll(0).angles(), window = phi_window(layer),
            to = at_roll(0).angle_of(inner(layer + 1, b));
  if (layer == 0 && start_) {
    const double cell = -kPi + kTwoPi * to / angles;
    if (!(std::abs(wrap_angle(cell - phi(0, 0))) <= window * kTwoPi / angles + 1e-9)) return false;
  } else {
    const int apart = std::abs(at_roll(0).angle_of(a % width_) - to);
    if (std::min(apart, angles - apart) > window) return false;
  }
  if (flip == 0) return true;
  const auto from = node(layer, a), onto = node(layer + 1, b);
  return from && onto && may_flip(flip, *from) && may_flip(flip, *onto);
}

void KnotGrid::successors(int layer, int a, std::vector<SlotRun>& out) const {
  out.clear();
  if (given(layer + 1)) {
    if (in_window(layer, a, 0)) out.push_back({0, 1});
    return;
  }
  const int angles = at_roll(0).angles(), window = phi_window(layer);
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
  const int windings = at_roll(0).windings(), from = branch(layer, a), end = first + count;
  const auto q = node(layer, a);
  for (const int rank : near(layer, rank_of(layer, a), true))
    for (const int flip : {0, kFlips[0], kFlips[1]}) {
      if (flip != 0 && !(q && may_flip(flip, *q))) continue;
      for (int winding = 0; winding < windings; ++winding) {
        const int zero = slot_of(rank, ((from ^ flip) * windings + winding) * angles);
        if (end > angles) add_flips(layer, flip, {zero, zero + end - angles}, out);
        add_flips(layer, flip, {zero + first, zero + std::min(end, angles)}, out);
      }
    }
}

void KnotGrid::add_flips(int layer, int bit, const SlotRun& run, std::vector<SlotRun>& out) const {
  if (bit == 0) return out.push_back(run);
  bool goes_on = false;
  for (int b = run.first; b < run.last; ++b) {
    const auto q = node(layer + 1, b);
    const bool flips = q && may_flip(bit, *q);
    if (flips && goes_on)
      out.back().last = b + 1;
    else if (flips)
      out.push_back({b, b + 1});
    goes_on = flips;
  }
}

double KnotGrid::chosen_roll(int layer, int a, int b, int i, double t) const {
  if (!chain_->free_roll) return 0;
  const double from = roll(layer, a);
  if (t == 0) return from;
  const double change = roll(layer + 1, b) - from;
  const double chosen = from + t * (circle_ ? wrap_angle(change) : change);
  if (t == 1) return chosen;
  // Where a window narrows between two knots the roll follows its end.
  const Roll& window = path_of_rows().layer(i).window;
  return std::clamp(chosen, window.lower, std::max(window.lower, window.upper));
}

double KnotGrid::roll_of_row(int layer, int a, int b, int i, double t, const Config& q) const {
  return last_joint() ? roll_between(path_of_rows().layer(i).tool, chain_->tool(q))
                      : chosen_roll(layer, a, b, i, t);
}

std::optional<Config> KnotGrid::row_between(int layer, int a, int b, int i, double t,
                                            const Config& chord) const {
  constexpr int kSteps = 6;
  Pose tool = path_of_rows().layer(i).tool;
  std::optional<PoseNewton::Point> point;
  if (last_joint()) {
    // The roll is what the other joints make it: joint 7 turns the tool meanwhile, and back.
    constexpr double kFree = 1e-6;
    Config scale2 = scale2_;
    scale2[kDof - 1] = kFree;
    const auto turned = [&](const Config& q) {
      return rolled(tool, roll_between(tool, chain_->tool(q)));
    };
    point = newton_->nearest(chord, turned(chord), scale2, kSteps);
    if (point) {
      Config q = point->q;
      q[kDof - 1] = *last_joint();
      point = newton_->with_joint_at(q, turned(q), kDof - 1, *last_joint());
    }
  } else {
    if (chain_->free_roll) tool = rolled(tool, chosen_roll(layer, a, b, i, t));
    point = newton_->nearest(chord, tool, scale2_, kSteps);
  }
  return point ? std::optional(point->q) : std::nullopt;
}

std::optional<Lattice::RollStep> KnotGrid::roll_between_rows(int i, const Config&, double from_roll,
                                                             const Config&, double to_roll) const {
  if (!last_joint() && !windows_of_roll_) return std::nullopt;
  const double travel = path_of_rows().layer(i).travel - path_of_rows().layer(i - 1).travel,
               most = limits_.roll_slope * travel,
               turned = std::abs(wrap_angle(to_roll - from_roll));
  return RollStep{turned, most, travel, turned <= most + 1e-9};
}

TrajectoryRow KnotGrid::row(int i, const Config& q, double roll) const {
  const PathLayer& layer = path_of_rows().layer(i);
  const ArmPlane& plane = planes_[static_cast<std::size_t>(i)];
  return {
      layer.s,
      arm_angle(*arm_,
                chain_->free_roll ? carry_plane(*arm_, plane, rolled(layer.tool, roll)) : plane, q),
      arm_->branch(q), q, circle_ ? wrap_angle(roll) : roll};
}

LatticeInfo KnotGrid::describe() const {
  LatticeInfo info = Lattice::describe();
  const SrsLattice& one = at_roll(0);
  info.grid = LatticeInfo::Grid{one.angles(), kBranches, one.windings(), widest_phi_window(), {}};
  if (chain_->free_roll) info.grid->rolls = rolls();
  return info;
}

std::unique_ptr<Lattice> KnotGrid::laid_out(Layout layout, const Budget& budget) const {
  std::unique_ptr<Lattice> lattice(
      new KnotGrid(*chain_, *arm_, problem_, budget, std::move(layout)));
  lattice->take_clearances(limits_);
  return lattice;
}

std::unique_ptr<Lattice> KnotGrid::with_windings(const Joints& joints) const {
  if (circles_ == Joints{}) return nullptr;
  Layout layout = layout_;
  for (std::size_t j = 0; j < kDof; ++j) layout.wound[j] = layout.wound[j] || joints[j];
  layout.told_apart.push_back(joints);
  return laid_out(std::move(layout), {});
}

std::unique_ptr<Lattice> KnotGrid::with_knots(const std::set<int>& steps,
                                              const Budget& budget) const {
  std::optional<Knots> halved = knots().halved(steps);
  if (!halved) return nullptr;
  Layout layout = layout_;
  layout.knots = *std::move(halved);
  return laid_out(std::move(layout), budget);
}

}  // namespace swivel
