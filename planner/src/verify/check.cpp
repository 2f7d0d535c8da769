// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/verify/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <optional>
#include <stdexcept>

#include "measure/deepest_contact.hpp"
#include "measure/first_clearance_violation.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/places_near.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "verify/answer_check.hpp"
#include "verify/between_samples.hpp"
#include "verify/check_rates.hpp"
#include "verify/given_ends.hpp"
#include "verify/move_cost.hpp"
#include "verify/path_following.hpp"
#include "verify/places_on_path.hpp"

namespace swivel {

namespace {

constexpr double kPose = 1e-6;   // m and rad
constexpr double kLimit = 1e-9;  // rad
constexpr double kSame = 1e-9;   // m along the path
// of a step: as near as this is at a layer, or the same place
constexpr double kNear = 1e-3;
constexpr double kArmAngle = 1e-3;                // rad
constexpr PoseDistance kAtWaypoints{1e-3, 0.02};  // where the problem sets no tolerance

double angle_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// Returns the distance of two poses, m or rad, whichever is more.
double apart(const Pose& a, const Pose& b) {
  return std::max((a.translation() - b.translation()).norm(), angle_between(a, b));
}

/// Returns what each joint may move on the steps of a path, summed up: entry i is the sum over the
/// steps before layer i, rad. Throws InputError if a speed limit that is needed is missing.
std::vector<Config> allowed_moves(const PathProblem& problem, const Chain& chain,
                                  const ToolPath& path) {
  const Limits& limits = problem.limits;
  const bool timed = limits.tool_speed || limits.tool_turn_speed;
  const std::size_t joints = chain.roll ? kDof - 1 : kDof;  // the roll has no speed of its own
  for (std::size_t j = 0; j < joints; ++j)
    if ((timed || problem.cost.metric == CostMetric::kTime) && chain.limit[j].velocity <= 0)
      throw InputError(
          problem.source,
          std::string(timed ? "limits.tool_speed" : "cost.metric: time") + ": joint '" +
              chain.joint_names[j] +
              "' has no speed limit in the URDF: allowed are robots whose joints all have one");
  std::vector<Config> allowed{Config::Zero()};
  for (int i = 0; i + 1 < path.size(); ++i) {
    double dt = 0;
    if (limits.tool_speed && !turns_on_the_spot(path.layer(i)))
      dt = std::max(dt, path.layer(i).step_length / *limits.tool_speed);
    if (limits.tool_turn_speed)
      dt = std::max(dt, path.layer(i).step_angle / *limits.tool_turn_speed);
    Config bound = joint_steps(chain, limits);
    if (chain.roll) bound[kDof - 1] = roll_step_bound(path, i, limits, problem.resolution);
    for (std::size_t j = 0; dt > 0 && j < joints; ++j) {
      double& joint = bound[static_cast<Eigen::Index>(j)];
      joint = std::min(joint, chain.limit[j].velocity * dt);
    }
    allowed.push_back(allowed.back() + bound);
  }
  return allowed;
}

/// All collision queries of a check.
class Contacts {
 public:
  /// Builds the world of the problem, which forgives kVerdictBand, with the shapes of `like`, a
  /// world of the same robot.
  Contacts(const PreparedRobot& robot, const PathProblem& problem, const World& like,
           const Budget& budget)
      : world_(like, problem, budget, kVerdictBand),
        query_(world_),
        rule_(world_.edge_rule(robot.radii())),
        budget_(&budget) {}
  std::optional<World::Query::Clearance> clearance(const Config& q) { return query_.clearance(q); }
  /// Returns a pair that is allowed to touch and is deeper than allowed, with a lower bound of its
  /// depth, m; none if there is none.
  std::optional<std::pair<AllowedPair, double>> too_deep(const Config& q) {
    for (const AllowedPair& allowed : world_.allowed()) {
      if (!allowed.depth) continue;
      const double most = *allowed.depth + kVerdictBand;
      if (const Depth depth = query_.depth(q, allowed.pair, most); depth.at_most > most)
        return std::pair(allowed, depth.at_least);
    }
    return std::nullopt;
  }
  [[nodiscard]] bool may_touch() const { return !world_.allowed().empty(); }
  [[nodiscard]] std::optional<DeepestContact> deepest(const std::vector<Config>& rows) const {
    return deepest_contact(world_, rows, *budget_);
  }
  std::optional<BodyPair> on_the_way(const Config& from, const Config& to) {
    return edge_blocked(query_, rule_, from, to, *budget_);
  }
  [[nodiscard]] std::optional<ClearanceViolation> first_along(
      const Limits& limits, const std::vector<Config>& rows) const {
    return first_clearance_violation(world_, rule_, limits, rows, *budget_);
  }
  [[nodiscard]] std::string names(const BodyPair& pair) const {
    const auto& name = world_.body_names();
    return "'" + name[static_cast<std::size_t>(pair.a)] + "' and '" +
           name[static_cast<std::size_t>(pair.b)] + "'";
  }
  [[nodiscard]] RequiredClearance required_clearance(const BodyPair& pair) const {
    return world_.required_clearance(pair);
  }
  [[nodiscard]] std::int64_t fcl_calls() const { return query_.counters().fcl_calls; }

 private:
  World world_;
  World::Query query_;
  EdgeRule rule_;
  const Budget* budget_;
};

/// Returns rows with their rolls counted from the frames of the path (counted_from_path()). The
/// place of a row is the first at its s at which the path has the tool's position and axis, of
/// those that are not before the place of the row before it.
std::vector<TrajectoryRow> rows_counted_from(const ToolPath& path, const PathProblem& problem,
                                             const Chain& chain, std::vector<TrajectoryRow> rows) {
  if (!path.has_waypoint_turns()) return rows;
  const PlacesOnPath places(path, problem.smooth.has_value(),
                            problem.smooth ? problem.smooth->position : 0, true);
  double before = 0;
  for (TrajectoryRow& row : rows) {
    if (!row.q.allFinite() || !std::isfinite(row.s)) continue;
    const std::vector<double> fits = places.fits(chain.tool(row.q), row.s);
    const auto next = std::lower_bound(fits.begin(), fits.end(), before);
    const double place = next != fits.end() ? *next
                         : !fits.empty()    ? fits.back()
                                            : places.place_at(row.s);
    before = place;
    row = counted_from_path(chain, path, travel_at(path, place), row);
  }
  return rows;
}

class Check {
 public:
  /// Prepares the check of `rows`. `like` is a world of the robot; `timed` holds the same rows with
  /// times, or is null.
  Check(const PreparedRobot& robot, const PathProblem& problem, const World& like,
        const std::vector<TrajectoryRow>& rows, const CheckOptions& options,
        const std::vector<TimedRow>* timed = nullptr)
      : problem_(problem),
        options_(options),
        limits_(problem.limits),
        chain_(robot.arm().chain),
        arm_(robot.arm_class().srs ? &*robot.arm_class().srs : nullptr),
        given_rows_(rows),
        timed_(timed),
        path_(problem_path(problem, chain_, options.budget)),
        rows_(rows_counted_from(path_, problem, chain_, rows)),
        allowed_(allowed_moves(problem, chain_, path_)),
        planes_(arm_ ? carried_planes(*arm_, path_, options.budget) : std::vector<ArmPlane>{}),
        contacts_(robot, problem, like, options.budget),
        along_{limits_.tool_path_error.value_or(kNone), limits_.tool_angle_error.value_or(kNone)},
        at_waypoints_{limits_.tool_path_error.value_or(kAtWaypoints.position),
                      limits_.tool_angle_error.value_or(kAtWaypoints.angle)} {
    if (limits_.step_error)
      lattice_.emplace(
          chain_, robot.srs("limits.step_error"), path_, problem, Budget(), std::vector<ArmPlane>(),
          std::nullopt,
          SrsLattice::possible_circles(chain_, robot.srs("limits.step_error"), path_, problem));
  }

  CheckResult run() {
    if (rows_.size() < 2) fail("%zu row(s): at least two are needed", rows_.size());
    if (!rows_.empty())
      for (const std::string& line : faults_of_given_ends(problem_, chain_, given_rows_))
        fail(line);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      options_.budget.poll();
      const bool is_sound = sound(k);
      tools_.push_back(rows_[k].q.allFinite() ? tool_of(rows_[k]) : Pose::Identity());
      candidates_.push_back(is_sound ? places_of(k) : std::vector<Candidate>{});
    }
    choose_places();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (k > 0 && rows_[k].q.allFinite() && rows_[k - 1].q.allFinite())
        result_.cost += move_cost(problem_.cost, chain_, rows_[k].q - rows_[k - 1].q);
      if (!examined(k)) continue;
      options_.budget.poll();
      examine_row(k);
      if (k > 0 && examined(k - 1)) examine_move(k);
    }
    if (chain_.tool_may_turn() && problem_.cost.roll > 0) result_.cost += cost_of_roll();
    examine_travel();
    if (timed_ && timed_->size() >= 2)
      result_.motion = examine_rates(chain_, limits_, problem_.source, *timed_, tools_,
                                     [this](const std::string& line) { fail(line); });
    if (!options_.margins && result_.failure_count == 0) examine_clearance();
    if (options_.margins) {
      std::vector<Config> joints;
      for (const TrajectoryRow& row : rows_)
        if (row.q.allFinite()) joints.push_back(row.q);
      if (joints.size() == rows_.size() || !contacts_.may_touch()) {
        result_.deepest_contact = contacts_.deepest(joints);
        result_.deepest_contact_status = known(true, result_.deepest_contact.has_value());
      }
      result_.min_clearance_status =
          known(result_.rows_examined > 0, result_.min_clearance.has_value());
    }
    result_.fcl_calls = contacts_.fcl_calls();
    result_.passed = result_.failure_count == 0;
    return std::move(result_);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  /// A place of the path that a row may be at.
  struct Candidate {
    double place = 0;
    std::size_t before = 0;  // the candidate of the row before from which this one is reached
  };

  void fail(const std::string& line) {
    constexpr std::int64_t kMostLines = 20;
    if (++result_.failure_count <= kMostLines) result_.failures.push_back(line);
  }
  [[gnu::format(printf, 2, 3)]] void fail(const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    fail(formatted_list(format, arguments));
    va_end(arguments);
  }

  /// Returns the tool's pose without the roll that the row states, as the path has it.
  [[nodiscard]] Pose tool_of(const TrajectoryRow& row) const {
    const Pose tool = chain_.tool(row.q);
    return chain_.free_roll ? rolled(tool, -row.roll) : tool;
  }
  [[nodiscard]] double roll_change(std::size_t k) const {
    if (!chain_.free_roll) return 0;
    const double change = rows_[k].roll - rows_[k - 1].roll;
    return chain_.free_roll->circle() ? wrap_angle(change) : change;
  }

  [[nodiscard]] bool examined(std::size_t k) const { return !candidates_[k].empty(); }
  [[nodiscard]] double place(std::size_t k) const { return candidates_[k][chosen_[k]].place; }
  [[nodiscard]] const char* joint_name(std::size_t j) const {
    return chain_.joint_names[j].c_str();
  }

  /// Examines the values and joint limits of a row; returns false if it fails.
  bool sound(std::size_t k) {
    const TrajectoryRow& row = rows_[k];
    const bool rates_finite = !timed_ || (std::isfinite((*timed_)[k].t) &&
                                          (*timed_)[k].v.allFinite() && (*timed_)[k].a.allFinite());
    if (!std::isfinite(row.s) || !std::isfinite(row.phi) || !std::isfinite(row.roll) ||
        !row.q.allFinite() || !rates_finite) {
      fail("row %zu: has values that are not finite", k);
      return false;
    }
    if (const auto& range = chain_.free_roll;
        range && !range->circle() &&
        !(row.roll >= range->lower - roll_slack() && row.roll <= range->upper + roll_slack())) {
      fail("row %zu: roll %.9g is outside its range", k, row.roll);
      return false;
    }
    bool inside = true;
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_.limit[j];
      if (limit.continuous) continue;
      const double value = row.q[static_cast<Eigen::Index>(j)];
      const double by = std::min(value - limit.lower, limit.upper - value) - limits_.joint_margin;
      if (!(by >= -kLimit)) {
        fail("row %zu: joint '%s' at %.9g is outside its limits", k, joint_name(j), value);
        inside = false;
      } else {
        auto& nearest = limit.slides ? result_.nearest_slide_limit : result_.nearest_limit;
        if (!nearest || by < nearest->by) nearest = {static_cast<int>(j), by, k};
      }
    }
    return inside;
  }

  /// Returns the places at a row's s at which the path has the tool's pose, in order. Fails the row
  /// if there are none.
  std::vector<Candidate> places_of(std::size_t k) {
    const double s = rows_[k].s;
    const double begin = path_.layer(0).s, end = path_.layer(path_.size() - 1).s;
    if (!(s >= begin - kSame && s <= end + kSame)) {
      fail("row %zu: s = %.9g lies outside the path: allowed are %.9g to %.9g", k, s, begin, end);
      return {};
    }
    const Pose& tool = tools_[k];
    std::vector<Candidate> found;
    double position = kNone, angle = kNone;  // of the nearest
    const auto try_place = [&](double place) {
      const Pose there = pose_at(path_, place);
      const double position_error = (there.translation() - tool.translation()).norm(),
                   angle_error = angle_between(there, tool);
      if (std::max(position_error, angle_error) < std::max(position, angle))
        position = position_error, angle = angle_error;
      if (!(position_error <= kPose && angle_error <= kPose)) return false;
      if (found.empty() || found.back().place < place) found.push_back({.place = place});
      return true;
    };
    const auto at_s = [&](int layer) { return std::abs(path_.layer(layer).s - s) <= kSame; };
    for (int i = first_step_to(s - kSame); i + 1 < path_.size() && path_.layer(i).s <= s + kSame;
         ++i) {
      // The tool's place on the step, within what s leaves open: all of it if the step only turns.
      // Layers are tried first and exactly.
      bool at_layer = at_s(i) && try_place(i);
      if (at_s(i + 1)) at_layer = try_place(i + 1) || at_layer;
      if (at_layer) continue;
      const PathLayer& step = path_.layer(i);
      const Vector3d along = path_.layer(i + 1).tool.translation() - step.tool.translation();
      const Eigen::AngleAxisd turn(step.tool.linear().transpose() * tool.linear());
      double t = ((tool.translation() - step.tool.translation()).dot(along) +
                  turn.angle() * turn.axis().dot(step.step_rotation)) /
                 (along.squaredNorm() + step.step_rotation.squaredNorm());
      const double length = path_.layer(i + 1).s - step.s;
      if (problem_.smooth && i == 0 && problem_.start)  // may lead to the path from beside it
        t = nearest_on_curve(i, length > 0 ? std::clamp((s - step.s) / length, 0.0, 1.0) : t, tool);
      if (length > 0)
        t = std::clamp(t, (s - kSame - step.s) / length, (s + kSame - step.s) / length);
      t = std::clamp(t, 0.0, 1.0);
      if (problem_.smooth && step.step_length == 0) t = nearest_on_curve(i, t, tool);
      try_place(i + t);
    }
    result_.worst_position = std::max(result_.worst_position, position);
    result_.worst_angle = std::max(result_.worst_angle, angle);
    if (found.empty())
      fail("row %zu: the tool is %.3g m and %.3g rad from the path at s = %.9g", k, position, angle,
           s);
    return found;
  }

  /// Returns the share of a rounded step at which it is nearest to the pose, by secants from the
  /// answer t for a straight step.
  [[nodiscard]] double nearest_on_curve(int i, double t, const Pose& tool) const {
    const double weight = path_.layer(i).step_angle > 0 ? path_.layer(i).step_angle : 1;
    const auto off = [&](const Pose& from, const Pose& to) {
      const Eigen::AngleAxisd turn(from.linear().transpose() * to.linear());
      Eigen::Matrix<double, 6, 1> d;
      d << (to.translation() - from.translation()), turn.angle() * turn.axis() / weight;
      return d;
    };
    constexpr double kStep = 1e-4;
    constexpr int kMost = 40;  // a bend into the path ends at rest across it
    for (int round = 0; round < kMost; ++round) {
      const Pose here = path_.at(i, t);
      const Eigen::Matrix<double, 6, 1> slope =
          (off(here, path_.at(i, t + kStep)) - off(here, path_.at(i, t - kStep))) / (2 * kStep);
      if (slope.squaredNorm() == 0) break;
      const double before = t;
      t = std::clamp(t + off(here, tool).dot(slope) / slope.squaredNorm(), 0.0, 1.0);
      if (std::abs(t - before) < 1e-13) break;
    }
    return t;
  }

  /// Returns the first step that ends at s or later.
  [[nodiscard]] int first_step_to(double s) const {
    int low = 0, high = path_.size() - 2;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (path_.layer(middle + 1).s >= s)
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  }

  /// Matches rows to places so that no move fails, if that is possible. A row has one place, unless
  /// the path returns to a pose while s stands still: then the places are kept that can be reached
  /// from the row before.
  void choose_places() {
    chosen_.assign(rows_.size(), 0);
    jumps_.assign(rows_.size(), false);
    std::optional<std::size_t> before;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (!examined(k)) continue;
      if (k == 0) candidates_[0].resize(1);  // the first on the path
      if (before && candidates_[*before].size() * candidates_[k].size() > 1)
        keep_reachable(*before, k);
      before = k;
    }
    if (!before) return;
    std::size_t best = candidates_[*before].size() - 1;  // the last on the path
    for (std::size_t k = *before + 1; k-- > 0;) {
      if (!examined(k)) continue;
      chosen_[k] = best;
      best = candidates_[k][best].before;
    }
  }

  /// Keeps those places of row k to which a move leads that passes; if there are none, those to
  /// which a move goes forward; else all.
  void keep_reachable(std::size_t before, std::size_t k) {
    enum Verdict { kPasses, kFails, kGoesBack };
    const std::vector<Candidate>& from = candidates_[before];
    std::vector<Candidate>& to = candidates_[k];
    const bool neighbours = before + 1 == k;
    const Config move = rows_[k].q - rows_[before].q;
    std::vector<double> ends;
    for (const Candidate& candidate : to) ends.push_back(candidate.place);
    std::vector<Verdict> best(ends.size(), kGoesBack);
    std::optional<ToolMotion> motion;
    for (std::size_t f = 0; f < from.size(); ++f) {
      const double begin = from[f].place;
      const auto later = static_cast<std::size_t>(
          std::upper_bound(ends.begin(), ends.end(), begin) - ends.begin());
      std::vector<bool> reached(ends.size() - later, !neighbours);
      if (neighbours && !reached.empty() && excess(move, begin, ends.back()).by <= 0) {
        if (!motion) motion = motion_to(k);
        reached =
            follows(*motion, path_, begin, std::span(ends).subspan(later), along_, at_waypoints_);
        for (std::size_t c = later; c < ends.size(); ++c) {
          if (is_step(begin, ends[c]))
            reached[c - later] = within(step_deviation(k, begin), along_);
          reached[c - later] = reached[c - later] && excess(move, begin, ends[c]).by <= 0;
        }
      }
      for (std::size_t c = 0; c < to.size(); ++c) {
        const bool stands = neighbours && timed_ && may_rest(begin) && has_same_pose(k) &&
                            std::abs(ends[c] - begin) <= kNear;
        const Verdict verdict = stands || (c >= later && reached[c - later]) ? kPasses
                                : ends[c] < begin                            ? kGoesBack
                                                                             : kFails;
        // Among equally good places to come from, the last one counts: from there the way is the
        // shortest.
        if (verdict <= best[c]) best[c] = verdict, to[c].before = f;
      }
    }
    const Verdict least = *std::min_element(best.begin(), best.end());
    std::vector<Candidate> kept;
    for (std::size_t c = 0; c < to.size(); ++c)
      if (best[c] == least) kept.push_back(to[c]);
    to.swap(kept);
  }

  /// Returns the tool's motion from row k - 1 to row k.
  [[nodiscard]] ToolMotion motion_to(std::size_t k) const {
    const std::array<double, 2> rolls{-rows_[k - 1].roll, -rows_[k - 1].roll - roll_change(k)};
    return tool_motion(chain_, rows_[k - 1].q, rows_[k].q, {tools_[k - 1], tools_[k]},
                       at_waypoints_, options_.margins ? 4 : 1,
                       chain_.free_roll ? rolls : std::array<double, 2>{});
  }
  /// Returns true if the move is a step from a layer to the next.
  static bool is_step(double begin, double end) {
    return std::floor(begin) == begin && end == begin + 1;
  }
  static bool within(const PoseDistance& deviation, const PoseDistance& tolerance) {
    return deviation.position <= tolerance.position + kPose &&
           deviation.angle <= tolerance.angle + kPose;
  }
  /// Returns the deviation that the lattice's rule bounds, on the move from row k - 1, at a layer,
  /// to row k, at the next layer.
  [[nodiscard]] PoseDistance step_deviation(std::size_t k, double layer) const {
    const auto most = [](const std::array<double, 3>& deviation) {
      return *std::max_element(deviation.begin(), deviation.end());
    };
    const Config &from = rows_[k - 1].q, move = rows_[k].q - from;
    return {along_.position < kNone
                ? most(path_deviation(chain_, path_, static_cast<int>(layer), from, move))
                : 0,
            along_.angle < kNone
                ? most(angle_deviation(chain_, path_, static_cast<int>(layer), from, move))
                : 0};
  }

  struct Excess {
    double by = -kNone;  // rad, above what is allowed
    double share = 0;    // of what is allowed
    std::size_t joint = 0;
  };
  /// Returns by how much the worst joint moves more than the steps between two places allow in sum;
  /// a step that is touched counts whole.
  [[nodiscard]] Excess excess(const Config& move, double from, double to) const {
    const auto first = static_cast<std::size_t>(std::min(std::floor(from), path_.size() - 2.0));
    const auto last = std::max(first + 1, static_cast<std::size_t>(std::ceil(to)));
    Excess worst;
    for (std::size_t j = 0; j < kDof; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      const double allowed = allowed_[last][joint] - allowed_[first][joint];
      const double by = std::abs(move[joint]) - allowed - kLimit;
      if (by > worst.by) worst.by = by, worst.joint = j;
      worst.share = std::max(worst.share, std::abs(move[joint]) / allowed);
    }
    return worst;
  }

  void examine_row(std::size_t k) {
    const TrajectoryRow& row = rows_[k];
    ++result_.rows_examined;
    if (k == 0 && place(k) > 0) fail("row 0: begins at s = %.9g, not with the path", row.s);
    if (k + 1 == rows_.size() && place(k) < path_.size() - 1)
      fail("row %zu: ends at s = %.9g, before the path", k, row.s);
    examine_labels(k);
    if (limits_.manipulability > 0) {
      const double w = chain_.manipulability(row.q);
      if (!(w >= limits_.manipulability - 1e-9))
        fail("row %zu: manipulability %.3g is below %.3g", k, w, limits_.manipulability);
    }
    if (!options_.margins) return;  // examine_clearance() tests all rows at once
    if (const auto deep = contacts_.too_deep(row.q))
      fail("row %zu: %s are %.3f mm deep in each other: allowed are %.3f mm", k,
           contacts_.names(deep->first.pair).c_str(), 1e3 * deep->second, 1e3 * *deep->first.depth);
    const auto clearance = contacts_.clearance(row.q);
    if (!clearance) return;
    result_.min_clearance =
        std::min(result_.min_clearance.value_or(clearance->least), clearance->least);
    const double margin = clearance->margin() - kVerdictBand;  // the world forgives the band
    result_.min_margin = std::min(result_.min_margin.value_or(margin), margin);
    if (!(clearance->distance > 0))
      fail("row %zu: %s touch", k, contacts_.names(clearance->pair).c_str());
    else if (!(clearance->margin() >= 0))
      fail("row %zu: clearance %.3f mm between %s is below %.3f mm", k, 1e3 * clearance->distance,
           contacts_.names(clearance->pair).c_str(),
           1e3 * contacts_.required_clearance(clearance->pair).node);
  }

  /// Examines the clearance of all rows and moves, whose joints have passed.
  void examine_clearance() {
    std::vector<Config> joints;
    for (const TrajectoryRow& row : rows_) joints.push_back(row.q);
    const auto found = contacts_.first_along(limits_, joints);
    if (!found) return;
    const RequiredClearance required = contacts_.required_clearance(found->pair);
    if (found->between)
      fail_move(found->row, found->pair);
    else
      fail(required.node < 0 ? "row %zu: %s are more than %.3f mm deep in each other"
                             : "row %zu: clearance between %s is below %.3f mm",
           found->row, contacts_.names(found->pair).c_str(), 1e3 * std::abs(required.node));
  }

  /// Returns by how much rolls may exceed their bounds, rad.
  [[nodiscard]] double roll_slack() const {
    return timed_ ? std::max(kPose, path_.rounding()) : kPose;
  }

  /// Examines the labels of a row: the roll, which its waypoints bound, and arm angle and branch,
  /// which must be those of its joints.
  void examine_labels(std::size_t k) {
    const TrajectoryRow& row = rows_[k];
    if (chain_.tool_may_turn()) {
      const int i = std::min(static_cast<int>(std::floor(place(k))), path_.size() - 2);
      const PathLayer &from = path_.layer(i), &to = path_.layer(i + 1);
      const Roll window = path_.window_at(from.travel + (place(k) - i) * (to.travel - from.travel));
      const double roll = roll_of(chain_, row);
      if (!(roll >= window.lower - roll_slack() && roll <= window.upper + roll_slack()))
        fail("row %zu: roll %.9g is outside what its waypoints allow", k, roll);
    }
    if (chain_.roll && !(std::abs(wrap_angle(row.phi - row.q[kDof - 1])) <= kArmAngle))
      fail("row %zu: phi is %.6g, the roll %.6g", k, row.phi, row.q[kDof - 1]);
    if (!arm_) return;
    const int layer = static_cast<int>(std::floor(place(k)));
    ArmPlane plane = planes_[static_cast<std::size_t>(layer)];
    if (layer < place(k)) plane = carry_plane(*arm_, plane, pose_at(path_, place(k)));
    if (chain_.free_roll)
      plane = carry_plane(*arm_, plane, rolled(pose_at(path_, place(k)), row.roll));
    const double phi = arm_angle(*arm_, plane, row.q);
    if (!(std::abs(wrap_angle(row.phi - phi)) <= kArmAngle))
      fail("row %zu: phi is %.6g, that of the joints %.6g", k, row.phi, phi);

    if (!is_of_branch(*arm_, row.q, row.branch))
      fail("row %zu: branch is %d, that of the joints %d", k, row.branch, arm_->branch(row.q));
  }

  /// Examines the move from row k - 1 to row k. A move that its joints may not make is not examined
  /// further.
  void examine_move(std::size_t k) {
    const Config &from = rows_[k - 1].q, &to = rows_[k].q;
    const double begin = place(k - 1), end = place(k);
    ++result_.moves_examined;
    const bool same_pose = has_same_pose(k),
               same_place = begin == end || (same_pose && std::abs(end - begin) <= kNear);
    if (end < begin && !same_place)
      return fail("rows %zu-%zu: the tool goes back on its path, from s = %.9g to %.9g", k - 1, k,
                  rows_[k - 1].s, rows_[k].s);
    const bool at_rest = same_place || (same_pose && !timed_);
    if (at_rest && !(timed_ && may_rest(end)))
      return fail("rows %zu-%zu: the tool rests at s = %.9g", k - 1, k, rows_[k].s);
    if (!may_move(k)) return;
    if (at_rest) {
      examine_rest(k);
    } else {
      examine_path(k);
      examine_step_error(k);
    }
    if (!options_.margins || limits_.edges != EdgeMode::kContinuous) return;
    if (const auto pair = contacts_.on_the_way(from, to)) fail_move(k, *pair);
  }

  /// Fails the move to row k, on which the two bodies come too near.
  void fail_move(std::size_t k, const BodyPair& pair) {
    const double required = contacts_.required_clearance(pair).motion;
    fail(required < 0 ? "rows %zu-%zu: %s may come more than %.3f mm deep into each other"
                      : "rows %zu-%zu: %s come closer than %.3f mm",
         k - 1, k, contacts_.names(pair).c_str(), 1e3 * std::abs(required));
  }

  /// Returns true if the tool has the same pose at row k - 1 and at row k; it may have turned away
  /// and come back between.
  [[nodiscard]] bool has_same_pose(std::size_t k) const {
    return std::abs(rows_[k].s - rows_[k - 1].s) <= kSame &&
           apart(tools_[k - 1], tools_[k]) <= 1e-9;
  }
  /// Returns true for a place at one of the ends of the path or at a corner.
  [[nodiscard]] bool may_rest(double place) const {
    const auto near = [&](int layer) { return std::abs(place - layer) <= kNear; };
    return near(0) || near(path_.size() - 1) ||
           std::any_of(path_.corners().begin(), path_.corners().end(),
                       [&](const ToolPath::Corner& c) { return near(c.layer); });
  }

  bool may_move(std::size_t k) {
    const Config move = rows_[k].q - rows_[k - 1].q;
    const Excess worst = excess(move, place(k - 1), place(k));
    result_.largest_step = std::max(result_.largest_step, worst.share);
    if (worst.by > 0) {
      jumps_[k] = true;
      const double moved = std::abs(move[static_cast<Eigen::Index>(worst.joint)]);
      fail("rows %zu-%zu: joint '%s' moves by %.6g %s, joint_step and speeds allow %.6g", k - 1, k,
           joint_name(worst.joint), moved, chain_.limit[worst.joint].slides ? "m" : "rad",
           moved - worst.by);
      return false;
    }
    const auto travel = [&](double at) { return path_.layer(static_cast<int>(at)).travel; };
    const double way = travel(std::ceil(place(k))) - travel(std::floor(place(k - 1)));
    if (const double turned = std::abs(roll_change(k));
        !(turned <= limits_.roll_slope * way + kArmAngle)) {
      fail("rows %zu-%zu: the roll changes by %.6g rad, roll_slope allows %.6g", k - 1, k, turned,
           limits_.roll_slope * way);
      return false;
    }
    for (std::size_t j = 0; j < kDof; ++j) {
      const double moved = std::abs(move[static_cast<Eigen::Index>(j)]);
      if (!(chain_.limit[j].continuous || chain_.limit[j].wide()) || moved < kPi) continue;
      fail("rows %zu-%zu: continuous joint '%s' moves by %.6g rad: allowed is less than pi", k - 1,
           k, joint_name(j), moved);
      return false;
    }
    return true;
  }

  void examine_path(std::size_t k) {
    const double begin = place(k - 1), end = place(k);
    if (is_step(begin, end)) {
      const PoseDistance off = step_deviation(k, begin);
      if (!within(off, along_)) stray(k, off);
      if (!options_.margins) return;
    }
    const ToolMotion motion = motion_to(k);
    if (options_.margins) {
      const PoseDistance worst = largest_deviation(motion, path_, begin, end);
      result_.worst_path_error = std::max(result_.worst_path_error, worst.position);
      result_.worst_path_angle = std::max(result_.worst_path_angle, worst.angle);
    }
    if (is_step(begin, end)) return;
    const std::array<double, 1> ends{end};
    const auto passes = [&](const PoseDistance& along, const PoseDistance& waypoints) -> bool {
      return follows(motion, path_, begin, ends, along, waypoints)[0];
    };
    if (passes(along_, at_waypoints_)) return;
    // How far it strays: the least tolerance of the position, then of the angle, with which the
    // move would pass.
    const auto needed = [](double allowed, auto pass) {
      double low = 0, high = allowed;
      while (!pass(high) && high < 1e3) low = high, high *= 2;
      for (int step = 0; step < 12; ++step)
        (pass((low + high) / 2) ? high : low) = (low + high) / 2;
      return high;
    };
    const auto position = [&](double x) {
      return passes({limits_.tool_path_error ? x : kNone, kNone}, {x, kNone});
    };
    const auto angle = [&](double x) {
      return passes({kNone, limits_.tool_angle_error ? x : kNone}, {kNone, x});
    };
    stray(k, {needed(at_waypoints_.position, position), needed(at_waypoints_.angle, angle)});
  }

  /// Returns how far the tool leaves its pose of row k - 1 on the move to row k, at its farthest.
  [[nodiscard]] PoseDistance sway(std::size_t k) const {
    const ToolMotion motion = motion_to(k);
    PoseDistance most{0, 0};
    for (const Pose& tool : motion.poses) {
      most.position =
          std::max(most.position, (tool.translation() - tools_[k - 1].translation()).norm());
      most.angle = std::max(most.angle, angle_between(tools_[k - 1], tool));
    }
    // errors of the motion are forgiven
    return {most.position - motion.error.position, most.angle - motion.error.angle};
  }

  /// Examines a move while the tool rests at a waypoint. The joints may move straight from row k -
  /// 1 to row k as long as the tool stays there.
  void examine_rest(std::size_t k) {
    const PoseDistance off = sway(k);
    if (options_.margins) {
      result_.worst_path_error = std::max(result_.worst_path_error, off.position);
      result_.worst_path_angle = std::max(result_.worst_path_angle, off.angle);
    }
    if (!within(off, at_waypoints_)) stray(k, off);
  }

  void stray(std::size_t k, const PoseDistance& off) {
    result_.worst_path_error = std::max(result_.worst_path_error, off.position);
    result_.worst_path_angle = std::max(result_.worst_path_angle, off.angle);
    fail(
        "rows %zu-%zu: the tool leaves the path by %.3g mm and %.3g rad: allowed are %.3g mm and "
        "%.3g rad%s",
        k - 1, k, 1e3 * off.position, off.angle, 1e3 * at_waypoints_.position, at_waypoints_.angle,
        within(off, at_waypoints_) ? ", both at once" : "");
  }

  void examine_step_error(std::size_t k) {
    if (!lattice_ || !is_step(place(k - 1), place(k))) return;
    const int layer = static_cast<int>(place(k - 1));
    const auto phi = [&](std::size_t row, int at) {
      return arm_angle(*arm_, planes_[static_cast<std::size_t>(at)], rows_[row].q);
    };
    const double phi0 = phi(k - 1, layer), phi1 = phi(k, layer + 1), dphi = wrap_angle(phi1 - phi0);
    const double error =
        std::max(step_error(*lattice_, layer, 0, rows_[k - 1].branch & (kBranches - 1), phi0, dphi),
                 step_error(*lattice_, layer, 1, rows_[k].branch & (kBranches - 1), phi1, dphi));
    if (!(error <= *limits_.step_error * (1 + 1e-6)))
      fail("rows %zu-%zu: step error %.6g is above %.6g", k - 1, k, error, *limits_.step_error);
  }

  /// Examines how far a joint, and the roll of a tool that may turn, comes between any two rows:
  /// many small moves within one step could add up to a large one. It may come no further than the
  /// touched steps allow, plus one step, since it may overshoot inside the first and the last.
  void examine_travel() {
    for (std::size_t j = 0; j < kDof; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      examine_travel(
          "joint '" + chain_.joint_names[j] + "'", "joint_step and speeds", kLimit,
          [&](std::size_t k) { return rows_[k].q[joint]; },
          [&](std::size_t layer) { return allowed_[layer][joint]; });
    }
    if (!chain_.free_roll) return;
    std::vector<double> rolls;  // unwrapped
    for (std::size_t k = 0; k < rows_.size(); ++k)
      rolls.push_back(k == 0 ? rows_[k].roll : rolls.back() + roll_change(k));
    examine_travel(
        "the roll", "roll_slope", kArmAngle, [&](std::size_t k) { return rolls[k]; },
        [&](std::size_t layer) {
          return limits_.roll_slope * path_.layer(static_cast<int>(layer)).travel;
        });
  }
  /// Examines value(row) by the greatest travel allowed(layer) up to a layer.
  template <class Value, class Allowed>
  void examine_travel(const std::string& what, const char* limits, double forgiven,
                      const Value& value, const Allowed& allowed) {
    for (const double sign : {1.0, -1.0}) {
      double least = kNone;  // least of sign * value minus what was allowed up to there
      std::size_t since = 0;
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (!examined(k)) continue;
        if (jumps_[k]) least = kNone;  // reported already
        const auto first =
            static_cast<std::size_t>(std::min(std::floor(place(k)), path_.size() - 2.0));
        const auto last = static_cast<std::size_t>(std::ceil(place(k)));
        const double at = sign * value(k), step = allowed(first + 1) - allowed(first);
        if (at - allowed(last) - step > least + forgiven) {
          const double from = sign * value(since);
          fail("rows %zu-%zu: %s comes %.6g rad far: allowed are %.6g by %s", since, k,
               what.c_str(), at - from, least + allowed(last) + step - from, limits);
          least = kNone;
        }
        if (at - allowed(first) < least) least = at - allowed(first), since = k;
      }
    }
  }

  /// Returns the cost of the rolls: each row's, weighted with half of the path to the rows before
  /// and after it.
  [[nodiscard]] double cost_of_roll() const {
    double sum = 0;
    for (std::size_t k = 1; k < rows_.size(); ++k)
      for (const std::size_t row : {k - 1, k})
        if (rows_[row].q.allFinite())
          sum += problem_.cost.roll * (rows_[k].s - rows_[k - 1].s) / 2 *
                 std::abs(wrap_angle(roll_of(chain_, rows_[row])));
    return sum;
  }

  const PathProblem& problem_;
  const CheckOptions& options_;
  const Limits& limits_;
  const Chain& chain_;
  const SrsArm* arm_;  // null: no arm angle; phi and branch of rows are for reports alone
  const std::vector<TrajectoryRow>& given_rows_;
  const std::vector<TimedRow>* timed_;
  ToolPath path_;
  const std::vector<TrajectoryRow> rows_;  // with rolls counted from the frames of the path
  std::vector<Config> allowed_;
  std::vector<ArmPlane> planes_;
  std::optional<SrsLattice> lattice_;  // for the estimate of the step error alone
  Contacts contacts_;
  PoseDistance along_, at_waypoints_;
  std::vector<Pose> tools_;                         // identity for rows whose joints are not finite
  std::vector<std::vector<Candidate>> candidates_;  // empty: the row is not examined
  std::vector<std::size_t> chosen_;
  std::vector<bool> jumps_;  // the move to the row is too large for its joints
  CheckResult result_;
};

}  // namespace

CheckResult check_trajectory(const PreparedRobot& robot, const PathProblem& problem,
                             const std::vector<TrajectoryRow>& rows, const CheckOptions& options) {
  validate(problem);
  robot.require_prepared_for(problem);
  CheckResult result = Check(robot, problem, robot.world(), rows, options).run();
  const bool on_path = result.worst_position <= kPose && result.worst_angle <= kPose;
  if (result.passed || on_path || problem.smooth) return result;
  // Trajectories from which motions are to be made follow the rounded path of
  // with_motion_defaults().
  const PathProblem of_motions = with_motion_defaults(problem);
  try {
    CheckResult rounded = Check(robot, of_motions, robot.world(), rows, options).run();
    if (rounded.failure_count >= result.failure_count) return result;
    rounded.rounded = true;
    return rounded;
  } catch (const InputError&) {  // a given start that is not on that path
    return result;
  }
}

CheckResult check_motion(const PreparedRobot& robot, const PathProblem& problem,
                         const std::vector<TimedRow>& rows, const CheckOptions& options) {
  validate(problem);
  robot.require_prepared_for(problem);
  return check_motion_in(robot.world(), robot, problem, rows, options);
}

CheckResult check_trajectory(const PathProblem& problem, const std::vector<TrajectoryRow>& rows,
                             const CheckOptions& options) {
  return check_trajectory(PreparedRobot(problem, options.budget), problem, rows, options);
}

CheckResult check_motion_in(const World& world, const PreparedRobot& robot,
                            const PathProblem& problem, const std::vector<TimedRow>& rows,
                            const CheckOptions& options) {
  const PathProblem of_samples = problem_of_samples(problem);
  std::vector<TrajectoryRow> places;
  for (const TimedRow& row : rows) places.push_back(row.row);
  return Check(robot, of_samples, world, places, options, &rows).run();
}

void require_passed(const CheckResult& result) {
  if (result.passed) return;
  const std::int64_t more = result.failure_count - 1;
  throw std::logic_error("the answer does not pass its own check: " + result.failures.at(0) +
                         (more > 0 ? ", and " + std::to_string(more) + " more" : ""));
}

void require_passed(const AnswerCheck& result) {
  if (result.passed) return;
  if (result.failures.empty())
    for (const CheckResult& run : result.runs) require_passed(run);
  throw std::logic_error("the answer does not pass its own check: " + result.failures.at(0));
}

void check_answer(const World& world, const PreparedRobot& robot, const PathProblem& problem,
                  const std::vector<TrajectoryRow>& rows, const Budget& budget) {
  const TraceSpan span("check");
  require_passed(Check(robot, problem, world, rows, {.margins = false, .budget = budget}).run());
}

void check_answer(const World& world, const PreparedRobot& robot, const PathProblem& problem,
                  const std::vector<TimedRow>& rows, const Budget& budget) {
  const TraceSpan span("check");
  require_passed(
      check_motion_in(world, robot, problem, rows, {.margins = false, .budget = budget}));
}

}  // namespace swivel
