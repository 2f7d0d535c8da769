// SPDX-License-Identifier: BSD-3-Clause
// Bindings of strokes.
#include "problems/problem.hpp"

#include <algorithm>
#include <cmath>

#include "base/archive.hpp"
#include "base/interruptible.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

Doubles to_doubles(py::handle source, const char* what, const char* allowed) {
  Doubles array = Doubles::ensure(source);
  if (array && array.ndim() <= 1) return array;
  PyErr_Clear();
  throw py::value_error(std::string(what) + ": allowed is " + allowed);
}

std::optional<Vector3d> to_own_offset(py::handle source, const char* what) {
  if (source.is_none()) return {};
  return to_offset(source, what);
}

std::vector<double> to_feed(py::handle source) {
  if (source.is_none()) return {};
  const Doubles feed = to_doubles(source, "feed", "one number for each waypoint, m/s, or None");
  return {feed.data(), feed.data() + feed.size()};
}
std::optional<py::array_t<double>> from_feed(const std::vector<double>& feed) {
  if (feed.empty()) return {};
  return py::array_t<double>(static_cast<py::ssize_t>(feed.size()), feed.data());
}

std::string stroke_words(const Stroke& stroke) {
  return "'" + stroke.name + "': " + std::to_string(stroke.waypoints.size()) + " waypoints" +
         (stroke.frame.empty() ? "" : " in '" + stroke.frame + "'") +
         (stroke.reversible ? ", reversible" : "") + (stroke.closed ? ", closed" : "");
}

void bind_stroke(py::module_& m) {
  py::class_<Stroke> type(m, "Stroke",
                          "One run of the tool on the part. What is None is as the problem says.");
  make_copyable(type);
  type.def(pickling<Stroke>());
  type.def(py::init([](std::string name, std::vector<Waypoint> waypoints, std::string frame,
                       const std::optional<PathSmoothing>& smooth, bool reversible,
                       const ArrayLike& approach, const ArrayLike& retract,
                       std::optional<double> process_speed, std::optional<double> approach_speed,
                       const ArrayLike& feed, const std::optional<Limits>& limits,
                       const std::optional<Resolution>& resolution, const ArrayLike& end,
                       bool closed) {
             return Stroke{std::move(name),
                           std::move(waypoints),
                           std::move(frame),
                           smooth,
                           reversible,
                           to_own_offset(approach, "approach"),
                           to_own_offset(retract, "retract"),
                           process_speed,
                           approach_speed,
                           to_feed(feed),
                           limits,
                           resolution,
                           to_posture(end, "end"),
                           closed};
           }),
           py::arg("name"), py::arg("waypoints"), py::kw_only(), py::arg("frame") = "",
           py::arg("smooth") = py::none(), py::arg("reversible") = false,
           py::arg("approach") = py::none(), py::arg("retract") = py::none(),
           py::arg("process_speed") = py::none(), py::arg("approach_speed") = py::none(),
           py::arg("feed") = py::none(), py::arg("limits") = py::none(),
           py::arg("resolution") = py::none(), py::arg("end") = py::none(),
           py::arg("closed") = false,
           "name: of its own among the strokes of the problem. waypoints, frame, smooth: as of a "
           "Task. "
           "reversible: the tool may run from the last waypoint to the first. approach, retract: "
           "from where the tool comes and where it goes, on straight lines without turning: m "
           "against its z axis, or (3,), m in the tool frame there. process_speed, approach_speed: "
           "m/s, on the stroke and on these lines. feed: (n,), m/s, from each waypoint on. end: "
           "(7,) joints to end in after the retract, rad; not of reversible strokes. closed: the "
           "run must end, after the retract, in the joints in which it begins; approach and "
           "retract are equal then.")
      .def_readwrite("name", &Stroke::name)
      .def_readwrite("waypoints", &Stroke::waypoints,
                     "(n, 7): x y z (m) qw qx qy qz, in `frame`; with roll_min and roll_max (rad) "
                     "(n, 9). A copy; assign to change it.")
      .def_readwrite("frame", &Stroke::frame,
                     "Base link (also empty) or the name of a scene object.")
      .def_readwrite("smooth", &Stroke::smooth, "None: the polyline as it is.")
      .def_readwrite("reversible", &Stroke::reversible,
                     "Whether the tool may run from the last waypoint to the first.")
      .def_property(
          "approach", [](const Stroke& stroke) { return stroke.approach; },
          [](Stroke& stroke, const OptionalArray& from) {
            stroke.approach = to_own_offset(from, "approach");
          },
          "From where the tool comes: (3,), m in the tool frame of the first waypoint, or None. A "
          "copy; assign it, or m against the tool's z axis, to change it.")
      .def_property(
          "retract", [](const Stroke& stroke) { return stroke.retract; },
          [](Stroke& stroke, const OptionalArray& to) {
            stroke.retract = to_own_offset(to, "retract");
          },
          "Where the tool goes, alike, in the tool frame of the last waypoint.")
      .def_readwrite("process_speed", &Stroke::process_speed, "m/s along the stroke, or None.")
      .def_readwrite("approach_speed", &Stroke::approach_speed,
                     "m/s along approach and retract, or None.")
      .def_property(
          "feed", [](const Stroke& stroke) { return from_feed(stroke.feed); },
          [](Stroke& stroke, const OptionalArray& feed) { stroke.feed = to_feed(feed); },
          "(n,), m/s from each waypoint on, instead of process_speed, or None. A copy; assign to "
          "change it.")
      .def_readwrite("limits", &Stroke::limits, "Instead of those of the problem, or None.")
      .def_readwrite("resolution", &Stroke::resolution, "Instead of that of the problem, or None.")
      .def_property(
          "end", [](const Stroke& stroke) { return stroke.end; },
          [](Stroke& stroke, const OptionalArray& end) { stroke.end = to_posture(end, "end"); },
          "(7,) joints to end in after the retract, rad, or None. A copy; assign to change it.")
      .def_readwrite("closed", &Stroke::closed,
                     "Whether the run must end in the joints in which it begins.")
      .def(
          "__eq__", [](const Stroke& a, const Stroke& b) { return a == b; }, py::is_operator())
      .def("__repr__", [](const Stroke& stroke) { return "<Stroke " + stroke_words(stroke) + ">"; })
      .attr("__hash__") = py::none();
}

}  // namespace

Vector3d to_offset(py::handle source, const char* what) {
  const char* const allowed = "a number from 0 on, m, or (3,), m in the tool frame";
  const Doubles values = to_doubles(source, what, allowed);
  if (values.ndim() == 1 && values.size() == 3)
    return {values.data()[0], values.data()[1], values.data()[2]};
  if (values.ndim() != 0 || !(values.data()[0] >= 0))
    throw py::value_error(std::string(what) + ": allowed is " + allowed);
  // A length of 0 has no sign, as in files.
  return values.data()[0] == 0 ? Vector3d(Vector3d::Zero()) : Vector3d(0, 0, -values.data()[0]);
}
std::vector<Stroke> StrokeList::all() const {
  std::vector<Stroke> all;
  if (!list) return all;
  for (const py::handle item : *list) {
    if (!py::isinstance<Stroke>(item))
      throw py::type_error("strokes[" + std::to_string(all.size()) +
                           "]: " + py::type::of(item).attr("__name__").cast<std::string>() +
                           ": allowed are Strokes");
    all.push_back(item.cast<const Stroke&>());
  }
  return all;
}

void StrokeList::set(const std::vector<Stroke>& all) {
  list.emplace();
  for (const Stroke& stroke : all) list->append(py::cast(stroke));
}

void bind_strokes(py::module_& m) {
  bind_enum<StrokeOrder>(m, "StrokeOrder", "In which order the strokes of a problem are run.",
                         {{"given", StrokeOrder::kGiven}, {"best", StrokeOrder::kBest}});
  PlainStruct<LiftOffs>(m, "LiftOffs",
                        "Lets strokes that no single run finishes be done in several, as few as "
                        "there can be, at the cheapest places; as keywords.")
      .member("cost", &LiftOffs::cost, "Of each lift-off, in units of the metric.")
      .member("overlap", &LiftOffs::overlap,
              "m: so much before the end of a run the next one begins.")
      .finish();
  bind_stroke(m);
}

}  // namespace swivel::python
