// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"

namespace swivel {

namespace {

constexpr double kLengths[] = {0.02, 0.05, 0.1};  // of lines that are tried, m

/// Plans changed jobs within one time-out.
class JobTrials {
 public:
  JobTrials(const PreparedRobot& robot, const Problem& job, const Answer& result,
            const PlanOptions& options)
      : robot_(robot),
        job_(job),
        result_(result),
        options_(options),
        until_(Clock::now() +
               std::chrono::duration_cast<Clock::duration>(
                   std::chrono::duration<double>(std::min(options.timeout_s.value_or(1.0), 1e6)))) {
    options_.check = false;
    options_.evidence = {};
  }

  AdviceList advise() {
    std::vector<std::size_t> without;
    for (const RunAnswer& run : result_.arm().runs)
      if (run.status == PlanStatus::kInfeasible) without.push_back(run.run.stroke);
    if (!without.empty())
      advise_on_strokes(without);
    else if (result_.arm().no_transition)
      advise_on_transition(*result_.arm().no_transition);
    std::stable_sort(advice_.changes.begin(), advice_.changes.end(),
                     [](const Advice& a, const Advice& b) { return a.outcome < b.outcome; });
    return std::move(advice_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] double seconds_left() const {
    return std::chrono::duration<double>(until_ - Clock::now()).count();
  }
  [[nodiscard]] const std::string& name(std::size_t stroke) const {
    return job_.arm().strokes[stroke].name;
  }

  void advise_on_strokes(const std::vector<std::size_t>& without) {
    leave_out(without);
    for (const std::size_t stroke : without) reverse(stroke);
    for (std::size_t k = 0; k < without.size(); ++k) {
      AdviceAlone& one = advice_.alone.emplace_back(AdviceAlone{name(without[k]), false, {}});
      PlanOptions options = options_;
      options.timeout_s = seconds_left() / static_cast<double>(without.size() - k);
      if (!(*options.timeout_s > 0)) continue;
      Planner planner(problem_of_run(job_, run_of(without[k])));
      const PlanResult alone = planner.plan(options);
      options.timeout_s = std::min(*options.timeout_s, seconds_left());
      if (*options.timeout_s > 0) one.advice = swivel::advise(planner, alone, options);
    }
  }
  [[nodiscard]] StrokeRun run_of(std::size_t stroke) const {
    for (const RunAnswer& run : result_.arm().runs)
      if (run.run.stroke == stroke) return run.run;
    return {stroke, false};
  }

  void advise_on_transition(const NoTransition& none) {
    using Where = NoTransition::Where;
    const std::size_t runs = result_.arm().runs.size();
    const bool from_home = none.to == 0, to_home = none.to == runs;
    bool lengthened = none.where == Where::kHome;
    if (none.where == Where::kEndBefore || (none.where == Where::kBetween && !from_home))
      lengthened = lengthen(Advice::Change::kRetract, {result_.arm().runs[none.to - 1].run.stroke});
    if (none.where == Where::kBegin || (none.where == Where::kBetween && !to_home))
      lengthened = lengthen(Advice::Change::kApproach, {result_.arm().runs[none.to].run.stroke}) ||
                   lengthened;
    if (!lengthened) lengthen(Advice::Change::kLines, all_strokes());
    if (none.where == Where::kHome || from_home || to_home) move_home();
    if (none.where == Where::kHome) return;
    if (job_.arm().order == StrokeOrder::kGiven && runs > 1) {
      Problem changed = job_;
      changed.arm().order = StrokeOrder::kBest;
      add({.change = Advice::Change::kBestOrder}, changed);
    }
    std::vector<std::size_t> beside;
    if (!from_home) beside.push_back(result_.arm().runs[none.to - 1].run.stroke);
    if (!to_home) beside.push_back(result_.arm().runs[none.to].run.stroke);
    for (const std::size_t stroke : beside) reverse(stroke);
    for (const std::size_t stroke : beside) leave_out({stroke});
  }

  /// Notes what planning a changed job gives.
  Advice::Outcome add(Advice advice, const Problem& changed) {
    const double seconds = seconds_left();
    if (seconds > 0) {
      PlanOptions options = options_;
      options.timeout_s = seconds;
      try {
        const Answer found = plan_job(robot_, changed, options);
        if (!found.arm().parts.empty()) {
          advice.outcome = Advice::Outcome::kSolved;
          advice.cost = found.cost;
        } else if (found.status == PlanStatus::kInfeasible) {
          advice.outcome = Advice::Outcome::kNoHelp;
        }
      } catch (const InputError&) {  // the form of a job does not allow the change
        advice.outcome = Advice::Outcome::kNoHelp;
      }
    }
    advice_.changes.push_back(std::move(advice));
    return advice_.changes.back().outcome;
  }

  void leave_out(std::vector<std::size_t> strokes) {
    std::sort(strokes.begin(), strokes.end());
    if (strokes.size() == job_.arm().strokes.size()) return;
    Advice advice{.change = Advice::Change::kWithoutStrokes};
    for (const std::size_t stroke : strokes) advice.strokes.push_back(name(stroke));
    Problem changed = job_;
    for (std::size_t k = strokes.size(); k-- > 0;)
      changed.arm().strokes.erase(changed.arm().strokes.begin() +
                                  static_cast<std::ptrdiff_t>(strokes[k]));
    add(std::move(advice), changed);
  }

  /// Tries a stroke from its last waypoint to its first, unless it is reversible. By
  /// itself it has a path either way unless the lines of approach and retract differ.
  void reverse(std::size_t stroke) {
    const Stroke& of = job_.arm().strokes[stroke];
    const bool alone =
        result_.arm().runs.size() == 1 ||
        std::any_of(result_.arm().runs.begin(), result_.arm().runs.end(), [&](const auto& run) {
          return run.run.stroke == stroke && run.status == PlanStatus::kInfeasible;
        });
    if (of.reversible || of.end || (alone && of.approach == of.retract)) return;
    Problem changed = job_;
    Stroke& turned = changed.arm().strokes[stroke];
    std::reverse(turned.waypoints.begin(), turned.waypoints.end());
    // a feed holds from its waypoint to the next
    if (turned.feed.size() > 1) std::reverse(turned.feed.begin(), turned.feed.end() - 1);
    add({.change = Advice::Change::kReversed, .strokes = {name(stroke)}}, changed);
  }

  [[nodiscard]] std::vector<std::size_t> all_strokes() const {
    std::vector<std::size_t> all(job_.arm().strokes.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }
  /// Tries longer lines of approach, of retract, or of both at some strokes until one length helps.
  /// Returns true if one does.
  bool lengthen(Advice::Change change, const std::vector<std::size_t>& strokes) {
    for (const double length : kLengths) {
      Problem changed = job_;
      bool any = false;
      const auto extend = [&](Vector3d& line) {
        if (line.norm() >= length) return;
        line = Vector3d(0, 0, -length);
        any = true;
      };
      Advice advice{.change = change, .length = length};
      for (const std::size_t stroke : strokes) {
        // the lines of a closed stroke are equal
        if (job_.arm().strokes[stroke].closed && change != Advice::Change::kLines) continue;
        if (change != Advice::Change::kRetract) extend(changed.arm().strokes[stroke].approach);
        // a given end stands where the retract ends
        if (change != Advice::Change::kApproach && !job_.arm().strokes[stroke].end)
          extend(changed.arm().strokes[stroke].retract);
        if (change != Advice::Change::kLines) advice.strokes.push_back(name(stroke));
      }
      if (!any) continue;
      const Advice::Outcome outcome = add(std::move(advice), changed);
      if (outcome == Advice::Outcome::kSolved) return true;
      if (outcome != Advice::Outcome::kNoHelp) return false;
    }
    return false;
  }

  /// Tries the home at which the cheapest job without one begins.
  void move_home() {
    Advice advice{.change = Advice::Change::kHome};
    Problem changed = job_;
    changed.arm().home.reset();
    PlanOptions options = options_;
    options.timeout_s = seconds_left();
    if (*options.timeout_s > 0) {
      const Answer found = plan_job(robot_, changed, options);
      if (!found.arm().parts.empty()) {
        Config home = found.arm().parts.front().rows.front().q;
        for (double& joint : home.coordinates()) joint = std::round(1e4 * joint) / 1e4;
        changed.arm().home = advice.home = home;
        if (robot_.arm().chain.roll_fixed)
          (*advice.home)[kDof - 1] = std::numeric_limits<double>::infinity();
        add(std::move(advice), changed);
        return;
      }
      if (found.status == PlanStatus::kInfeasible) advice.outcome = Advice::Outcome::kNoHelp;
    }
    advice_.changes.push_back(std::move(advice));
  }

  const PreparedRobot& robot_;
  const Problem& job_;
  const Answer& result_;
  PlanOptions options_;
  Clock::time_point until_;
  AdviceList advice_;
};

}  // namespace

AdviceList advise_job(const PreparedRobot& robot, const Problem& job, const Answer& result,
                      PlanOptions options) {
  if (result.status != PlanStatus::kInfeasible) return {};
  return JobTrials(robot, job, result, options).advise();
}

}  // namespace swivel
