// SPDX-License-Identifier: BSD-3-Clause
// Bindings of motions in time, of one arm and of two, and of what refining made of rows.
#include <algorithm>

#include "answers/answer.hpp"
#include "base/archive.hpp"
#include "swivel/core/answer/timed_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"

namespace swivel::python {

namespace {

using Rows = std::shared_ptr<const std::vector<TimedRow>>;

/// Returns the number of the arm of a motion whose word `name` is asked for. Throws AttributeError
/// where there are two arms.
std::size_t number_of(const Motion& motion, const char* name) {
  if (!motion.arm && motion.of.has_two_arms())
    throw py::attribute_error(std::string(name) + ": of one arm: allowed is motion.arms[name]." +
                              name);
  return motion.arm.value_or(0);
}
/// Returns the motion of the arm whose word `name` is asked for. Throws ValueError if there is
/// none.
const ArmMotion& arm_of(const Motion& motion, const char* name) {
  const std::size_t arm = number_of(motion, name);
  return motion.motion().arms[arm];
}
/// Returns the samples of that arm; none where there is no motion.
Rows rows_of(const Motion& motion, const char* name) {
  const std::size_t arm = number_of(motion, name);
  if (!motion.executable()) return std::make_shared<const std::vector<TimedRow>>();
  return {motion.of.found, &motion.motion().arms[arm].rows};
}
const io::JointNames& joint_names_of(const Motion& motion, const char* name) {
  return motion.of.found->arms[number_of(motion, name)].joint_names;
}

template <class Number>
py::array_t<Number> timed_column(const Rows& rows, Number TimedRow::*member) {
  return column(rows, rows->empty() ? nullptr : &(rows->front().*member));
}
/// Returns the number of joints of the motion's arm.
std::size_t joints_of(const Motion& motion, const char* name) {
  return named_joints(joint_names_of(motion, name));
}
py::array_t<double> timed_joints(const Motion& motion, const char* name,
                                 const Config TimedRow::*member) {
  const Rows rows = rows_of(motion, name);
  return column(rows, rows->empty() ? nullptr : (rows->front().*member).data(),
                static_cast<py::ssize_t>(joints_of(motion, name)));
}
template <class Number>
py::array_t<Number> placed_column(const Rows& rows, Number TrajectoryRow::*member) {
  return column(rows, rows->empty() ? nullptr : &(rows->front().row.*member));
}

py::array_t<double> roll_of(const Motion& motion) {
  const Rows rows = rows_of(motion, "roll");
  if (joint_names_of(motion, "roll")[kDof - 1] == "roll")
    return column(rows, rows->empty() ? nullptr : &rows->front().row.q[kDof - 1]);
  return placed_column(rows, &TrajectoryRow::roll);
}

Typed<"dict[str, _Array]"> peaks_of(const Motion& motion) {
  require_path(motion.of, "peaks");
  const char* const names[] = {"speed", "acceleration", "jerk"};
  py::dict peaks;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t joints = joints_of(motion, "peaks");
    py::array_t<double> ratios(static_cast<py::ssize_t>(joints));
    for (std::size_t j = 0; j < joints; ++j)
      ratios.mutable_at(j) = arm_of(motion, "peaks").peaks[k][j].ratio;
    peaks[names[k]] = ratios;
  }
  return peaks;
}

py::array_t<bool> process_of(const Motion& motion) {
  require_strokes(motion.of, "process");
  const Rows rows = rows_of(motion, "process");
  py::array_t<bool> process(static_cast<py::ssize_t>(rows->size()));
  if (rows->empty()) return process;
  const std::vector<ProcessEvent>& events = arm_of(motion, "process").events;
  bool* out = process.mutable_data();
  bool on = false;
  std::size_t next = 0;
  for (const TimedRow& row : *rows) {
    while (next < events.size() && events[next].t <= row.t) on = events[next++].on;
    *out++ = on;
  }
  return process;
}

py::array_t<std::size_t> part_of(const Motion& motion) {
  require_strokes(motion.of, "part");
  const ArmMotion& arm = arm_of(motion, "part");
  return column(std::shared_ptr<const std::vector<std::size_t>>(motion.of.found, &arm.part),
                arm.part.data());
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

std::vector<NamedEvent> events_of(const Motion& motion) {
  require_strokes(motion.of, "events");
  std::vector<NamedEvent> events;
  for (const ProcessEvent& event : arm_of(motion, "events").events)
    events.push_back(
        {event.t, event.s, motion.of.executed->arm().strokes[event.stroke].name, event.on});
  return events;
}

/// Returns the name of a part of a motion of strokes for people, by its number.
std::string part_words(const Motion& motion, std::size_t part) {
  const ArmTask& arm = motion.of.executed->arm();
  const std::vector<StrokeRun> order = order_of(motion.of.found->arm());
  const bool home = arm.home.has_value();
  const std::size_t run = home ? part / 2 : (part + 1) / 2;
  if (run >= order.size()) return "transition home";
  const std::string name = run_words(arm.strokes[order[run].stroke].name, order[run].reversed);
  return (part % 2 == 1) == home ? name : "transition to " + name;
}

/// Returns why there is no motion; nothing where there is one.
std::optional<std::string> reason_of(const Motion& motion) {
  if (!motion.fault.empty()) return motion.fault;
  const MotionTiming& timing = motion.timing();
  if (!timing.failure) return {};
  return (motion.of.has_paths() ? "" : part_words(motion, timing.failed_part) + ": ") +
         timing.failure->reason;
}

std::optional<RefinedPath> refinement_of(const Motion& motion) {
  require_path(motion.of, "refinement");
  const std::size_t arm = number_of(motion, "refinement");
  const auto& refinement = motion.of.found->refinement;
  if (!refinement) return {};
  return RefinedPath{std::shared_ptr<const Refined>(motion.of.found, &refinement->runs[arm]),
                     motion.of.found->arms[arm].joint_names};
}

std::vector<RefinedPath> refinements_of(const Motion& motion) {
  std::vector<RefinedPath> all;
  const swivel::Answer& found = *motion.of.found;
  if (!found.refinement) return all;
  const std::vector<Refined>& runs = found.refinement->runs;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t arm = found.arms.size() == 2 ? k : 0;
    if (motion.arm.value_or(arm) == arm)
      all.push_back(
          {std::shared_ptr<const Refined>(motion.of.found, &runs[k]), found.arms[arm].joint_names});
  }
  return all;
}

Typed<"dict[str, Motion]"> arms_of(const Motion& motion) {
  py::dict all;
  const std::vector<ArmAnswer>& arms = motion.of.found->arms;
  for (std::size_t k = motion.arm.value_or(0); k < (motion.arm ? *motion.arm + 1 : arms.size());
       ++k)
    all[arms[k].name.c_str()] = py::cast(Motion{motion.of, k, motion.fault});
  return all;
}

void save(const Motion& motion, const std::filesystem::path& file) {
  const swivel::Motion& all = motion.motion();
  io::write_file(file, motion.arm
                           ? io::motion_text(all.arms[*motion.arm], joint_names_of(motion, "save"),
                                             motion.of.executed->arm().base_link, file)
                           : io::motion_text(*motion.of.found, *motion.of.executed, file));
}

void bind_pieces(py::module_& m) {
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
          "singular",
          [](const TimedPath::Slow& x) {
            return x.singular.empty() ? std::nullopt : std::optional(x.singular);
          },
          "'shoulder', 'elbow', 'wrist' or None.")
      .def("__repr__", [](const TimedPath::Slow& x) {
        return formatted(
            "<Slow from s = %.4f to %.4f m: %.0f %% of the speed, for the %s of joint %d>",
            x.from_s, x.to_s, 100 * x.share, to_string(x.reason), x.joint);
      });
}

/// Binds what a motion of any problem says.
void bind_whole(py::class_<Motion>& type) {
  type.def(pickling<Motion>())
      .def_property_readonly("executable", &Motion::executable)
      .def_property_readonly("reason", &reason_of,
                             "Why it is not executable, of strokes with the part; or None.")
      .def_property_readonly(
          "at_s",
          [](const Motion& x) {
            const auto& failure = x.timing().failure;
            return failure ? std::optional(failure->s) : std::nullopt;
          },
          "Where it is not, m along the path or the part, or None.")
      .def_property_readonly(
          "at_part",
          [](const Motion& x) -> std::optional<std::size_t> {
            require_strokes(x.of, "at_part");
            if (!x.timing().failure) return {};
            return x.timing().failed_part;
          },
          "Of strokes, number of the part that is not, from 0, or None.")
      .def_property_readonly("arms", &arms_of,
                             "Name of the arm -> its Motion; '' where there is one arm. Samples of "
                             "two arms of one number are simultaneous.")
      .def_property_readonly(
          "duration",
          [](const Motion& x) {
            return x.arm ? arm_of(x, "duration").duration : x.motion().duration;
          },
          "s, from rest to rest.")
      .def_property_readonly(
          "ideal",
          [](const Motion& x) {
            require_path(x.of, "ideal");
            const bool both = x.of.has_two_arms() && !x.arm;
            return both ? x.motion().ideal : arm_of(x, "ideal").ideal;
          },
          "s, at the speed asked for throughout; of two arms that of the faster tool. Not of "
          "strokes.")
      .def_property_readonly(
          "rate", [](const Motion& x) { return x.motion().rate; }, "Samples a second.")
      .def_property_readonly(
          "warnings",
          [](const Motion& x) {
            const bool both = x.of.has_two_arms() && !x.arm;
            return both ? x.motion().warnings : arm_of(x, "warnings").warnings;
          },
          "Of two arms those of both together; each arm has its own besides.")
      .def("save", &save, py::arg("file"),
           "The ending chooses: .csv, .json or .yaml (ROS 2's JointTrajectory, of strokes with "
           "`events`), .mcap (JointState, of strokes with /process).")
      .def("__len__",
           [](const Motion& x) {
             return x.executable() ? x.motion().arms.front().rows.size() : std::size_t{0};
           })
      .def("__repr__", [](const Motion& x) { return "<Motion " + motion_words(x) + ">"; });
}

/// Binds the samples of one arm.
void bind_samples(py::class_<Motion>& type) {
  type.def_property_readonly(
          "t", [](const Motion& x) { return timed_column(rows_of(x, "t"), &TimedRow::t); },
          "(m,), s.")
      .def_property_readonly(
          "s", [](const Motion& x) { return placed_column(rows_of(x, "s"), &TrajectoryRow::s); },
          "(m,), m along the path or the stroke; in transitions it means nothing, as phi and "
          "branch.")
      .def_property_readonly(
          "phi",
          [](const Motion& x) { return placed_column(rows_of(x, "phi"), &TrajectoryRow::phi); },
          "(m,), carried arm angle, rad.")
      .def_property_readonly(
          "branch",
          [](const Motion& x) {
            return placed_column(rows_of(x, "branch"), &TrajectoryRow::branch);
          },
          "(m,), 0 to 7.")
      .def_property_readonly(
          "roll", &roll_of,
          "(m,), by how much the tool is turned about its z axis, rad; 0 where it may not turn.")
      .def_property_readonly(
          "joints",
          [](const Motion& x) {
            const Rows rows = rows_of(x, "joints");
            return column(rows, rows->empty() ? nullptr : rows->front().row.q.data(),
                          static_cast<py::ssize_t>(joints_of(x, "joints")));
          },
          "(m, 7), rad.")
      .def_property_readonly(
          "velocities", [](const Motion& x) { return timed_joints(x, "velocities", &TimedRow::v); },
          "(m, 7), rad/s.")
      .def_property_readonly(
          "accelerations",
          [](const Motion& x) { return timed_joints(x, "accelerations", &TimedRow::a); },
          "(m, 7), rad/s^2.")
      .def_property_readonly(
          "joint_names", [](const Motion& x) { return names_in(joint_names_of(x, "joint_names")); })
      .def_property_readonly("part", &part_of,
                             "Of strokes (m,), number of the part to which each row leads, from 0.")
      .def_property_readonly(
          "process", &process_of,
          "Of strokes (m,) bool, whether the process is on from this row to the next.")
      .def_property_readonly("events", &events_of,
                             "Of strokes ProcessEvents: when the process is switched on and off.")
      .def_property_readonly(
          "peaks", &peaks_of,
          "'speed', 'acceleration', 'jerk': (7,), the largest over what the joint can do. Not of "
          "strokes, as the next three.")
      .def_property_readonly(
          "slow",
          [](const Motion& x) {
            require_path(x.of, "slow");
            return arm_of(x, "slow").slow;
          },
          "Stretches below the speed asked for.")
      .def_property_readonly(
          "stops",
          [](const Motion& x) {
            require_path(x.of, "stops");
            return arm_of(x, "stops").stops;
          },
          "Corners that the tool stops at.")
      .def_property_readonly(
          "between_samples",
          [](const Motion& x) {
            require_path(x.of, "between_samples");
            const ArmMotion& arm = arm_of(x, "between_samples");
            return std::pair(arm.between_position, arm.between_angle);
          },
          "How far the tool leaves its path between samples, m and rad.")
      .def_property_readonly("refinement", &refinement_of,
                             "Refined, where rows were refined before they were timed; else None. "
                             "Not of strokes.")
      .def_property_readonly("refinements", &refinements_of,
                             "Refined of each run of strokes, or of each arm, where rows were "
                             "refined before they were timed; else none.");
}

}  // namespace

const swivel::Motion& Motion::motion() const {
  if (!executable()) throw py::value_error("the motion is " + motion_words(*this));
  return *timing().motion;
}

std::string motion_words(const Motion& motion) {
  const MotionTiming& timing = motion.timing();
  if (timing.failure) {
    const std::string text = timed_text(*motion.of.found, *motion.of.executed);
    return text.substr(0, text.find('\n'));
  }
  if (!motion.executable()) return "not executable: " + reason_of(motion).value_or("stopped");
  const swivel::Motion& all = *timing.motion;
  const ArmMotion& arm = all.arms[motion.arm.value_or(0)];
  std::string text = formatted("%.3f s, ", all.duration);
  if (!motion.of.has_paths()) {
    const std::size_t lift_offs = lift_off_count(*motion.of.executed);
    text += formatted("%zu strokes, ", arm.events.size() / 2 - lift_offs);
    if (lift_offs > 0) text += formatted("%zu lift-off%s, ", lift_offs, lift_offs == 1 ? "" : "s");
  }
  text += formatted("%zu samples at %.6g Hz", arm.rows.size(), all.rate);
  if (motion.of.has_paths() && arm.ideal > 0)
    text += formatted(" (%.3f s at the speed asked throughout)", arm.ideal);
  if (motion.of.has_paths() && !arm.stops.empty())
    text += formatted(", %zu stops", arm.stops.size());
  return text;
}

std::string refined_words(const Refined& refined) {
  if (!refined.refined) return "not refined: " + refined.reason;
  return formatted("refined: cost %.6g before, %.6g now", refined.cost_before, refined.cost);
}

void bind_motion(py::module_& m) {
  bind_pieces(m);
  py::class_<Motion> type(
      m, "Motion",
      "A motion in time, from rest to rest, of one arm or of two by one clock, or why there is "
      "none. Arrays are read-only views; of two arms each of `arms` has its own. Strokes are run "
      "with rest at the ends of their parts.");
  bind_whole(type);
  bind_samples(type);
}

}  // namespace swivel::python
