// SPDX-License-Identifier: BSD-3-Clause
// Bindings of answers about jobs: plans, their parts and runs, motions and verdicts.
#include "job_results.hpp"

#include <algorithm>

#include "job_archive.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

using Rows = std::vector<TrajectoryRow>;

template <class Value>
std::optional<Value> or_none(bool given, const Value& value) {
  return given ? std::optional(value) : std::nullopt;
}
std::optional<std::pair<std::string, std::string>> bodies_or_none(
    const std::optional<std::array<std::string, 2>>& bodies) {
  if (!bodies) return {};
  return std::pair((*bodies)[0], (*bodies)[1]);
}

const std::string& name_of(const swivel::Problem& job, const StrokeRun& run) {
  return job.arm().strokes[run.stroke].name;
}
/// Returns the name of a run for people.
std::string run_words(const std::string& stroke, bool reversed) {
  return "stroke '" + stroke + "'" + (reversed ? " backwards" : "");
}

std::optional<double> gap_of(const Answer& result) {
  if (result.arm().parts.empty() || (result.bound <= 0 && result.lattice_cost > 0)) return {};
  return result.lattice_cost > 0 ? result.lattice_cost / result.bound - 1 : 0.0;
}

/// Returns the runs between which no transition was found: their names, None for home.
std::optional<std::pair<std::optional<std::string>, std::optional<std::string>>> no_transition_of(
    const JobPlan& plan) {
  const ArmAnswer& result = plan.result().arm();
  if (!result.no_transition) return {};
  const std::size_t to = result.no_transition->to;
  const auto name = [&](std::size_t k) {
    return or_none(k < result.runs.size(),
                   k < result.runs.size() ? name_of(*plan.job, result.runs[k].run) : std::string());
  };
  return std::pair(to == 0 ? std::nullopt : name(to - 1), name(to));
}

std::vector<JobRun> runs_of(const JobPlan& plan) {
  std::vector<JobRun> runs;
  for (const RunAnswer& one : plan.result().arm().runs) {
    JobRun& run = runs.emplace_back();
    run.result = std::shared_ptr<const RunAnswer>(plan.plan, &one);
    run.stroke = name_of(*plan.job, one.run);
    for (const swivel::Part& part : plan.result().arm().parts)
      if (part.run == one.run) run.cost = part.cost;
  }
  return runs;
}

/// Returns the places at which a plan's tool lifts off. Its job has the runs between them.
std::vector<LiftOffPlace> lift_offs_of(const JobPlan& plan) {
  std::vector<std::string> names;  // of the strokes of the job that was given
  std::vector<double> approaches;  // m; s of rows counts them as well
  for (const swivel::Stroke& stroke : plan.job->arm().strokes) {
    const std::string& name = stroke.piece ? stroke.piece->stroke : stroke.name;
    if (!names.empty() && names.back() == name) continue;
    names.push_back(name);
    approaches.push_back(stroke.approach.norm());
  }
  std::vector<LiftOffPlace> places;
  for (LiftOffAnswer lift : plan.result().arm().lift_offs) {
    for (double* const s : {&lift.end, &lift.resumed, &lift.reached})
      *s += approaches.at(lift.stroke);
    places.push_back({names.at(lift.stroke), std::move(lift)});
  }
  return places;
}

std::string lift_words(std::size_t count) {
  return count == 0 ? "" : formatted(", %zu lift-off%s", count, count == 1 ? "" : "s");
}

std::string part_words(const JobPart& part) {
  return (part.stroke ? run_words(*part.stroke, part.reversed) : std::string("transition")) +
         formatted(": %zu rows", part.rows->size()) +
         (part.cost ? formatted(", cost %.6g", *part.cost) : "");
}

/// Returns the name of a part of a motion for people, by its number.
std::string part_words(const JobMotion& motion, std::size_t part) {
  const bool home = motion.job->arm().home.has_value();
  const std::size_t run = home ? part / 2 : (part + 1) / 2;
  if (run >= motion.order.size()) return "transition home";
  const std::string name =
      run_words(name_of(*motion.job, motion.order[run]), motion.order[run].reversed);
  return (part % 2 == 1) == home ? name : "transition to " + name;
}

std::string motion_words(const JobMotion& motion) {
  if (const auto& failure = motion.timing->failure)
    return "not executable: " + part_words(motion, motion.timing->failed_part) +
           formatted(": s = %.4f m: ", failure->s) + failure->reason;
  if (!motion.fault.empty()) return "not executable: " + motion.fault;
  const swivel::ArmMotion& m = motion.timing->motion->arms.front();
  const std::size_t lift_offs = lift_off_count(*motion.job);
  return formatted("%.3f s, %zu strokes", m.duration, m.events.size() / 2 - lift_offs) +
         lift_words(lift_offs) + formatted(", %zu samples at %.6g Hz", m.rows.size(), m.rate);
}

std::string infeasible_words(const JobPlan& plan) {
  const Answer& result = plan.result();
  for (const RunAnswer& one : result.arm().runs)
    if (one.status == PlanStatus::kInfeasible)
      return run_words(name_of(*plan.job, one.run), one.run.reversed) + " has no path by itself" +
             (one.diagnosis ? ": " + py::str(py::cast(one.diagnosis->cause)).cast<std::string>()
                            : "");
  if (!result.arm().no_transition) return "none found";
  std::vector<std::string> runs;
  for (const RunAnswer& one : result.arm().runs)
    runs.push_back(run_words(name_of(*plan.job, one.run), one.run.reversed));
  return words(*result.arm().no_transition, runs);
}

std::string plan_words(const JobPlan& plan) {
  const Answer& result = plan.result();
  std::string text = to_string(result.status);
  if (result.status == PlanStatus::kInfeasible) return text + ": " + infeasible_words(plan);
  if (result.arm().parts.empty()) return text;
  text +=
      formatted(": %zu strokes", plan.job->arm().strokes.size() - result.arm().lift_offs.size()) +
      lift_words(result.arm().lift_offs.size()) + formatted(", cost %.6g", result.cost);
  if (const auto gap = gap_of(result)) text += formatted(", %.3g %% above its bound", 100 * *gap);
  if (plan.plan->motion) text += "; " + motion_words(motion_of(plan));
  if (plan.plan->stopped) text += "; stopped before its motion";
  return text;
}

std::string csv_of(const JobPlan& plan) {
  if (plan.result().arm().parts.empty())
    throw py::value_error(std::string("the plan has no job: ") + to_string(plan.result().status));
  return io::to_csv(plan.result(), *plan.job);
}

std::string motion_text(const JobMotion& motion, const std::filesystem::path& file) {
  return io::job_motion_text(*motion.motion(), *motion.job, motion.joint_names,
                             motion.job->arm().base_link, file);
}

// --- parts

Trajectory to_trajectory(const py::object& rows) {
  if (py::isinstance<Trajectory>(rows)) return rows.cast<Trajectory>();
  const py::array_t<double> joints = to_joints(rows, "rows");
  auto all = std::make_shared<Rows>(static_cast<std::size_t>(joints.shape(0)));
  for (py::ssize_t k = 0; k < joints.shape(0); ++k)
    (*all)[static_cast<std::size_t>(k)].q = Eigen::Map<const Config>(joints.data(k, 0));
  return {std::move(all), {}};
}

void bind_part(py::module_& m) {
  py::class_<JobPart>(m, "JobPart",
                      "A part of a job: a run of a stroke, or a transition, in which the joints "
                      "move straight from row to row.")
      .def(pickling<JobPart>())
      .def(py::init([](const Typed<"Trajectory | ArrayLike">& rows,
                       std::optional<std::string> stroke, bool reversed, double begin) {
             const Trajectory trajectory = to_trajectory(rows);
             if (stroke && !py::isinstance<Trajectory>(rows))
               throw py::value_error("rows: of a stroke allowed is a Trajectory");
             JobPart part;
             part.rows = trajectory.rows, part.joint_names = trajectory.joint_names;
             part.stroke = std::move(stroke), part.reversed = reversed, part.begin = begin;
             return part;
           }),
           py::arg("rows"), py::arg("stroke") = py::none(), py::kw_only(),
           py::arg("reversed") = false, py::arg("begin") = 0.0,
           "rows: a Trajectory; of a transition also (n, 7), rad. stroke: its name, 'ring/2' of "
           "the second run of a stroke with lift-offs; None: a transition. reversed: it is run "
           "from the last waypoint to the first. begin: m along the stroke at which such a run "
           "begins.")
      .def_readonly("stroke", &JobPart::stroke,
                    "Its name; 'ring/1', 'ring/2' of runs between lift-offs; None of a transition.")
      .def_readonly("begin", &JobPart::begin,
                    "m along the stroke at which its run begins: not 0 only behind a lift-off.")
      .def_readonly("reversed", &JobPart::reversed,
                    "Whether it runs from the last waypoint to the first.")
      .def_readonly("cost", &JobPart::cost, "Of a part that was planned, else None.")
      .def_property_readonly(
          "trajectory",
          [](const JobPart& x) {
            return Trajectory{x.rows, x.joint_names};
          },
          "Its rows. s begins at 0 in each run, where its approach begins; in transitions s, phi "
          "and branch mean nothing.")
      .def_property_readonly(
          "joints",
          [](const JobPart& x) {
            return column(x.rows, x.rows->empty() ? nullptr : x.rows->front().q.data(), kDof);
          },
          "(n, 7) float64, rad: those of the trajectory.")
      .def_property_readonly(
          "process",
          [](const JobPart& x) -> std::optional<py::array_t<bool>> {
            if (x.process.size() != x.rows->size()) return {};
            py::array_t<bool> process(static_cast<py::ssize_t>(x.process.size()));
            std::copy(x.process.begin(), x.process.end(), process.mutable_data());
            return process;
          },
          "(n,) bool, whether a row is on the stroke itself, not on approach, retract or a "
          "transition; None of a part made by hand.")
      .def_property_readonly(
          "barred_by", [](const JobPart& x) { return bodies_or_none(x.barred_by); },
          "Of a transition with corners: two bodies that bar the straight one, else None.")
      .def("__len__", [](const JobPart& x) { return x.rows->size(); })
      .def("__repr__", [](const JobPart& x) { return "<JobPart " + part_words(x) + ">"; });
}

void bind_run(py::module_& m) {
  py::class_<JobRun>(m, "JobRun", "What a job's plan found out about one run of a stroke.")
      .def(pickling<JobRun>())
      .def_readonly("stroke", &JobRun::stroke,
                    "Its name; 'ring/1', 'ring/2' of runs between lift-offs.")
      .def_property_readonly(
          "reversed", [](const JobRun& x) { return x.result->run.reversed; },
          "Whether it runs from the last waypoint to the first.")
      .def_property_readonly(
          "status", [](const JobRun& x) { return x.result->status; },
          "Status: whether it has a path by itself.")
      .def_property_readonly(
          "least_cost",
          [](const JobRun& x) {
            return or_none(x.result->status == PlanStatus::kSolved, x.result->least_cost);
          },
          "Of the run by itself; None where it has no path.")
      .def_readonly("cost", &JobRun::cost, "Of the run in the job; None where there is no job.")
      .def_property_readonly(
          "lattice", [](const JobRun& x) -> const LatticeInfo& { return x.result->lattice; })
      .def_property_readonly(
          "measures", [](const JobRun& x) -> const Measures& { return *x.result; },
          "What its rows in the job come near to; all of it with evidence=True.")
      .def_property_readonly(
          "diagnosis",
          [](const JobRun& x) { return x.result->diagnosis ? &*x.result->diagnosis : nullptr; },
          py::return_value_policy::reference_internal,
          "Why it has no path by itself; None unless that is so.")
      .def("__repr__", [](const JobRun& x) {
        std::string text = "<JobRun " + run_words(x.stroke, x.result->run.reversed) + ": " +
                           to_string(x.result->status);
        if (x.result->status == PlanStatus::kSolved)
          text += formatted(", at least %.6g by itself", x.result->least_cost);
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
          "end", [](const LiftOffPlace& x) { return x.result.end; },
          "m along the stroke and its approach, as s of rows: where the run ends.")
      .def_property_readonly(
          "resumed", [](const LiftOffPlace& x) { return x.result.resumed; },
          "m along the stroke and its approach: where the next run begins.")
      .def_property_readonly(
          "reached", [](const LiftOffPlace& x) { return x.result.reached; },
          "m along the stroke and its approach: how far the longest run from the same begin leads.")
      .def_property_readonly(
          "cause", [](const LiftOffPlace& x) -> const Cause& { return x.result.cause; },
          "What ends every run there; CauseKind.NONE where no single cause is known.")
      .def("__repr__", [](const LiftOffPlace& x) {
        const bool known = x.result.cause.kind != Cause::Kind::kNone;
        return "<LiftOff of '" + x.stroke +
               formatted("': ends at s = %.4f m, goes on at %.4f m; no run leads beyond %.4f m",
                         x.result.end, x.result.resumed, x.result.reached) +
               (known ? ": " + py::str(py::cast(x.result.cause)).cast<std::string>() : "") + ">";
      });
}

void bind_plan(py::module_& m) {
  py::class_<JobPlan>(m, "JobPlan",
                      "The answer of plan_job(): the parts of a job, or why there is none.")
      .def(pickling<JobPlan>())
      .def_property_readonly(
          "status", [](const JobPlan& p) { return p.result().status; },
          "Status: where time was up before there was a proved job, parts are none.")
      .def_property_readonly(
          "solved", [](const JobPlan& p) { return p.result().status == PlanStatus::kSolved; })
      .def_property_readonly(
          "cost",
          [](const JobPlan& p) {
            return or_none(!p.result().arm().parts.empty(), p.result().cost);
          },
          "Of strokes, transitions and lift-offs; None where there are no parts.")
      .def_property_readonly(
          "bound",
          [](const JobPlan& p) {
            return or_none(!p.result().arm().parts.empty(), p.result().bound);
          },
          "No job of the lattices' nodes in this order costs less, if its transitions are those "
          "that are found.")
      .def_property_readonly(
          "bound_any",
          [](const JobPlan& p) {
            return or_none(!p.result().arm().parts.empty(), p.result().bound_any);
          },
          "No job of the lattices' nodes in this order costs less, whatever its transitions.")
      .def_property_readonly(
          "gap", [](const JobPlan& p) { return gap_of(p.result()); },
          "What the search minimised over bound, less 1: 0 where the job is optimal. None where "
          "there is no bound.")
      .def_property_readonly(
          "parts", [](const JobPlan& p) { return parts_of(p, p.result().arm().parts); },
          "Transitions and runs, JobParts, in the order in which they are executed; none unless "
          "solved.")
      .def_property_readonly(
          "partial", [](const JobPlan& p) { return parts_of(p, p.result().arm().partial); },
          "Where time was up before a job was proved: the parts of the cheapest one known, "
          "unproved.")
      .def_property_readonly("runs", &runs_of, "JobRuns, in the order in which they are executed.")
      .def_property_readonly(
          "lift_offs", &lift_offs_of,
          "LiftOff of each place at which the tool lifts off within a stroke, in the order "
          "of the job.")
      .def_property_readonly("no_transition", &no_transition_of,
                             "(from, to) where each run has a path, but no transition joins these "
                             "two: names of strokes, None for home. Else None.")
      .def_property_readonly(
          "barred_by",
          [](const JobPlan& p) {
            const auto& none = p.result().arm().no_transition;
            return bodies_or_none(none ? none->bodies : std::nullopt);
          },
          "The two bodies in the way there, or None.")
      .def_property_readonly(
          "barred_where",
          [](const JobPlan& p)
              -> std::optional<Typed<"Literal['between', 'home', 'end', 'begin']">> {
            const auto& none = p.result().arm().no_transition;
            if (!none) return {};
            return to_string(none->where);
          },
          "Where they are: 'between' the two, at 'home', wherever the run before may 'end', or "
          "wherever the next one may 'begin'. None where there is a job.")
      .def_property_readonly(
          "motion",
          [](const JobPlan& p) -> std::optional<JobMotion> {
            if (!p.plan->motion) return {};
            return motion_of(p);
          },
          "JobMotion, where it was asked for and there is a job.")
      .def_property_readonly(
          "stopped", [](const JobPlan& p) { return p.plan->stopped; },
          "There is a job, but time ran out before its motion.")
      .def_property_readonly("planner", [](const JobPlan& p) { return p.result().planner; })
      .def_property_readonly("threads", [](const JobPlan& p) { return p.result().threads; })
      .def_property_readonly("joint_names",
                             [](const JobPlan& p) { return p.result().arm().joint_names; })
      .def_property_readonly(
          "held",
          [](const JobPlan& p) {
            std::map<std::string, double> held;
            for (const HeldJoint& joint : p.result().arm().held) held[joint.name] = joint.position;
            return held;
          },
          "Joints between base and tip that are not planned -> where they stand, rad or m.")
      .def_property_readonly(
          "counters", [](const JobPlan& p) { return counters_of(p.result().arm().counters); },
          "Work done, by name.")
      .def_property_readonly(
          "transition_counters", [](const JobPlan& p) -> Typed<"dict[str, int]"> {
            const TransitionCounters& t = p.result().arm().transitions;
            py::dict all;
            all["pairs"] = t.pairs, all["searches"] = t.searches, all["rounds"] = t.rounds;
            return all;
          },
          "'pairs' of configurations asked whether the way is free, 'searches' for a way around, "
          "'rounds': jobs tried.")
      .def_property_readonly(
          "time_ms", [](const JobPlan& p) { return p.result().time_ms; }, "By stage.")
      .def_property_readonly(
          "dropped_pairs", [](const JobPlan& p) { return p.result().arm().dropped_pairs; },
          "Touch in every posture: not kept apart.")
      .def_property_readonly(
          "reduced_pairs", [](const JobPlan& p) { return p.result().arm().reduced_pairs; },
          "Near by design: keep less.")
      .def_property_readonly("warnings", [](const JobPlan& p) { return p.result().warnings; })
      .def("to_csv", &csv_of, "The trajectory of the job as CSV, docs/formats.md.")
      .def(
          "to_json", [](const JobPlan& p) { return io::to_json(p.result(), *p.job); },
          "The result of the job as text, docs/formats.md.")
      .def(
          "save",
          [](const JobPlan& p, const std::filesystem::path& file) {
            io::write_file(file, csv_of(p));
          },
          py::arg("file"), "The trajectory as CSV, docs/formats.md.")
      .def("__repr__", [](const JobPlan& p) { return "<JobPlan " + plan_words(p) + ">"; });
}

// --- motion

template <class Number>
py::array_t<Number> timed_column(const JobMotion& motion, Number TimedRow::*member) {
  const auto m = motion.motion();
  const std::shared_ptr<const std::vector<TimedRow>> rows(m, &m->rows);
  return column(rows, rows->empty() ? nullptr : &(rows->front().*member));
}
py::array_t<double> timed_joints(const JobMotion& motion, const Config TimedRow::*member) {
  const auto m = motion.motion();
  const std::shared_ptr<const std::vector<TimedRow>> rows(m, &m->rows);
  return column(rows, rows->empty() ? nullptr : (rows->front().*member).data(), kDof);
}
template <class Number>
py::array_t<Number> placed_column(const JobMotion& motion, Number TrajectoryRow::*member) {
  const auto m = motion.motion();
  const std::shared_ptr<const std::vector<TimedRow>> rows(m, &m->rows);
  return column(rows, rows->empty() ? nullptr : &(rows->front().row.*member));
}

/// Returns the last joint of all rows, which is the roll of arms of six joints.
py::array_t<double> last_joint(const JobMotion& motion) {
  const auto m = motion.motion();
  const std::shared_ptr<const std::vector<TimedRow>> rows(m, &m->rows);
  return column(rows, rows->empty() ? nullptr : &rows->front().row.q[kDof - 1]);
}

py::array_t<bool> process_of(const JobMotion& motion) {
  const auto m = motion.motion();
  py::array_t<bool> process(static_cast<py::ssize_t>(m->rows.size()));
  bool* out = process.mutable_data();
  bool on = false;
  std::size_t next = 0;
  for (const TimedRow& row : m->rows) {
    while (next < m->events.size() && m->events[next].t <= row.t) on = m->events[next++].on;
    *out++ = on;
  }
  return process;
}

struct NamedEvent {
  double t = 0, s = 0;
  std::string stroke;
  bool on = false;
};
template <class A>
void serialize(A& archive, NamedEvent& x) {
  auto& [t, s, stroke, on] = x;
  archive(t, s, stroke, on);
}

void bind_event(py::module_& m) {
  py::class_<NamedEvent>(m, "ProcessEvent", "A moment at which the process is switched.")
      .def(pickling<NamedEvent>())
      .def_readonly("t", &NamedEvent::t, "s, that of a row.")
      .def_readonly("stroke", &NamedEvent::stroke, "Its name.")
      .def_readonly("s", &NamedEvent::s, "m along the stroke, its approach included.")
      .def_readonly("on", &NamedEvent::on, "Whether the process is switched on, or off.")
      .def("__repr__", [](const NamedEvent& x) {
        return formatted("<ProcessEvent %s at t = %.3f s, '", x.on ? "on" : "off", x.t) + x.stroke +
               formatted("', s = %.4f m>", x.s);
      });
}

std::vector<NamedEvent> events_of(const JobMotion& motion) {
  std::vector<NamedEvent> events;
  for (const ProcessEvent& event : motion.motion()->events)
    events.push_back({event.t, event.s, motion.job->arm().strokes[event.stroke].name, event.on});
  return events;
}

void bind_motion(py::module_& m) {
  bind_event(m);
  py::class_<JobMotion>(m, "JobMotion",
                        "The motion of a whole job in time, with rest at the ends of its parts, or "
                        "why there is none. Arrays are read-only views.")
      .def(pickling<JobMotion>())
      .def_property_readonly("executable",
                             [](const JobMotion& x) { return x.timing->motion.has_value(); })
      .def_property_readonly(
          "reason",
          [](const JobMotion& x) -> std::optional<std::string> {
            if (!x.fault.empty()) return x.fault;
            if (!x.timing->failure) return {};
            return part_words(x, x.timing->failed_part) + ": " + x.timing->failure->reason;
          },
          "Why it is not executable, with the part, or None.")
      .def_property_readonly(
          "at_part",
          [](const JobMotion& x) {
            return or_none(x.timing->failure.has_value(), x.timing->failed_part);
          },
          "Number of the part that is not, from 0, or None.")
      .def_property_readonly(
          "at_s",
          [](const JobMotion& x) {
            return or_none(x.timing->failure.has_value(),
                           x.timing->failure ? x.timing->failure->s : 0.0);
          },
          "Where it is not, m along the part, or None.")
      .def_property_readonly(
          "t", [](const JobMotion& x) { return timed_column(x, &TimedRow::t); }, "(m,), s.")
      .def_property_readonly(
          "part",
          [](const JobMotion& x) {
            const auto motion = x.motion();
            return column(std::shared_ptr<const std::vector<std::size_t>>(motion, &motion->part),
                          motion->part.data());
          },
          "(m,), number of the part of the job to which each row leads, from 0.")
      .def_property_readonly("process", &process_of,
                             "(m,) bool, whether the process is on from this row to the next.")
      .def_property_readonly(
          "s", [](const JobMotion& x) { return placed_column(x, &TrajectoryRow::s); },
          "(m,), m along the stroke; in transitions it means nothing, as phi and branch.")
      .def_property_readonly(
          "phi", [](const JobMotion& x) { return placed_column(x, &TrajectoryRow::phi); },
          "(m,), carried arm angle, rad.")
      .def_property_readonly(
          "branch", [](const JobMotion& x) { return placed_column(x, &TrajectoryRow::branch); },
          "(m,), 0 to 7.")
      .def_property_readonly(
          "roll",
          [](const JobMotion& x) {
            if (x.joint_names[kDof - 1] == "roll") return last_joint(x);
            return placed_column(x, &TrajectoryRow::roll);
          },
          "(m,), by how much the tool is turned about its z axis, rad; 0 where it may not turn.")
      .def_property_readonly(
          "joints",
          [](const JobMotion& x) {
            const auto motion = x.motion();
            const std::shared_ptr<const std::vector<TimedRow>> rows(motion, &motion->rows);
            return column(rows, rows->empty() ? nullptr : rows->front().row.q.data(), kDof);
          },
          "(m, 7), rad.")
      .def_property_readonly(
          "velocities", [](const JobMotion& x) { return timed_joints(x, &TimedRow::v); },
          "(m, 7), rad/s.")
      .def_property_readonly(
          "accelerations", [](const JobMotion& x) { return timed_joints(x, &TimedRow::a); },
          "(m, 7), rad/s^2.")
      .def_readonly("joint_names", &JobMotion::joint_names)
      .def_property_readonly(
          "duration", [](const JobMotion& x) { return x.motion()->duration; },
          "s, from rest to rest.")
      .def_property_readonly(
          "rate", [](const JobMotion& x) { return x.motion()->rate; }, "Samples a second.")
      .def_property_readonly("events", &events_of,
                             "ProcessEvents: when the process is switched on and off.")
      .def_property_readonly("warnings", [](const JobMotion& x) { return x.motion()->warnings; })
      .def(
          "save",
          [](const JobMotion& x, const std::filesystem::path& file) {
            io::write_file(file, motion_text(x, file));
          },
          py::arg("file"),
          "The ending chooses: .csv, .json or .yaml (ROS 2's JointTrajectory, with `events`), "
          ".mcap (JointState, with /process).")
      .def("__len__",
           [](const JobMotion& x) {
             return x.timing->motion ? x.timing->motion->arms.front().rows.size() : std::size_t{0};
           })
      .def("__repr__", [](const JobMotion& x) { return "<JobMotion " + motion_words(x) + ">"; });
}

void bind_check(py::module_& m) {
  py::class_<JobCheck>(m, "JobCheck", "What an independent look at a job's rows found.")
      .def(pickling<JobCheck>())
      .def_property_readonly("passed", [](const JobCheck& c) { return c.result.passed; })
      .def("__bool__", [](const JobCheck& c) { return c.result.passed; })
      .def_property_readonly(
          "failures", [](const JobCheck& c) { return c.result.failures; },
          "A line each, with part and row; the first 20.")
      .def_property_readonly("failure_count",
                             [](const JobCheck& c) { return c.result.failure_count; })
      .def_property_readonly(
          "cost", [](const JobCheck& c) { return c.result.cost; }, "Of the rows as given.")
      .def_property_readonly(
          "runs",
          [](const JobCheck& c) {
            std::vector<Check> runs;
            for (const CheckResult& run : c.result.runs) runs.push_back({run, c.joint_names});
            return runs;
          },
          "A Check of each run, in their order.")
      .def("__repr__", [](const JobCheck& c) {
        if (c.result.passed)
          return formatted("<JobCheck passed: %zu runs, cost %.6g>", c.result.runs.size(),
                           c.result.cost);
        return formatted("<JobCheck failed, %lld failures: ",
                         static_cast<long long>(c.result.failure_count)) +
               c.result.failures.front() + ">";
      });
}

}  // namespace

std::shared_ptr<const swivel::ArmMotion> JobMotion::motion() const {
  if (!timing->motion) throw py::value_error("the motion is " + motion_words(*this));
  return {timing, &timing->motion->arms.front()};
}

std::shared_ptr<const swivel::Problem> without_surroundings(const swivel::Problem& job) {
  auto rest = std::make_shared<swivel::Problem>();
  ArmTask& arm = rest->arm();
  const ArmTask& given = job.arm();
  arm.base_link = given.base_link, rest->source = job.source;
  arm.strokes = given.strokes;
  arm.home = given.home, arm.order = given.order, arm.lift = given.lift;
  return rest;
}

std::vector<JobPart> parts_of(const JobPlan& plan, const std::vector<swivel::Part>& of) {
  std::vector<JobPart> parts;
  for (const swivel::Part& one : of) {
    JobPart& part = parts.emplace_back();
    part.rows = std::shared_ptr<const Rows>(plan.plan, &one.rows);
    part.joint_names = plan.result().arm().joint_names;
    if (one.run) {
      part.stroke = name_of(*plan.job, *one.run), part.reversed = one.run->reversed;
      part.begin = s_of_piece(plan.job->arm().strokes[one.run->stroke]);
    }
    part.cost = one.cost, part.barred_by = one.barred_by;
    part.process = process_of_rows(one, *plan.job);
  }
  return parts;
}

JobMotion motion_of(const JobPlan& plan) {
  if (!plan.plan->motion) throw py::value_error("the plan has no motion");
  JobMotion motion;
  motion.timing = std::shared_ptr<const MotionTiming>(plan.plan, &*plan.plan->motion);
  motion.job = plan.job;
  for (const RunAnswer& run : plan.result().arm().runs) motion.order.push_back(run.run);
  motion.joint_names = plan.result().arm().joint_names;
  return motion;
}

void bind_job_results(py::module_& m) {
  bind_part(m);
  bind_run(m);
  bind_lift_off(m);
  bind_motion(m);
  bind_plan(m);
  bind_check(m);
}

}  // namespace swivel::python
