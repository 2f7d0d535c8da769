// SPDX-License-Identifier: BSD-3-Clause
// Bindings of trajectories, plans, motions and verdicts.
#include "results.hpp"

#include "archive.hpp"

#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"

namespace swivel::python {

namespace {

using Rows = std::vector<TrajectoryRow>;

template <class Row, class Number>
py::array_t<Number> member_column(const std::shared_ptr<const std::vector<Row>>& rows,
                                  Number Row::*member) {
  return column(rows, rows->empty() ? nullptr : &(rows->front().*member));
}
py::array_t<double> joints_of(const std::shared_ptr<const Rows>& rows) {
  return column(rows, rows->empty() ? nullptr : rows->front().q.data(), kDof);
}
template <class Number>
py::array_t<Number> timed_column(const Motion& motion, Number TrajectoryRow::*member) {
  const auto rows = motion.rows();
  return column(rows, rows->empty() ? nullptr : &(rows->front().row.*member));
}
py::array_t<double> timed_joints(const Motion& motion, const Config TimedRow::*member) {
  const auto rows = motion.rows();
  return column(rows, rows->empty() ? nullptr : (rows->front().*member).data(), kDof);
}

std::string without_end(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

io::JointNames to_joint_names(const std::vector<std::string>& names) {
  io::JointNames all;
  if (!names.empty() && names.size() != kDof)
    throw py::value_error("joint_names: " + std::to_string(names.size()) + ": allowed are 7");
  for (std::size_t k = 0; k < kDof; ++k)
    all[k] = names.empty() ? "joint_" + std::to_string(k + 1) : names[k];
  return all;
}

bool last_joint_is_roll(const io::JointNames& names) {
  return names[kDof - 1] == "roll";
}

Trajectory make_trajectory(const ArrayLike& joints, const ArrayLike& s, const ArrayLike& phi,
                           const ArrayLike& branch, const std::vector<std::string>& names,
                           const ArrayLike& roll) {
  const auto q = to_joints(joints, "joints");
  using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const auto numbers = [&](py::handle source, const char* name) {
    const Doubles array = Doubles::ensure(source);
    if (!array || array.ndim() != 1 || array.shape(0) != q.shape(0)) {
      PyErr_Clear();
      throw py::value_error(std::string(name) + ": allowed is one number for each of the " +
                            std::to_string(q.shape(0)) + " rows");
    }
    return array;
  };
  const Doubles along = numbers(s, "s");
  const Doubles angle = phi.is_none() ? Doubles() : numbers(phi, "phi"),
                label = branch.is_none() ? Doubles() : numbers(branch, "branch"),
                turn = roll.is_none() ? Doubles() : numbers(roll, "roll");
  auto rows = std::make_shared<Rows>(static_cast<std::size_t>(q.shape(0)));
  for (py::ssize_t k = 0; k < q.shape(0); ++k) {
    TrajectoryRow& row = (*rows)[static_cast<std::size_t>(k)];
    row.q = Eigen::Map<const Config>(q.data(k, 0));
    row.s = along.at(k);
    if (!phi.is_none()) row.phi = angle.at(k);
    if (!roll.is_none()) row.roll = turn.at(k);
    if (!branch.is_none()) {
      const double value = label.at(k);
      if (!(value >= 0 && value <= 7) || value != static_cast<int>(value))
        throw py::value_error("branch[" + std::to_string(k) +
                              "]: allowed are whole numbers from 0 to 7");
      row.branch = static_cast<int>(value);
    }
  }
  Trajectory made{std::move(rows), to_joint_names(names)};
  if (!roll.is_none() && last_joint_is_roll(made.joint_names))
    throw py::value_error("roll: is the last joint of these rows already: allowed is None");
  return made;
}

void save_trajectory(const Trajectory& trajectory, const std::filesystem::path& csv) {
  PlanResult result;
  result.trajectory = *trajectory.rows;
  result.joint_names = trajectory.joint_names;
  io::write_trajectory(csv, result);
}

std::variant<Trajectory, Motion> load_trajectory(const std::filesystem::path& name,
                                                 const std::vector<std::string>& names,
                                                 const Problem* given) {
  const PathProblem* const problem = given != nullptr ? &path_of(*given, "problem") : nullptr;
  const io::JointNames joint_names = to_joint_names(names);
  io::TrajectoryFile file = io::load_trajectory_file(name, joint_names);
  const bool timed = !file.timed.empty();
  if (!(timed ? file.stated.motions() : file.stated.rows())) {
    if (problem == nullptr)
      throw InputError(name.string() + ": does not state all of s, phi, branch, " +
                       (timed ? "speeds and accelerations" : "roll") +
                       ": allowed is a problem as well, by which they can be worked out");
    const PreparedRobot robot(*problem);
    if (timed)
      file.timed = complete_motion(robot, *problem, std::move(file.timed), file.stated);
    else
      file.rows = complete_rows(robot, *problem, std::move(file.rows), file.stated);
  }
  if (!timed) return Trajectory{std::make_shared<const Rows>(std::move(file.rows)), joint_names};
  auto timing = std::make_shared<TimingResult>();
  TimedPath& path = timing->motion.emplace();
  path.duration = file.timed.back().t;
  path.rate = static_cast<double>(file.timed.size() - 1) / (path.duration - file.timed.front().t);
  path.rows = std::move(file.timed);
  return Motion{std::move(timing), joint_names, ""};
}

Typed<"dict[str, _Array]"> peaks_of(const Motion& motion) {
  const char* const names[] = {"speed", "acceleration", "jerk"};
  py::dict peaks;
  for (std::size_t k = 0; k < 3; ++k) {
    py::array_t<double> ratios(kDof);
    for (std::size_t j = 0; j < kDof; ++j) ratios.mutable_at(j) = motion.path().peaks[k][j].ratio;
    peaks[names[k]] = ratios;
  }
  return peaks;
}

std::string motion_words(const Motion& motion) {
  if (motion.timing->failure)
    return formatted("not executable at s = %.4f m: ", motion.timing->failure->s) +
           motion.timing->failure->reason;
  const TimedPath& path = motion.path();
  std::string text =
      formatted("%.3f s, %zu samples at %.6g Hz", path.duration, path.rows.size(), path.rate);
  if (path.ideal > 0) text += formatted(" (%.3f s at the speed asked throughout)", path.ideal);
  if (!path.stops.empty()) text += formatted(", %zu stops", path.stops.size());
  return text;
}

std::string refined_words(const Refined& refined) {
  if (!refined.refined) return "not refined: " + refined.reason;
  return formatted("refined: cost %.6g before, %.6g now", refined.cost_before, refined.cost);
}

std::string plan_words(const Plan& plan) {
  const PlanResult& result = plan.result();
  std::string text = answer_text(result);
  text = text.substr(0, text.find('\n'));
  const auto took = result.time_ms.find("plan");
  if (took != result.time_ms.end()) text += formatted(" | %.1f ms", took->second);
  std::string after;
  if (plan.plan->refinement) after = refined_words(*plan.plan->refinement);
  if (plan.plan->motion)
    after +=
        (after.empty() ? "" : "; ") +
        motion_words({std::shared_ptr<const TimingResult>(plan.plan, &*plan.plan->motion), {}, ""});
  return text + (after.empty() ? "" : "\n      " + after);
}

template <class E>
std::vector<std::pair<std::string, E>> names_from(E first, E last) {
  std::vector<std::pair<std::string, E>> names;
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k)
    names.emplace_back(to_string(static_cast<E>(k)), static_cast<E>(k));
  return names;
}

std::pair<std::string, std::string> bodies_of(const std::array<std::string, 2>& bodies) {
  return {bodies[0], bodies[1]};
}
/// Returns a distance from a limit with its unit: degrees, or mm of a joint that slides.
std::string distance_words(const NearestLimit& limit) {
  return limit.slides ? formatted("%.2f mm", 1e3 * limit.margin)
                      : formatted("%.2f deg", limit.margin * 180 / kPi);
}
std::optional<std::string> or_none(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}
std::optional<std::pair<int, int>> pair_or_none(int first, int last) {
  if (first < 0 && last < 0) return {};
  return std::pair(first, last);
}

void bind_measures(py::module_& m) {
  py::class_<LeastMargin>(m, "LeastMargin",
                          "The row and pair that come nearest to what must be kept there.")
      .def(pickling<LeastMargin>())
      .def_readonly("margin", &LeastMargin::margin, "clearance - required, m.")
      .def_readonly("clearance", &LeastMargin::clearance, "m.")
      .def_readonly("required", &LeastMargin::required, "m.")
      .def_property_readonly("bodies", [](const LeastMargin& x) { return bodies_of(x.bodies); })
      .def_readonly("row", &LeastMargin::row)
      .def("__repr__", [](const LeastMargin& x) {
        return formatted("<LeastMargin %.3f mm: %.3f mm of %.3f asked, ", 1e3 * x.margin,
                         1e3 * x.clearance, 1e3 * x.required) +
               x.bodies[0] + " - " + x.bodies[1] + formatted(", row %d>", x.row);
      });
  py::class_<DeepestContact>(
      m, "DeepestContact", "The deepest contact of bodies that a scene object allows to touch it.")
      .def(pickling<DeepestContact>())
      .def_readonly("depth", &DeepestContact::depth,
                    "m, found at a row: the bodies are at least so deep.")
      .def_readonly("at_most", &DeepestContact::at_most,
                    "m: the bodies are nowhere deeper at rows; None where that is not known "
                    "within 0.5 mm.")
      .def_readonly("allowed", &DeepestContact::allowed, "m, or None: however deep.")
      .def_property_readonly("bodies", [](const DeepestContact& x) { return bodies_of(x.bodies); })
      .def_readonly("row", &DeepestContact::row, "Index of the row.")
      .def("__repr__", [](const DeepestContact& x) {
        return formatted("<DeepestContact %.3f mm", 1e3 * x.depth) +
               (x.at_most ? formatted(", at most %.3f", 1e3 * *x.at_most) : "") +
               (x.allowed ? formatted(", allowed %.3f", 1e3 * *x.allowed) : "") + ", " +
               x.bodies[0] + " - " + x.bodies[1] + formatted(", row %d>", x.row);
      });
  py::class_<NearestLimit>(m, "NearestLimit", "How near the rows come to a joint's limit.")
      .def(pickling<NearestLimit>())
      .def_readonly("margin", &NearestLimit::margin,
                    "rad, to the limit itself; m of a joint that slides.")
      .def_readonly("joint", &NearestLimit::joint)
      .def_property_readonly(
          "side", [](const NearestLimit& x) { return to_string(x.side); }, "'lower' or 'upper'.")
      .def_readonly("row", &NearestLimit::row)
      .def_readonly("slides", &NearestLimit::slides)
      .def("__repr__", [](const NearestLimit& x) {
        return "<NearestLimit " + x.joint + ", " + distance_words(x) +
               formatted(" from its %s limit, row %d>", to_string(x.side), x.row);
      });
  py::class_<TopToolSpeed>(
      m, "TopToolSpeed",
      "The highest constant speed of the tool at which no joint need turn faster than it can.")
      .def(pickling<TopToolSpeed>())
      .def_readonly("speed", &TopToolSpeed::speed, "m/s.")
      .def_readonly("joint", &TopToolSpeed::joint, "That bounds it.")
      .def_readonly("row", &TopToolSpeed::row, "On the step from it.")
      .def("__repr__", [](const TopToolSpeed& x) {
        return formatted("<TopToolSpeed %.4g m/s, ", x.speed) + x.joint +
               formatted(", row %d>", x.row);
      });
  using ToolPathError = decltype(Measures::tool_path_error_mm);
  py::class_<ToolPathError>(m, "ToolPathError",
                            "How far the tool leaves its path between layers, mm.")
      .def(pickling<ToolPathError>())
      .def_readonly("mean", &ToolPathError::mean, "mm.")
      .def_readonly("max", &ToolPathError::max, "mm.")
      .def_readonly("row", &ToolPathError::row, "The step from it has the largest.")
      .def_readonly("allowed", &ToolPathError::allowed, "limits.tool_path_error, m, or None.")
      .def("__repr__", [](const ToolPathError& x) {
        return formatted("<ToolPathError mean %.4g mm, max %.4g mm>", x.mean, x.max);
      });
  py::class_<Measures>(m, "Measures",
                       "What a trajectory comes near to, and how well it follows its path. None: "
                       "not asked for, or does not apply.")
      .def(pickling<Measures>())
      .def_readonly("nearest_limit", &Measures::nearest_limit,
                    "NearestLimit of the joints that turn.")
      .def_readonly("nearest_slide_limit", &Measures::nearest_slide_limit,
                    "NearestLimit of the joint that slides.")
      .def_readonly("top_tool_speed", &Measures::top_tool_speed, "TopToolSpeed.")
      .def_property_readonly(
          "tool_path_error_mm",
          [](const Measures& x) {
            return x.evidence.tool_path_error ? std::optional(x.tool_path_error_mm) : std::nullopt;
          },
          "ToolPathError.")
      .def_readonly("min_clearance", &Measures::min_clearance, "Of the nearest pair on any row, m.")
      .def_property_readonly(
          "min_clearance_status",
          [](const Measures& x) -> MeasureStatusName {
            return to_string(x.min_clearance_status());
          },
          "Of min_clearance and min_margin: 'measured', 'none' (no pair is near) or "
          "'not_measured' (not asked for, or time ran out).")
      .def_readonly("min_margin", &Measures::min_margin, "LeastMargin.")
      .def_readonly("deepest_contact", &Measures::deepest_contact, "DeepestContact.")
      .def_property_readonly(
          "deepest_contact_status",
          [](const Measures& x) -> MeasureStatusName {
            return to_string(x.deepest_contact_status());
          },
          "'measured', 'none' (no allowed pair was found to touch) or 'not_measured' (not asked "
          "for, or time ran out).")
      .def_property_readonly(
          "min_manipulability",
          [](const Measures& x) {
            return x.evidence.postures ? std::optional(x.min_manipulability) : std::nullopt;
          },
          "Least sqrt(det(J J^T)).")
      .def_property_readonly(
          "arm_angle",
          [](const Measures& x) {
            return py::array_t<double>(static_cast<py::ssize_t>(x.arm_angle.size()),
                                       x.arm_angle.data());
          },
          "Conventional arm angle of each row of S-R-S arms, (n,), rad; empty where not asked for.")
      .def("__repr__", [](const Measures& x) {
        std::string text;
        const auto add = [&](const std::string& more) {
          text += (text.empty() ? "" : ", ") + more;
        };
        if (x.min_clearance) add(formatted("least clearance %.3f mm", 1e3 * *x.min_clearance));
        if (x.min_margin)
          add(formatted("%.3f mm more than asked (", 1e3 * x.min_margin->margin) +
              x.min_margin->bodies[0] + " - " + x.min_margin->bodies[1] + ")");
        if (x.deepest_contact)
          add(formatted("contact %.3f mm deep", 1e3 * x.deepest_contact->depth));
        if (const std::string missing = words_of_unmeasured(x); !missing.empty())
          add("not measured: " + missing);
        for (const auto& nearest : {x.nearest_limit, x.nearest_slide_limit})
          if (nearest) add(nearest->joint + " " + distance_words(*nearest) + " from its limit");
        if (x.evidence.tool_path_error)
          add(formatted("tool %.4g mm off", x.tool_path_error_mm.max));
        if (x.top_tool_speed) add(formatted("tool speed up to %.3g m/s", x.top_tool_speed->speed));
        return "<Measures " + text + ">";
      });
}

void bind_verdicts(py::module_& m) {
  bind_enum<PlanStatus>(m, "Status", "What became of a plan.",
                        names_from(PlanStatus::kSolved, PlanStatus::kCancelled));
  bind_enum<Cause::Kind>(m, "CauseKind", "What removes nodes or edges of a lattice.",
                         names_from(Cause::Kind::kNone, Cause::Kind::kCheck));
  bind_enum<Advice::Change>(m, "Change", "What may be changed of a problem.",
                            names_from(Advice::Change::kFreeStart, Advice::Change::kMovePaths));
  bind_enum<Advice::Outcome>(m, "Outcome", "What planning the changed problem gave.",
                             names_from(Advice::Outcome::kSolved, Advice::Outcome::kUnknown));

  py::class_<Cause>(m, "Cause", "One thing that ends paths. str() says it in words, with figures.")
      .def(pickling<Cause>())
      .def_readonly("kind", &Cause::kind, "CauseKind.")
      .def_property_readonly(
          "side", [](const Cause& c) { return or_none(to_string(c.side)); },
          "'lower', 'upper' or None.")
      .def_property_readonly(
          "joint", [](const Cause& c) { return or_none(c.joint); }, "Of limits, steps and speeds.")
      .def_readonly("other_joints", &Cause::other_joints,
                    "Every node has several joints beyond their limits; `joint` is the furthest.")
      .def_readonly("unwinds", &Cause::unwinds,
                    "Of a limit: the joint can follow only beyond the end of its range, where it "
                    "would have to unwind by a turn.")
      .def_property_readonly(
          "bodies",
          [](const Cause& c) {
            const bool none = c.bodies[0].empty() && c.bodies[1].empty();
            return none ? std::nullopt : std::optional(bodies_of(c.bodies));
          },
          "Of pairs: two names.")
      .def_readonly("between_layers", &Cause::between_layers)
      .def_property_readonly(
          "object", [](const Cause& c) { return or_none(c.object); },
          "A scene object that several bodies come too near to.")
      .def_readonly("value", &Cause::value,
                    "What it is where it misses least, in `unit`; None where it was not measured.")
      .def_readonly("limit", &Cause::limit, "What is allowed, in `unit`.")
      .def_readonly("over", &Cause::over,
                    "Of the roll's slope: the length of path for which `limit` is allowed, m.")
      .def_property_readonly("unit", &Cause::unit, "'m', 'rad' or ''.")
      .def_property_readonly(
          "check", [](const Cause& c) { return or_none(c.check); },
          "Name of the caller's own check.")
      .def("__str__",
           [](const Cause& c) {
             const std::string by = figures(c);
             return words(c) + (by.empty() ? "" : " (" + by + ")");
           })
      .def("__repr__", [](const Cause& c) {
        return "<Cause " + py::str(py::cast(c)).cast<std::string>() + ">";
      });
  py::class_<EmptyLayers>(m, "EmptyLayers",
                          "Layers, one after the other, that have no node left for one cause.")
      .def(pickling<EmptyLayers>())
      .def_property_readonly(
          "layers", [](const EmptyLayers& e) { return std::pair(e.first, e.last); },
          "First and last.")
      .def_property_readonly(
          "s", [](const EmptyLayers& e) { return std::pair(e.first_s, e.last_s); },
          "m, first and last.")
      .def_property_readonly(
          "waypoints",
          [](const EmptyLayers& e) { return pair_or_none(e.first_waypoint, e.last_waypoint); })
      .def_readonly("cause", &EmptyLayers::cause, "At the layer that misses least.")
      .def_readonly("most", &EmptyLayers::most, "The most that one of them misses by.")
      .def("__repr__", [](const EmptyLayers& e) {
        return formatted("<EmptyLayers %d to %d: ", e.first, e.last) + words(e.cause) + ">";
      });
  py::class_<Diagnosis>(m, "Diagnosis", "Why an infeasible problem has no path.")
      .def(pickling<Diagnosis>())
      .def_readonly("reached_layer", &Diagnosis::reached_layer,
                    "The furthest that a valid path reaches; None: the first layer is empty.")
      .def_readonly("reached_s", &Diagnosis::reached_s, "m.")
      .def_readonly("cause", &Diagnosis::cause, "The one thing that ends every path there.")
      .def_readonly("at_s", &Diagnosis::at_s, "m, of the layer past the furthest one.")
      .def_property_readonly(
          "waypoints",
          [](const Diagnosis& d) { return pair_or_none(d.waypoints[0], d.waypoints[1]); },
          "Before and after it.")
      .def_readonly("without_it", &Diagnosis::without_it,
                    "A layer that paths reach if the cause alone is removed.")
      .def_readonly("without_it_s", &Diagnosis::without_it_s, "m.")
      .def_readonly("together", &Diagnosis::together,
                    "What must go besides, where no single thing helps.")
      .def_readonly("empty_layers", &Diagnosis::empty_layers, "With evidence=True.")
      .def_property_readonly(
          "removed", [](const Diagnosis& d) -> Typed<"list[tuple[Cause, int]]"> {
            py::list all;
            for (const auto& [cause, count] : d.removed) all.append(py::make_tuple(cause, count));
            return all;
          },
          "With evidence=True: (Cause, nodes and edges that it removed just past the furthest "
          "layer).")
      .def_property_readonly(
          "holds", [](const Diagnosis& d) { return to_string(d.holds()); },
          "'this_resolution', 'exact_tool' (whatever the resolution, for a tool exactly on its "
          "path), or\n"
          "'every_resolution' (a waypoint has no joints within their limits).")
      .def_property_readonly(
          "unreachable",
          [](const Diagnosis& d) -> std::optional<int> {
            return d.unreachable ? std::optional(d.unreachable->layer) : std::nullopt;
          },
          "A layer that no joints within their limits reach, at any arm angle.")
      .def_readonly("complete", &Diagnosis::complete,
                    "False where time ran out; what is said is true nevertheless.")
      .def_readonly("layers_known", &Diagnosis::layers_known)
      .def("__repr__", [](const Diagnosis& d) {
        return "<Diagnosis: " + py::str(py::cast(d.cause)).cast<std::string>() +
               (d.reached_s ? formatted(" ends every path by s = %.4f m>", *d.reached_s)
                            : std::string(" bars the first layer>"));
      });
  py::class_<Advice>(
      m, "Advice",
      "One change of a problem that has no path, and what planning the changed problem gave.")
      .def(pickling<Advice>())
      .def_readonly("change", &Advice::change, "Change.")
      .def_property_readonly("object", [](const Advice& a) { return or_none(a.object); })
      .def_readonly("asked", &Advice::from, "Of limits: what the problem asks, in its unit.")
      .def_readonly("changed_to", &Advice::to, "Of limits: what this is about.")
      .def_readonly("offset", &Advice::offset, "Of an object that is moved, (3,), m, base frame.")
      .def_property_readonly(
          "also", [](const Advice& a) { return or_none(a.also); },
          "Name of a second object that is moved or removed with the first one; None: none is.")
      .def_readonly("also_offset", &Advice::also_offset,
                    "Of a second object that is moved, (3,), m, base frame.")
      .def_readonly("outcome", &Advice::outcome, "Outcome.")
      .def_readonly("cost", &Advice::cost, "Where it solves.")
      .def_readonly("reached_s", &Advice::reached_s, "Where there is no path either, m.")
      .def("__repr__", [](const Advice& a) {
        return "<Advice " + std::string(to_string(a.outcome)) + ": " + words(a) +
               (a.cost ? formatted(", cost %.6g>", *a.cost) : std::string(">"));
      });
  py::class_<SpecialPair>(
      m, "SpecialPair", "A robot pair without an SRDF's word that is not kept apart as others are.")
      .def(pickling<SpecialPair>())
      .def_property_readonly("bodies", [](const SpecialPair& p) { return bodies_of(p.bodies); })
      .def_readonly("median", &SpecialPair::median, "Clearance over sampled postures, m.")
      .def_readonly("clearance", &SpecialPair::clearance, "m, kept on layers.")
      .def_readonly("edge_clearance", &SpecialPair::edge_clearance, "m, kept between them.")
      .def("__repr__", [](const SpecialPair& p) {
        return "<SpecialPair " + p.bodies[0] + " - " + p.bodies[1] +
               formatted(": keeps %.3f mm>", 1e3 * p.clearance);
      });
}

void bind_trajectory(py::module_& m) {
  py::class_<Trajectory>(
      m, "Trajectory",
      "Rows along a tool path. Arrays are read-only views that keep the rows alive.")
      .def(pickling<Trajectory>())
      .def(py::init(&make_trajectory), py::arg("joints"), py::arg("s"), py::arg("phi") = py::none(),
           py::arg("branch") = py::none(), py::arg("joint_names") = std::vector<std::string>{},
           py::arg("roll") = py::none(),
           "joints: (n, 7), rad. s: (n,), m along the path. phi: carried arm angle, rad, and "
           "branch: 0 to 7, of S-R-S arms. roll: of seven-joint arms whose tool may turn, rad; the "
           "roll of six-joint arms is the last of the joints. All of these are 0 by default.")
      .def_property_readonly(
          "s", [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::s); },
          "(n,), m along the path.")
      .def_property_readonly(
          "phi", [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::phi); },
          "(n,), carried arm angle, rad.")
      .def_property_readonly(
          "branch",
          [](const Trajectory& t) { return member_column(t.rows, &TrajectoryRow::branch); },
          "(n,), 0 to 7.")
      .def_property_readonly(
          "roll",
          [](const Trajectory& t) {
            if (last_joint_is_roll(t.joint_names))
              return column(t.rows, t.rows->empty() ? nullptr : &t.rows->front().q[kDof - 1]);
            return member_column(t.rows, &TrajectoryRow::roll);
          },
          "(n,), by how much the tool is turned about its z axis, rad; 0 where it may not turn.")
      .def_property_readonly(
          "joints", [](const Trajectory& t) { return joints_of(t.rows); },
          "(n, 7) float64, rad, base to tip.")
      .def_readonly("joint_names", &Trajectory::joint_names)
      .def("save", &save_trajectory, py::arg("file"), "As CSV, docs/formats.md.")
      .def("__len__", [](const Trajectory& t) { return t.rows->size(); })
      .def("__repr__", [](const Trajectory& t) {
        return t.rows->empty() ? std::string("<Trajectory, empty>")
                               : formatted("<Trajectory of %zu rows, s %.4g to %.4g m>",
                                           t.rows->size(), t.rows->front().s, t.rows->back().s);
      });

  py::class_<TimedPath::Stop>(m, "Stop", "Where the tool comes to rest on its way.")
      .def(pickling<TimedPath::Stop>())
      .def_readonly("waypoint", &TimedPath::Stop::waypoint)
      .def_readonly("s", &TimedPath::Stop::s, "m.")
      .def_readonly("t", &TimedPath::Stop::t, "s.")
      .def("__repr__", [](const TimedPath::Stop& x) {
        return formatted("<Stop at waypoint %d, s = %.4f m, t = %.3f s>", x.waypoint, x.s, x.t);
      });
  py::class_<TimedPath::Slow>(m, "Slow", "A stretch that is slower than asked for.")
      .def(pickling<TimedPath::Slow>())
      .def_property_readonly(
          "s", [](const TimedPath::Slow& x) { return std::pair(x.from_s, x.to_s); },
          "m, from and to.")
      .def_property_readonly(
          "t", [](const TimedPath::Slow& x) { return std::pair(x.from_t, x.to_t); },
          "s, from and to.")
      .def_readonly("share", &TimedPath::Slow::share, "Of the speed asked for, at its slowest.")
      .def_readonly("joint", &TimedPath::Slow::joint, "Number of the joint that bounds it, from 0.")
      .def_property_readonly(
          "reason", [](const TimedPath::Slow& x) { return to_string(x.reason); },
          "'speed', 'acceleration' or 'jerk' of that joint.")
      .def_property_readonly(
          "singular", [](const TimedPath::Slow& x) { return or_none(x.singular); },
          "'shoulder', 'elbow', 'wrist' or None.")
      .def("__repr__", [](const TimedPath::Slow& x) {
        return formatted(
            "<Slow from s = %.4f to %.4f m: %.0f %% of the speed, for the %s of joint %d>",
            x.from_s, x.to_s, 100 * x.share, to_string(x.reason), x.joint);
      });
  py::class_<Motion>(
      m, "Motion",
      "A motion in time, from rest to rest, or why there is none. Arrays are read-only views.")
      .def(pickling<Motion>())
      .def_property_readonly("executable",
                             [](const Motion& x) { return x.timing->motion.has_value(); })
      .def_property_readonly(
          "reason",
          [](const Motion& x) {
            return x.timing->failure ? std::optional(x.timing->failure->reason) : std::nullopt;
          },
          "Why it is not executable, or None.")
      .def_property_readonly(
          "at_s",
          [](const Motion& x) {
            return x.timing->failure ? std::optional(x.timing->failure->s) : std::nullopt;
          },
          "Where it is not, m, or None.")
      .def_property_readonly(
          "t", [](const Motion& x) { return member_column(x.rows(), &TimedRow::t); }, "(m,), s.")
      .def_property_readonly(
          "s", [](const Motion& x) { return timed_column(x, &TrajectoryRow::s); },
          "(m,), m along the path.")
      .def_property_readonly(
          "phi", [](const Motion& x) { return timed_column(x, &TrajectoryRow::phi); },
          "(m,), carried arm angle, rad.")
      .def_property_readonly(
          "branch", [](const Motion& x) { return timed_column(x, &TrajectoryRow::branch); },
          "(m,), 0 to 7.")
      .def_property_readonly(
          "roll",
          [](const Motion& x) {
            const auto rows = x.rows();
            if (last_joint_is_roll(x.joint_names))
              return column(rows, rows->empty() ? nullptr : &rows->front().row.q[kDof - 1]);
            return timed_column(x, &TrajectoryRow::roll);
          },
          "(m,), by how much the tool is turned about its z axis, rad; 0 where it may not turn.")
      .def_property_readonly(
          "joints",
          [](const Motion& x) {
            const auto rows = x.rows();
            return column(rows, rows->empty() ? nullptr : rows->front().row.q.data(), kDof);
          },
          "(m, 7), rad.")
      .def_property_readonly(
          "velocities", [](const Motion& x) { return timed_joints(x, &TimedRow::v); },
          "(m, 7), rad/s.")
      .def_property_readonly(
          "accelerations", [](const Motion& x) { return timed_joints(x, &TimedRow::a); },
          "(m, 7), rad/s^2.")
      .def_readonly("joint_names", &Motion::joint_names)
      .def_property_readonly(
          "duration", [](const Motion& x) { return x.path().duration; },
          "s, until the tool rests at the end.")
      .def_property_readonly(
          "ideal", [](const Motion& x) { return x.path().ideal; },
          "s, at the speed asked for throughout.")
      .def_property_readonly(
          "rate", [](const Motion& x) { return x.path().rate; }, "Samples a second.")
      .def_property_readonly(
          "peaks", &peaks_of,
          "'speed', 'acceleration', 'jerk': (7,), the largest over what the joint can do.")
      .def_property_readonly(
          "slow", [](const Motion& x) { return x.path().slow; },
          "Stretches below the speed asked for.")
      .def_property_readonly(
          "stops", [](const Motion& x) { return x.path().stops; },
          "Corners that the tool stops at.")
      .def_property_readonly(
          "between_samples",
          [](const Motion& x) {
            return std::pair(x.path().between_position, x.path().between_angle);
          },
          "How far the tool leaves its path between samples, m and rad.")
      .def_property_readonly("warnings", [](const Motion& x) { return x.path().warnings; })
      .def(
          "save",
          [](const Motion& x, const std::filesystem::path& file) {
            io::write_file(file, io::motion_text(x.path(), x.joint_names, x.frame, file));
          },
          py::arg("file"),
          "The ending chooses: .csv, .json or .yaml (ROS 2's JointTrajectory), .mcap (JointState).")
      .def("__len__", [](const Motion& x) { return x.rows()->size(); })
      .def("__repr__", [](const Motion& x) { return "<Motion " + motion_words(x) + ">"; });

  py::class_<RefinedPath>(m, "Refined", "A path of the lattice and what refining made of it.")
      .def(pickling<RefinedPath>())
      .def_property_readonly(
          "refined", [](const RefinedPath& x) { return x.refined->refined; },
          "False: the rows are those given.")
      .def_property_readonly(
          "reason", [](const RefinedPath& x) { return or_none(x.refined->reason); },
          "Why they are, or None.")
      .def_property_readonly("trajectory",
                             [](const RefinedPath& x) {
                               return Trajectory{
                                   std::shared_ptr<const Rows>(x.refined, &x.refined->rows),
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
  m.def("_load_trajectory", &load_trajectory);
}

void bind_plan(py::module_& m) {
  py::class_<LatticeInfo>(m, "LatticeInfo", "The lattice that was searched.")
      .def(pickling<LatticeInfo>())
      .def_readonly("layers", &LatticeInfo::layers)
      .def_readonly("nodes", &LatticeInfo::nodes)
      .def_readonly("arcs", &LatticeInfo::arcs,
                    "Arcs of self-motion in all layers, of arms that are not S-R-S; else None.")
      .def_readonly("method", &LatticeInfo::method, "How solutions are found.")
      .def_readonly("complete", &LatticeInfo::complete, "False: \"no path\" means \"none found\".")
      .def_readonly("cost", &LatticeInfo::cost, "What the search minimised.")
      .def("__repr__", [](const LatticeInfo& x) {
        return formatted("<LatticeInfo %d layers, %lld nodes, ", x.layers,
                         static_cast<long long>(x.nodes)) +
               x.method + ">";
      });
  py::class_<Plan>(
      m, "Plan",
      "The answer of a planner: a trajectory, or why there is none. It outlives the planner.")
      .def(pickling<Plan>())
      .def_property_readonly(
          "status", [](const Plan& p) { return p.result().status; }, "Status.")
      .def_property_readonly("solved",
                             [](const Plan& p) { return p.result().status == PlanStatus::kSolved; })
      .def_property_readonly(
          "cost",
          [](const Plan& p) {
            const bool solved = p.result().status == PlanStatus::kSolved;
            return solved ? std::optional(p.result().cost) : std::nullopt;
          },
          "Of the trajectory, by the problem's metric; None unless solved.")
      .def_property_readonly(
          "trajectory",
          [](const Plan& p) {
            return Trajectory{std::shared_ptr<const Rows>(p.plan, &p.result().trajectory),
                              p.result().joint_names};
          },
          "Empty unless solved.")
      .def_property_readonly(
          "joints",
          [](const Plan& p) {
            return joints_of(std::shared_ptr<const Rows>(p.plan, &p.result().trajectory));
          },
          "(n, 7) float64, rad: those of the trajectory.")
      .def_property_readonly(
          "partial",
          [](const Plan& p) {
            return Trajectory{std::shared_ptr<const Rows>(p.plan, &p.result().partial),
                              p.result().joint_names};
          },
          "Where there is no answer: rows from the first on that are known to be valid; maybe "
          "none.")
      .def_property_readonly(
          "lattice_path",
          [](const Plan& p) {
            return Trajectory{
                std::shared_ptr<const Rows>(
                    p.plan, p.plan->refinement ? &p.plan->lattice_path : &p.result().trajectory),
                p.result().joint_names};
          },
          "The trajectory before it was refined.")
      .def_property_readonly(
          "measures", [](const Plan& p) -> const Measures& { return p.result(); },
          "What the trajectory comes near to; all of it with evidence=True.")
      .def_property_readonly(
          "diagnosis",
          [](const Plan& p) { return p.result().diagnosis ? &*p.result().diagnosis : nullptr; },
          py::return_value_policy::reference_internal,
          "Why there is no path; None unless infeasible.")
      .def_property_readonly(
          "refinement",
          [](const Plan& p) -> std::optional<RefinedPath> {
            if (!p.plan->refinement) return {};
            return RefinedPath{std::shared_ptr<const Refined>(p.plan, &*p.plan->refinement),
                               p.result().joint_names};
          },
          "Refined, where it was asked for and there is a path.")
      .def_property_readonly(
          "motion",
          [](const Plan& p) -> std::optional<Motion> {
            if (!p.plan->motion) return {};
            return Motion{std::shared_ptr<const TimingResult>(p.plan, &*p.plan->motion),
                          p.result().joint_names, p.frame};
          },
          "Motion, where it was asked for and there is a path.")
      .def_property_readonly(
          "stopped", [](const Plan& p) { return p.plan->stopped; },
          "With a path: time ran out before all that was asked for was done.")
      .def_property_readonly("planner", [](const Plan& p) { return p.result().planner; })
      .def_property_readonly("threads", [](const Plan& p) { return p.result().threads; })
      .def_property_readonly("joint_names", [](const Plan& p) { return p.result().joint_names; })
      .def_property_readonly(
          "held",
          [](const Plan& p) {
            std::map<std::string, double> held;
            for (const HeldJoint& joint : p.result().held) held[joint.name] = joint.position;
            return held;
          },
          "Joints between base and tip that are not planned -> where they stand, rad or m; the "
          "answer is of the arm with them "
          "there.")
      .def_property_readonly("lattice",
                             [](const Plan& p) -> const LatticeInfo& { return p.result().lattice; })
      .def_property_readonly(
          "counters", [](const Plan& p) { return counters_of(p.result().counters); },
          "Work done, by name.")
      .def_property_readonly(
          "time_ms", [](const Plan& p) { return p.result().time_ms; },
          "prepare, plan, report, and stages of these by name.")
      .def_property_readonly(
          "dropped_pairs", [](const Plan& p) { return p.result().dropped_pairs; },
          "Touch in every posture: not kept apart.")
      .def_property_readonly(
          "reduced_pairs", [](const Plan& p) { return p.result().reduced_pairs; },
          "Near by design: keep less.")
      .def_property_readonly("warnings", [](const Plan& p) { return p.result().warnings; })
      .def(
          "to_json",
          [](const Plan& p) {
            return io::to_json(answer_of(*p.plan, p.timing), one_path(PathProblem()));
          },
          "RESULT.json as text, docs/formats.md.")
      .def("__str__", [](const Plan& p) { return without_end(answer_text(p.result())); })
      .def("__repr__", [](const Plan& p) { return "<Plan " + plan_words(p) + ">"; });

  py::class_<Check>(m, "Check", "What an independent look at a trajectory found.")
      .def(pickling<Check>())
      .def_property_readonly("passed", [](const Check& c) { return c.result.passed; })
      .def("__bool__", [](const Check& c) { return c.result.passed; })
      .def_property_readonly(
          "failures", [](const Check& c) { return c.result.failures; },
          "A line each, with the row; the first 20.")
      .def_property_readonly("failure_count", [](const Check& c) { return c.result.failure_count; })
      .def_property_readonly(
          "worst_position", [](const Check& c) { return c.result.worst_position; },
          "m, tool against path at the rows.")
      .def_property_readonly(
          "worst_angle", [](const Check& c) { return c.result.worst_angle; }, "rad.")
      .def_property_readonly(
          "worst_path_error", [](const Check& c) { return c.result.worst_path_error; },
          "m, between rows.")
      .def_property_readonly(
          "worst_path_angle", [](const Check& c) { return c.result.worst_path_angle; }, "rad.")
      .def_property_readonly(
          "largest_step", [](const Check& c) { return c.result.largest_step; },
          "A joint's move over what is allowed.")
      .def_property_readonly(
          "cost", [](const Check& c) { return c.result.cost; }, "Of the rows as given.")
      .def_property_readonly(
          "rounded", [](const Check& c) { return c.result.rounded; },
          "Whether the rows were judged on the path of motions, whose corners are rounded.")
      .def_property_readonly(
          "min_clearance", [](const Check& c) { return c.result.min_clearance; },
          "m, of any pair at the rows.")
      .def_property_readonly(
          "min_clearance_status",
          [](const Check& c) -> MeasureStatusName {
            return to_string(c.result.min_clearance_status);
          },
          "Of min_clearance and min_margin: 'measured', 'none' (no pair is near) or "
          "'not_measured' (no row could be examined).")
      .def_property_readonly(
          "min_margin", [](const Check& c) { return c.result.min_margin; },
          "m, least clearance less what the pair must keep.")
      .def_property_readonly(
          "deepest_contact", [](const Check& c) { return c.result.deepest_contact; },
          "DeepestContact.")
      .def_property_readonly(
          "deepest_contact_status",
          [](const Check& c) -> MeasureStatusName {
            return to_string(c.result.deepest_contact_status);
          },
          "'measured', 'none' (no allowed pair was found to touch) or 'not_measured' (a row has "
          "joints that are no numbers).")
      .def_property_readonly(
          "duration",
          [](const Check& c) {
            return c.result.motion ? std::optional(c.result.motion->duration) : std::nullopt;
          },
          "Of motions, s.")
      .def_property_readonly(
          "peaks", [](const Check& c) -> std::optional<Typed<"dict[str, float]">> {
            if (!c.result.motion) return {};
            py::dict peaks;
            const char* const names[] = {"speed", "acceleration", "jerk"};
            for (std::size_t k = 0; k < 3; ++k) peaks[names[k]] = c.result.motion->peaks[k].ratio;
            return peaks;
          },
          "Of motions: the largest over what the joint can do, by name.")
      .def("__repr__", [](const Check& c) {
        const CheckResult& r = c.result;
        std::string text = formatted("<Check passed: cost %.6g", r.cost);
        if (!r.passed)
          text =
              formatted("<Check failed, %lld failures: ", static_cast<long long>(r.failure_count)) +
              r.failures.front();
        if (r.min_clearance)
          text += formatted(", least clearance %.3f mm, %.3f mm more than asked",
                            1e3 * *r.min_clearance, 1e3 * *r.min_margin);
        if (r.deepest_contact)
          text += formatted(", contact %.3f mm deep", 1e3 * r.deepest_contact->depth);
        return text + ">";
      });
}

}  // namespace

Typed<"dict[str, int]"> counters_of(const Counters& c) {
  py::dict all;
  all["ik_nodes"] = c.ik_nodes;
  all["edges"] = c.edges;
  all["nodes_checked"] = c.nodes_checked;
  all["edges_checked"] = c.edges_checked;
  all["fcl_calls"] = c.fcl_calls;
  all["certified_free"] = c.proved_free;
  all["certified_colliding"] = c.proved_colliding;
  all["expansions"] = c.expansions;
  all["iterations"] = c.iterations;
  return all;
}

std::shared_ptr<const std::vector<TimedRow>> Motion::rows() const {
  if (timing->motion) return {timing, &timing->motion->rows};
  return std::make_shared<const std::vector<TimedRow>>();
}

const TimedPath& Motion::path() const {
  if (!timing->motion)
    throw py::value_error("the motion is not executable: " +
                          (timing->failure ? timing->failure->reason : "stopped"));
  return *timing->motion;
}

void bind_results(py::module_& m) {
  bind_measures(m);
  bind_verdicts(m);
  bind_trajectory(m);
  bind_plan(m);
}

}  // namespace swivel::python
