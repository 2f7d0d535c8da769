// SPDX-License-Identifier: BSD-3-Clause
#include "answers/answer.hpp"
#include "base/interruptible.hpp"
#include "problems/problem.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

PYBIND11_MODULE(_swivel, m) {
  namespace py = pybind11;
  m.attr("__version__") = SWIVEL_VERSION;
  py::register_exception<swivel::InputError>(m, "InputError", PyExc_ValueError).doc() =
      "Bad input from a file or a robot: one line that names the file and line, key or row, what "
      "is wrong, and what is allowed.";
  py::register_exception<swivel::InvalidArgument>(m, "InvalidArgument", PyExc_ValueError).doc() =
      "A value that no problem may have: one line that names the member, its value, and what is "
      "allowed.";
  // Signatures can name only types that are bound before them.
  swivel::python::bind_problem(m);
  swivel::python::bind_strokes(m);
  swivel::python::bind_whole_problem(m);
  swivel::python::bind_measures(m);
  swivel::python::bind_rows(m);
  swivel::python::bind_parts_of_answers(m);
  swivel::python::bind_motion(m);
  swivel::python::bind_answer(m);
  swivel::python::bind_check(m);
  swivel::python::bind_advice(m);
  swivel::python::bind_states(m);
  swivel::python::bind_planner(m);
  swivel::python::bind_functions(m);
  swivel::python::bind_drawings(m);
  swivel::python::bind_certificates(m);
  swivel::python::bind_runs(m);
  swivel::python::bind_plan_many(m);
  py::module_::import("atexit").attr("register")(
      py::cpp_function(&swivel::python::UnderWay::end_all));
}
