// SPDX-License-Identifier: BSD-3-Clause
// Pages of jobs, and certificates that a stroke has no path. A plan keeps its job, not its
// lattices, so the job is planned again.
#include <algorithm>

#include "interruptible.hpp"
#include "job_results.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/motion/job_text.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/report/job_page.hpp"

namespace swivel::python {

namespace {

/// Returns the job that a plan is of as it was planned: `given`, or the one that the plan keeps.
/// Throws ValueError if there is none, and for plans without a verdict.
swivel::Problem completed(const JobPlan& plan, const Problem* given) {
  const PlanStatus status = plan.result().status;
  if ((status != PlanStatus::kSolved && status != PlanStatus::kInfeasible) || plan.plan->stopped)
    throw py::value_error("the plan was stopped: allowed are plans that were not");
  if (given == nullptr && !plan.given)
    throw py::value_error(
        "job: a plan that was unpickled has none: allowed is the job that was planned");
  swivel::Problem job = given != nullptr ? to_core(*given) : *plan.given;
  return plan.timing ? with_motion_defaults(std::move(job)) : job;
}

bool same_parts(const Answer& a, const Answer& b) {
  const auto same_rows = [](const TrajectoryRow& x, const TrajectoryRow& y) {
    return x.s == y.s && x.q == y.q;
  };
  return a.status == b.status &&
         std::equal(a.arm().parts.begin(), a.arm().parts.end(), b.arm().parts.begin(),
                    b.arm().parts.end(), [&](const swivel::Part& x, const swivel::Part& y) {
                      return x.run == y.run && std::equal(x.rows.begin(), x.rows.end(),
                                                          y.rows.begin(), y.rows.end(), same_rows);
                    });
}

/// Plans a job again, and fills `view`. Throws ValueError if another answer is found, and Stopped.
Answer planned_again(const JobPlan& plan, const PreparedRobot& robot, const swivel::Problem& job,
                     PlanOptions options, ProblemView& view) {
  for (const auto& [name, kind] : EnumNames<PlannerKind>::names)
    if (name == plan.result().planner) options.planner = kind;
  options.check = true;
  Answer again = plan.timing ? plan_job_motion(robot, job, options, *plan.timing, &view)
                             : swivel::plan_job(robot, job, options, &view);
  if (again.status != PlanStatus::kSolved && again.status != PlanStatus::kInfeasible)
    throw Stopped();
  if (!same_parts(again, plan.result()))
    throw py::value_error("job: has another answer than the plan: allowed is its own");
  return again;
}

/// Returns the page of a job's plan.
std::string page_of(const JobPlan& plan, const Problem* given) {
  require_pages();
  const swivel::Problem job = completed(plan, given);
  return interruptible([&](const std::stop_token& stop) {
    const Budget budget({}, nullptr, stop);
    PlanOptions options;
    options.stop = stop;
    options.evidence = Evidence::all();
    const PreparedRobot robot(problem_of_run(job, {0, false}), budget);
    ProblemView view;
    const Answer again = planned_again(plan, robot, job, options, view);
    const swivel::Problem executed = executed_problem(job, again);
    std::string text = answer_text(again, executed);
    if (again.motion) text += swivel::job_motion_text(*again.motion, again.arm().parts, executed);
    const io::VisualRobot visual = io::load_visuals(*job.arm().model);
    const swivel::Motion* const motion = again.timed();
    return to_job_page(
        {robot, executed, again, view, motion != nullptr ? &motion->arms.front() : nullptr},
        io::to_json(again, executed), budget, {"", text, visual.model.get(), visual.left_out});
  });
}

/// Returns the certificate that the first stroke without a path has none. Throws ValueError where
/// each has one, and for plans with a motion, TimeoutError.
InfeasibilityCertificate proof_of(const JobPlan& plan, const Problem* given,
                                  std::optional<double> timeout) {
  if (plan.timing)
    throw py::value_error(
        "a certificate is of the job as it is: allowed is a plan without speed, turn_speed and "
        "rate");
  const swivel::Problem job = completed(plan, given);
  const std::vector<RunAnswer>& runs = plan.result().arm().runs;
  const auto run = std::find_if(runs.begin(), runs.end(), [](const RunAnswer& one) {
    return one.status == PlanStatus::kInfeasible;
  });
  if (run == runs.end())
    throw py::value_error(
        "no stroke is known to have no path by itself: allowed is a plan with such a stroke");
  if (job.arm().strokes[run->run.stroke].reversible)
    throw py::value_error("stroke '" + job.arm().strokes[run->run.stroke].name +
                          "' is reversible, and a certificate is of one direction: allowed are "
                          "strokes that are not reversible");
  return interruptible([&](const std::stop_token& stop) {
    const Budget budget(timeout, nullptr, stop);
    PlanOptions options;
    options.stop = stop;
    options.timeout_s = timeout;
    const PreparedRobot robot(problem_of_run(job, {0, false}), budget);
    ProblemView view;
    static_cast<void>(planned_again(plan, robot, job, options, view));
    InfeasibilityCertificate proof =
        prove_infeasible(view.runs.at(static_cast<std::size_t>(run - runs.begin())), budget);
    proof.stroke = job.arm().strokes[run->run.stroke].name;
    proof.reversed = run->run.reversed;
    return proof;
  });
}

}  // namespace

void bind_job_drawings(py::module_& m) {
  m.def("_draw_job", &page_of, py::arg("plan"), py::arg("job"),
        "The page of a job's plan as HTML; used by the package's report().");
  m.def("_job_certificate", &proof_of, py::arg("plan"), py::arg("job"), py::arg("timeout"),
        "Used by the package's JobPlan.certificate().");
}

}  // namespace swivel::python
