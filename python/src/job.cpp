// SPDX-License-Identifier: BSD-3-Clause
// Bindings of jobs and their strokes.
#include "job.hpp"

#include <algorithm>
#include <cmath>

#include "interruptible.hpp"
#include "job_archive.hpp"
#include "runs.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

using Strokes = Typed<"Iterable[Stroke]", py::iterable>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

Doubles to_doubles(py::handle source, const char* what, const char* allowed) {
  Doubles array = Doubles::ensure(source);
  if (array && array.ndim() <= 1) return array;
  PyErr_Clear();
  throw py::value_error(std::string(what) + ": allowed is " + allowed);
}

/// Returns where the tool stands before a stroke or after it, m in the tool frame, from a distance
/// against the tool's z axis or a vector.
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
std::optional<Vector3d> to_own_offset(py::handle source, const char* what) {
  if (source.is_none()) return {};
  return to_offset(source, what);
}

std::optional<Config> to_home(py::handle source) {
  if (source.is_none()) return {};
  const Doubles joints = to_doubles(source, "home", "(7,), rad");
  if (joints.ndim() != 1 || joints.size() != kDof)
    throw py::value_error("home: allowed is (7,), rad");
  return Config(Eigen::Map<const Config>(joints.data()));
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

/// Sets what is shared to what all strokes have, else leaves it, and unsets it in each stroke that
/// has just that.
template <class Value>
void share(std::vector<Stroke>& strokes, std::optional<Value> Stroke::*own, Value& shared) {
  const bool same = std::all_of(strokes.begin(), strokes.end(), [&](const Stroke& stroke) {
    return stroke.*own == strokes.front().*own;
  });
  if (same && !strokes.empty() && strokes.front().*own) shared = *(strokes.front().*own);
  for (Stroke& stroke : strokes)
    if (stroke.*own == shared) (stroke.*own).reset();
}

std::string stroke_words(const Stroke& stroke) {
  return "'" + stroke.name + "': " + std::to_string(stroke.waypoints.size()) + " waypoints" +
         (stroke.frame.empty() ? "" : " in '" + stroke.frame + "'") +
         (stroke.reversible ? ", reversible" : "") + (stroke.closed ? ", closed" : "");
}

void bind_stroke(py::module_& m) {
  py::class_<Stroke> type(m, "Stroke",
                          "One run of the tool on the part. What is None is as the job says.");
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
           "name: of its own among the strokes of the job. waypoints, frame, smooth: as of a Task. "
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
      .def_readwrite("limits", &Stroke::limits, "Instead of those of the job, or None.")
      .def_readwrite("resolution", &Stroke::resolution, "Instead of that of the job, or None.")
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

Job::Job(const Job& other)
    : Robot(other),
      source(other.source),
      scene(other.scene),
      vary(other.vary),
      limits(other.limits),
      resolution(other.resolution),
      cost(other.cost),
      refinement(other.refinement),
      home(other.home),
      order(other.order),
      approach(other.approach),
      retract(other.retract),
      process_speed(other.process_speed),
      approach_speed(other.approach_speed),
      rapid(other.rapid),
      lift(other.lift) {
  set_strokes(other.all_strokes());
}

std::vector<Stroke> Job::all_strokes() const {
  std::vector<Stroke> all;
  for (const py::handle item : strokes) {
    if (!py::isinstance<Stroke>(item))
      throw py::type_error("strokes[" + std::to_string(all.size()) +
                           "]: " + py::type::of(item).attr("__name__").cast<std::string>() +
                           ": allowed are Strokes");
    all.push_back(item.cast<const Stroke&>());
  }
  return all;
}

void Job::set_strokes(const std::vector<Stroke>& all) {
  strokes = py::list();
  for (const Stroke& stroke : all) strokes.append(py::cast(stroke));
}

swivel::Problem to_core(const Job& job) {
  swivel::Problem core;
  ArmTask& arm = core.arm();
  static_cast<Robot&>(arm) = job;
  core.source = job.source, core.scene = job.scene, core.vary = job.vary;
  arm.transition_limits = job.limits, arm.home = job.home, arm.order = job.order;
  arm.process_speed = job.process_speed, arm.approach_speed = job.approach_speed;
  arm.rapid = job.rapid, arm.lift = job.lift;
  for (Stroke& stroke : job.all_strokes()) {
    swivel::Stroke& made = arm.strokes.emplace_back();
    made.name = std::move(stroke.name), made.waypoints = std::move(stroke.waypoints);
    pass_half_turns(arm, made.waypoints);
    made.path_frame = std::move(stroke.frame), made.smooth = stroke.smooth;
    made.limits = stroke.limits.value_or(job.limits);
    made.resolution = stroke.resolution.value_or(job.resolution);
    made.cost = job.cost, made.refinement = job.refinement;
    made.reversible = stroke.reversible;
    made.approach = stroke.approach.value_or(job.approach);
    made.retract = stroke.retract.value_or(job.retract);
    made.process_speed = stroke.process_speed, made.approach_speed = stroke.approach_speed;
    made.feed = std::move(stroke.feed), made.end = stroke.end, made.closed = stroke.closed;
  }
  if (is_path(core)) throw InvalidArgument("strokes: name: allowed are non-empty names");
  validate(core);
  return core;
}

Job from_core(swivel::Problem core) {
  Job job;
  ArmTask& arm = core.arm();
  static_cast<Robot&>(job) = arm;
  job.source = std::move(core.source), job.scene = std::move(core.scene);
  job.vary = std::move(core.vary);
  job.limits = arm.transition_limits, job.home = arm.home, job.order = arm.order;
  job.process_speed = arm.process_speed, job.approach_speed = arm.approach_speed;
  job.rapid = arm.rapid, job.lift = arm.lift;
  std::vector<Stroke> strokes;
  for (swivel::Stroke& stroke : arm.strokes) {
    job.cost = stroke.cost, job.refinement = stroke.refinement;  // files have one for all
    const bool own_limits = stroke.limits != arm.transition_limits;
    strokes.push_back({std::move(stroke.name), std::move(stroke.waypoints),
                       std::move(stroke.path_frame), stroke.smooth, stroke.reversible,
                       stroke.approach, stroke.retract, stroke.process_speed, stroke.approach_speed,
                       std::move(stroke.feed),
                       own_limits ? std::optional(stroke.limits) : std::nullopt, stroke.resolution,
                       stroke.end, stroke.closed});
  }
  share(strokes, &Stroke::resolution, job.resolution);
  share(strokes, &Stroke::approach, job.approach);
  share(strokes, &Stroke::retract, job.retract);
  job.set_strokes(strokes);
  return job;
}

swivel::Problem to_core(const JobOrFile& job) {
  if (const auto* made = std::get_if<const Job*>(&job)) return to_core(**made);
  const std::filesystem::path& file = std::get<std::filesystem::path>(job);
  return interruptible([&](const std::stop_token&) { return io::load_job(file); });
}

void bind_job(py::module_& m) {
  bind_enum<StrokeOrder>(m, "StrokeOrder", "In which order the strokes of a job are run.",
                         {{"given", StrokeOrder::kGiven}, {"best", StrokeOrder::kBest}});
  PlainStruct<LiftOffs>(m, "LiftOffs",
                        "Lets strokes that no single run finishes be done in several, as few as "
                        "there can be, at the cheapest places; as keywords.")
      .member("cost", &LiftOffs::cost, "Of each lift-off, in units of the metric.")
      .member("overlap", &LiftOffs::overlap,
              "m: so much before the end of a run the next one begins.")
      .finish();
  bind_stroke(m);
  py::class_<Job, Robot> type(
      m, "Job",
      "Strokes with transitions between them, from a home and back: what a problem file with "
      "`strokes` says.");
  make_copyable(type);
  type.def(pickling<Job>());
  type.def(py::init([](const Robot& robot, const Strokes& strokes, const SceneObjects& scene,
                       const Limits& limits, const Resolution& resolution, const Cost& cost,
                       const Refinement& refinement, const ArrayLike& home,
                       const OrName<StrokeOrder>& order, const ArrayLike& approach,
                       const ArrayLike& retract, std::optional<double> process_speed,
                       std::optional<double> approach_speed, double rapid,
                       const std::optional<LiftOffs>& lift) {
             Job job;
             static_cast<Robot&>(job) = robot;
             job.strokes = py::list(strokes);
             static_cast<void>(job.all_strokes());
             for (const py::handle object : scene)
               job.scene.push_back(object.cast<const SceneObject&>());
             job.limits = limits, job.resolution = resolution, job.cost = cost;
             job.refinement = refinement, job.home = to_home(home);
             job.order = to_enum<StrokeOrder>(order);
             job.approach = to_offset(approach, "approach");
             job.retract = to_offset(retract, "retract");
             job.process_speed = process_speed, job.approach_speed = approach_speed;
             job.rapid = rapid, job.lift = lift;
             return job;
           }),
           py::arg("robot"), py::arg("strokes"), py::arg("scene") = py::tuple(), py::kw_only(),
           py::arg_v("limits", Limits(), "Limits()"),
           py::arg_v("resolution", Resolution(), "Resolution()"),
           py::arg_v("cost", Cost(), "Cost()"),
           py::arg_v("refinement", Refinement(), "Refinement()"), py::arg("home") = py::none(),
           py::arg("order") = "given", py::arg("approach") = 0.0, py::arg("retract") = 0.0,
           py::arg("process_speed") = py::none(), py::arg("approach_speed") = py::none(),
           py::arg("rapid") = 1.0, py::arg("lift") = py::none(),
           "strokes: Strokes. limits, resolution, approach, retract, process_speed and "
           "approach_speed hold for strokes that have none of their own; limits are kept in "
           "transitions, too. home: (7,), rad, or None. order: StrokeOrder or its name. rapid: "
           "share of the joints' speeds in transitions. lift: LiftOffs; None: each stroke is done "
           "in "
           "one run.")
      .def_readonly("source", &Job::source, "The file; empty of jobs made in memory.")
      .def_readwrite("scene", &Job::scene, "Scene, changed in place.")
      .def_property_readonly(
          "robot", [](const Job& job) { return Robot(job); }, "A copy.")
      .def_property(
          "strokes", [](const Job& job) -> Typed<"list[Stroke]"> { return job.strokes; },
          [](Job& job, const Strokes& strokes) { job.strokes = py::list(strokes); },
          "A list of Strokes, changed in place.")
      .def_readwrite("limits", &Job::limits,
                     "Of transitions, and of strokes that have none of their own.")
      .def_readwrite("resolution", &Job::resolution, "Of strokes that have none of their own.")
      .def_readwrite("cost", &Job::cost)
      .def_readwrite("refinement", &Job::refinement)
      .def_property(
          "home", [](const Job& job) { return job.home; },
          [](Job& job, const OptionalArray& home) { job.home = to_home(home); },
          "(7,), rad, where the job begins and ends, or None: at its strokes. A copy; assign to "
          "change it.")
      .def_property(
          "order", [](const Job& job) { return job.order; },
          [](Job& job, const OrName<StrokeOrder>& order) {
            job.order = to_enum<StrokeOrder>(order);
          },
          "StrokeOrder.")
      .def_property(
          "approach", [](const Job& job) { return job.approach; },
          [](Job& job, const ArrayLike& from) { job.approach = to_offset(from, "approach"); },
          "From where the tool comes to strokes that do not say it: (3,), m in the tool frame; 0: "
          "no line. A copy; assign it, or m against the tool's z axis, to change it.")
      .def_property(
          "retract", [](const Job& job) { return job.retract; },
          [](Job& job, const ArrayLike& to) { job.retract = to_offset(to, "retract"); },
          "Where the tool goes after them, alike.")
      .def_readwrite("process_speed", &Job::process_speed,
                     "m/s along strokes, or None: limits.tool_speed.")
      .def_readwrite("approach_speed", &Job::approach_speed,
                     "m/s along approach and retract, or None: as on the stroke.")
      .def_readwrite("rapid", &Job::rapid, "Share of the joints' speeds in transitions, to 1.")
      .def_readwrite("lift", &Job::lift,
                     "LiftOffs, where the tool may lift off within strokes, in the given order of "
                     "strokes; None: each is done in one run.")
      .def(
          "validate", [](const Job& job) { static_cast<void>(to_core(job)); },
          "Raises InvalidArgument, which names stroke and member, for what no job may have.")
      .def(
          "placed",
          [](const Job& job, const Offset& offset, const std::optional<std::string>& object,
             bool path, bool base, const HeldPositions& hold) {
            return from_core(placed_problem(held_as(to_core(job), hold),
                                            to_movable(object, path, base, !hold.empty()), offset));
          },
          py::arg("offset"), py::kw_only(), py::arg("object") = py::none(), py::arg("path") = false,
          py::arg("base") = false, py::arg("hold") = HeldPositions(),
          "The job of one placement: an object of the scene, the paths of all strokes or the robot "
          "moved by x y z (m) roll pitch yaw (rad) in the\n"
          "base frame, about its own origin, with the joints of `hold` held there, rad or m.")
      .def(
          "episode",
          [](const Job& job, std::uint64_t seed, std::uint64_t episode) {
            return from_core(episode_problem(to_core(job), seed, episode));
          },
          py::arg("seed"), py::arg("episode"),
          "The job of this episode of a campaign: objects moved as the file's `vary` says.")
      .def(
          "save",
          [](const Job& job, const std::filesystem::path& file) {
            const swivel::Problem core = to_core(job);
            interruptible([&](const std::stop_token&) {
              io::save_problem(core, file);
              return true;
            });
          },
          py::arg("file"),
          "Writes a problem file that gives this job when it is loaded, as Problem.save() does. "
          "Raises InputError for what no file can say, and InvalidArgument.")
      .def("__repr__", [](const Job& job) {
        return "<Job" + (job.source.empty() ? "" : " '" + job.source + "'") + ": " +
               py::repr(py::cast(Robot(job))).cast<std::string>() + ", " +
               std::to_string(job.strokes.size()) + " strokes, " +
               std::to_string(job.scene.size()) + " objects>";
      });
  m.def(
      "load_job",
      [](const std::filesystem::path& file) {
        return from_core(interruptible([&](const std::stop_token&) { return io::load_job(file); }));
      },
      py::arg("file"),
      "A problem file with `strokes`, docs/formats.md; one with `path` is a job of one stroke. "
      "Raises InputError, which names file and line.");
}

}  // namespace swivel::python
