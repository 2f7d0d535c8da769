// SPDX-License-Identifier: BSD-3-Clause
#include "job/lift_offs/plan_lift_offs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "job/lift_offs/lift_search.hpp"
#include "plan/answer.hpp"
#include "plan/search.hpp"
#include "plan/search_settings.hpp"
#include "plan/stopwatch.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

constexpr int kMostTries = 24;  // jobs planned to choose the places of one stroke

/// A stroke that is done in several runs.
struct CutStroke {
  std::unique_ptr<LiftSearch> search;
  int count = 0;  ///< of lift-offs
  LiftSearch::Places places;
};

class LiftPlan {
 public:
  LiftPlan(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
           const Budget& budget, ProblemView* view,
           const std::function<Answer(const Problem&, ProblemView*)>& plan)
      : robot_(robot), job_(job), options_(options), budget_(budget), view_(view), plan_(plan) {}

  Answer run() {
    uncut_ = std::make_shared<Problem>(job_);
    uncut_->arm().lift.reset();
    Answer first = plan_(*uncut_, view_);
    keep(uncut_);
    const bool cut = std::any_of(job_.arm().strokes.begin(), job_.arm().strokes.end(),
                                 [](const Stroke& stroke) { return stroke.piece.has_value(); });
    if (!job_.arm().lift || cut || first.status != PlanStatus::kInfeasible) return first;
    bool stopped = false;
    try {
      Stopwatch watch;
      if (!find_cuts(first)) return first;
      for (CutStroke& stroke : strokes_) choose(stroke);
      first.time_ms["lift"] = watch.lap();
    } catch (const Stopped&) {
      stopped = true;
    }
    if (best_ && !best_->arm().parts.empty()) return finish(std::move(first));
    if (stopped || (best_ && best_->status != PlanStatus::kInfeasible)) {
      // Whether lift-offs suffice is not known.
      first.status = stopped_status(budget_);
      first.arm().runs.clear();
    }
    return first;
  }

 private:
  /// Lets a view live as long as the job to which it refers.
  void keep(const std::shared_ptr<Problem>& job) {
    if (view_ != nullptr)
      view_->owner =
          std::make_shared<std::pair<std::shared_ptr<Problem>, std::shared_ptr<const void>>>(
              job, view_->owner);
  }
  /// Finds the least number of lift-offs of each stroke that has no path by itself. Returns false,
  /// and says so in the result, where one cannot be done in any number of runs.
  bool find_cuts(Answer& first) {
    for (const RunAnswer& run : first.arm().runs) {
      if (run.status != PlanStatus::kInfeasible) continue;
      CutStroke& stroke = strokes_.emplace_back();
      stroke.search =
          std::make_unique<LiftSearch>(robot_, job_, run.run.stroke, distance_proofs_of(options_),
                                       options_.hooks.check, threads_for(options_), budget_);
      const std::optional<int> least = stroke.search->least();
      stroke.count = std::max(1, least.value_or(1));
      const auto places = least ? stroke.search->next(stroke.count) : std::nullopt;
      if (!places) {
        first.warnings.push_back("stroke '" + job_.arm().strokes[run.run.stroke].name +
                                 "': no number of lift-offs suffices: some place on it cannot be "
                                 "passed by any run");
        return false;
      }
      stroke.places = *places;
    }
    return !strokes_.empty();
  }

  [[nodiscard]] std::vector<LiftOff> lift_offs() const {
    std::vector<LiftOff> all;
    for (const CutStroke& stroke : strokes_)
      all.insert(all.end(), stroke.places.lift_offs.begin(), stroke.places.lift_offs.end());
    return all;
  }
  /// Plans the job with the places chosen now, and keeps it if it is the best so far.
  Answer evaluate() {
    const std::vector<LiftOff> places = lift_offs();
    const auto job = std::make_shared<Problem>(with_lift_offs(job_, places));
    ProblemView view;
    Answer found = plan_(*job, view_ == nullptr ? nullptr : &view);
    add_counters(found.arm().counters, counters_);
    const bool better =
        !best_ || (!found.arm().parts.empty() &&
                   (best_->arm().parts.empty() || found.lattice_cost < best_->lattice_cost));
    if (better) {
      best_ = found;
      best_lift_offs_ = places;
      if (view_ != nullptr) {
        std::swap(*view_, view);
        keep(job);
      }
    }
    return found;
  }

  /// Chooses the places of a stroke: plans the job with the cheapest ones, as long as others may be
  /// cheaper with their moves around obstacles.
  void choose(CutStroke& stroke) {
    const bool alone = job_.arm().strokes.size() == 1;
    std::optional<double> rest;  // cost of everything but the stroke, and home beside it
    std::optional<LiftSearch::Places> kept;
    double least = std::numeric_limits<double>::infinity();
    int failures = 0;
    for (int k = 0; k < kMostTries; ++k) {
      const Answer found = evaluate();
      std::vector<std::size_t> faults = faults_of(found, stroke);
      if (found.arm().parts.empty()) {
        ++failures;
      } else {
        const double cost = found.lattice_cost;
        if (!rest) rest = alone ? 0 : cost - stroke.places.cost - detours(found, stroke);
        if (cost < least) least = cost, kept = stroke.places;
        // A move that the places count on is barred, and another one took its place.
        constexpr double kRounding = 1e-9;
        if (faults.empty() && cost > (1 + kRounding) * (*rest + stroke.places.cost))
          faults = {dearest_lift_off(found)};
      }
      if (faults.empty() || found.status == PlanStatus::kTimeout ||
          found.status == PlanStatus::kCancelled)
        break;
      const int around = found.arm().parts.empty() ? (1 << std::min(failures - 1, 6)) - 1 : 0;
      for (const std::size_t fault : faults) stroke.search->leave_out(fault, around);
      const auto next = stroke.search->next(stroke.count);
      if (!next || (rest && *rest + next->cost >= least)) break;
      stroke.places = *next;
    }
    if (kept) stroke.places = *kept;
  }

  /// Returns the numbers of a stroke's lift-offs, from 0, beside which a run has no path or a
  /// transition has none or is a detour.
  [[nodiscard]] std::vector<std::size_t> faults_of(const Answer& found,
                                                   const CutStroke& stroke) const {
    std::set<std::size_t> faults;
    const Problem job = with_lift_offs(job_, lift_offs());
    const std::string& name = job_.arm().strokes[stroke.places.lift_offs.front().stroke].name;
    const auto count = static_cast<std::size_t>(stroke.count);
    // number of the run among those of this stroke
    const auto number = [&](std::size_t run) -> std::optional<std::size_t> {
      if (run >= job.arm().strokes.size() || !job.arm().strokes[run].piece ||
          job.arm().strokes[run].piece->stroke != name)
        return std::nullopt;
      std::size_t before = 0;
      while (before < run && job.arm().strokes[run - 1 - before].piece &&
             job.arm().strokes[run - 1 - before].piece->stroke == name)
        ++before;
      return before;
    };
    for (std::size_t run = 0; run < found.arm().runs.size(); ++run)
      if (const auto k = number(run);
          k && found.arm().runs[run].status == PlanStatus::kInfeasible) {
        if (*k > 0) faults.insert(*k - 1);
        if (*k < count) faults.insert(*k);
      }
    if (found.arm().no_transition)
      if (const auto k = number(found.arm().no_transition->to); k && *k > 0) faults.insert(*k - 1);
    for (std::size_t part = 1; part + 1 < found.arm().parts.size(); ++part) {
      if (found.arm().parts[part].run || found.arm().parts[part].rows.size() <= 2) continue;
      const auto k = number(found.arm().parts[part + 1].run->stroke);
      if (k && *k > 0) faults.insert(*k - 1);
    }
    return {faults.begin(), faults.end()};
  }
  /// Returns the number, from 0, of the lift-off whose move costs most.
  [[nodiscard]] static std::size_t dearest_lift_off(const Answer& found) {
    std::size_t dearest = 0, number = 0;
    double most = -1;
    const std::vector<Part>& parts = found.arm().parts;
    for (std::size_t k = 1; k + 1 < parts.size(); ++k) {
      if (parts[k].run) continue;
      if (parts[k].cost > most) most = parts[k].cost, dearest = number;
      ++number;
    }
    return dearest;
  }
  /// Returns by how much the transitions of a stroke's lift-offs are dearer than straight ones.
  [[nodiscard]] double detours(const Answer& found, const CutStroke& stroke) const {
    const Problem job = with_lift_offs(job_, lift_offs());
    const std::string& name = job_.arm().strokes[stroke.places.lift_offs.front().stroke].name;
    double sum = 0;
    for (std::size_t part = 1; part + 1 < found.arm().parts.size(); ++part) {
      if (found.arm().parts[part].run) continue;
      const auto &before = job.arm().strokes[found.arm().parts[part - 1].run->stroke].piece,
                 &after = job.arm().strokes[found.arm().parts[part + 1].run->stroke].piece;
      if (!before || !after || before->stroke != name || after->stroke != name) continue;
      const std::vector<TrajectoryRow>& rows = found.arm().parts[part].rows;
      sum += found.arm().parts[part].cost - stroke.search->distance(rows.front().q, rows.back().q);
    }
    return sum;
  }

  /// Returns the best job with what its lift-offs cost and why each is there.
  Answer finish(Answer first) {
    Answer found = std::move(*best_);
    const double cost = static_cast<double>(best_lift_offs_.size()) * job_.arm().lift->cost;
    found.cost += cost;
    found.lattice_cost += cost;
    found.bound += cost;
    found.bound_any += cost;
    found.bound_orders += cost;
    found.arm().counters = first.arm().counters;
    add_counters(counters_, found.arm().counters);
    if (const auto lift = first.time_ms.find("lift"); lift != first.time_ms.end())
      found.time_ms["lift"] = lift->second;
    for (std::size_t k = 0; k < best_lift_offs_.size(); ++k)
      found.arm().lift_offs.push_back(explained(k, first));
    return found;
  }
  /// Returns lift-off number k of the answer with what ends the run before it, were it longer.
  [[nodiscard]] LiftOffAnswer explained(std::size_t k, const Answer& first) const {
    LiftOffAnswer lift{best_lift_offs_[k], 0, {}};
    const bool first_of_stroke = k == 0 || best_lift_offs_[k - 1].stroke != lift.stroke;
    const double begin = first_of_stroke ? 0 : best_lift_offs_[k - 1].resumed;
    std::optional<Diagnosis> diagnosis;
    if (first_of_stroke) {
      for (const RunAnswer& run : first.arm().runs)
        if (run.run.stroke == lift.stroke) diagnosis = run.diagnosis;
    } else {
      diagnosis = diagnosis_after(k - 1);
    }
    for (const CutStroke& stroke : strokes_)
      if (stroke.places.lift_offs.front().stroke == lift.stroke)
        lift.reached = stroke.search->reach(begin);
    // The cause is that of this place only if the run by itself, whose nodes may differ, ends here.
    constexpr double kSamePlace = 1e-6;  // m
    if (!diagnosis || !diagnosis->reached_s) return lift;
    const double there =
        begin + *diagnosis->reached_s - job_.arm().strokes[lift.stroke].approach.norm();
    if (std::abs(there - lift.reached) <= kSamePlace) lift.cause = diagnosis->cause;
    return lift;
  }
  /// Returns what ends every run that begins at lift-off number k and goes on to the stroke's end.
  [[nodiscard]] std::optional<Diagnosis> diagnosis_after(std::size_t k) const {
    const LiftOff& begin = best_lift_offs_[k];
    const Problem job = with_lift_offs(job_, {begin});
    PlanOptions alone = options_;
    alone.check = false;
    Planner planner(std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &robot_),
                    problem_of_run(job, {begin.stroke + 1, false}));
    const PlanResult found = planner.plan(alone);
    if (found.status != PlanStatus::kInfeasible) return std::nullopt;
    return found.diagnosis;
  }

  const PreparedRobot& robot_;
  const Problem& job_;
  const PlanOptions& options_;
  const Budget& budget_;
  ProblemView* view_;
  const std::function<Answer(const Problem&, ProblemView*)>& plan_;
  std::shared_ptr<Problem> uncut_;
  std::vector<CutStroke> strokes_;
  std::optional<Answer> best_;
  std::vector<LiftOff> best_lift_offs_;
  Counters counters_;  // of all jobs with lift-offs
};

}  // namespace

Answer plan_with_lift_offs(const PreparedRobot& robot, const Problem& job,
                           const PlanOptions& options, const Budget& budget, ProblemView* view,
                           const std::function<Answer(const Problem&, ProblemView*)>& plan) {
  if (!job.arm().lift) return plan(job, view);
  return LiftPlan(robot, job, options, budget, view, plan).run();
}

}  // namespace swivel
