// SPDX-License-Identifier: BSD-3-Clause
// Maps and pages of answers. An answer keeps its problem, not its lattices, so it is planned again.
#include <algorithm>

#include "answers/answer.hpp"
#include "base/interruptible.hpp"
#include "problems/problem.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/page.hpp"

namespace swivel::python {

namespace {

/// Returns true if two answers say that arms do the same.
bool same_parts(const swivel::Answer& a, const swivel::Answer& b) {
  const auto same_row = [](const TrajectoryRow& x, const TrajectoryRow& y) {
    return x.s == y.s && x.phi == y.phi && x.branch == y.branch && x.q == y.q && x.roll == y.roll;
  };
  const auto same_part = [&](const swivel::Part& x, const swivel::Part& y) {
    return x.run == y.run &&
           std::equal(x.rows.begin(), x.rows.end(), y.rows.begin(), y.rows.end(), same_row);
  };
  return a.status == b.status &&
         std::equal(a.arms.begin(), a.arms.end(), b.arms.begin(), b.arms.end(),
                    [&](const ArmAnswer& x, const ArmAnswer& y) {
                      return std::equal(x.parts.begin(), x.parts.end(), y.parts.begin(),
                                        y.parts.end(), same_part);
                    });
}

/// Throws ValueError for answers that planning again would not give.
void require_drawable(const Answer& answer) {
  const PlanStatus status = answer.found->status;
  if ((status != PlanStatus::kSolved && status != PlanStatus::kInfeasible) || answer.found->stopped)
    throw py::value_error("the answer has no verdict: allowed are those that were not stopped");
  if (answer.own_functions)
    throw py::value_error(
        "the answer depends on check, check_motions or cost: allowed are those to the problem "
        "alone");
}

/// Plans again what an answer is of, and draws it: the maps of its runs as SVG, and with
/// `with_page` the page. `full`: the clearance of every node is asked. Throws ValueError for
/// answers without a verdict, and if another answer is found.
std::pair<std::string, std::string> draw(const Answer& answer, const Problem* given, bool with_page,
                                         bool full) {
  if (with_page) require_pages();
  require_drawable(answer);
  if (given == nullptr && !answer.given)
    throw py::value_error(
        "problem: an answer that was unpickled has none: allowed is the problem that was planned");
  const swivel::Problem problem = given != nullptr ? to_core(*given) : *answer.given;
  PlanOptions options;
  options.planner = to_enum<PlannerKind>(py::str(answer.found->planner));
  options.check = true;
  if (with_page) options.evidence = Evidence::all();
  return interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    const Budget budget({}, nullptr, stop);
    ProblemPlanner planner(problem, answer.asked, budget);
    const swivel::Answer again = planner.plan(options, true);
    if (!same_parts(again, *answer.found))
      throw py::value_error("problem: has another answer than this one: allowed is its own");
    const swivel::Problem executed = executed_problem(planner.problem(), again);
    if (planner.view().runs.empty() && (!with_page || executed.arms.size() == 2))
      throw py::value_error("the answer has nothing to draw: no lattice was searched");
    const std::vector<RunMap> maps = make_maps(planner.view(), again, executed, full, budget);
    std::pair<std::string, std::string> drawn{maps.empty() ? "" : to_svg(maps), ""};
    if (!with_page) return drawn;
    const io::VisualRobot visual = io::load_visuals(*problem.arm().model);
    drawn.second = to_page(planner, again, io::to_json(again, executed), maps, budget,
                           {"", whole_text(again, executed), visual.model.get(), visual.left_out});
    return drawn;
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
  m.def("_page_available", &page_available);
  m.def("_draw", &draw, py::arg("answer"), py::arg("problem"), py::arg("page"), py::arg("full"),
        "(maps of the runs as SVG, page as HTML or '') of an answer.");
}

}  // namespace swivel::python
