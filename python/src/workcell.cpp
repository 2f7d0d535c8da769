// SPDX-License-Identifier: BSD-3-Clause
// Workcells: two arms that work at one time.
#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>

#include "interruptible.hpp"
#include "plan_keywords.hpp"
#include "results.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/workcell.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel::python {

namespace {

/// A workcell as Python holds it. It does not change.
struct Workcell {
  std::shared_ptr<const swivel::Workcell> cell;  // shared with plans
};

struct WorkcellPlan {
  std::shared_ptr<const WorkcellResult> result;  // shared with trajectories
};

struct WorkcellCheck {
  WorkcellCheckResult result;
};

using WorkcellOrFile = std::variant<const Workcell*, std::filesystem::path>;

std::shared_ptr<const swivel::Workcell> to_core(const WorkcellOrFile& cell) {
  if (const auto* made = std::get_if<const Workcell*>(&cell)) return (*made)->cell;
  return std::make_shared<const swivel::Workcell>(
      io::load_workcell(std::get<std::filesystem::path>(cell)));
}

/// Returns true if two scenes have objects of the same names at the same places.
bool same_places(const std::vector<SceneObject>& a, const std::vector<SceneObject>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SceneObject& x, const SceneObject& y) {
                      return x.name == y.name && x.pose.matrix() == y.pose.matrix();
                    });
}

/// Gives an arm the rows of a motion; limits, resolution and cost are those of `like`. Throws
/// ValueError for rows of other joints.
void give(WorkcellArm& arm, const Robot& robot, const Trajectory& motion, const Task& like) {
  static_cast<Robot&>(arm) = robot;
  const auto names =
      build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll)
          .chain.joint_names;
  if (!std::equal(names.begin(), names.end(), motion.joint_names.begin(), motion.joint_names.end()))
    throw py::value_error("arms: the trajectory of '" + arm.name +
                          "' has other joints than its robot: allowed are rows of this robot");
  arm.limits = like.limits;
  arm.resolution = like.resolution;
  arm.cost = like.cost;
  for (const TrajectoryRow& row : *motion.rows) arm.given.push_back(row.q);
}

/// Returns the steps between rows at which waypoints are. Throws ValueError unless they ascend
/// from 0.
std::vector<int> steps_of(const std::vector<int>& at_rows) {
  std::vector<int> steps;
  for (std::size_t k = 1; k < at_rows.size(); ++k) steps.push_back(at_rows[k] - at_rows[k - 1]);
  if (at_rows.front() != 0 || std::any_of(steps.begin(), steps.end(), [](int n) { return n < 1; }))
    throw py::value_error("at_rows: allowed are ascending rows from 0");
  return steps;
}

/// Makes a workcell of two arms, whose scene is that of the first that has a problem.
Workcell make_workcell(const py::dict& arms, const std::vector<std::array<std::string, 2>>& touch,
                       const std::vector<int>& at_rows) {
  if (arms.size() != 2)
    throw py::value_error("arms: has " + std::to_string(arms.size()) +
                          " entries: allowed are two, name -> Problem");
  auto cell = std::make_shared<swivel::Workcell>();
  std::size_t k = 0;
  const Problem* first_problem = nullptr;
  for (const auto& [name, value] : arms) {
    WorkcellArm& arm = cell->arms[k++];
    arm.name = py::str(name);
    if (py::isinstance<py::tuple>(value)) continue;  // its motion is given
    const auto& problem = value.cast<const Problem&>();
    static_cast<Robot&>(arm) = problem;
    static_cast<Task&>(arm) = problem;
    if (!at_rows.empty()) arm.steps = steps_of(at_rows);
    if (first_problem == nullptr) {
      first_problem = &problem;
      cell->scene = problem.scene;
      cell->vary = problem.vary;
      cell->source = problem.source;
    } else if (!problem.scene.empty() && !same_places(problem.scene, cell->scene)) {
      throw py::value_error(
          "arms: have different scenes: allowed is one scene, or none of the "
          "second arm");
    }
  }
  if (first_problem == nullptr)
    throw py::value_error("arms: both motions are given: allowed is one Problem at least");
  k = 0;
  for (const auto& [name, value] : arms) {
    WorkcellArm& arm = cell->arms[k++];
    if (!py::isinstance<py::tuple>(value)) continue;
    const auto& [robot, motion] = value.cast<std::pair<const Robot*, const Trajectory*>>();
    give(arm, *robot, *motion, *first_problem);
  }
  // Two Robots of Python that were loaded from one file have a model each.
  const RobotModel &first = *cell->arms[0].model, &second = *cell->arms[1].model;
  if (first.source == second.source && first.links.size() == second.links.size() &&
      first.joints.size() == second.joints.size())
    cell->arms[1].model = cell->arms[0].model;
  cell->may_touch = touch;
  validate(*cell);
  return {std::move(cell)};
}

/// Returns the number of an arm. Throws KeyError for an unknown name.
std::size_t number_of(const std::array<std::string, 2>& names, const std::string& name) {
  for (std::size_t k = 0; k < 2; ++k)
    if (names[k] == name) return k;
  throw py::key_error("'" + name + "': allowed are '" + names[0] + "' and '" + names[1] + "'");
}

std::array<std::string, 2> names_of(const swivel::Workcell& cell) {
  return {cell.arms[0].name, cell.arms[1].name};
}

Trajectory trajectory_of(const WorkcellPlan& plan, std::size_t arm) {
  const PlanResult& result = plan.result->arms[arm];
  return {std::shared_ptr<const std::vector<TrajectoryRow>>(plan.result, &result.trajectory),
          result.joint_names};
}

WorkcellPlan plan(const WorkcellOrFile& of, PlanOptions options) {
  const auto cell = to_core(of);
  return {std::make_shared<const WorkcellResult>(interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    const PreparedWorkcell prepared(*cell, Budget({}, nullptr, stop));
    return plan_workcell(prepared, options);
  }))};
}

using Checked = std::variant<WorkcellPlan, py::dict, std::filesystem::path>;
WorkcellCheck check(const WorkcellOrFile& of, const Checked& rows) {
  const auto cell = to_core(of);
  const auto names = names_of(*cell);
  std::array<std::vector<TrajectoryRow>, 2> given;
  if (const auto* dict = std::get_if<py::dict>(&rows))
    for (std::size_t k = 0; k < 2; ++k) {
      if (!dict->contains(names[k])) throw py::key_error("'" + names[k] + "': is missing");
      given[k] = *(*dict)[names[k].c_str()].cast<const Trajectory&>().rows;
    }
  if (const auto* made = std::get_if<WorkcellPlan>(&rows))
    for (std::size_t k = 0; k < 2; ++k) given[k] = made->result->arms[k].trajectory;
  const auto* file = std::get_if<std::filesystem::path>(&rows);
  return interruptible([&](const std::stop_token& stop) -> WorkcellCheck {
    CheckOptions options;
    options.budget = Budget({}, nullptr, stop);
    const PreparedWorkcell prepared(*cell, options.budget);
    if (file != nullptr)
      given = io::load_workcell_csv(
          *file, names,
          {prepared.robot(0).arm().chain.joint_names, prepared.robot(1).arm().chain.joint_names});
    return {check_workcell(prepared, given, options)};
  });
}

void bind_cell(py::module_& m) {
  py::class_<Workcell>(m, "Workcell", "Two arms of one robot that work at one time.")
      .def(
          py::init(&make_workcell), py::arg("arms"), py::kw_only(),
          py::arg("may_touch") = std::vector<std::array<std::string, 2>>(),
          py::arg("at_rows") = std::vector<int>(),
          "arms: two entries, name -> Problem, of one robot model with one base link and one "
          "`hold`; the `frame` of one path may be the name of the other arm, which leads then. The "
          "scene is that of the first. One entry may be (Robot, Trajectory) instead: an arm whose "
          "motion is given, with limits, resolution and cost of the other. at_rows: the row of "
          "that "
          "motion at which each waypoint of the other arm is; empty: there is one for each row, or "
          "two. may_touch: pairs of bodies, one of either arm, that may touch. Raises "
          "InvalidArgument.")
      .def_property_readonly(
          "names", [](const Workcell& w) { return names_of(*w.cell); }, "Names of both arms.")
      .def_property_readonly("source", [](const Workcell& w) { return w.cell->source; })
      .def("__repr__", [](const Workcell& w) {
        const std::size_t of = w.cell->given_arm() == 0u ? 1 : 0;
        return formatted("<Workcell of '%s' and '%s', %zu waypoints>", w.cell->arms[0].name.c_str(),
                         w.cell->arms[1].name.c_str(), w.cell->arms[of].waypoints.size());
      });
  m.def(
      "load_workcell",
      [](const std::filesystem::path& file) {
        return Workcell{std::make_shared<const swivel::Workcell>(io::load_workcell(file))};
      },
      py::arg("file"), "A problem file with `arms`, docs/formats.md. Raises InputError.");
}

void bind_plan(py::module_& m) {
  py::class_<WorkcellPlan>(m, "WorkcellPlan",
                           "What was planned for two arms. None: does not apply.")
      .def_property_readonly("status", [](const WorkcellPlan& p) { return p.result->status; })
      .def_property_readonly(
          "solved", [](const WorkcellPlan& p) { return p.result->status == PlanStatus::kSolved; })
      .def_property_readonly("names", [](const WorkcellPlan& p) { return p.result->names; })
      .def_property_readonly(
          "given",
          [](const WorkcellPlan& p) -> std::optional<std::string> {
            if (!p.result->given_arm) return {};
            return p.result->names[*p.result->given_arm];
          },
          "Name of the arm whose motion was given.")
      .def_property_readonly(
          "cost", [](const WorkcellPlan& p) { return p.result->cost; }, "Of both paths together.")
      .def_property_readonly(
          "bound", [](const WorkcellPlan& p) { return p.result->bound; },
          "No two paths without conflict cost less; inf: there are none.")
      .def_property_readonly(
          "least_costs", [](const WorkcellPlan& p) { return p.result->least_costs; },
          "Of the arms by themselves; inf: it has no path.")
      .def_property_readonly(
          "decided_by", [](const WorkcellPlan& p) { return to_string(p.result->decided_by); },
          "'arms alone', 'regions', 'pairs of nodes', or 'none' where time was up.")
      .def_property_readonly(
          "trajectories",
          [](const WorkcellPlan& p) {
            py::dict all;
            if (!p.result->arms[0].trajectory.empty())
              for (std::size_t k = 0; k < 2; ++k)
                all[p.result->names[k].c_str()] = py::cast(trajectory_of(p, k));
            return all;
          },
          "Name of the arm -> Trajectory; rows of one number are simultaneous. Empty: no plan.")
      .def_property_readonly(
          "conflict",
          [](const WorkcellPlan& p) -> std::optional<std::array<std::string, 2>> {
            if (!p.result->conflict) return {};
            return p.result->conflict->bodies;
          },
          "Two bodies that meet on the cheapest paths, where each arm has a path and both together "
          "have none.")
      .def(
          "diagnosis",
          [](const WorkcellPlan& p, const std::string& arm) -> std::optional<Diagnosis> {
            const std::size_t k = number_of(p.result->names, arm);
            if (p.result->status != PlanStatus::kInfeasible ||
                std::isfinite(p.result->least_costs[k]))
              return {};
            return p.result->arms[k].diagnosis;
          },
          py::arg("arm"), "Why this arm has no path by itself.")
      .def_property_readonly(
          "clearance",
          [](const WorkcellPlan& p) -> std::optional<double> {
            if (!p.result->between_arms) return {};
            return p.result->between_arms->clearance;
          },
          "Between bodies of both arms at rows, m, with evidence=True.")
      .def_property_readonly("time_ms", [](const WorkcellPlan& p) { return p.result->time_ms; })
      .def_property_readonly("warnings", [](const WorkcellPlan& p) { return p.result->warnings; })
      .def(
          "to_json", [](const WorkcellPlan& p) { return io::to_workcell_json(*p.result); },
          "As `swivel plan --json` writes it.")
      .def(
          "save",
          [](const WorkcellPlan& p, const std::filesystem::path& file) {
            if (p.result->arms[0].trajectory.empty()) throw py::value_error("there is no plan");
            io::write_file(file, io::to_workcell_csv(*p.result));
          },
          py::arg("file"), "The trajectories of both arms as CSV, docs/formats.md.")
      .def("__repr__", [](const WorkcellPlan& p) {
        return p.result->arms[0].trajectory.empty()
                   ? std::string("<WorkcellPlan ") + to_string(p.result->status) + ">"
                   : formatted("<WorkcellPlan %s: %zu rows, cost %.6g>",
                               to_string(p.result->status), p.result->arms[0].trajectory.size(),
                               p.result->cost);
      });
}

void bind_check(py::module_& m) {
  py::class_<WorkcellCheck>(m, "WorkcellCheck",
                            "What an independent look at two arms' trajectories found.")
      .def_property_readonly("passed", [](const WorkcellCheck& c) { return c.result.passed; })
      .def("__bool__", [](const WorkcellCheck& c) { return c.result.passed; })
      .def_property_readonly(
          "failures",
          [](const WorkcellCheck& c) {
            std::vector<std::string> all;
            for (const CheckResult& arm : c.result.arms)
              all.insert(all.end(), arm.failures.begin(), arm.failures.end());
            all.insert(all.end(), c.result.failures.begin(), c.result.failures.end());
            return all;
          },
          "One line each: of the first arm, the second, and both together.")
      .def_property_readonly(
          "clearance",
          [](const WorkcellCheck& c) -> std::optional<double> {
            if (!c.result.between) return {};
            return c.result.between->clearance;
          },
          "Of the bodies of both arms with the least margin, m.")
      .def("__repr__", [](const WorkcellCheck& c) {
        return c.result.passed ? "<WorkcellCheck passed>" : "<WorkcellCheck failed>";
      });
}

}  // namespace

void bind_workcell(py::module_& m) {
  bind_cell(m);
  bind_plan(m);
  bind_check(m);
  m.def(
      "plan_workcell",
      [](const WorkcellOrFile& workcell, const py::object& planner, int threads,
         std::optional<double> timeout, bool evidence, const py::object& progress) {
        PlanOptions options = to_plan_options(planner, threads, timeout);
        options.check = true;
        if (evidence) options.evidence = Evidence::all();
        options.progress = to_progress(progress);
        return plan(workcell, options);
      },
      py::arg("workcell").none(false), py::kw_only(), py::arg("planner") = "parallel",
      py::arg("threads") = 0, py::arg("timeout") = py::none(), py::arg("evidence") = false,
      py::arg("progress") = py::none(),
      "Plans two arms that work at one time: the cheapest two paths without conflict. No plan is a "
      "WorkcellPlan, not an exception. Other threads of Python run meanwhile; Ctrl-C stops it.\n\n"
      "workcell: a Workcell, or the name of its file. planner: 'parallel' or 'lazy'. threads: 0 "
      "for all cores. timeout: s, for everything. evidence: find all measures. progress(stage, "
      "done, of): now and then. Raises InputError, InvalidArgument, and what progress raised.");
  m.def("check_workcell", &check, py::arg("workcell").none(false), py::arg("rows").none(false),
        "Proves the trajectories of two arms from the workcell alone, or says what is wrong with "
        "them: WorkcellCheck.\n\n"
        "workcell: a Workcell, or the name of its file. rows: a WorkcellPlan, name -> Trajectory, "
        "or the name of a CSV file. Raises InputError and InvalidArgument.");
}

}  // namespace swivel::python
