// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lattice/circle_turns.hpp"
#include "lattice/given_posture.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/equations/pose_error_bound.hpp"
#include "swivel/core/lattice/places_near.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel {

namespace {

/// Rounds x to a multiple of 2^-40 `unit`, for |x| < 2048 `unit`. Sums of such costs are exact in
/// any order.
double rounded(double x, double unit) {
  const double shift = 6144.0 * unit;  // 1.5 * 2^12, whose last place is 2^-40
  return (x + shift) - shift;
}

/// Returns the least power of two >= x for x > 0; 1 for x = 0.
double power_of_two_from(double x) {
  int exponent = 0;
  return x > 0 ? std::ldexp(1.0, std::frexp(x, &exponent) > 0.5 ? exponent : exponent - 1) : 1.0;
}

bool within(const Config& delta, const Config& bound) {
  for (int k = 0; k < kDof; ++k)
    if (!(std::abs(delta[k]) <= bound[k])) return false;
  return true;
}

/// The straight segment of the tool's origin from a layer to the next; a point if the two coincide.
class Step {
 public:
  Step(const ToolPath& path, int layer) : start_(path.layer(layer).tool.translation()) {
    const Vector3d along = path.layer(layer + 1).tool.translation() - start_;
    length_ = along.norm();
    if (length_ >= kShortest) direction_ = along / length_;
  }
  /// Returns the distance of a point from the segment, m.
  [[nodiscard]] double aside(const Vector3d& p) const {
    const Vector3d d = p - start_;
    return (d - std::clamp(d.dot(direction_), 0.0, length_) * direction_).norm();
  }
  /// Returns the share of the step, 0 to 1, at which the path is compared with a tool that is at a
  /// point at the share t of its move: t, or the share nearest to t whose place is as near to the
  /// point as any (places_near()).
  [[nodiscard]] double share(const Vector3d& p, double t) const {
    const Shares near = places_near(start_, length_ * direction_, p, aside(p));
    return std::clamp(t, near.low, near.high);
  }

 private:
  static constexpr double kShortest = 1e-9;  // m
  Vector3d start_, direction_ = Vector3d::Zero();
  double length_;
};

}  // namespace

Lattice::Lattice(const Chain& chain, Knots knots, const PathProblem& problem,
                 const Config& fit_error)
    : chain_(&chain),
      knots_(std::move(knots)),
      path_(&knots_.path()),
      limits_(problem.limits),
      cost_(problem.cost),
      starts_given_(problem.start.has_value()),
      end_(problem.end && !path_->ends_early()
               ? std::optional(joints_given(PathEnd::kLast, problem, chain, *path_))
               : std::nullopt),
      given_start_(problem.start
                       ? std::optional(joints_given(PathEnd::kFirst, problem, chain, *path_))
                       : std::nullopt),
      fit_error_(fit_error),
      steps_of_rows_(step_bounds_along(chain, path_of_rows(), limits_, problem.resolution)) {
  const bool timed = limits_.tool_speed || limits_.tool_turn_speed;
  const std::array<double, kDof> weights = joint_weights(cost_, chain);
  for (std::size_t k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain.limit[k];
    const bool roll = chain.roll && k + 1 == kDof;
    if (!roll && (timed || cost_.metric == CostMetric::kTime) && limit.velocity <= 0)
      throw InputError(
          problem.source,
          std::string(timed ? "limits.tool_speed" : "cost.metric: time") + ": joint '" +
              chain.joint_names[k] +
              "' has no speed limit in the URDF: allowed are robots whose joints all have one");
    continuous_[k] = limit.continuous || limit.wide();
    if (!roll && !continuous_[k] &&
        limit.lower + limits_.joint_margin > limit.upper - limits_.joint_margin)
      throw InputError(problem.source, "limits.joint_margin: leaves no range for joint '" +
                                           chain.joint_names[k] + "'" + ": allowed is at most " +
                                           formatted("%.9g", (limit.upper - limit.lower) / 2));
    cost_scale_[k] = cost_.metric != CostMetric::kTime ? weights[k] : roll ? 0 : 1 / limit.velocity;
    if (cost_.metric == CostMetric::kTime && !weight_allowed(cost_scale_[k]))
      throw InputError(problem.source, "joint '" + chain.joint_names[k] +
                                           "': its speed limit in the URDF does not suit "
                                           "cost.metric: time: allowed are 1e-6 to 1e6 rad/s");
  }
  double most_costly = *std::max_element(cost_scale_.begin(), cost_scale_.end());
  if (problem.roll && cost_.roll > 0) {
    roll_weights_ = path_->shares();
    for (double& weight : roll_weights_)
      most_costly = std::max(most_costly, kPi * (weight *= cost_.roll));
  }
  cost_unit_ = power_of_two_from(most_costly);
  steps_ = 0x1p24 / cost_unit_;
  const double heaviest = *std::max_element(cost_scale_.begin(), cost_scale_.end());
  for (std::size_t k = 0; k < kDof; ++k)
    middle_weight_[k] = heaviest > 0 ? std::max(cost_scale_[k], 0.01 * heaviest) : 1;
  set_row_step_bounds(has_layers_between() ? knots_.bounds_between(steps_of_rows_)
                                           : steps_of_rows_);
}

Config joint_steps(const Chain& chain, const Limits& limits) {
  Config steps = Config::Constant(limits.joint_step);
  if (const int slide = chain.slide(); slide >= 0) steps[slide] *= kSlideForTurn;
  return steps;
}

std::vector<Config> Lattice::step_bounds_along(const Chain& chain, const ToolPath& path,
                                               const Limits& limits, const Resolution& resolution) {
  const bool timed = limits.tool_speed || limits.tool_turn_speed, differ = timed || chain.roll;
  std::vector<Config> bounds(differ ? static_cast<std::size_t>(path.size()) - 1 : 1,
                             joint_steps(chain, limits));
  for (int i = 0; differ && i + 1 < path.size(); ++i) {
    const PathLayer& layer = path.layer(i);
    if (chain.roll)
      bounds[static_cast<std::size_t>(i)][kDof - 1] = roll_step_bound(path, i, limits, resolution);
    double dt = 0;
    if (limits.tool_speed && !turns_on_the_spot(layer))
      dt = std::max(dt, layer.step_length / *limits.tool_speed);
    if (limits.tool_turn_speed) dt = std::max(dt, layer.step_angle / *limits.tool_turn_speed);
    if (dt <= 0) continue;  // the given speed says nothing of the duration of this step
    for (int k = 0; k < kDof; ++k) {
      double& most = bounds[static_cast<std::size_t>(i)][k];
      if (!chain.roll || k + 1 < kDof)
        most = std::min(most, chain.limit[static_cast<std::size_t>(k)].velocity * dt);
    }
  }
  return bounds;
}

void Lattice::set_row_step_bounds(std::vector<Config> bounds) {
  row_step_bounds_ = std::move(bounds);
  step_bounds_.clear();
  for (const Config& most : row_step_bounds_) step_bounds_.push_back(most + 2 * fit_error_);
}

void Lattice::treat_as_circles(const Joints& circles) {
  circles_ = circles;
  for (std::size_t j = 0; j < kDof; ++j) continuous_[j] = continuous_[j] || circles[j];
}

std::optional<Config> Lattice::row_between(int, int, int, int, double, const Config&) const {
  return std::nullopt;
}

double Lattice::roll_of_row(int, int, int, int, double, const Config&) const {
  return 0;
}

std::optional<Lattice::RollStep> Lattice::roll_between_rows(int i, const Config& from, double,
                                                            const Config& to, double) const {
  if (!chain_->roll) return std::nullopt;
  const double change = std::abs(to[kDof - 1] - from[kDof - 1]),
               most = step_bound_of_rows(i - 1)[kDof - 1];
  return RollStep{change, most, most / limits_.roll_slope, change <= most};
}

void Lattice::check_row(int i, const Config& q, InterpolatedEdge& edge) const {
  using Fault = InterpolatedEdge::Fault;
  const double margin = limits_.joint_margin - kLimitTolerance;
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain_->limit[j];
    const double x = q[static_cast<Eigen::Index>(j)];
    const bool windowed = chain_->roll && j + 1 == kDof && !path_of_rows().layer(i).in_window(x);
    if (windowed || (!continuous_[j] && !(x >= limit.lower + margin && x <= limit.upper - margin)))
      edge.joints |= static_cast<std::uint8_t>(1u << j);
  }
  if (edge.joints)
    edge.fault = Fault::kLimit;
  else if (!manipulable(q))
    edge.fault = Fault::kManipulability;
}

void Lattice::check_step(int i, const Config& from, double from_roll, const Config& to,
                         double to_roll, InterpolatedEdge& edge) const {
  using Fault = InterpolatedEdge::Fault;
  const ToolPath& path = path_of_rows();
  const Config move = to - from;
  const auto roll = roll_between_rows(i, from, from_roll, to, to_roll);
  if (roll && !roll->allowed) {
    edge.fault = Fault::kRollSlope;
    edge.roll = *roll;
  } else if (!(move.cwiseAbs().array() <= step_bound_of_rows(i - 1).array()).all()) {
    edge.fault = Fault::kStep;
  } else if (!keeps_path_error(*chain_, path, i - 1, from, move, limits_.tool_path_error)) {
    edge.fault = Fault::kPathError;
  } else if (!keeps_angle_error(*chain_, path, i - 1, from, move, limits_.tool_angle_error)) {
    edge.fault = Fault::kAngleError;
  }
}

Lattice::InterpolatedEdge Lattice::interpolate_edge(int layer, int a, const Config& qa, int b,
                                                    const Config& qb) const {
  using Fault = InterpolatedEdge::Fault;
  InterpolatedEdge edge;
  if (!has_layers_between()) return edge;
  const int first = layer_of_rows(layer), last = layer_of_rows(layer + 1);
  const ToolPath& path = path_of_rows();
  const double begin = path.layer(first).travel, way = path.layer(last).travel - begin;
  const Config chord = delta(qa, qb);
  Config from = qa;
  double from_roll = roll_of_row(layer, a, b, first, 0, qa);
  for (int i = first + 1; i <= last; ++i) {
    const double t = i == last ? 1 : (path.layer(i).travel - begin) / way;
    const std::optional<Config> to =
        i == last ? Config(qa + chord) : row_between(layer, a, b, i, t, qa + t * chord);
    if (to) {
      edge.q = *to;
      if (i < last) check_row(i, *to, edge);
    } else {
      edge.fault = Fault::kNoIk;
    }
    if (edge.fault != Fault::kNone) return edge;
    const double to_roll = roll_of_row(layer, a, b, i, t, *to);
    check_step(i, from, from_roll, *to, to_roll, edge);
    if (edge.fault != Fault::kNone) return edge;
    if (i < last) edge.rows.push_back(*to);
    if (i < last && chooses_roll()) edge.rolls.push_back(to_roll);
    from = *to;
    from_roll = to_roll;
  }
  return edge;
}

std::optional<Config> Lattice::exact_config(int, int, const Config& q) const {
  return q;
}

std::optional<Config> Lattice::exact_config(int layer, int slot) const {
  const auto q = node(layer, slot);
  return q ? exact_config(layer, slot, *q) : std::nullopt;
}

bool Lattice::manipulable(const Config& q) const {
  return !asks_manipulability() || chain_->manipulability(q) >= limits_.manipulability;
}

Config Lattice::delta(const Config& q0, const Config& q1) const {
  Config d = q1 - q0;
  for (int k = 0; k < kDof; ++k)
    if (continuous_[static_cast<std::size_t>(k)]) d[k] = wrap_angle(d[k]);
  return d;
}

Config Lattice::least_delta(const Config& q, const Config& lower, const Config& upper) const {
  constexpr double kSlack = 1e-12;  // rad; turns are added to circles' angles and rounded
  Config least;
  for (int k = 0; k < kDof; ++k) {
    if (!continuous_[static_cast<std::size_t>(k)]) {
      least[k] = std::max({lower[k] - q[k], q[k] - upper[k], 0.0});
      continue;
    }
    const double first = wrap_angle(lower[k] - q[k]), last = first + (upper[k] - lower[k]);
    const double before = first > 0 ? first : first + kTwoPi,  // to the interval, turning up
        after = last < 0 ? -last : kTwoPi - last;              // and turning down
    const bool inside = first <= 0 && last >= 0;
    least[k] = inside ? 0 : std::max(std::min(before, after) - kSlack, 0.0);
  }
  return least;
}

bool Lattice::step_allowed(int layer, const Config& delta) const {
  return within(delta, step_bound(layer));
}

bool Lattice::row_step_allowed(int layer, const Config& delta) const {
  return within(delta, row_step_bound(layer));
}

std::optional<Lattice::RollStep> Lattice::roll_step(int layer, int, const Config& q0, int,
                                                    const Config& q1) const {
  if (!chain_->roll) return std::nullopt;
  const double change = std::abs(delta(q0, q1)[kDof - 1]), most = row_step_bound(layer)[kDof - 1];
  return RollStep{change, most, most / limits_.roll_slope, change <= most};
}

double Lattice::rounded_cost(double cost) const {
  return rounded(cost, cost_unit_);
}

double Lattice::off_middle(const Config& q) const {
  double sum = 0;
  for (std::size_t j = 0; j < kDof; ++j) {
    const double x = q[static_cast<Eigen::Index>(j)];
    if (chain_->limit[j].continuous || chain_->limit[j].wide()) continue;
    double least = off_middle(j, x);
    if (continuous_[j]) {
      least = std::numeric_limits<double>::infinity();
      each_image(j, x, [&](double image) { least = std::min(least, off_middle(j, image)); });
    }
    sum += least;
  }
  return sum;
}

double Lattice::roll_weight(int layer) const {
  return roll_weights_.empty() ? 0 : roll_weights_[static_cast<std::size_t>(layer)];
}

double Lattice::roll_cost(int layer, double roll) const {
  return rounded_cost(roll_weight(layer) * std::abs(wrap_angle(roll)));
}

double Lattice::edge_cost(const Config& delta) const {
  double x[kDof];
  for (std::size_t k = 0; k < kDof; ++k)
    x[k] = cost_scale_[k] * delta[static_cast<Eigen::Index>(k)];
  if (cost_.metric == CostMetric::kL2)
    // The vector sweep adds in this order (shoulder, elbow, wrist); the bits must agree.
    return rounded(std::sqrt(((x[0] * x[0] + x[1] * x[1]) + x[2] * x[2]) + x[3] * x[3] +
                             ((x[4] * x[4] + x[5] * x[5]) + x[6] * x[6])),
                   cost_unit_);
  if (cost_.metric == CostMetric::kL1) {
    for (double& value : x) value = std::abs(value);
    return rounded(((x[0] + x[1]) + x[2]) + x[3] + ((x[4] + x[5]) + x[6]), cost_unit_);
  }
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return rounded(most, cost_unit_);
}

bool Lattice::follows_path(int layer, int a, const Config& q0, int b, const Config& q1) const {
  const Config move = delta(q0, q1);
  return keeps_path_error(*chain_, *path_, layer, q0, move, limits_.tool_path_error) &&
         keeps_angle_error(*chain_, *path_, layer, q0, move, limits_.tool_angle_error) &&
         keeps_step_error(layer, a, b);
}

double roll_step_bound(const ToolPath& path, int step, const Limits& limits,
                       const Resolution& resolution) {
  const double travel = path.layer(step + 1).travel - path.layer(step).travel;
  return std::min(kPi, limits.roll_slope * std::max(travel, resolution.ds / 2));
}

namespace {

/// The sines and cosines of a joint-linear move at t = 1/2, and of a quarter of the move, by whose
/// addition theorem those at t = 1/4 and 3/4 follow. A slide has its position for its sine.
class QuartersOfMove {
 public:
  QuartersOfMove(const Chain& chain, const Config& q0, const Config& delta)
      : chain_(chain), middle_(q0 + 0.5 * delta), quarter_(0.25 * delta) {
    for (int k = 0; k < kDof; ++k) c_[k] = std::cos(middle_[k]), s_[k] = std::sin(middle_[k]);
    if (const int k = chain.slide(); k >= 0) c_[k] = 0, s_[k] = middle_[k];
  }
  /// Returns where the tool is at t = 1/2.
  [[nodiscard]] Vector3d tool_halfway() const { return chain_.tool_point(c_, s_); }
  /// Returns where the tool is at t = 1/4 and t = 3/4.
  [[nodiscard]] std::array<Vector3d, 2> tool_at_quarters() const {
    Config c_before, s_before, c_after, s_after;
    for (int k = 0; k < kDof; ++k) {
      const double c = std::cos(quarter_[k]), s = std::sin(quarter_[k]);
      c_before[k] = c_[k] * c + s_[k] * s, s_before[k] = s_[k] * c - c_[k] * s;
      c_after[k] = c_[k] * c - s_[k] * s, s_after[k] = s_[k] * c + c_[k] * s;
    }
    if (const int k = chain_.slide(); k >= 0) {
      c_before[k] = c_after[k] = 0;
      s_before[k] = middle_[k] - quarter_[k], s_after[k] = middle_[k] + quarter_[k];
    }
    return {chain_.tool_point(c_before, s_before), chain_.tool_point(c_after, s_after)};
  }

 private:
  const Chain& chain_;
  Config middle_, quarter_, c_, s_;
};

/// Returns the angle between the tool and the path at t of a move from q0 by `delta`, rad.
double angle_deviation_at(const Chain& chain, const ToolPath& path, int layer, const Step& step,
                          const Config& q0, const Config& delta, double t) {
  const Pose tool = chain.tool(q0 + t * delta);
  const Pose asked = path.at(layer, step.share(tool.translation(), t));
  // For a tool that may turn about its z axis, only the angle between the z axes counts.
  return chain.tool_may_turn()
             ? std::atan2(asked.linear().col(2).cross(tool.linear().col(2)).norm(),
                          asked.linear().col(2).dot(tool.linear().col(2)))
             : Eigen::AngleAxisd(asked.linear().transpose() * tool.linear()).angle();
}

}  // namespace

std::array<double, 3> path_deviation(const Chain& chain, const ToolPath& path, int layer,
                                     const Config& q0, const Config& delta) {
  const Step step(path, layer);
  const QuartersOfMove move(chain, q0, delta);
  const auto quarters = move.tool_at_quarters();
  return {step.aside(quarters[0]), step.aside(move.tool_halfway()), step.aside(quarters[1])};
}

bool keeps_path_error(const Chain& chain, const ToolPath& path, int layer, const Config& q0,
                      const Config& delta, const std::optional<double>& most) {
  if (!most) return true;
  const Step step(path, layer);
  const QuartersOfMove move(chain, q0, delta);
  if (!(step.aside(move.tool_halfway()) <= *most)) return false;
  const auto quarters = move.tool_at_quarters();
  return step.aside(quarters[0]) <= *most && step.aside(quarters[1]) <= *most;
}

std::array<double, 3> angle_deviation(const Chain& chain, const ToolPath& path, int layer,
                                      const Config& q0, const Config& delta) {
  const Step step(path, layer);
  const auto at = [&](double t) {
    return angle_deviation_at(chain, path, layer, step, q0, delta, t);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

bool keeps_angle_error(const Chain& chain, const ToolPath& path, int layer, const Config& q0,
                       const Config& delta, const std::optional<double>& most) {
  if (!most) return true;
  const Step step(path, layer);
  for (const double t : {0.5, 0.25, 0.75})
    if (!(angle_deviation_at(chain, path, layer, step, q0, delta, t) <= *most)) return false;
  return true;
}

PoseErrorBound BodyPoseClasses::pose_error_of_node(int, int, const Config&) const {
  return {};
}

PoseErrorBound BodyPoseClasses::pose_error_between(int, int, const Config&) const {
  return {};
}

LatticeInfo Lattice::describe() const {
  LatticeInfo info;
  info.layers = layers();
  info.nodes = nodes();
  info.merged_waypoints = path_->merged_waypoints();
  return info;
}

Lattice::Followed Lattice::followed(const std::vector<int>& slots) const {
  constexpr double kTurned = 1e-3;  // rad, far less than a turn
  Followed rows;
  rows.q.reserve(slots.size());
  for (int k = 0; k < static_cast<int>(slots.size()); ++k) {
    const int slot = slots[static_cast<std::size_t>(k)];
    Config q = *exact_config(k, slot);
    if (k > 0 && has_layers_between()) {
      const int before = slots[static_cast<std::size_t>(k) - 1];
      const InterpolatedEdge edge = interpolate_edge(k - 1, before, rows.q.back(), slot, q);
      rows.q.insert(rows.q.end(), edge.rows.begin(), edge.rows.end());
      rows.rolls.insert(rows.rolls.end(), edge.rolls.begin(), edge.rolls.end());
    }
    rows.nodes.push_back(rows.q.size());
    rows.q.push_back(rows.q.empty() ? q : Config(rows.q.back() + delta(rows.q.back(), q)));
    if (chooses_roll())
      rows.rolls.push_back(roll_of_row(k, slot, slot, layer_of_rows(k), 0, rows.q.back()));
  }
  // The node of a given start may be in another turn.
  if (given_start_ && !rows.q.empty()) {
    const Config turns = *given_start_ - rows.q.front();
    if (turns.cwiseAbs().maxCoeff() > kTurned) {
      for (Config& q : rows.q) q += turns;
      rows.q.front() = *given_start_;
    }
  }
  if (static_cast<int>(slots.size()) == layers()) turn_to_end(rows.q);
  return rows;
}

CircleTurns Lattice::turns_along(const std::vector<Config>& rows) const {
  const bool ends = end_ && static_cast<int>(rows.size()) == path_of_rows().size();
  return circle_turns(*this, circles_, rows, starts_given_, ends ? &*end_ : nullptr);
}

bool Lattice::turn_into_limits(std::vector<Config>& rows) const {
  if (circles_ == Joints{}) return true;
  const CircleTurns turns = turns_along(rows);
  if (!turns.fit()) return false;
  for (Config& q : rows) q += turns.turn;
  return true;
}

std::vector<Config> Lattice::path_joints(const std::vector<int>& slots) const {
  std::vector<Config> rows = followed(slots).q;
  return turn_into_limits(rows) ? rows : std::vector<Config>();
}

Lattice::Joints Lattice::off_limits(const std::vector<int>& slots) const {
  if (circles_ == Joints{}) return {};
  return turns_along(followed(slots).q).furthest_over();
}

void Lattice::turn_to_end(std::vector<Config>& rows) const {
  constexpr double kRounding = 1e-9;  // rad
  for (int j = 0; j < kDof && is_closed(); ++j)
    if (std::abs(rows.front()[j] - rows.back()[j]) < kRounding) rows.back()[j] = rows.front()[j];
  if (!end_) return;
  for (int j = 0; j < kDof; ++j) {
    if (j == chain_->slide()) continue;
    const double turns = std::round(((*end_)[j] - rows.back()[j]) / kTwoPi) * kTwoPi;
    for (Config& q : rows) q[j] += starts_given_ ? 0 : turns;
    if (std::abs((*end_)[j] - rows.back()[j]) < kRounding) rows.back()[j] = (*end_)[j];
  }
}

TrajectoryRow Lattice::row(int i, const Config& q, double roll) const {
  return {path_of_rows().layer(i).s, 0, 0, q, roll};
}

std::vector<TrajectoryRow> Lattice::path_rows(const std::vector<int>& slots) const {
  Followed joints = followed(slots);
  if (!turn_into_limits(joints.q)) return {};
  std::vector<TrajectoryRow> rows;
  rows.reserve(joints.q.size());
  const auto roll = [&] { return joints.rolls.empty() ? 0 : joints.rolls[rows.size()]; };
  for (int k = 0; k < static_cast<int>(slots.size()); ++k) {
    const int slot = slots[static_cast<std::size_t>(k)];
    int between = k > 0 ? layer_of_rows(k - 1) : 0;
    while (rows.size() < joints.nodes[static_cast<std::size_t>(k)])
      rows.push_back(row(++between, joints.q[rows.size()], roll()));
    rows.push_back(
        {path_->layer(k).s, phi(k, slot), branch(k, slot), joints.q[rows.size()], roll()});
  }
  count_from_waypoints(*chain_, path_of_rows(), rows);
  return rows;
}

std::unique_ptr<Lattice> Lattice::with_windings(const Joints&) const {
  return nullptr;
}

}  // namespace swivel
