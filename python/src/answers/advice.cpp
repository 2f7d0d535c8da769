// SPDX-License-Identifier: BSD-3-Clause
// Bindings of advice: changes of a problem that has no answer, and what planning them gave.
#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::python {

namespace {

std::optional<std::string> or_none(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

template <class Advised>
std::string repr_of(const char* type, const Advised& a) {
  return std::string("<") + type + " " + to_string(a.outcome) + ": " + words(a) +
         (a.cost ? formatted(", cost %.6g>", *a.cost) : std::string(">"));
}

void bind_advice_on_paths(py::module_& m) {
  py::class_<Advice>(
      m, "Advice",
      "One change of a problem that has no path, and what planning the changed problem gave.")
      .def(pickling<Advice>())
      .def_readonly("change", &Advice::change, "Change.")
      .def_property_readonly("object", [](const Advice& a) { return or_none(a.object); })
      .def_readonly("asked", &Advice::from, "Of limits: what the problem asks, in its unit.")
      .def_readonly("changed_to", &Advice::to, "Of limits: what this is about.")
      .def_readonly("offset", &Advice::offset,
                    "Of an object or of paths that are moved, (3,), m, base frame.")
      .def_property_readonly(
          "also", [](const Advice& a) { return or_none(a.also); },
          "Name of a second object that is moved or removed with the first one; None: none is.")
      .def_readonly("also_offset", &Advice::also_offset,
                    "Of a second object that is moved, (3,), m, base frame.")
      .def_readonly("outcome", &Advice::outcome, "Outcome.")
      .def_readonly("cost", &Advice::cost, "Of all paths, where it solves.")
      .def_readonly("reached_s", &Advice::reached_s, "Where there is no path of one arm either, m.")
      .def("__repr__", [](const Advice& a) { return repr_of("Advice", a); });
  py::class_<WorkcellAdvice, Advice>(
      m, "WorkcellAdvice",
      "One change of a problem of two arms, and what planning both with it gave.")
      .def(pickling<WorkcellAdvice>())
      .def_property_readonly(
          "arm", [](const WorkcellAdvice& a) { return or_none(a.arm); },
          "Name of the arm that is changed; None: both, or the scene.")
      .def("__repr__", [](const WorkcellAdvice& a) { return repr_of("WorkcellAdvice", a); });
}

void bind_advice_on_strokes(py::module_& m) {
  using Change = JobAdvice::Change;
  std::vector<std::pair<std::string, Change>> names;
  for (int k = 0; k <= static_cast<int>(Change::kLines); ++k)
    names.emplace_back(to_string(static_cast<Change>(k)), static_cast<Change>(k));
  bind_enum<Change>(m, "JobChange", "What may be changed of a problem with strokes.", names);
  py::class_<JobAdvice>(m, "JobAdvice",
                        "One change of a problem with strokes, and what planning it gave.")
      .def(pickling<JobAdvice>())
      .def_readonly("change", &JobAdvice::change, "JobChange.")
      .def_readonly("strokes", &JobAdvice::strokes,
                    "Names of those that are changed; none where all are.")
      .def_readonly("length", &JobAdvice::length, "Of an approach or a retract, m.")
      .def_readonly("home", &JobAdvice::home, "(7,), rad, of another home.")
      .def_readonly("outcome", &JobAdvice::outcome, "Outcome.")
      .def_readonly("cost", &JobAdvice::cost, "Where it solves.")
      .def("__repr__", [](const JobAdvice& a) { return repr_of("JobAdvice", a); });
}

/// Returns the changes of a problem as a list of Python's.
py::list changes_of(const AdviceList& advice) {
  if (const auto* const path = std::get_if<std::vector<Advice>>(&advice.advice))
    return py::cast(*path);
  if (const auto* const strokes = std::get_if<AdviceOnJob>(&advice.advice))
    return py::cast(strokes->job);
  return py::cast(std::get<AdviceOnWorkcell>(advice.advice).cell);
}

}  // namespace

void bind_advice(py::module_& m) {
  bind_advice_on_paths(m);
  bind_advice_on_strokes(m);
  py::class_<AdviceList>(m, "AdviceList",
                         "Changes that would help a problem without an answer, what helps first: a "
                         "sequence of Advice for one path, of WorkcellAdvice for two arms, of "
                         "JobAdvice for strokes. str() says it.")
      .def(pickling<AdviceList>())
      .def_property_readonly(
          "alone", [](const AdviceList& advice) -> Typed<"dict[str, list[Advice]]"> {
            py::dict all;
            if (const auto* const strokes = std::get_if<AdviceOnJob>(&advice.advice))
              for (const StrokeAdvice& one : strokes->strokes)
                all[one.stroke.c_str()] = py::cast(one.advice);
            if (const auto* const arms = std::get_if<AdviceOnWorkcell>(&advice.advice))
              for (const ArmAdvice& one : arms->arms) all[one.arm.c_str()] = py::cast(one.advice);
            return all;
          },
          "Name of a stroke, or of one of two arms, that has no path by itself -> what would help "
          "it by itself.")
      .def("__len__", [](const AdviceList& advice) { return changes_of(advice).size(); })
      .def(
          "__getitem__",
          [](const AdviceList& advice,
             py::ssize_t k) -> Typed<"Advice | WorkcellAdvice | JobAdvice"> {
            const py::list all = changes_of(advice);
            const auto count = static_cast<py::ssize_t>(all.size());
            if (k < -count || k >= count)
              throw py::index_error("advice " + std::to_string(k) + " of " + std::to_string(count));
            return py::object(all[static_cast<std::size_t>(k < 0 ? k + count : k)]);
          },
          py::arg("k"), "The k-th change. Raises IndexError.")
      .def(
          "__iter__",
          [](const AdviceList& advice)
              -> Typed<"Iterator[Advice | WorkcellAdvice | JobAdvice]", py::iterator> {
            return py::iter(changes_of(advice));
          })
      .def("__str__", [](const AdviceList& advice) { return advice_text(advice.advice); })
      .def("__repr__", [](const AdviceList& advice) {
        return formatted("<AdviceList of %zu changes>", changes_of(advice).size());
      });
}

}  // namespace swivel::python
