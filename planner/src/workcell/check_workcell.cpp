// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/check_workcell.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "workcell/timed_workcell.hpp"

namespace swivel {

namespace {

using TwoTrajectories = std::array<std::vector<TrajectoryRow>, 2>;
using TwoMotions = std::array<std::vector<TimedRow>, 2>;

TwoTrajectories rows_of(const TwoMotions& motions) {
  TwoTrajectories rows;
  for (std::size_t k = 0; k < 2; ++k)
    for (const TimedRow& row : motions[k]) rows[k].push_back(row.row);
  return rows;
}

class WorkcellCheck {
 public:
  /// `world`: the bodies of both arms, with what they keep. `timed`: the rows with times, if they
  /// are those of a motion; else null.
  WorkcellCheck(const PreparedWorkcell& prepared, const InterArmWorld& world,
                const TwoTrajectories& rows, const CheckOptions& options,
                const TwoMotions* timed = nullptr)
      : prepared_(prepared),
        rows_(rows),
        options_(options),
        timed_(timed),
        query_(world, options.margins ? DistanceProofs::kOff : DistanceProofs::kOn) {}

  AnswerCheck run() {
    for (std::size_t k = 0; k < 2; ++k)
      result_.runs.push_back(
          timed_ != nullptr
              ? check_motion(prepared_.robot(k), prepared_.problem(k), (*timed_)[k], options_)
              : check_trajectory(prepared_.robot(k), prepared_.problem(k), rows_[k], options_));
    if (timed_ != nullptr ? by_one_clock() : simultaneous()) {
      if (timed_ == nullptr) {
        examine_given();
        if (prepared_.follower() >= 0) examine_follower_at_layers();
      }
      examine_both();
    }
    result_.passed = result_.runs[0].passed && result_.runs[1].passed && result_.failure_count == 0;
    return std::move(result_);
  }

 private:
  void fail(const std::string& line) {
    constexpr std::size_t kMostLines = 20;
    ++result_.failure_count;
    if (result_.failures.size() < kMostLines) result_.failures.push_back(line);
  }

  /// Returns whether there is one row of either arm at each layer, with finite joints.
  bool simultaneous() {
    constexpr double kSamePlace = 1e-6;  // m
    for (std::size_t k = 0; k < 2; ++k) {
      const PathProblem& problem = prepared_.problem(k);
      const ToolPath path =
          path_within_scale(problem, prepared_.robot(k).arm().chain, options_.budget);
      if (rows_[k].size() != static_cast<std::size_t>(path.size())) {
        fail(problem.source + formatted(": %zu rows: allowed is one at each layer of the path, %d",
                                        rows_[k].size(), path.size()));
        return false;
      }
      for (int i = 0; i < path.size(); ++i) {
        const TrajectoryRow& row = rows_[k][static_cast<std::size_t>(i)];
        if (!row.q.allFinite()) return false;  // the check of the arm says so
        if (std::abs(row.s - path.layer(i).s) <= kSamePlace) continue;
        fail(problem.source + formatted(": row %d: s is %.9g: allowed is that of layer %d, %.9g", i,
                                        row.s, i, path.layer(i).s));
        return false;
      }
    }
    return true;
  }

  /// Finds rows of a given motion that are not those given.
  void examine_given() {
    if (!prepared_.given_arm()) return;
    const auto& given = prepared_.given_rows();
    for (std::size_t row = 0; row < given.size(); ++row) {
      const double off =
          (rows_[*prepared_.given_arm()][row].q - given[row].q).cwiseAbs().maxCoeff();
      if (off > kLimitTolerance)
        fail(
            formatted("row %zu: a joint of '%s' is %.3g rad from the given motion: allowed are "
                      "the rows given",
                      row, prepared_.name(*prepared_.given_arm()).c_str(), off));
    }
  }
  /// Examines whether a follower's tool is on its path on the leader's tool where that really is.
  void examine_follower_at_layers() {
    constexpr double kOnPath = 4e-6;  // m and rad: either tool may be 1e-6 off its own path
    const auto follower = static_cast<std::size_t>(prepared_.follower());
    for (std::size_t row = 0; row < rows_[0].size(); ++row) {
      if (row % 64 == 0) options_.budget.poll();
      const int layer = static_cast<int>(row);
      const FollowerError error =
          follower_error(prepared_, {rows_[0][row].q, rows_[1][row].q}, layer);
      const double lever = 1 + prepared_.on_leader(layer).translation().norm();
      if (!(error.position <= kOnPath * lever && error.angle <= kOnPath))
        fail_off_leader(row, follower, error);
    }
  }
  void fail_off_leader(std::size_t row, std::size_t follower, const FollowerError& error) {
    fail(formatted("row %zu: the tool of '", row) + prepared_.name(follower) +
         formatted("' is %.4g mm and %.4g rad off its path on the tool of '", 1e3 * error.position,
                   error.angle) +
         prepared_.name(1 - follower) + "'");
  }
  /// Returns whether the rows of both arms are at the same times, with finite joints, and both
  /// tools at their places together.
  bool by_one_clock() {
    const auto& [first, second] = *timed_;
    if (first.empty() && second.empty()) {
      fail("no rows: allowed are at least two");
      return false;
    }
    if (first.size() != second.size()) {
      fail(formatted("%zu and %zu rows of the two arms: allowed are as many", first.size(),
                     second.size()));
      return false;
    }
    for (std::size_t row = 0; row < first.size(); ++row) {
      if (first[row].t != second[row].t) {
        fail(formatted("row %zu: the times of the two arms differ: %.9g and %.9g s", row,
                       first[row].t, second[row].t));
        return false;
      }
      if (!first[row].row.q.allFinite() || !second[row].row.q.allFinite()) return false;
    }
    if (prepared_.follower() >= 0)
      examine_follower();
    else
      examine_waypoints();
    return true;
  }
  /// Examines whether a follower's tool is on its path on the leader's tool.
  void examine_follower() {
    const auto follower = static_cast<std::size_t>(prepared_.follower());
    const Limits& limits = prepared_.problem(follower).limits;
    const double off = limits.tool_path_error.value_or(kOff),
                 turned = limits.tool_angle_error.value_or(kTurned);
    const FollowerMeter meter(prepared_, options_.budget);
    for (std::size_t row = 0; row < rows_[0].size(); ++row) {
      if (row % 64 == 0) options_.budget.poll();
      const FollowerError error =
          meter.at({rows_[0][row].q, rows_[1][row].q}, rows_[1 - follower][row].s);
      if (!(error.position <= off && error.angle <= turned)) fail_off_leader(row, follower, error);
    }
  }
  /// Examines whether both tools are at their waypoints together.
  void examine_waypoints() {
    constexpr double kSame = 1e-6;  // m
    std::array<ToolPath, 2> paths{path(0), path(1)};
    for (int layer = 0; layer < paths[0].size(); ++layer) {
      if (paths[0].layer(layer).waypoint < 0) continue;
      // The other tool is at its waypoint at some time while this one is at its own.
      for (std::size_t k = 0; k < 2; ++k) {
        const auto& rows = rows_[k];
        const double s = paths[k].layer(layer).s, other = paths[1 - k].layer(layer).s;
        const double off = prepared_.problem(1 - k).limits.tool_path_error.value_or(kOff);
        const auto from = std::find_if(
            rows.begin(), rows.end(), [&](const TrajectoryRow& row) { return row.s >= s - kSame; });
        auto to = std::find_if(from, rows.end(),
                               [&](const TrajectoryRow& row) { return row.s > s + kSame; });
        const double first = other_s(k, from - rows.begin(), s),
                     last = to == rows.end() ? rows_[1 - k].back().s
                                             : other_s(k, to - rows.begin(), s);
        if (first - off <= other && other <= last + off) continue;
        fail(formatted("waypoint %d: the tool of '", paths[0].layer(layer).waypoint) +
             prepared_.name(1 - k) +
             formatted("' is %.4g mm off its own when that of '",
                       1e3 * std::max(first - other, other - last)) +
             prepared_.name(k) + "' is there");
      }
    }
  }
  /// Returns the s of the other arm when arm k is at s, on the way to a row.
  [[nodiscard]] double other_s(std::size_t k, std::ptrdiff_t row, double s) const {
    const auto& other = rows_[1 - k];
    const auto to = std::min(static_cast<std::size_t>(row), other.size() - 1);
    if (to == 0) return other[0].s;
    const double from = rows_[k][to - 1].s, way = rows_[k][to].s - from;
    const double share = way > 0 ? std::clamp((s - from) / way, 0.0, 1.0) : 1;
    return other[to - 1].s + share * (other[to].s - other[to - 1].s);
  }
  [[nodiscard]] ToolPath path(std::size_t arm) const {
    return problem_path(prepared_.problem(arm), prepared_.robot(arm).arm().chain, options_.budget,
                        PathSmoothing{});
  }

  void examine_both() {
    const std::array<std::array<double, kDof>, 2> radii{prepared_.robot(0).radii(),
                                                        prepared_.robot(1).radii()};
    const bool moves = prepared_.problem(0).limits.edges == EdgeMode::kContinuous ||
                       prepared_.problem(1).limits.edges == EdgeMode::kContinuous;
    for (std::size_t row = 0; row < rows_[0].size(); ++row) {
      options_.budget.poll();
      const std::array<Config, 2> q{rows_[0][row].q, rows_[1][row].q};
      if (const auto pair = query_.find_violating_pair(q, ClearanceRule::kNode, kVerdictBand))
        fail(formatted("row %zu: ", row) + words(*pair) + " of the two arms are too near");
      if (options_.margins) measure(row, q);
      if (!moves || row + 1 == rows_[0].size()) continue;
      const std::array<Config, 2> to{rows_[0][row + 1].q, rows_[1][row + 1].q};
      if (const auto pair =
              query_.find_pair_blocking_motion(radii, q, to, kVerdictBand, options_.budget))
        fail(formatted("motion from row %zu: ", row) + words(*pair) +
             " of the two arms come too near");
    }
  }
  void measure(std::size_t row, const std::array<Config, 2>& q) {
    const auto found = query_.clearance(q);
    if (!found || (result_.between && found->margin() >= result_.between->margin)) return;
    result_.between = {found->margin(), found->distance, found->required,
                       prepared_.between().names(found->pair), static_cast<int>(row)};
  }
  [[nodiscard]] std::string words(const BodyPair& pair) const {
    const auto names = prepared_.between().names(pair);
    return names[0] + " and " + names[1];
  }

  static constexpr double kOff = 1e-3, kTurned = 0.02;  // m, rad

  const PreparedWorkcell& prepared_;
  const TwoTrajectories& rows_;
  const CheckOptions& options_;
  const TwoMotions* timed_;
  InterArmWorld::Query query_;
  AnswerCheck result_;
};

}  // namespace

AnswerCheck check_workcell(const PreparedWorkcell& prepared, const TwoTrajectories& rows,
                           const CheckOptions& options) {
  return WorkcellCheck(prepared, prepared.between(), rows, options).run();
}

AnswerCheck check_workcell_motion(const PreparedWorkcell& prepared, const TwoMotions& rows,
                                  const CheckOptions& options) {
  require_motion_defaults(prepared);
  const InterArmWorld world = prepared.between_samples(options.budget);
  return WorkcellCheck(prepared, world, rows_of(rows), options, &rows).run();
}

AnswerCheck check_workcell(const Problem& cell, const TwoTrajectories& rows,
                           const CheckOptions& options) {
  return check_workcell(PreparedWorkcell(cell, options.budget), rows, options);
}

}  // namespace swivel
