// SPDX-License-Identifier: BSD-3-Clause
// Maps and pages of plans. A plan keeps its problem, not its lattice, so it is planned again.
#include <algorithm>

#include "bindings.hpp"
#include "interruptible.hpp"
#include "results.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "swivel/report/page.hpp"
#include "swivel/report/workcell_page.hpp"
#include "workcells/workcell_plan.hpp"

namespace swivel::python {

namespace {

/// What is drawn of a plan.
struct Drawing {
  std::string map;   ///< SVG
  std::string page;  ///< HTML; empty if it was not asked for
};

/// Returns the problem that a plan is of, as it was planned: `given`, or the one that the plan
/// keeps. Throws ValueError if there is none, and for plans that functions of Python decided.
PathProblem problem_of(const Plan& plan, const Problem* given) {
  if (plan.own_functions)
    throw py::value_error(
        "the plan depends on check, check_motions or cost: allowed are plans of the problem alone");
  if (given == nullptr && !plan.problem)
    throw py::value_error(
        "problem: a plan that was unpickled has none: allowed is the problem that was planned");
  PathProblem problem = given != nullptr ? path_of(*given, "problem") : *plan.problem;
  if (plan.timing)
    problem = with_motion_defaults(std::move(problem));
  else if (plan.refined)
    keep_clearance_between_layers(problem.limits);
  return problem;
}

bool same_rows(const std::vector<TrajectoryRow>& a, const std::vector<TrajectoryRow>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const TrajectoryRow& x, const TrajectoryRow& y) {
                      return x.s == y.s && x.phi == y.phi && x.branch == y.branch && x.q == y.q &&
                             x.roll == y.roll;
                    });
}

/// Returns the page of a plan that a planner has just found.
std::string page_of(const PlanView& view, const LatticeMap& map, const MotionPlan& plan,
                    const std::optional<TimingOptions>& timing, const Budget& budget) {
  PageMotion motion;
  if (plan.refinement && plan.refinement->refined) motion.refined = &plan.result.trajectory;
  if (plan.motion && plan.motion->motion) motion.motion = &*plan.motion->motion;
  const io::VisualRobot visual = io::load_visuals(*view.problem.model);
  return to_page(view, map, io::to_json(answer_of(plan, timing), one_path(view.problem)), motion,
                 budget, {"", answer_text(plan.result), visual.model.get(), visual.left_out});
}

/// Plans again what a plan is of, and draws it. `full`: the clearance of every node is asked.
/// Throws ValueError for plans without a verdict, and if another path is found.
Drawing draw(const Plan& plan, const Problem* given, bool with_page, bool full) {
  if (with_page) require_pages();
  const PlanStatus status = plan.result().status;
  if (status != PlanStatus::kSolved && status != PlanStatus::kInfeasible)
    throw py::value_error("the plan has no verdict: allowed are those that were not stopped");
  const PathProblem problem = problem_of(plan, given);
  PlanOptions options;
  for (const auto& [name, kind] : EnumNames<PlannerKind>::names)
    if (name == plan.result().planner) options.planner = kind;
  options.check = true;
  if (with_page) options.evidence = Evidence::all();
  return interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    Planner planner(problem);
    const MotionPlan again = plan_motion(planner, options, plan.refined, plan.timing);
    if (again.result.status != status ||
        !same_rows(again.result.trajectory, plan.result().trajectory))
      throw py::value_error("problem: has another answer than the plan: allowed is its own");
    const Budget budget({}, nullptr, stop);
    const PlanView view = planner.view();
    const LatticeMap map = make_map(view, full, budget);
    Drawing drawing{to_svg(map), ""};
    if (with_page) drawing.page = page_of(view, map, again, plan.timing, budget);
    return drawing;
  });
}

/// Returns true if two plans have the same rows of both arms.
bool same_rows(const Answer& a, const Answer& b) {
  return same_rows(a.arms[0].rows(), b.arms[0].rows()) &&
         same_rows(a.arms[1].rows(), b.arms[1].rows());
}

/// Plans a workcell again and returns its page. Throws ValueError for plans without a verdict, and
/// if another plan is found.
std::string page_of(const WorkcellPlan& plan, const Problem* given) {
  require_pages();
  const Answer& known = *plan.plan;
  if ((known.status != PlanStatus::kSolved && known.status != PlanStatus::kInfeasible) ||
      plan.plan->stopped)
    throw py::value_error("the plan was stopped: allowed are plans that were not");
  PlanOptions options;
  for (const auto& [name, kind] : EnumNames<PlannerKind>::names)
    if (name == known.planner) options.planner = kind;
  options.check = true;
  options.evidence = Evidence::all();
  return interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    const Budget budget({}, nullptr, stop);
    const swivel::Problem cell = completed(plan, given);
    const PreparedWorkcell prepared(cell, budget);
    ProblemView view;
    const Answer again = plan_workcell_motion(prepared, options, plan.refined, plan.timing, &view);
    if (again.status != known.status || !same_rows(again, known))
      throw py::value_error("workcell: has another answer than the plan: allowed is its own");
    const io::VisualRobot visual = io::load_visuals(*cell.arms[0].model);
    return to_workcell_page({prepared, cell, again, view, again.timed()}, io::to_json(again, cell),
                            budget,
                            {"", answer_text(again, cell), visual.model.get(), visual.left_out});
  });
}

}  // namespace

void require_pages() {
  if (!page_available())
    throw py::value_error(
        "report: the package was built without pages, since node, npm or their network was "
        "missing: allowed is one that was built with them, see docs/guide/python.md");
}

void bind_drawings(py::module_& m) {
  m.def(
      "_draw_workcell",
      [](const WorkcellPlan& plan, const Problem* workcell) { return page_of(plan, workcell); },
      py::arg("plan"), py::arg("workcell"),
      "The page of a workcell's plan as HTML; used by the package's report().");
  m.def("_page_available", &page_available);
  m.def(
      "_draw",
      [](const Plan& plan, const Problem* problem, bool page, bool full) {
        const Drawing drawing = draw(plan, problem, page, full);
        return py::make_tuple(drawing.map, drawing.page);
      },
      py::arg("plan"), py::arg("problem"), py::arg("page"), py::arg("full"),
      "(map as SVG, page as HTML or '') of a plan; used by the package's map_svg() and report().");
}

}  // namespace swivel::python
