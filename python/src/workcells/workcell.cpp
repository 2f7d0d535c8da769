// SPDX-License-Identifier: BSD-3-Clause
// Workcells: two arms that work at one time.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "interruptible.hpp"
#include "plan_keywords.hpp"
#include "problem.hpp"
#include "results.hpp"
#include "runs.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "workcells/workcell_archive.hpp"

namespace swivel::python {

namespace {

struct WorkcellCheck {
  AnswerCheck result;
};

/// Returns the number of an arm. Throws KeyError for an unknown name.
std::size_t number_of(const std::array<std::string, 2>& names, const std::string& name) {
  for (std::size_t k = 0; k < 2; ++k)
    if (names[k] == name) return k;
  throw py::key_error("'" + name + "': allowed are '" + names[0] + "' and '" + names[1] + "'");
}

std::array<std::string, 2> names_of(const swivel::Problem& cell) {
  return {cell.arms[0].name, cell.arms[1].name};
}

Trajectory trajectory_of(const WorkcellPlan& plan, std::size_t arm) {
  const ArmAnswer& result = plan.plan->arms[arm];
  return {std::shared_ptr<const std::vector<TrajectoryRow>>(plan.plan, &result.rows()),
          result.joint_names};
}

/// Returns the refinement and the motion of a plan, as far as these were asked for.
WorkcellMotion motion_of(const WorkcellPlan& plan) {
  const Answer& result = *plan.plan;
  WorkcellMotion made{.names = names_of_arms(result),
                      .joint_names = joint_names_of_arms(result),
                      .frame = plan.frame};
  if (result.motion) made.timing = std::shared_ptr<const MotionTiming>(plan.plan, &*result.motion);
  if (result.refinement)
    made.refinement = std::shared_ptr<const RefinedArms>(plan.plan, &*result.refinement);
  return made;
}

WorkcellPlan plan(const ProblemOrFile& of, PlanOptions options,
                  const std::optional<TimingOptions>& timing, bool refine) {
  const auto cell = two_arms_of(of);
  WorkcellPlan made{
      .timing = timing, .refined = refine, .frame = cell->arms[0].base_link, .cell = cell};
  made.plan = std::make_shared<const Answer>(interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    const Budget budget({}, nullptr, stop);
    return plan_workcell_motion(PreparedWorkcell(completed(made, nullptr), budget), options, refine,
                                timing);
  }));
  return made;
}

/// Returns the timing that keywords ask for; none without a speed.
std::optional<TimingOptions> timing_of(std::optional<double> speed,
                                       std::optional<double> turn_speed,
                                       std::optional<double> rate) {
  if (!speed) {
    for (const auto& [given, name] : {std::pair(turn_speed, "turn_speed"), std::pair(rate, "rate")})
      if (given) throw py::value_error(std::string(name) + ": is of motions: allowed with speed");
    return std::nullopt;
  }
  TimingOptions timing{.speed = *speed, .turn_speed = turn_speed};
  if (rate) timing.rate = *rate;
  return timing;
}

/// Computes what a file does not state of the rows of both arms. Throws InputError.
void complete(const PreparedWorkcell& prepared, io::WorkcellRows& read,
              const std::filesystem::path& file, const Budget& budget) {
  try {
    if (read.timed[0].empty())
      read.rows = complete_rows(prepared, std::move(read.rows), read.stated, budget);
    else
      read.timed = complete_motion(prepared, std::move(read.timed), read.stated, budget);
  } catch (const InputError& error) {
    throw InputError(file.string(), error.what());
  }
}

using RowsByName = Typed<"dict[str, Trajectory] | dict[str, Motion]", py::dict>;
using Checked = std::variant<WorkcellPlan, WorkcellMotion, RowsByName, std::filesystem::path>;
WorkcellCheck check(const ProblemOrFile& of, const Checked& rows) {
  const auto cell = two_arms_of(of);
  const auto names = names_of(*cell);
  io::WorkcellRows given;
  if (const auto* const dict = std::get_if<RowsByName>(&rows)) given = rows_of(*dict, names);
  if (const auto* const motion = std::get_if<WorkcellMotion>(&rows))
    for (std::size_t k = 0; k < 2; ++k) given.timed[k] = motion->motion().arms[k].rows;
  if (const auto* made = std::get_if<WorkcellPlan>(&rows)) given.rows = rows_of_arms(*made->plan);
  const auto* file = std::get_if<std::filesystem::path>(&rows);
  return interruptible([&](const std::stop_token& stop) -> WorkcellCheck {
    CheckOptions options;
    options.budget = Budget({}, nullptr, stop);
    std::optional<PreparedWorkcell> prepared(std::in_place, *cell, options.budget);
    if (file != nullptr)
      given = io::load_workcell_rows(
          *file, names,
          {prepared->robot(0).arm().chain.joint_names, prepared->robot(1).arm().chain.joint_names});
    const bool timed = !given.timed[0].empty();
    if (timed) prepared.emplace(with_motion_defaults(*cell), options.budget);
    if (file != nullptr) complete(*prepared, given, *file, options.budget);
    if (!timed) return {check_workcell(*prepared, given.rows, options)};
    return {check_workcell_motion(*prepared, given.timed, options)};
  });
}

void bind_plan(py::module_& m) {
  py::class_<WorkcellPlan>(m, "WorkcellPlan",
                           "What was planned for two arms. None: does not apply.")
      .def(pickling<WorkcellPlan>())
      .def_property_readonly("status", [](const WorkcellPlan& p) { return p.plan->status; })
      .def_property_readonly(
          "solved", [](const WorkcellPlan& p) { return p.plan->status == PlanStatus::kSolved; })
      .def_property_readonly("names", [](const WorkcellPlan& p) { return names_of_arms(*p.plan); })
      .def_property_readonly(
          "given",
          [](const WorkcellPlan& p) -> std::optional<std::string> {
            const Answer& result = *p.plan;
            const auto given = result.given_arm();
            if (!given) return {};
            return result.arms[*given].name;
          },
          "Name of the arm whose motion was given.")
      .def_property_readonly(
          "cost", [](const WorkcellPlan& p) { return p.plan->cost; }, "Of both paths together.")
      .def_property_readonly(
          "bound", [](const WorkcellPlan& p) { return p.plan->bound; },
          "No two paths without conflict cost less; inf: there are none.")
      .def_property_readonly(
          "least_costs",
          [](const WorkcellPlan& p) {
            const auto& arms = p.plan->arms;
            return std::array{arms[0].run().least_cost, arms[1].run().least_cost};
          },
          "Of the arms by themselves; inf: it has no path.")
      .def_property_readonly(
          "decided_by",
          [](const WorkcellPlan& p)
              -> Typed<"Literal['arms alone', 'regions', 'pairs of nodes', 'none']"> {
            return to_string(p.plan->pair.decided_by);
          },
          "'arms alone', 'regions', 'pairs of nodes', or 'none' where time was up.")
      .def_property_readonly(
          "trajectories", [](const WorkcellPlan& p) -> Typed<"dict[str, Trajectory]"> {
            py::dict all;
            if (p.plan->has_rows())
              for (std::size_t k = 0; k < 2; ++k)
                all[p.plan->arms[k].name.c_str()] = py::cast(trajectory_of(p, k));
            return all;
          },
          "Name of the arm -> Trajectory; rows of one number are simultaneous. Empty: no plan.")
      .def_property_readonly(
          "conflict",
          [](const WorkcellPlan& p) -> std::optional<std::array<std::string, 2>> {
            if (!p.plan->pair.conflict) return {};
            return p.plan->pair.conflict->bodies;
          },
          "Two bodies that meet on the cheapest paths, where each arm has a path and both together "
          "have none.")
      .def(
          "diagnosis",
          [](const WorkcellPlan& p, const std::string& arm) -> std::optional<Diagnosis> {
            const std::size_t k = number_of(names_of_arms(*p.plan), arm);
            return p.plan->arms[k].run().diagnosis;
          },
          py::arg("arm"), "Why this arm has no path by itself.")
      .def_property_readonly(
          "clearance",
          [](const WorkcellPlan& p) -> std::optional<double> {
            if (!p.plan->pair.nearest) return {};
            return p.plan->pair.nearest->clearance;
          },
          "Between bodies of both arms at rows, m, with evidence=True.")
      .def_property_readonly(
          "clearance_status",
          [](const WorkcellPlan& p) -> MeasureStatusName {
            return to_string(p.plan->pair.nearest_status());
          },
          "'measured', 'none' (no pair is near) or 'not_measured' (not asked for, or time ran "
          "out).")
      .def_property_readonly("time_ms", [](const WorkcellPlan& p) { return p.plan->time_ms; })
      .def_property_readonly("warnings", [](const WorkcellPlan& p) { return p.plan->warnings; })
      .def(
          "to_json", [](const WorkcellPlan& p) { return io::to_json(*p.plan, swivel::two_arms()); },
          "As `swivel plan --json` writes it.")
      .def(
          "save",
          [](const WorkcellPlan& p, const std::filesystem::path& file) {
            if (!p.plan->has_rows()) throw py::value_error("there is no plan");
            io::write_file(file, io::to_csv(*p.plan, swivel::two_arms()));
          },
          py::arg("file"), "The trajectories of both arms as CSV, docs/formats.md.")
      .def_property_readonly(
          "refinements", [](const WorkcellPlan& p) { return motion_of(p).refinements(); },
          "Name of the arm -> Refined, with refine=True and a plan.")
      .def_property_readonly(
          "stopped", [](const WorkcellPlan& p) { return p.plan->stopped; },
          "With a plan: time ran out before all that was asked for was done.")
      .def_property_readonly(
          "motions", [](const WorkcellPlan& p) { return motion_of(p).motions(); },
          "Name of the arm -> Motion, with speed=; samples of one number are simultaneous. Empty: "
          "there is none.")
      .def_property_readonly(
          "not_executable",
          [](const WorkcellPlan& p) -> std::optional<std::string> {
            const auto& timing = p.plan->motion;
            if (!timing && p.timing && p.plan->stopped) return "stopped";
            if (!timing || !timing->failure) return {};
            return timing->failure->reason;
          },
          "Why the plan has no motion, with speed=; None: it has one, or none was asked for.")
      .def(
          "save_motion",
          [](const WorkcellPlan& p, const std::filesystem::path& file) { motion_of(p).save(file); },
          py::arg("file"),
          "The motion of both arms as .csv, .json or .yaml (JointTrajectory), or .mcap.")
      .def("__repr__", [](const WorkcellPlan& p) {
        return !p.plan->has_rows()
                   ? std::string("<WorkcellPlan ") + to_string(p.plan->status) + ">"
                   : formatted("<WorkcellPlan %s: %zu rows, cost %.6g>", to_string(p.plan->status),
                               p.plan->arm().rows().size(), p.plan->cost);
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
            for (const CheckResult& arm : c.result.runs)
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

AdviceOnWorkcell advise(const ProblemOrFile& of, const WorkcellPlan& plan, double timeout) {
  if (!(timeout > 0))
    throw py::value_error("timeout: not a positive number: allowed are values above 0");
  const auto cell = two_arms_of(of);
  return interruptible([&](const std::stop_token& stop) {
    PlanOptions options;
    options.timeout_s = timeout;
    options.stop = stop;
    return advise_workcell(*cell, *plan.plan, options);
  });
}

void bind_advice(py::module_& m) {
  const auto or_none = [](const std::string& text) {
    return text.empty() ? std::optional<std::string>() : text;
  };
  py::class_<WorkcellAdvice>(
      m, "WorkcellAdvice",
      "One change of a workcell that has no plan, and what planning both arms with it gave.")
      .def_property_readonly(
          "arm", [or_none](const WorkcellAdvice& a) { return or_none(a.arm); },
          "Name of the arm that is changed; None: both, or the scene.")
      .def_property_readonly(
          "change", [](const WorkcellAdvice& a) { return a.change; }, "Change.")
      .def_property_readonly("object",
                             [or_none](const WorkcellAdvice& a) { return or_none(a.object); })
      .def_property_readonly(
          "asked", [](const WorkcellAdvice& a) { return a.from; },
          "Of limits: what the workcell asks, in its unit.")
      .def_property_readonly(
          "changed_to", [](const WorkcellAdvice& a) { return a.to; },
          "Of limits: what this is about.")
      .def_property_readonly(
          "offset", [](const WorkcellAdvice& a) { return a.offset; },
          "Of an object or of paths that are moved, (3,), m, base frame.")
      .def_property_readonly(
          "also", [or_none](const WorkcellAdvice& a) { return or_none(a.also); },
          "Name of a second object that is moved or removed with the first one; None: none is.")
      .def_property_readonly(
          "also_offset", [](const WorkcellAdvice& a) { return a.also_offset; },
          "Of a second object that is moved, (3,), m, base frame.")
      .def_property_readonly(
          "outcome", [](const WorkcellAdvice& a) { return a.outcome; }, "Outcome.")
      .def_property_readonly(
          "cost", [](const WorkcellAdvice& a) { return a.cost; }, "Of both paths, where it solves.")
      .def("__repr__", [](const WorkcellAdvice& a) {
        return "<WorkcellAdvice " + std::string(to_string(a.outcome)) + ": " + words(a) +
               (a.cost ? formatted(", cost %.6g>", *a.cost) : std::string(">"));
      });
  py::class_<AdviceOnWorkcell>(m, "AdviceOnWorkcell",
                               "What would help a workcell that has no plan. str() says it.")
      .def_property_readonly(
          "cell", [](const AdviceOnWorkcell& a) { return a.cell; },
          "Changes of the workcell, what helps first: a list of WorkcellAdvice.")
      .def_property_readonly(
          "arms", [](const AdviceOnWorkcell& a) -> Typed<"dict[str, list[Advice]]"> {
            py::dict all;
            for (const ArmAdvice& one : a.arms) all[one.arm.c_str()] = py::cast(one.advice);
            return all;
          },
          "Name of an arm that has no path by itself -> what would help it by itself, a list of "
          "Advice.")
      .def("__str__", [](const AdviceOnWorkcell& a) { return advice_text(a); });
  m.def("_advise_two_arms", &advise);
}

}  // namespace

std::shared_ptr<const swivel::Problem> two_arms_of(const ProblemOrFile& of) {
  auto cell = std::make_shared<const swivel::Problem>(to_core(of));
  if (cell->arms.size() != 2) throw InvalidArgument("problem: has one arm: allowed are two arms");
  return cell;
}

io::WorkcellRows rows_of(const py::dict& rows, const std::array<std::string, 2>& names) {
  io::WorkcellRows all;
  for (std::size_t k = 0; k < 2; ++k) {
    if (!rows.contains(names[k])) throw py::key_error("'" + names[k] + "': is missing");
    const py::object one = rows[names[k].c_str()];
    if (py::isinstance<Motion>(one))
      all.timed[k] = *one.cast<const Motion&>().rows();
    else
      all.rows[k] = *one.cast<const Trajectory&>().rows;
  }
  if (all.timed[0].empty() != all.timed[1].empty())
    throw py::value_error("rows: one is a motion, the other one is none: allowed are two alike");
  return all;
}

swivel::Problem completed(const WorkcellPlan& plan, const Problem* given) {
  if (given == nullptr && !plan.cell)
    throw py::value_error(
        "workcell: a plan that was unpickled has none: allowed is the workcell that was planned");
  const swivel::Problem& cell = given != nullptr ? *given->two : *plan.cell;
  swivel::Problem whole = plan.timing ? with_motion_defaults(cell) : cell;
  for (ArmTask& arm : whole.arms)
    if (plan.refined) keep_clearance_between_layers(arm.path().limits);
  return whole;
}

void bind_workcell(py::module_& m) {
  bind_plan(m);
  bind_advice(m);
  bind_check(m);
  bind_workcell_motion(m);
  m.def(
      "_plan_two_arms",
      [](const ProblemOrFile& workcell, const OrName<PlannerKind>& planner, int threads,
         std::optional<double> timeout, bool prove, bool evidence, const ProgressCallback& progress,
         std::optional<double> speed, std::optional<double> turn_speed, std::optional<double> rate,
         bool refine) {
        PlanOptions options = to_plan_options(planner, threads, timeout, prove);
        if (evidence) options.evidence = Evidence::all();
        options.progress = to_progress(progress);
        return plan(workcell, options, timing_of(speed, turn_speed, rate), refine);
      },
      py::arg("workcell").none(false), py::kw_only(), py::arg("planner") = "parallel",
      py::arg("threads") = 0, py::arg("timeout") = py::none(), py::arg("prove") = true,
      py::arg("evidence") = false, py::arg("progress") = py::none(), py::arg("speed") = py::none(),
      py::arg("turn_speed") = py::none(), py::arg("rate") = py::none(), py::arg("refine") = false);
  m.def("_check_two_arms", &check, py::arg("workcell"), py::arg("rows").none(false));
}

}  // namespace swivel::python
