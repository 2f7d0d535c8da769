// SPDX-License-Identifier: BSD-3-Clause
// Bindings of answers and of their arms.
#include "answers/answer.hpp"

#include <cmath>
#include <map>

#include "base/archive.hpp"
#include "problems/problem.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

/// Binds words that arms have, and answers with one arm: each is read of the arm.
template <class T>
class ArmWords {
 public:
  explicit ArmWords(py::class_<T>& type) : type_(type) {}
  /// Binds a word of any arm. `get` returns it of an Arm.
  template <class Get>
  ArmWords& word(const char* name, const Get& get, const char* doc) {
    type_.def_property_readonly(
        name, [name, get](const T& self) { return get(arm_of(self, name)); }, doc);
    return *this;
  }
  /// Binds a word of arms that run one path and nothing else.
  template <class Get>
  ArmWords& path_word(const char* name, const Get& get, const char* doc) {
    return word(
        name,
        [name, get](const Arm& arm) {
          require_path(arm.of, name);
          return get(arm);
        },
        doc);
  }
  /// Binds a word of arms with strokes.
  template <class Get>
  ArmWords& strokes_word(const char* name, const Get& get, const char* doc) {
    return word(
        name,
        [name, get](const Arm& arm) {
          require_strokes(arm.of, name);
          return get(arm);
        },
        doc);
  }

 private:
  py::class_<T>& type_;
};

std::optional<double> finite_or_none(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

Trajectory first_rows(const Arm& arm, const std::vector<swivel::Part>& parts) {
  static const std::vector<TrajectoryRow> none;
  return arm.trajectory_of(parts.empty() ? none : parts.front().rows);
}

/// Returns the runs between which no transition was found: their names, None for home.
std::optional<std::pair<std::optional<std::string>, std::optional<std::string>>> no_transition_of(
    const Arm& arm) {
  const ArmAnswer& found = arm.found();
  if (!found.no_transition) return {};
  const std::vector<Run> runs = runs_of(arm);
  const auto name = [&](std::size_t k) {
    return k < runs.size() ? std::optional(runs[k].stroke) : std::nullopt;
  };
  const std::size_t to = found.no_transition->to;
  return std::pair(to == 0 ? std::nullopt : name(to - 1), name(to));
}

/// Binds what is known of any arm.
template <class T>
void bind_words_of_arms(py::class_<T>& type) {
  ArmWords<T>(type)
      .word(
          "parts", [](const Arm& x) { return parts_of(x, x.found().parts); },
          "Runs and transitions, Parts, in the order in which they are executed; none unless "
          "solved.")
      .word(
          "partial_parts", [](const Arm& x) { return parts_of(x, x.found().partial); },
          "Where there is no answer: of strokes the parts of the cheapest one known when time was "
          "up, unproved; of a path a part with the rows of `partial`. Maybe none.")
      .word("runs", &runs_of, "Runs, in the order in which they are executed.")
      .word(
          "given", [](const Arm& x) { return x.found().given; },
          "Whether the motion of this arm was given.")
      .word(
          "joint_names", [](const Arm& x) { return names_in(x.found().joint_names); },
          "Base to tip.")
      .word(
          "held",
          [](const Arm& x) {
            std::map<std::string, double> held;
            for (const HeldJoint& joint : x.found().held) held[joint.name] = joint.position;
            return held;
          },
          "Joints between base and tip that are not planned -> where they stand, rad or m; the "
          "answer is of the arm with them there.")
      .word(
          "counters", [](const Arm& x) { return counters_of(x.found().counters); },
          "Work done, by name.")
      .word(
          "dropped_pairs", [](const Arm& x) { return x.found().dropped_pairs; },
          "Touch in every posture: not kept apart.")
      .word(
          "reduced_pairs", [](const Arm& x) { return x.found().reduced_pairs; },
          "Near by design: keep less.");
}

/// Binds what is known of arms that run one path and nothing else.
template <class T>
void bind_words_of_paths(py::class_<T>& type) {
  ArmWords<T>(type)
      .path_word(
          "trajectory", [](const Arm& x) { return first_rows(x, x.found().parts); },
          "Of one path. Empty unless solved; rows of two arms of one number are simultaneous.")
      .path_word(
          "joints", [](const Arm& x) { return joints_of(first_rows(x, x.found().parts)); },
          "(n, 7) float64, rad: those of the trajectory.")
      .path_word(
          "partial", [](const Arm& x) { return first_rows(x, x.found().partial); },
          "Where there is no answer: rows from the first on that are known to be valid; maybe "
          "none.")
      .path_word(
          "lattice_path",
          [](const Arm& x) {
            const auto& refined = x.of.found->refinement;
            return refined ? x.trajectory_of(refined->runs[x.number].rows_before)
                           : first_rows(x, x.found().parts);
          },
          "The trajectory before it was refined.")
      .path_word(
          "refinement", [](const Arm& x) { return refinement_of(x, 0); },
          "Refined, where it was asked for and there is a path; of strokes each of `runs` has its "
          "own.")
      .path_word(
          "least_cost", [](const Arm& x) { return finite_or_none(x.found().run().least_cost); },
          "Of the path of the arm by itself; None where it has none.")
      .path_word(
          "lattice", [](const Arm& x) -> LatticeInfo { return x.found().run().lattice; },
          "Of one path, as the next two; of strokes each of `runs` has its own.")
      .path_word(
          "measures", [](const Arm& x) -> Measures { return x.found().run(); },
          "What the trajectory comes near to; all of it with evidence=True.")
      .path_word(
          "diagnosis", [](const Arm& x) { return x.found().run().diagnosis; },
          "Why there is no path; None unless infeasible.");
}

/// Binds what is known of arms with strokes.
template <class T>
void bind_words_of_strokes(py::class_<T>& type) {
  ArmWords<T>(type)
      .strokes_word("lift_offs", &lift_offs_of,
                    "LiftOff of each place at which the tool lifts off within a stroke, in the "
                    "order of strokes.")
      .strokes_word("no_transition", &no_transition_of,
                    "(from, to) where each run has a path, but no transition joins these two: "
                    "names of strokes, None for home. Else None.")
      .strokes_word(
          "barred_by",
          [](const Arm& x) {
            const auto& none = x.found().no_transition;
            return none ? none->bodies : std::nullopt;
          },
          "The two bodies in the way there, or None.")
      .strokes_word(
          "barred_where",
          [](const Arm& x) -> std::optional<Typed<"Literal['between', 'home', 'end', 'begin']">> {
            const auto& none = x.found().no_transition;
            if (!none) return {};
            return to_string(none->where);
          },
          "Where they are: 'between' the two, at 'home', wherever the run before may 'end', or "
          "wherever the next one may 'begin'. None where there is an answer.")
      .strokes_word(
          "transition_counters", [](const Arm& x) -> Typed<"dict[str, int]"> {
            const TransitionCounters& t = x.found().transitions;
            py::dict all;
            all["pairs"] = t.pairs, all["searches"] = t.searches, all["rounds"] = t.rounds;
            return all;
          },
          "'pairs' of configurations asked whether the way is free, 'searches' for a way around, "
          "'rounds': orders and ways tried.");
}

std::optional<double> gap_of(const swivel::Answer& found) {
  if (!found.has_rows() || (found.bound <= 0 && found.lattice_cost > 0)) return {};
  return found.lattice_cost > 0 ? found.lattice_cost / found.bound - 1 : 0.0;
}
template <class Value>
std::optional<Value> if_rows(const Answer& answer, const Value& value) {
  return answer.found->has_rows() ? std::optional(value) : std::nullopt;
}

Motion motion_of(const Answer& answer) {
  return {.of = answer};
}

std::string first_line(const Answer& answer) {
  const std::string text = answer_text(*answer.found, *answer.executed);
  return text.substr(0, text.find('\n'));
}

std::string words_of(const Answer& answer) {
  const swivel::Answer& found = *answer.found;
  if (!found.has_rows()) {  // in a second line, of which stroke or arm it is and why
    const std::string text = answer_text(found, *answer.executed);
    const std::size_t end = text.find('\n'), begin = text.find_first_not_of(" \n", end);
    return text.substr(0, end) + (begin == std::string::npos
                                      ? ""
                                      : "; " + text.substr(begin, text.find('\n', begin) - begin));
  }
  std::string text = first_line(answer);
  if (const auto took = found.time_ms.find("plan"); took != found.time_ms.end())
    text += formatted(" | %.1f ms", took->second);
  if (found.refinement) {
    text += " | " + (answer.executed->arms.size() == 1 && is_path(*answer.executed)
                         ? refined_words(found.refinement->runs.front())
                         : formatted("refined: cost %.6g before, %.6g now",
                                     found.refinement->cost_before, found.refinement->cost));
  }
  if (found.motion) text += " | motion: " + motion_words(motion_of(answer));
  if (found.stopped) text += " | stopped before all was done";
  return text;
}

std::string csv_of(const Answer& answer) {
  if (!answer.found->has_rows())
    throw py::value_error(std::string("there are no rows: the answer is '") +
                          to_string(answer.found->status) + "'");
  return io::to_csv(*answer.found, *answer.executed);
}

Typed<"dict[str, Arm]"> arms_of(const Answer& answer) {
  py::dict all;
  for (std::size_t k = 0; k < answer.found->arms.size(); ++k)
    all[answer.found->arms[k].name.c_str()] = py::cast(Arm{answer, k});
  return all;
}

/// Returns what was found about two arms. Throws AttributeError for a word `name` of one arm.
const PairAnswer& pair_of(const Answer& answer, const char* name) {
  if (!answer.has_two_arms())
    throw py::attribute_error(std::string(name) + ": is of an answer of two arms");
  return answer.found->pair;
}

void bind_words_of_pairs(py::class_<Answer>& type) {
  type.def_property_readonly(
          "decided_by",
          [](const Answer& x)
              -> Typed<"Literal['arms alone', 'regions', 'pairs of nodes', 'none']"> {
            return to_string(pair_of(x, "decided_by").decided_by);
          },
          "Of two arms, as the next three: 'arms alone', 'regions', 'pairs of nodes', or 'none' "
          "where time was up.")
      .def_property_readonly(
          "conflict",
          [](const Answer& x) -> std::optional<std::array<std::string, 2>> {
            const auto& conflict = pair_of(x, "conflict").conflict;
            if (!conflict) return {};
            return conflict->bodies;
          },
          "Two bodies that meet on the cheapest paths, where each arm has a path and both together "
          "have none.")
      .def_property_readonly(
          "clearance",
          [](const Answer& x) -> std::optional<double> {
            const auto& nearest = pair_of(x, "clearance").nearest;
            if (!nearest) return {};
            return nearest->clearance;
          },
          "Between bodies of both arms at rows, m, with evidence=True.")
      .def_property_readonly(
          "clearance_status",
          [](const Answer& x) -> MeasureStatusName {
            return to_string(pair_of(x, "clearance_status").nearest_status());
          },
          "'measured', 'none' (no pair is near) or 'not_measured' (not asked for, or time ran "
          "out).");
}

void bind_verdict(py::class_<Answer>& type) {
  type.def(pickling<Answer>())
      .def_property_readonly(
          "status", [](const Answer& x) { return x.found->status; },
          "Status. Where time was up before there was a proved answer, there are no parts.")
      .def_property_readonly("solved",
                             [](const Answer& x) { return x.found->status == PlanStatus::kSolved; })
      .def_property_readonly(
          "cost", [](const Answer& x) { return if_rows(x, x.found->cost); },
          "Of all rows by the problem's metric, of transitions and lift-offs; None unless solved.")
      .def_property_readonly(
          "bound",
          [](const Answer& x) {
            return x.has_two_arms() ? finite_or_none(x.found->bound) : if_rows(x, x.found->bound);
          },
          "No answer of the lattices' nodes costs less: of strokes, none in this order whose "
          "transitions are those that are found. None where it is not known.")
      .def_property_readonly(
          "bound_any", [](const Answer& x) { return if_rows(x, x.found->bound_any); },
          "No answer of the lattices' nodes in this order of strokes costs less, whatever its "
          "transitions.")
      .def_property_readonly(
          "bound_orders", [](const Answer& x) { return if_rows(x, x.found->bound_orders); },
          "No answer of the lattices' nodes in any order that the problem allows costs less, whose "
          "transitions are those that are found.")
      .def_property_readonly(
          "gap", [](const Answer& x) { return gap_of(*x.found); },
          "What the search minimised over bound, less 1: 0 where the answer is optimal. None where "
          "there is no bound.")
      .def_property_readonly("arms", &arms_of,
                             "Name of the arm -> Arm; '' where there is one arm, whose words the "
                             "answer has as well.")
      .def_property_readonly(
          "motion",
          [](const Answer& x) -> std::optional<Motion> {
            if (!x.found->motion) return {};
            return motion_of(x);
          },
          "Motion, where it was asked for, there are rows, and time was left to make it.")
      .def_property_readonly(
          "stopped", [](const Answer& x) { return x.found->stopped; },
          "There are rows, but time ran out before all that was asked for was done.")
      .def_property_readonly("planner", [](const Answer& x) { return x.found->planner; })
      .def_property_readonly("threads", [](const Answer& x) { return x.found->threads; })
      .def_property_readonly(
          "time_ms", [](const Answer& x) { return x.found->time_ms; }, "By stage.")
      .def_property_readonly("warnings", [](const Answer& x) { return x.found->warnings; })
      .def("to_csv", &csv_of, "All rows as CSV, docs/formats.md. Raises ValueError unless solved.")
      .def(
          "to_json", [](const Answer& x) { return io::to_json(*x.found, *x.executed); },
          "RESULT.json as text, docs/formats.md.")
      .def(
          "save",
          [](const Answer& x, const std::filesystem::path& file) {
            io::write_file(file, csv_of(x));
          },
          py::arg("file"), "All rows as CSV, docs/formats.md. Raises ValueError unless solved.")
      .def("_problem",
           [](const Answer& x) -> std::optional<Problem> {
             if (!x.given) return {};
             return from_core(*x.given);
           })
      .def("_is_of_problem_alone",
           [](const Answer& x) { return !x.own_functions && !x.asked.refine && !x.asked.timing; })
      .def("__str__",
           [](const Answer& x) {
             std::string text = answer_text(*x.found, *x.executed);
             while (!text.empty() && text.back() == '\n') text.pop_back();
             return text;
           })
      .def("__repr__", [](const Answer& x) { return "<Answer " + words_of(x) + ">"; });
}

}  // namespace

Arm arm_of(const Answer& answer, const char* name) {
  if (answer.has_two_arms())
    throw py::attribute_error(std::string(name) + ": of one arm: allowed is answer.arms[name]." +
                              name);
  return {answer, 0};
}
void require_path(const Answer& answer, const char* name) {
  if (!answer.has_paths())
    throw py::attribute_error(std::string(name) +
                              ": of one path: allowed without strokes; `parts` and `runs` have "
                              "what is known of strokes");
}
void require_strokes(const Answer& answer, const char* name) {
  if (answer.has_paths())
    throw py::attribute_error(std::string(name) + ": is of a problem with strokes");
}

std::shared_ptr<const swivel::Problem> without_surroundings(const swivel::Problem& problem) {
  auto rest = std::make_shared<swivel::Problem>();
  rest->source = problem.source;
  rest->arms.clear();
  for (const ArmTask& given : problem.arms) {
    ArmTask& arm = rest->arms.emplace_back();
    arm.name = given.name, arm.base_link = given.base_link;
    arm.strokes = given.strokes;
    arm.home = given.home, arm.order = given.order, arm.lift = given.lift;
  }
  return rest;
}

Answer made_answer(swivel::Answer found, swivel::Problem given, MotionRequest asked) {
  Answer answer;
  answer.executed = without_surroundings(executed_problem(given, found));
  answer.found = std::make_shared<const swivel::Answer>(std::move(found));
  answer.asked = std::move(asked);
  answer.given = std::make_shared<const swivel::Problem>(std::move(given));
  return answer;
}

std::vector<StrokeRun> order_of(const ArmAnswer& arm) {
  std::vector<StrokeRun> order;
  for (const RunAnswer& run : arm.runs) order.push_back(run.run);
  if (order.empty())  // of rows that were timed, not planned
    for (const swivel::Part& part : arm.parts)
      if (part.run) order.push_back(*part.run);
  return order;
}

void bind_answer(py::module_& m) {
  py::class_<Arm> arm(m, "Arm", "What an answer says of one of its arms.");
  py::class_<Answer> answer(
      m, "Answer",
      "The answer to a problem: what its arms do, or why there is no such motion. It outlives the "
      "problem and its planner. Words of a path, of strokes and of two arms raise AttributeError "
      "where the problem has no such thing.");
  arm.def(pickling<Arm>())
      .def_property_readonly(
          "name", [](const Arm& x) { return x.found().name; }, "'' of the only arm.")
      .def_property_readonly("warnings",
                             [](const Arm& x) {
                               return x.of.has_two_arms() ? x.found().warnings
                                                          : x.of.found->warnings;
                             })
      .def("__repr__", [](const Arm& x) {
        return "<Arm '" + x.found().name + "' of " + first_line(x.of) + ">";
      });
  bind_verdict(answer);
  bind_words_of_pairs(answer);
  bind_words_of_arms(arm), bind_words_of_arms(answer);
  bind_words_of_paths(arm), bind_words_of_paths(answer);
  bind_words_of_strokes(arm), bind_words_of_strokes(answer);
}

}  // namespace swivel::python
