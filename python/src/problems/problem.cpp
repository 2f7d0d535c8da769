// SPDX-License-Identifier: BSD-3-Clause
// Bindings of problems: one path, strokes, or two arms.
#include "problems/problem.hpp"

#include <algorithm>

#include "base/archive.hpp"
#include "base/interruptible.hpp"
#include "base/trajectory.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/path_range.hpp"

namespace swivel::python {

namespace {

using Strokes = Typed<"Iterable[Stroke]", py::iterable>;

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

/// Returns true if two scenes have objects of the same names at the same places.
bool same_places(const std::vector<SceneObject>& a, const std::vector<SceneObject>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SceneObject& x, const SceneObject& y) {
                      return x.name == y.name && x.pose.matrix() == y.pose.matrix();
                    });
}

/// Gives an arm the rows of a motion; limits, resolution and cost are those of `like`. Throws
/// ValueError for rows of other joints.
void give(ArmTask& arm, const Robot& robot, const Trajectory& motion, const PathProblem& like) {
  const Task task = task_to_core(like, like);
  static_cast<Robot&>(arm) = robot;
  if (arm.roll) arm.roll = Roll{};  // the rows say how the tool stands turned
  const auto names =
      build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll)
          .chain.joint_names;
  if (!std::equal(names.begin(), names.end(), motion.joint_names.begin(), motion.joint_names.end()))
    throw py::value_error("arms: the trajectory of '" + arm.name +
                          "' has other joints than its robot: allowed are rows of this robot");
  arm.path().limits = task.limits;
  arm.path().resolution = task.resolution;
  arm.path().cost = task.cost;
  for (const TrajectoryRow& row : *motion.rows) arm.given.push_back(row.q);
}

/// Returns the steps between rows at which waypoints are. Throws ValueError unless they ascend
/// from 0.
std::vector<int> steps_of(const std::vector<int>& at_rows) {
  std::vector<int> steps;
  for (std::size_t k = 1; k < at_rows.size(); ++k) steps.push_back(at_rows[k] - at_rows[k - 1]);
  if (at_rows.front() != 0 || std::any_of(steps.begin(), steps.end(), [](int n) { return n < 1; }))
    throw py::value_error("at_rows: allowed are ascending rows from 0");
  return steps;
}

std::string problem_words(const Problem& problem) {
  if (problem.two) {
    const std::vector<ArmTask>& arms = problem.two->arms;
    const std::size_t of = problem.two->given_arm() == 0u ? 1 : 0;
    return formatted("<Problem of '%s' and '%s', %zu waypoints>", arms[0].name.c_str(),
                     arms[1].name.c_str(), arms[of].path().waypoints.size());
  }
  const std::string robot = py::repr(py::cast(Robot(problem))).cast<std::string>();
  return "<Problem" + (problem.source.empty() ? "" : " '" + problem.source + "'") + ": " +
         robot.substr(7, robot.size() - 8) + "; " +
         (problem.strokes.list ? std::to_string(problem.strokes.list->size()) + " strokes, "
                               : std::to_string(problem.waypoints.size()) + " waypoints, ") +
         std::to_string(problem.scene.size()) + " objects>";
}

/// Returns the problem of each arm by itself, by its name.
Typed<"dict[str, Problem]"> arms_of(const Problem& problem) {
  py::dict arms;
  if (!problem.two) arms[""] = py::cast(problem);
  if (problem.two)
    for (const ArmTask& arm : problem.two->arms)
      arms[arm.name.c_str()] =
          py::cast(from_core(one_path(problem_of_path(*problem.two, arm, arm.path()))));
  return arms;
}

void save(const Problem& problem, const std::filesystem::path& file) {
  if (problem.two) throw InvalidArgument("save: a problem of two arms: allowed is one of one arm");
  const swivel::Problem core = to_core(problem);
  PathProblem path = problem;
  static_cast<Task&>(path) = task_to_core(path, problem);
  interruptible([&](const std::stop_token&) {
    if (is_path(core))
      io::save_problem(path, file);
    else
      io::save_problem(core, file);
    return true;
  });
}

void bind_constructors(py::class_<Problem, Robot, Task>& type) {
  type.def(py::init([](const Robot& robot, const Task& task, const SceneObjects& scene) {
             Problem problem;
             static_cast<Robot&>(problem) = robot;
             static_cast<Task&>(problem) = task;
             for (const py::handle object : scene)
               problem.scene.push_back(object.cast<const SceneObject&>());
             pass_half_turns(problem, problem.waypoints);
             return problem;
           }),
           py::arg("robot"), py::arg("task"), py::arg("scene") = py::tuple(),
           "One path. A tool that may turn freely about its z axis passes half turns between "
           "waypoints: those behind a half turn about another axis are turned by 180 deg about z.");
  type.def(py::init([](const Robot& robot, const Strokes& strokes, const SceneObjects& scene,
                       const Limits& limits, const Resolution& resolution, const Cost& cost,
                       const Refinement& refinement, const ArrayLike& home,
                       const OrName<StrokeOrder>& order, const ArrayLike& approach,
                       const ArrayLike& retract, std::optional<double> process_speed,
                       std::optional<double> approach_speed, double rapid,
                       const std::optional<LiftOffs>& lift) {
             Problem problem;
             static_cast<Robot&>(problem) = robot;
             problem.strokes.list = py::list(strokes);
             static_cast<void>(problem.strokes.all());
             for (const py::handle object : scene)
               problem.scene.push_back(object.cast<const SceneObject&>());
             problem.limits = limits, problem.resolution = resolution, problem.cost = cost;
             problem.refinement = refinement, problem.home = to_posture(home, "home");
             problem.order = to_enum<StrokeOrder>(order);
             problem.approach = to_offset(approach, "approach");
             problem.retract = to_offset(retract, "retract");
             problem.process_speed = process_speed, problem.approach_speed = approach_speed;
             problem.rapid = rapid, problem.lift = lift;
             return problem;
           }),
           py::arg("robot"), py::arg("strokes"), py::arg("scene") = py::tuple(), py::kw_only(),
           py::arg_v("limits", Limits(), "Limits()"),
           py::arg_v("resolution", Resolution(), "Resolution()"),
           py::arg_v("cost", Cost(), "Cost()"),
           py::arg_v("refinement", Refinement(), "Refinement()"), py::arg("home") = py::none(),
           py::arg("order") = "given", py::arg("approach") = 0.0, py::arg("retract") = 0.0,
           py::arg("process_speed") = py::none(), py::arg("approach_speed") = py::none(),
           py::arg("rapid") = 1.0, py::arg("lift") = py::none(),
           "Strokes with transitions between them, from a home and back. limits, resolution, "
           "approach, retract, process_speed and approach_speed hold for strokes that have none of "
           "their own; limits are kept in transitions, too. home: (7,), rad, or None. order: "
           "StrokeOrder or its name. rapid: share of the joints' speeds in transitions. lift: "
           "LiftOffs; None: each stroke is done in one run.");
  type.def(py::init(&problem_of_arms), py::arg("arms"), py::kw_only(),
           py::arg("may_touch") = std::vector<std::array<std::string, 2>>(),
           py::arg("at_rows") = std::vector<int>(),
           "Two arms that work at one time. arms: two entries, name -> Problem of one path, of one "
           "robot model with one base link and one `hold`; the `frame` of one path may be the name "
           "of the other arm, which leads then. The scene is that of the first. One entry may be "
           "(Robot, Trajectory) instead: an arm whose motion is given, with limits, resolution and "
           "cost of the other. at_rows: the row of that motion at which each waypoint of the other "
           "arm is; empty: there is one for each row, or two. may_touch: pairs of bodies, one of "
           "either arm, that may touch. Raises InvalidArgument.");
}

/// Binds what problems with strokes have; the package's Problem refuses these words of others.
void bind_of_strokes(py::class_<Problem, Robot, Task>& type) {
  type.def_property(
          "strokes",
          [](const Problem& problem) -> Typed<"list[Stroke]"> { return *problem.strokes.list; },
          [](Problem& problem, const Strokes& strokes) {
            problem.strokes.list = py::list(strokes);
          },
          "A list of Strokes, changed in place.")
      .def_property(
          "home", [](const Problem& problem) { return problem.home; },
          [](Problem& problem, const OptionalArray& home) {
            problem.home = to_posture(home, "home");
          },
          "(7,), rad, where the arm begins and ends, or None: at its strokes. A copy; assign to "
          "change it.")
      .def_property(
          "order", [](const Problem& problem) { return problem.order; },
          [](Problem& problem, const OrName<StrokeOrder>& order) {
            problem.order = to_enum<StrokeOrder>(order);
          },
          "StrokeOrder.")
      .def_property(
          "approach", [](const Problem& problem) { return problem.approach; },
          [](Problem& problem, const ArrayLike& from) {
            problem.approach = to_offset(from, "approach");
          },
          "From where the tool comes to strokes that do not say it: (3,), m in the tool frame; 0: "
          "no line. A copy; assign it, or m against the tool's z axis, to change it.")
      .def_property(
          "retract", [](const Problem& problem) { return problem.retract; },
          [](Problem& problem, const ArrayLike& to) { problem.retract = to_offset(to, "retract"); },
          "Where the tool goes after them, alike.")
      .def_readwrite("process_speed", &Problem::process_speed,
                     "m/s along strokes, or None: limits.tool_speed.")
      .def_readwrite("approach_speed", &Problem::approach_speed,
                     "m/s along approach and retract, or None: as on the stroke.")
      .def_readwrite("rapid", &Problem::rapid, "Share of the joints' speeds in transitions, to 1.")
      .def_readwrite("lift", &Problem::lift,
                     "LiftOffs, where the tool may lift off within strokes, in the given order of "
                     "strokes; None: each is done in one run.");
}

}  // namespace

Problem problem_of_arms(const ArmsByName& arms,
                        const std::vector<std::array<std::string, 2>>& touch,
                        const std::vector<int>& at_rows) {
  if (arms.size() != 2)
    throw py::value_error("arms: has " + std::to_string(arms.size()) +
                          " entries: allowed are two, name -> Problem");
  auto cell = std::make_shared<swivel::Problem>(two_arms());
  std::size_t k = 0;
  const PathProblem* first_problem = nullptr;
  for (const auto& [name, value] : arms) {
    ArmTask& arm = cell->arms[k++];
    arm.name = py::str(name);
    if (py::isinstance<py::tuple>(value)) continue;  // its motion is given
    const auto& problem = path_of(value.cast<const Problem&>(), "arms");
    static_cast<Robot&>(arm) = problem;
    static_cast<Task&>(arm.path()) = task_to_core(problem, problem);
    if (!at_rows.empty()) arm.path().steps = steps_of(at_rows);
    if (first_problem == nullptr) {
      first_problem = &problem;
      cell->scene = problem.scene;
      cell->vary = problem.vary;
      cell->source = problem.source;
    } else if (!problem.scene.empty() && !same_places(problem.scene, cell->scene)) {
      throw py::value_error(
          "arms: have different scenes: allowed is one scene, or none of the "
          "second arm");
    }
  }
  if (first_problem == nullptr)
    throw py::value_error("arms: both motions are given: allowed is one Problem at least");
  k = 0;
  for (const auto& [name, value] : arms) {
    ArmTask& arm = cell->arms[k++];
    if (!py::isinstance<py::tuple>(value)) continue;
    const auto& [robot, motion] = value.cast<std::pair<const Robot*, const Trajectory*>>();
    give(arm, *robot, *motion, *first_problem);
  }
  // Two Robots of Python that were loaded from one file have a model each.
  const RobotModel &first = *cell->arms[0].model, &second = *cell->arms[1].model;
  if (first.source == second.source && first.links.size() == second.links.size() &&
      first.joints.size() == second.joints.size())
    cell->arms[1].model = cell->arms[0].model;
  cell->may_touch = touch;
  validate(*cell);
  Problem made;
  static_cast<Robot&>(made) = cell->arm();
  made.two = std::move(cell);
  return made;
}

namespace {

/// Seven numbers, one for each joint, that a problem has.
struct OfJoints {
  const char* name;
  double* numbers;
  bool rates = false;  ///< of what joints can do: the roll has as much as joint 6
};

void add(const char* name, std::optional<Config>& posture, std::vector<OfJoints>& all) {
  if (posture) all.push_back({name, posture->data()});
}
void add(Limits& limits, std::vector<OfJoints>& all) {
  for (const auto& [name, numbers] : {std::pair("joint_speed", &limits.joint_speed),
                                      std::pair("joint_acceleration", &limits.joint_acceleration),
                                      std::pair("joint_jerk", &limits.joint_jerk)})
    if (*numbers) all.push_back({name, (*numbers)->data(), true});
}
void add(Cost& cost, std::vector<OfJoints>& all) {
  if (cost.weights) all.push_back({"weights", cost.weights->data()});
}
std::vector<OfJoints> numbers_of(Task& task) {
  std::vector<OfJoints> all;
  add("start", task.start, all), add("end", task.end, all);
  add(task.limits, all), add(task.cost, all);
  return all;
}
std::vector<OfJoints> numbers_of(ArmTask& arm) {
  std::vector<OfJoints> all;
  add("home", arm.home, all), add(arm.transition_limits, all);
  for (swivel::Stroke& stroke : arm.strokes)
    for (const OfJoints& one : numbers_of(static_cast<Task&>(stroke))) all.push_back(one);
  return all;
}

/// Brings numbers from Python's form to the planner's, task_to_core().
void to_core(const Robot& robot, const std::vector<OfJoints>& all) {
  if (all.empty()) return;
  const bool six = arm_of(robot).chain.roll_fixed;
  for (const OfJoints& of : all) {
    double& last = of.numbers[kDof - 1];
    if ((last == kNoSeventh) != six)
      throw InvalidArgument(std::string(of.name) + ": " + (six ? "7" : "6") +
                            " numbers: allowed are " + (six ? "6" : "7"));
    if (six) last = of.rates ? of.numbers[kDof - 2] : 0;
  }
}

/// Brings numbers from the planner's form to Python's, task_from_core().
void from_core(const Robot& robot, const std::vector<OfJoints>& all) {
  if (all.empty() || !arm_of(robot).chain.roll_fixed) return;
  for (const OfJoints& of : all) of.numbers[kDof - 1] = kNoSeventh;
}

}  // namespace

Task task_to_core(Task task, const Robot& robot) {
  to_core(robot, numbers_of(task));
  return task;
}

Task task_from_core(Task task, const Robot& robot) {
  from_core(robot, numbers_of(task));
  return task;
}

std::size_t coordinates_of(const swivel::Problem& problem) {
  return arm_of(problem.arms.front()).chain.coordinates();
}

swivel::Problem to_core(const Problem& problem) {
  if (problem.two) return *problem.two;
  if (!problem.strokes.list) {
    PathProblem path = problem;
    static_cast<Task&>(path) = task_to_core(path, problem);
    return one_path(std::move(path));
  }
  swivel::Problem core;
  ArmTask& arm = core.arm();
  static_cast<Robot&>(arm) = problem;
  core.source = problem.source, core.scene = problem.scene, core.vary = problem.vary;
  arm.transition_limits = problem.limits, arm.home = problem.home, arm.order = problem.order;
  arm.process_speed = problem.process_speed, arm.approach_speed = problem.approach_speed;
  arm.rapid = problem.rapid, arm.lift = problem.lift;
  for (Stroke& stroke : problem.strokes.all()) {
    swivel::Stroke& made = arm.strokes.emplace_back();
    made.name = std::move(stroke.name), made.waypoints = std::move(stroke.waypoints);
    pass_half_turns(arm, made.waypoints);
    made.path_frame = std::move(stroke.frame), made.smooth = stroke.smooth;
    made.limits = stroke.limits.value_or(problem.limits);
    made.resolution = stroke.resolution.value_or(problem.resolution);
    made.cost = problem.cost, made.refinement = problem.refinement;
    made.reversible = stroke.reversible;
    made.approach = stroke.approach.value_or(problem.approach);
    made.retract = stroke.retract.value_or(problem.retract);
    made.process_speed = stroke.process_speed, made.approach_speed = stroke.approach_speed;
    made.feed = std::move(stroke.feed), made.end = stroke.end, made.closed = stroke.closed;
  }
  if (is_path(core)) throw InvalidArgument("strokes: name: allowed are non-empty names");
  to_core(arm, numbers_of(arm));
  validate(core);
  return core;
}

Problem from_core(swivel::Problem core) {
  Problem problem;
  if (core.arms.size() == 2) {
    static_cast<Robot&>(problem) = core.arm();
    problem.two = std::make_shared<const swivel::Problem>(std::move(core));
    return problem;
  }
  ArmTask& arm = core.arm();
  static_cast<Robot&>(problem) = arm;
  problem.source = std::move(core.source), problem.scene = std::move(core.scene);
  problem.vary = std::move(core.vary);
  if (is_path(core)) {
    static_cast<Task&>(problem) = task_from_core(arm.path(), arm);
    return problem;
  }
  from_core(arm, numbers_of(arm));
  problem.limits = arm.transition_limits, problem.home = arm.home, problem.order = arm.order;
  problem.process_speed = arm.process_speed, problem.approach_speed = arm.approach_speed;
  problem.rapid = arm.rapid, problem.lift = arm.lift;
  std::vector<Stroke> strokes;
  for (swivel::Stroke& stroke : arm.strokes) {
    problem.cost = stroke.cost, problem.refinement = stroke.refinement;  // files have one for all
    const bool own_limits = stroke.limits != arm.transition_limits;
    strokes.push_back({std::move(stroke.name), std::move(stroke.waypoints),
                       std::move(stroke.path_frame), stroke.smooth, stroke.reversible,
                       stroke.approach, stroke.retract, stroke.process_speed, stroke.approach_speed,
                       std::move(stroke.feed),
                       own_limits ? std::optional(stroke.limits) : std::nullopt, stroke.resolution,
                       stroke.end, stroke.closed});
  }
  share(strokes, &Stroke::resolution, problem.resolution);
  share(strokes, &Stroke::approach, problem.approach);
  share(strokes, &Stroke::retract, problem.retract);
  problem.strokes.set(strokes);
  return problem;
}

swivel::Problem to_core(const ProblemOrFile& problem) {
  if (const auto* made = std::get_if<const Problem*>(&problem)) return to_core(**made);
  const std::filesystem::path& file = std::get<std::filesystem::path>(problem);
  return interruptible([&](const std::stop_token&) { return io::load_problem(file); });
}

const PathProblem& path_of(const Problem& problem, const char* what) {
  if (problem.two || problem.strokes.list)
    throw InvalidArgument(std::string(what) + ": a problem " +
                          (problem.two ? "of two arms" : "with strokes") +
                          ": allowed is one of one path");
  return problem;
}

Movable to_movable(const std::optional<std::string>& object, bool path, bool base, bool only_held,
                   const std::optional<std::string>& arm) {
  if (arm && !path) throw InvalidArgument("arm: whose path is moved: allowed with path=True");
  if (only_held && !object && !path && !base) return {Movable::Kind::kNothing, ""};
  if (static_cast<int>(object.has_value()) + static_cast<int>(path) + static_cast<int>(base) != 1)
    throw InvalidArgument(
        "object, path, base: what is to be moved: allowed is exactly one of the three");
  if (object) return {Movable::Kind::kObject, *object};
  return {path ? Movable::Kind::kPath : Movable::Kind::kBase, {}, arm.value_or("")};
}

void bind_whole_problem(py::module_& m) {
  py::class_<Problem, Robot, Task> type(
      m, "Problem",
      "What a problem file says: a robot, the scene, and one path or strokes; or two arms.");
  make_copyable(type);
  type.def(pickling<Problem>());
  bind_constructors(type);
  type.def_property(
          "waypoints", [](const Problem& problem) { return problem.waypoints; },
          [](Problem& problem, std::vector<Waypoint> waypoints) {
            pass_half_turns(problem, waypoints);
            problem.waypoints = std::move(waypoints);
          },
          "As of a Task. A copy; assign to change it.")
      .def_property_readonly(
          "source",
          [](const Problem& problem) { return problem.two ? problem.two->source : problem.source; },
          "The file; empty of problems made in memory.")
      .def_readwrite("scene", &Problem::scene, "Scene, changed in place.")
      .def_property_readonly(
          "robot", [](const Problem& problem) { return Robot(problem); }, "A copy.")
      .def_property_readonly(
          "task", [](const Problem& problem) { return Task(problem); }, "A copy, of one path.")
      .def_property_readonly("arms", &arms_of,
                             "Name of the arm -> its problem by itself, a copy; '' where there is "
                             "one arm.")
      .def(
          "validate",
          [](const Problem& problem) {
            const swivel::Problem core = to_core(problem);
            if (is_path(core)) validate(problem_of_run(core, {0, false}));
          },
          "Raises InvalidArgument, which names stroke and member, for what no problem may have.")
      .def(
          "placed",
          [](const Problem& problem, const Offset& offset, const std::optional<std::string>& object,
             bool path, bool base, const std::optional<std::string>& arm,
             const HeldPositions& hold) {
            return from_core(placed_problem(held_as(to_core(problem), hold),
                                            to_movable(object, path, base, !hold.empty(), arm),
                                            offset));
          },
          py::arg("offset"), py::kw_only(), py::arg("object") = py::none(), py::arg("path") = false,
          py::arg("base") = false, py::arg("arm") = py::none(), py::arg("hold") = HeldPositions(),
          "The problem of one placement: an object of the scene with the paths on it, the paths of "
          "all strokes or both arms (a follower's with its leader's tool), that of `arm` alone (a "
          "follower's in the frame of its leader's tool), or the robot moved by x y z (m) roll "
          "pitch yaw (rad) in the base frame, about its own origin, with the joints of `hold` held "
          "there, rad or m.")
      .def(
          "episode",
          [](const Problem& problem, std::uint64_t seed, std::uint64_t episode) {
            return from_core(episode_problem(to_core(problem), seed, episode));
          },
          py::arg("seed"), py::arg("episode"),
          "The problem of this episode of a campaign: objects moved as the file's `vary` says.")
      .def("save", &save, py::arg("file"),
           "Writes a problem file that gives this problem when it is loaded; not of two arms. Of a "
           "problem that was loaded from a file it is that file with what has changed since: "
           "comments, order and layout stay, names of files are as seen from the new place. A "
           "problem made in memory is written whole. The file is replaced as a whole, or left as "
           "it was. Raises InputError for what no file can say, and InvalidArgument.")
      .def(
          "stretch",
          [](const Problem& problem, double begin, std::optional<double> end) {
            PathRange range{begin};
            if (end) range.to = *end;
            return Problem(problem_of_range(path_of(problem, "stretch"), range));
          },
          py::arg("begin"), py::arg("end") = py::none(),
          "The problem of a stretch of one path alone, between two arc lengths, m, which the arm "
          "begins and ends in any posture. end: None for the path's end. Raises InvalidArgument.")
      .def("_kind",
           [](const Problem& problem) {
             return problem.two ? "two arms" : problem.strokes.list ? "strokes" : "one path";
           })
      .def(
          "__eq__",
          [](const Problem& a, const Problem& b) {
            const bool paths = !a.strokes.list && !a.two && !b.strokes.list && !b.two;
            return paths ? static_cast<const Task&>(a) == b : &a == &b;
          },
          py::is_operator())
      .def("__repr__", &problem_words)
      .attr("__hash__") = py::none();
  bind_of_strokes(type);
  m.def(
      "load",
      [](const std::filesystem::path& file) {
        return from_core(
            interruptible([&](const std::stop_token&) { return io::load_problem(file); }));
      },
      py::arg("file"),
      "A problem file, docs/formats.md: one path, strokes or two arms. Raises InputError, which "
      "names file and line.");
}

}  // namespace swivel::python
