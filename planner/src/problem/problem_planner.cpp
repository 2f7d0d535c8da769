// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/problem/problem_planner.hpp"

#include <algorithm>
#include <utility>

#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"

namespace swivel {

namespace {

Problem completed(Problem problem, const MotionRequest& asked) {
  if (asked.timing) return with_motion_defaults(std::move(problem));
  if (asked.refine)
    for (ArmTask& arm : problem.arms)
      for (Stroke& stroke : arm.strokes) keep_clearance_between_layers(stroke.limits);
  return problem;
}

}  // namespace

struct ProblemPlanner::Impl {
  Problem problem;
  MotionRequest asked;
  ProblemView view;

  Impl(Problem p, MotionRequest a) : problem(completed(std::move(p), a)), asked(std::move(a)) {}
  virtual ~Impl() = default;
  /// Replaces the problem by one of the same kind, already completed. Returns false, and changes
  /// nothing, where nothing of this planner serves it.
  virtual bool take(Problem& next, const Budget& budget) = 0;
  virtual Answer plan(const PlanOptions& options, bool keeps_view) = 0;
  [[nodiscard]] virtual AdviceList advise(const Answer& answer,
                                          const PlanOptions& options) const = 0;
  [[nodiscard]] virtual std::optional<AnyCertificate> prove(Answer& answer,
                                                            const Budget& budget) const = 0;
  [[nodiscard]] virtual const PreparedRobot& robot() const = 0;
};

/// Plans one path.
struct ProblemPlanner::OfPath : Impl {
  Planner planner;

  OfPath(Problem p, MotionRequest a)
      : Impl(std::move(p), std::move(a)), planner(problem_of_run(problem, {0, false})) {}

  bool take(Problem& next, const Budget& budget) override {
    if (!is_path(next)) return false;
    PathProblem path = problem_of_run(next, {0, false});
    if (planner.prepare(budget).difference_from(path) != nullptr) return false;
    planner.set_problem(std::move(path));
    return true;
  }
  Answer plan(const PlanOptions& options, bool keeps_view) override {
    view = {};
    Answer answer =
        answer_of(plan_motion(planner, options, asked.refine, asked.timing), asked.timing);
    const bool decided =
        answer.status == PlanStatus::kSolved || answer.status == PlanStatus::kInfeasible;
    if (keeps_view && decided) view.runs.push_back(planner.view());
    return answer;
  }
  [[nodiscard]] AdviceList advise(const Answer& answer, const PlanOptions& options) const override {
    return {swivel::advise(planner, answer.arm().run(), options), {}};
  }
  [[nodiscard]] std::optional<AnyCertificate> prove(Answer& /*answer*/,
                                                    const Budget& budget) const override {
    return swivel::prove_infeasible(planner.view(), budget);
  }
  [[nodiscard]] const PreparedRobot& robot() const override { return planner.view().robot; }
};

/// Plans the strokes of one arm.
struct ProblemPlanner::OfStrokes : Impl {
  PreparedRobot prepared;

  OfStrokes(Problem p, MotionRequest a, const Budget& budget)
      : Impl(std::move(p), std::move(a)), prepared(problem_of_run(problem, {0, false}), budget) {}

  bool take(Problem& next, const Budget& /*budget*/) override {
    if (next.arms.size() != 1 || is_path(next)) return false;
    validate(next);
    return prepared.difference_from(next.arm()) == nullptr;
  }
  Answer plan(const PlanOptions& options, bool keeps_view) override {
    view = {};
    ProblemView* const kept = keeps_view ? &view : nullptr;
    return plan_job_motion(prepared, problem, options, asked.refine, asked.timing, kept);
  }
  [[nodiscard]] AdviceList advise(const Answer& answer, const PlanOptions& options) const override {
    return advise_job(prepared, problem, answer, options);
  }
  [[nodiscard]] std::optional<AnyCertificate> prove(Answer& answer,
                                                    const Budget& budget) const override {
    const std::vector<RunAnswer>& runs = answer.arm().runs;
    const auto run = std::find_if(runs.begin(), runs.end(), [](const RunAnswer& one) {
      return one.status == PlanStatus::kInfeasible;
    });
    if (run == runs.end()) {
      answer.warnings.emplace_back(runs.empty()  // where home is barred
                                       ? "no stroke was planned by itself: there is no certificate"
                                       : "each stroke has a path by itself: there is no "
                                         "certificate");
      return std::nullopt;
    }
    const Stroke& stroke = problem.arm().strokes[run->run.stroke];
    if (stroke.reversible) {
      answer.warnings.push_back("stroke '" + stroke.name +
                                "' is reversible, and a certificate is of one direction: there is "
                                "none; allowed are strokes that are not reversible");
      return std::nullopt;
    }
    const auto index = static_cast<std::size_t>(run - runs.begin());
    InfeasibilityCertificate proof = swivel::prove_infeasible(view.runs.at(index), budget);
    proof.stroke = stroke.name;
    proof.reversed = run->run.reversed;
    return proof;
  }
  [[nodiscard]] const PreparedRobot& robot() const override { return prepared; }
};

/// Plans two arms.
struct ProblemPlanner::OfTwoArms : Impl {
  PreparedWorkcell prepared;

  OfTwoArms(Problem p, MotionRequest a, const Budget& budget)
      : Impl(std::move(p), std::move(a)), prepared(problem, budget) {}

  bool take(Problem& next, const Budget& budget) override {
    if (next.arms.size() != 2) return false;
    PreparedWorkcell made(prepared, next, budget);
    view = {};  // refers to what was prepared before
    prepared = std::move(made);
    return true;
  }
  Answer plan(const PlanOptions& options, bool keeps_view) override {
    view = {};
    return plan_workcell_motion(prepared, options, asked.refine, asked.timing,
                                keeps_view ? &view : nullptr);
  }
  [[nodiscard]] AdviceList advise(const Answer& answer, const PlanOptions& options) const override {
    return advise_workcell(problem, answer, options);
  }
  [[nodiscard]] std::optional<AnyCertificate> prove(Answer& /*answer*/,
                                                    const Budget& budget) const override {
    return swivel::prove_infeasible(prepared, budget);
  }
  [[nodiscard]] const PreparedRobot& robot() const override { return prepared.robot(0); }
};

void ProblemPlanner::set_problem(Problem problem, const Budget& budget) {
  set_problem(std::move(problem), impl_->asked, budget);
}
void ProblemPlanner::set_problem(Problem problem, MotionRequest asked, const Budget& budget) {
  Problem next = completed(problem, asked);
  if (!impl_->take(next, budget)) {
    *this = ProblemPlanner(std::move(problem), std::move(asked), budget);
    return;
  }
  impl_->view = {};
  impl_->problem = std::move(next);
  impl_->asked = std::move(asked);
}

ProblemPlanner::ProblemPlanner(Problem problem, MotionRequest asked, const Budget& budget) {
  if (problem.arms.size() == 2)
    impl_ = std::make_unique<OfTwoArms>(std::move(problem), std::move(asked), budget);
  else if (is_path(problem))
    impl_ = std::make_unique<OfPath>(std::move(problem), std::move(asked));
  else
    impl_ = std::make_unique<OfStrokes>(std::move(problem), std::move(asked), budget);
}
ProblemPlanner::~ProblemPlanner() = default;
ProblemPlanner::ProblemPlanner(ProblemPlanner&&) noexcept = default;
ProblemPlanner& ProblemPlanner::operator=(ProblemPlanner&&) noexcept = default;

const Problem& ProblemPlanner::problem() const {
  return impl_->problem;
}
Answer ProblemPlanner::plan(const PlanOptions& options, bool keeps_view) {
  return impl_->plan(options, keeps_view);
}
const ProblemView& ProblemPlanner::view() const {
  return impl_->view;
}
AdviceList ProblemPlanner::advise(const Answer& answer, const PlanOptions& options) const {
  return impl_->advise(answer, options);
}
std::optional<AnyCertificate> ProblemPlanner::prove_infeasible(Answer& answer,
                                                               const Budget& budget) const {
  return impl_->prove(answer, budget);
}
const PreparedRobot& ProblemPlanner::robot() const {
  return impl_->robot();
}
const PreparedWorkcell& ProblemPlanner::two_arms() const {
  return dynamic_cast<const OfTwoArms&>(*impl_).prepared;
}

}  // namespace swivel
