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

void bind_change(py::module_& m) {
  py::class_<Advice>(
      m, "Advice",
      "One change of a problem that has no answer, and what planning the changed problem gave.")
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
      .def_property_readonly(
          "arm", [](const Advice& a) { return or_none(a.arm); },
          "Of two arms: name of the one that is changed; None: both, or the scene.")
      .def_readonly("strokes", &Advice::strokes,
                    "Names of the strokes that are changed; none where all are.")
      .def_readonly("length", &Advice::length, "Of an approach or a retract, m.")
      .def_readonly("home", &Advice::home, "(7,), rad, of another home.")
      .def_readonly("outcome", &Advice::outcome, "Outcome.")
      .def_readonly("cost", &Advice::cost, "Of the answer, where it solves.")
      .def_readonly("reached_s", &Advice::reached_s,
                    "Where there is no path either, of one path alone, m.")
      .def("__repr__", [](const Advice& a) {
        return "<Advice " + std::string(to_string(a.outcome)) + ": " + words(a) +
               (a.cost ? formatted(", cost %.6g>", *a.cost) : std::string(">"));
      });
}

}  // namespace

void bind_advice(py::module_& m) {
  bind_change(m);
  py::class_<AdviceList>(m, "AdviceList",
                         "Changes that would help a problem without an answer, what helps first: a "
                         "sequence of Advice. str() says it.")
      .def(pickling<AdviceList>())
      .def_property_readonly(
          "alone", [](const AdviceList& advice) -> Typed<"dict[str, list[Advice]]"> {
            py::dict all;
            for (const AdviceAlone& one : advice.alone)
              all[one.name.c_str()] = py::cast(one.advice);
            return all;
          },
          "Name of a stroke, or of one of two arms, that has no path by itself -> what would help "
          "it by itself.")
      .def("__len__", [](const AdviceList& advice) { return advice.changes.size(); })
      .def(
          "__getitem__",
          [](const AdviceList& advice, py::ssize_t k) {
            const auto count = static_cast<py::ssize_t>(advice.changes.size());
            if (k < -count || k >= count)
              throw py::index_error("advice " + std::to_string(k) + " of " + std::to_string(count));
            return advice.changes[static_cast<std::size_t>(k < 0 ? k + count : k)];
          },
          py::arg("k"), "The k-th change. Raises IndexError.")
      .def(
          "__iter__", [](const AdviceList& advice) -> Typed<"Iterator[Advice]", py::iterator> {
            return py::iter(py::cast(advice.changes));
          })
      .def("__str__", [](const AdviceList& advice) { return advice_text(advice); })
      .def("__repr__", [](const AdviceList& advice) {
        return formatted("<AdviceList of %zu changes>", advice.changes.size());
      });
}

}  // namespace swivel::python
