// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/check_workcell.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel {

namespace {

using TwoTrajectories = std::array<std::vector<TrajectoryRow>, 2>;

class WorkcellCheck {
 public:
  WorkcellCheck(const PreparedWorkcell& prepared, const TwoTrajectories& rows,
                const CheckOptions& options)
      : prepared_(prepared),
        rows_(rows),
        options_(options),
        query_(prepared.between(), options.margins ? DistanceProofs::kOff : DistanceProofs::kOn) {}

  WorkcellCheckResult run() {
    for (std::size_t k = 0; k < 2; ++k)
      result_.arms[k] =
          check_trajectory(prepared_.robot(k), prepared_.problem(k), rows_[k], options_);
    if (simultaneous()) {
      examine_given();
      examine_both();
    }
    result_.passed = result_.arms[0].passed && result_.arms[1].passed && result_.failure_count == 0;
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
      const Problem& problem = prepared_.problem(k);
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

  const PreparedWorkcell& prepared_;
  const TwoTrajectories& rows_;
  const CheckOptions& options_;
  InterArmWorld::Query query_;
  WorkcellCheckResult result_;
};

}  // namespace

WorkcellCheckResult check_workcell(const PreparedWorkcell& prepared, const TwoTrajectories& rows,
                                   const CheckOptions& options) {
  return WorkcellCheck(prepared, rows, options).run();
}

WorkcellCheckResult check_workcell(const Workcell& cell, const TwoTrajectories& rows,
                                   const CheckOptions& options) {
  return check_workcell(PreparedWorkcell(cell, options.budget), rows, options);
}

void require_passed(const WorkcellCheckResult& result) {
  for (const CheckResult& arm : result.arms) require_passed(arm);
  if (!result.passed)
    throw std::logic_error("an answer for two arms is invalid: " + result.failures.front());
}

}  // namespace swivel
