// SPDX-License-Identifier: BSD-3-Clause
// Bindings of the parts of an answer: runs of strokes and transitions, what was found out about
// each run, and places where the tool lifts off.
#include <algorithm>

#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::python {

namespace {

template <class Value>
std::optional<Value> or_none(bool given, const Value& value) {
  return given ? std::optional(value) : std::nullopt;
}

std::string part_words(const Part& part) {
  return (part.stroke ? run_words(*part.stroke, part.reversed) : std::string("transition")) +
         formatted(": %zu rows", part.trajectory.rows->size()) +
         (part.cost ? formatted(", cost %.6g", *part.cost) : "");
}

/// Returns rows that are given as a Trajectory, or as the joints alone.
Trajectory to_trajectory(const py::object& rows) {
  if (py::isinstance<Trajectory>(rows)) return rows.cast<Trajectory>();
  const Postures joints = to_joints(rows, "rows", 0);
  auto all = std::make_shared<std::vector<TrajectoryRow>>(joints.rows.size());
  for (std::size_t k = 0; k < joints.rows.size(); ++k) (*all)[k].q = joints.rows[k];
  return {std::move(all), joints.width < kDof ? to_joint_names({}, joints.width) : JointNames()};
}

void bind_part(py::module_& m) {
  py::class_<Part>(m, "Part",
                   "A part of what an arm does: a run of a stroke, or a transition, in which the "
                   "joints move straight from row to row.")
      .def(pickling<Part>())
      .def(py::init([](const Typed<"Trajectory | ArrayLike">& rows,
                       std::optional<std::string> stroke, bool reversed, double begin) {
             if (stroke && !py::isinstance<Trajectory>(rows))
               throw py::value_error("rows: of a stroke allowed is a Trajectory");
             Part part;
             part.trajectory = to_trajectory(rows);
             part.stroke = std::move(stroke), part.reversed = reversed, part.begin = begin;
             return part;
           }),
           py::arg("rows"), py::arg("stroke") = py::none(), py::kw_only(),
           py::arg("reversed") = false, py::arg("begin") = 0.0,
           "rows: a Trajectory; of a transition also (n, 7), rad. stroke: its name, 'ring/2' of "
           "the second run of a stroke with lift-offs; None: a transition. reversed: it is run "
           "from the last waypoint to the first. begin: m along the stroke at which such a run "
           "begins.")
      .def_readonly("stroke", &Part::stroke,
                    "Its name; 'ring/1', 'ring/2' of runs between lift-offs; '' of the path of a "
                    "problem without strokes; None of a transition.")
      .def_readonly("begin", &Part::begin,
                    "m along the stroke at which its run begins: not 0 only behind a lift-off.")
      .def_readonly("reversed", &Part::reversed,
                    "Whether it runs from the last waypoint to the first.")
      .def_readonly("cost", &Part::cost, "Of a part that was planned, else None.")
      .def_readonly("trajectory", &Part::trajectory,
                    "Its rows. s begins at 0 in each run, where its approach begins; in "
                    "transitions s, phi and branch mean nothing.")
      .def_property_readonly(
          "joints", [](const Part& x) { return joints_of(x.trajectory); },
          "(n, 7) float64, rad: those of the trajectory.")
      .def_property_readonly(
          "process",
          [](const Part& x) -> std::optional<py::array_t<bool>> {
            if (x.process.size() != x.trajectory.rows->size()) return {};
            py::array_t<bool> process(static_cast<py::ssize_t>(x.process.size()));
            std::copy(x.process.begin(), x.process.end(), process.mutable_data());
            return process;
          },
          "(n,) bool, whether a row is on the stroke itself, not on approach, retract or a "
          "transition; None of a part made by hand.")
      .def_readonly("barred_by", &Part::barred_by,
                    "Of a transition with corners: two bodies that bar the straight one, else "
                    "None.")
      .def("__len__", [](const Part& x) { return x.trajectory.rows->size(); })
      .def("__repr__", [](const Part& x) { return "<Part " + part_words(x) + ">"; });
}

void bind_refined(py::module_& m) {
  py::class_<RefinedPath>(m, "Refined", "A path of the lattice and what refining made of it.")
      .def(pickling<RefinedPath>())
      .def_property_readonly(
          "refined", [](const RefinedPath& x) { return x.refined->refined; },
          "False: the rows are those given.")
      .def_property_readonly(
          "reason",
          [](const RefinedPath& x) {
            const std::string& reason = x.refined->reason;
            return reason.empty() ? std::nullopt : std::optional(reason);
          },
          "Why they are, or None.")
      .def_property_readonly("trajectory",
                             [](const RefinedPath& x) {
                               return Trajectory{std::shared_ptr<const std::vector<TrajectoryRow>>(
                                                     x.refined, &x.refined->rows),
                                                 x.joint_names};
                             })
      .def_property_readonly("cost_before",
                             [](const RefinedPath& x) { return x.refined->cost_before; })
      .def_property_readonly("cost", [](const RefinedPath& x) { return x.refined->cost; })
      .def_property_readonly(
          "bend_before", [](const RefinedPath& x) { return x.refined->bend_before; },
          "Largest second divided difference of the joints, rad/m^2.")
      .def_property_readonly(
          "bend", [](const RefinedPath& x) { return x.refined->bend; }, "rad/m^2.")
      .def("__repr__",
           [](const RefinedPath& x) { return "<Refined " + refined_words(*x.refined) + ">"; });
}

void bind_run(py::module_& m) {
  py::class_<Run>(m, "Run", "What a plan found out about one run of a stroke, or about a path.")
      .def(pickling<Run>())
      .def_readonly("stroke", &Run::stroke,
                    "Its name; 'ring/1', 'ring/2' of runs between lift-offs; '' of a path.")
      .def_property_readonly(
          "reversed", [](const Run& x) { return x.found->run.reversed; },
          "Whether it runs from the last waypoint to the first.")
      .def_property_readonly(
          "status", [](const Run& x) { return x.found->status; },
          "Status: whether it has a path by itself.")
      .def_property_readonly(
          "least_cost",
          [](const Run& x) {
            return or_none(x.found->status == PlanStatus::kSolved, x.found->least_cost);
          },
          "Of the run by itself; None where it has no path.")
      .def_readonly("cost", &Run::cost, "Of the run in the answer; None where there is none.")
      .def_property_readonly("lattice",
                             [](const Run& x) -> const LatticeInfo& { return x.found->lattice; })
      .def_property_readonly(
          "measures", [](const Run& x) -> const Measures& { return *x.found; },
          "What its rows in the answer come near to; all of it with evidence=True.")
      .def_property_readonly(
          "diagnosis", [](const Run& x) { return x.found->diagnosis; },
          "Why it has no path by itself; None unless that is so.")
      .def_readonly("refinement", &Run::refinement,
                    "Refined, where it was asked for and there is an answer; else None.")
      .def("__repr__", [](const Run& x) {
        std::string text = "<Run " + run_words(x.stroke, x.found->run.reversed) + ": " +
                           to_string(x.found->status);
        if (x.found->status == PlanStatus::kSolved)
          text += formatted(", at least %.6g by itself", x.found->least_cost);
        if (x.cost) text += formatted(", cost %.6g", *x.cost);
        return text + ">";
      });
}

void bind_lift_off(py::module_& m) {
  py::class_<LiftOffPlace>(m, "LiftOff",
                           "A place at which the tool lifts off within a stroke, and why.")
      .def(pickling<LiftOffPlace>())
      .def_readonly("stroke", &LiftOffPlace::stroke, "The name of the whole stroke.")
      .def_property_readonly(
          "end", [](const LiftOffPlace& x) { return x.found.end; },
          "m along the stroke and its approach, as s of rows: where the run ends.")
      .def_property_readonly(
          "resumed", [](const LiftOffPlace& x) { return x.found.resumed; },
          "m along the stroke and its approach: where the next run begins.")
      .def_property_readonly(
          "reached", [](const LiftOffPlace& x) { return x.found.reached; },
          "m along the stroke and its approach: how far the longest run from the same begin leads.")
      .def_property_readonly(
          "cause", [](const LiftOffPlace& x) -> const Cause& { return x.found.cause; },
          "What ends every run there; CauseKind.NONE where no single cause is known.")
      .def("__repr__", [](const LiftOffPlace& x) {
        const bool known = x.found.cause.kind != Cause::Kind::kNone;
        return "<LiftOff of '" + x.stroke +
               formatted("': ends at s = %.4f m, goes on at %.4f m; no run leads beyond %.4f m",
                         x.found.end, x.found.resumed, x.found.reached) +
               (known ? ": " + py::str(py::cast(x.found.cause)).cast<std::string>() : "") + ">";
      });
}

}  // namespace

std::string run_words(const std::string& stroke, bool reversed) {
  return (stroke.empty() ? "path" : "stroke '" + stroke + "'") + (reversed ? " backwards" : "");
}

std::vector<Part> parts_of(const Arm& arm, const std::vector<swivel::Part>& of) {
  const swivel::Problem& problem = *arm.of.executed;
  const std::vector<swivel::Stroke>& strokes = problem.arms[arm.number].strokes;
  std::vector<Part> parts;
  for (const swivel::Part& one : of) {
    Part& part = parts.emplace_back();
    part.trajectory = arm.trajectory_of(one.rows);
    if (one.run) {
      part.stroke = strokes[one.run->stroke].name, part.reversed = one.run->reversed;
      part.begin = s_of_piece(strokes[one.run->stroke]);
    }
    part.cost = one.cost, part.barred_by = one.barred_by;
    part.process = arm.of.has_paths() ? std::vector<bool>(one.rows.size(), true)
                                      : process_of_rows(one, problem);
  }
  return parts;
}

std::optional<RefinedPath> refinement_of(const Arm& arm, std::size_t run) {
  const auto& refinement = arm.of.found->refinement;
  if (!refinement) return {};
  const Refined& refined = refinement->runs.at(arm.number + run);
  return RefinedPath{std::shared_ptr<const Refined>(arm.of.found, &refined),
                     arm.found().joint_names};
}

std::vector<Run> runs_of(const Arm& arm) {
  std::vector<Run> runs;
  for (const RunAnswer& one : arm.found().runs) {
    Run& run = runs.emplace_back();
    run.found = std::shared_ptr<const RunAnswer>(arm.of.found, &one);
    run.stroke = arm.of.executed->arms[arm.number].strokes[one.run.stroke].name;
    for (const swivel::Part& part : arm.found().parts)
      if (part.run == one.run) run.cost = part.cost;
    run.refinement = refinement_of(arm, runs.size() - 1);
  }
  return runs;
}

std::vector<LiftOffPlace> lift_offs_of(const Arm& arm) {
  std::vector<std::string> names;  // of the strokes of the problem that was given
  std::vector<double> approaches;  // m; s of rows counts them as well
  for (const swivel::Stroke& stroke : arm.of.executed->arms[arm.number].strokes) {
    const std::string& name = stroke.piece ? stroke.piece->stroke : stroke.name;
    if (!names.empty() && names.back() == name) continue;
    names.push_back(name);
    approaches.push_back(stroke.approach.norm());
  }
  std::vector<LiftOffPlace> places;
  for (LiftOffAnswer lift : arm.found().lift_offs) {
    for (double* const s : {&lift.end, &lift.resumed, &lift.reached})
      *s += approaches.at(lift.stroke);
    places.push_back({names.at(lift.stroke), std::move(lift)});
  }
  return places;
}

void bind_parts_of_answers(py::module_& m) {
  bind_part(m);
  bind_refined(m);
  bind_run(m);
  bind_lift_off(m);
}

}  // namespace swivel::python
