// SPDX-License-Identifier: BSD-3-Clause
// Bindings of the planner, with the caller's own checks and costs.
#include "swivel/planner/plan/planner.hpp"

#include <atomic>
#include <chrono>
#include <optional>

#include "bindings.hpp"
#include "interruptible.hpp"
#include "plan_keywords.hpp"
#include "problem.hpp"
#include "results.hpp"
#include "states.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/measure/measure.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::python {

namespace {

std::string name_of(const py::object& function) {
  const py::object name = py::getattr(function, "__name__", py::none());
  return py::isinstance<py::str>(name)
             ? name.cast<std::string>()
             : py::type::of(function).attr("__name__").cast<std::string>();
}

/// Returns the answers of a Python function as an array with one number for each of `count` states.
/// Throws ValueError for another shape or type.
template <class Number>
py::array_t<Number> answers_of(const py::object& answer, std::size_t count,
                               const std::string& what) {
  const py::array array = py::array::ensure(answer);
  PyErr_Clear();
  constexpr bool kLogical = std::is_same_v<Number, bool>;
  const bool kind =
      array && (kLogical ? array.dtype().kind() == 'b'
                         : std::string("fiu").find(array.dtype().kind()) != std::string::npos);
  if (!kind || array.ndim() != 1 || array.shape(0) != static_cast<py::ssize_t>(count))
    throw py::value_error(what + " returned " +
                          (array ? py::str(array.dtype()).cast<std::string>() + " of shape " +
                                       py::str(array.attr("shape")).cast<std::string>()
                                 : "no array") +
                          ": allowed is " + (kLogical ? "bool" : "float64") + " of shape (" +
                          std::to_string(count) + ",)");
  return py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(array);
}

/// Returns a copy of states as an array, since a function may keep its argument.
template <class Item>
py::array_t<double> states_of(std::span<const Item> items, const Config& (*joints)(const Item&)) {
  py::array_t<double> states(
      {static_cast<py::ssize_t>(items.size()), static_cast<py::ssize_t>(kDof)});
  double* out = states.mutable_data();
  for (const Item& item : items) out = std::copy_n(joints(item).data(), kDof, out);
  return states;
}
const Config& itself(const Config& q) {
  return q;
}

/// A check by Python functions of arrays. The interpreter's lock must be held when it is made and
/// destroyed.
class ArrayCheck : public StateCheck {
 public:
  ArrayCheck(py::object check, py::object motions)
      : check_(std::move(check)), motions_(std::move(motions)) {
    name_ = name_of(check_.is_none() ? motions_ : check_);
  }
  [[nodiscard]] std::string name() const override { return name_; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    if (check_is_none()) return static_cast<void>(std::fill(allowed.begin(), allowed.end(), true));
    const py::gil_scoped_acquire gil;
    const auto answer =
        answers_of<bool>(check_(states_of(states, itself)), states.size(), "check '" + name_ + "'");
    std::copy_n(answer.data(), allowed.size(), allowed.begin());
  }
  [[nodiscard]] bool checks_motions() const override { return motions_.ptr() != Py_None; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    const py::gil_scoped_acquire gil;
    const auto from =
        states_of<Motion>(motions, [](const Motion& m) -> const Config& { return m.from; });
    const auto to =
        states_of<Motion>(motions, [](const Motion& m) -> const Config& { return m.to; });
    const auto answer =
        answers_of<bool>(motions_(from, to), motions.size(), "check_motions of '" + name_ + "'");
    std::copy_n(answer.data(), allowed.size(), allowed.begin());
  }

 private:
  [[nodiscard]] bool check_is_none() const { return check_.ptr() == Py_None; }
  py::object check_, motions_;
  std::string name_;
};

class ArrayCost : public StateCost {
 public:
  explicit ArrayCost(py::object cost) : cost_(std::move(cost)), name_(name_of(cost_)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    const py::gil_scoped_acquire gil;
    const auto answer =
        answers_of<double>(cost_(states_of(states, itself)), states.size(), "cost '" + name_ + "'");
    std::copy_n(answer.data(), costs.size(), costs.begin());
  }

 private:
  py::object cost_;
  std::string name_;
};

/// Throws TypeError for what is neither None nor can be called.
void require_function(const py::object& function, const char* name) {
  if (!function.is_none() && PyCallable_Check(function.ptr()) == 0)
    throw py::type_error(std::string(name) + ": not callable: allowed is a function, or None");
}

/// The options of a plan as Python keywords.
struct PlanKeywords {
  py::object planner;
  int threads = 0;
  std::optional<double> timeout;
  bool prove = true, evidence = false;
  py::object check, check_motions, cost, progress;
  [[nodiscard]] PlanOptions options() const {
    PlanOptions options = to_plan_options(planner, threads, timeout, prove);
    if (evidence) options.evidence = Evidence::all();
    require_function(check, "check");
    require_function(check_motions, "check_motions");
    require_function(cost, "cost");
    if (!check.is_none() || !check_motions.is_none())
      options.hooks.check = std::make_shared<ArrayCheck>(check, check_motions);
    if (!cost.is_none()) options.hooks.cost = std::make_shared<ArrayCost>(cost);
    options.progress = to_progress(progress);
    return options;
  }
};

TimingOptions timing_of(const PathProblem& problem, std::optional<double> speed,
                        std::optional<double> turn_speed, double rate,
                        std::optional<double> chord) {
  TimingOptions options;
  if (!speed && !problem.limits.tool_speed)
    throw py::value_error(
        "speed: is not given, nor limits.tool_speed: allowed is the speed of the tool in m/s");
  options.speed = speed.value_or(problem.limits.tool_speed.value_or(0));
  options.turn_speed = turn_speed ? turn_speed : problem.limits.tool_turn_speed;
  options.rate = rate;
  if (!(options.speed > 0))
    throw py::value_error("speed: not a positive number: allowed are values above 0, m/s");
  if (options.turn_speed && !(*options.turn_speed > 0))
    throw py::value_error("turn_speed: not a positive number: allowed are values above 0, rad/s");
  options.chord = chord;
  if (chord && !(*chord > 0))
    throw py::value_error("chord: not a positive number: allowed are values above 0, m");
  if (!(rate > 0 && rate <= 1e5))
    throw py::value_error("rate: allowed are numbers > 0, at most 100000");
  return options;
}

PathProblem problem_of(const Robot& robot, const std::optional<Task>& task,
                       const SceneObjects& scene) {
  PathProblem problem;
  static_cast<Robot&>(problem) = robot;
  if (task) static_cast<Task&>(problem) = *task;
  pass_half_turns(problem, problem.waypoints);
  for (const py::handle object : scene) problem.scene.push_back(object.cast<const SceneObject&>());
  return problem;
}

/// A planner for one thread at a time; a second thread gets a RuntimeError meanwhile. The planner's
/// task is the user's, or that task with the defaults of motions while a motion is planned.
class SharedPlanner {
  class Use {
   public:
    explicit Use(SharedPlanner& planner) : planner_(planner) {
      if (planner_.in_use_.exchange(true))
        throw std::runtime_error(
            "this planner is at work, in another thread or in a function of its own: allowed is a "
            "clone() for each thread");
    }
    ~Use() { planner_.in_use_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    SharedPlanner& planner_;
  };
  /// Returns work(robot, problem, budget), called with the prepared robot. `timeout`: s.
  template <class Work>
  auto prepared(const Work& work, std::optional<double> timeout = {}) {
    const Use use(*this);
    if (timeout && !(*timeout > 0))
      throw py::value_error("timeout: not a positive number: allowed are values above 0, or None");
    planner_.set_task(task_);
    return interruptible([&](const std::stop_token& stop) {
      const Budget budget(timeout, nullptr, stop);
      return work(planner_.prepare(budget), planner_.problem(), budget);
    });
  }

 public:
  explicit SharedPlanner(Planner planner)
      : planner_(std::move(planner)), task_(planner_.problem()) {}

  [[nodiscard]] PathProblem problem() {
    const Use use(*this);
    PathProblem problem = planner_.problem();
    static_cast<Task&>(problem) = task_;
    return problem;
  }
  [[nodiscard]] bool in_use() const { return in_use_; }
  [[nodiscard]] std::unique_ptr<SharedPlanner> clone() {
    const Use use(*this);
    planner_.set_task(task_);
    return std::make_unique<SharedPlanner>(planner_.clone());
  }
  void set_task(Task task) {
    const Use use(*this);
    pass_half_turns(planner_.problem(), task.waypoints);
    planner_.set_task(task);
    task_ = planner_.problem();
  }
  /// Applies a change of robot or scene.
  template <class Change>
  void change(const Change& change) {
    const Use use(*this);
    change(planner_);
  }
  /// Returns the number of rows that a trajectory of the whole path has.
  int rows_of_path() {
    return prepared(
        [](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return problem_path(problem, robot.arm().chain, budget).size();
        });
  }
  Plan plan(const PlanKeywords& keywords, bool refined, std::optional<double> speed,
            std::optional<double> turn_speed, std::optional<double> rate,
            std::optional<double> chord) {
    const Use use(*this);
    Plan plan;
    PlanOptions options = keywords.options();
    planner_.set_task(task_);
    if (!speed && (turn_speed || rate || chord))
      throw py::value_error(std::string(turn_speed ? "turn_speed"
                                        : rate     ? "rate"
                                                   : "chord") +
                            ": is of motions: allowed with speed");
    if (speed)
      plan.timing = timing_of(planner_.problem(), speed, turn_speed,
                              rate.value_or(TimingOptions().rate), chord);
    if (plan.timing) {
      planner_.set_task(with_motion_defaults(planner_.problem()));
    } else if (refined) {
      Task task = task_;
      keep_clearance_between_layers(task.limits);
      planner_.set_task(task);
    }
    plan.frame = planner_.problem().base_link;
    plan.refined = refined;
    plan.own_functions =
        !keywords.check.is_none() || !keywords.check_motions.is_none() || !keywords.cost.is_none();
    plan.problem = std::make_shared<const PathProblem>(planner_.problem());
    plan.plan = std::make_shared<const MotionPlan>(interruptible([&](const std::stop_token& stop) {
      options.stop = stop;
      return plan_motion(planner_, options, refined, plan.timing);
    }));
    return plan;
  }
  Check check(const Trajectory& trajectory) {
    return prepared([&](const PreparedRobot& robot, const PathProblem& problem, const Budget&) {
      return Check{check_trajectory(robot, problem, *trajectory.rows), trajectory.joint_names};
    });
  }
  Check check(const Motion& motion) {
    const auto rows = motion.rows();
    static_cast<void>(motion.path());
    return prepared([&](const PreparedRobot& robot, const PathProblem& problem, const Budget&) {
      return Check{check_motion(robot, problem, *rows), motion.joint_names};
    });
  }
  Measures measure(const Trajectory& trajectory) {
    return prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return swivel::measure(robot, problem, *trajectory.rows, Evidence::all(), budget);
        });
  }
  Clearances clearance(const ArrayLike& joints, std::optional<double> timeout) {
    const std::vector<Config> states = to_states(joints);
    return {std::make_shared<const StateClearances>(prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return state_clearances(robot, problem, states, budget);
        },
        timeout))};
  }
  RefinedPath refine(const Trajectory& trajectory, std::optional<double> timeout) {
    Refined refined = prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return swivel::refine(robot, problem, *trajectory.rows, {}, budget);
        },
        timeout);
    return {std::make_shared<const Refined>(std::move(refined)), trajectory.joint_names};
  }
  python::Motion time(const Trajectory& trajectory, std::optional<double> speed,
                      std::optional<double> turn_speed, double rate, std::optional<double> chord,
                      std::optional<double> timeout) {
    const PathProblem held = problem();
    const TimingOptions options = timing_of(held, speed, turn_speed, rate, chord);
    TimingResult timing = prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem,
            const Budget& budget) -> TimingResult {
          return time_trajectory(robot, problem, *trajectory.rows, options, budget);
        },
        timeout);
    return {std::make_shared<const TimingResult>(std::move(timing)), trajectory.joint_names,
            held.base_link};
  }
  std::vector<Advice> advise(const Plan& plan, double timeout) {
    const Use use(*this);
    if (!(timeout > 0))
      throw py::value_error("timeout: not a positive number: allowed are values above 0");
    planner_.set_task(task_);
    return interruptible([&](const std::stop_token& stop) {
      PlanOptions options;
      options.timeout_s = timeout;
      options.stop = stop;
      return swivel::advise(planner_, plan.result(), options);
    });
  }

 private:
  Planner planner_;
  Task task_;
  std::atomic<bool> in_use_ = false;
};

}  // namespace

PlanOptions to_plan_options(const py::object& planner, int threads, std::optional<double> timeout,
                            bool prove) {
  PlanOptions options;
  options.check = prove;
  options.planner = to_enum<PlannerKind>(planner);
  constexpr int kMostThreads = 1024;
  if (threads < 0 || threads > kMostThreads)
    throw py::value_error("threads: " + std::to_string(threads) +
                          ": allowed are 0 (all cores) to " + std::to_string(kMostThreads));
  options.threads = threads;
  if (timeout && !(*timeout > 0))
    throw py::value_error("timeout: not a positive number: allowed are values above 0, or None");
  options.timeout_s = timeout;
  return options;
}

ProgressFunction to_progress(const py::object& progress) {
  require_function(progress, "progress");
  if (progress.is_none()) return {};
  using Clock = std::chrono::steady_clock;
  return [tell = progress.ptr(), last = Clock::time_point()](const Progress& now) mutable {
    if (Clock::now() - last < std::chrono::milliseconds(20)) return;
    last = Clock::now();
    const py::gil_scoped_acquire gil;
    py::reinterpret_borrow<py::object>(tell)(to_string(now.stage), now.done, now.of);
  };
}

void bind_planner(py::module_& m) {
  bind_enum<PlannerKind>(
      m, "PlannerKind",
      "The same question, answered four ways; all give the same trajectory, bit for bit.",
      {{"eager", PlannerKind::kEager},
       {"eager_dp", PlannerKind::kEagerDp},
       {"lazy", PlannerKind::kLazy},
       {"parallel", PlannerKind::kParallel}});
  py::class_<SharedPlanner>(m, "Planner",
                            "An arm that plans again and again. It holds scene and task, which may "
                            "change between plans, and re-uses what did\n"
                            "not change; answers never depend on the plans before. For one thread "
                            "at a time: others take a clone().")
      .def(py::init([](const Problem& problem) {
             return std::make_unique<SharedPlanner>(Planner(path_of(problem, "Planner")));
           }),
           py::arg("problem"), "problem: of one path. Raises InvalidArgument and InputError.")
      .def(
          py::init(
              [](const Robot& robot, const std::optional<Task>& task, const SceneObjects& scene) {
                return std::make_unique<SharedPlanner>(Planner(problem_of(robot, task, scene)));
              }),
          py::arg("robot"), py::arg("task") = py::none(), py::arg("scene") = py::tuple(),
          "scene: a Scene, or any sequence of SceneObjects. Raises InvalidArgument and InputError.")
      .def_property_readonly(
          "problem", [](SharedPlanner& self) { return Problem(self.problem()); },
          "A copy of what it holds; change it with the methods below.")
      .def("clone", &SharedPlanner::clone,
           "A planner of the same problem that remembers no plan, for another thread.")
      .def(
          "prepare",
          [](SharedPlanner& self) {
            self.change([](Planner& planner) {
              interruptible([&](const std::stop_token& stop) {
                return &planner.prepare(Budget({}, nullptr, stop));
              });
            });
          },
          "Trees of the robot's meshes, pairs that touch by design: what the first plan would do "
          "otherwise.")
      .def("set_task", &SharedPlanner::set_task, py::arg("task"))
      .def(
          "set_scene",
          [](SharedPlanner& self, const SceneObjects& scene) {
            std::vector<SceneObject> objects;
            for (const py::handle object : scene)
              objects.push_back(object.cast<const SceneObject&>());
            self.change([&](Planner& planner) { planner.set_scene(std::move(objects)); });
          },
          py::arg("scene"))
      .def(
          "add",
          [](SharedPlanner& self, SceneObject object) {
            self.change([&](Planner& planner) { planner.add(std::move(object)); });
          },
          py::arg("object"), "Adds a SceneObject.")
      .def(
          "move",
          [](SharedPlanner& self, const std::string& name, const Pose& pose) {
            self.change([&](Planner& planner) { planner.move(name, pose); });
          },
          py::arg("name"), py::arg("pose"),
          "pose: in the base frame. Raises InvalidArgument for an unknown name.")
      .def(
          "remove",
          [](SharedPlanner& self, const std::string& name) {
            self.change([&](Planner& planner) { planner.remove(name); });
          },
          py::arg("name"))
      .def(
          "attach",
          [](SharedPlanner& self, AttachedBody body) {
            self.change([&](Planner& planner) { planner.attach(std::move(body)); });
          },
          py::arg("body"), "A tool or part that the arm carries from now on.")
      .def(
          "detach",
          [](SharedPlanner& self, const std::string& name) {
            self.change([&](Planner& planner) { planner.detach(name); });
          },
          py::arg("name"))
      .def(
          "plan",
          [](SharedPlanner& self, OrName<PlannerKind> planner, int threads,
             std::optional<double> timeout, bool prove, bool evidence, Typed<"_Check"> check,
             Typed<"_MotionCheck"> check_motions, Typed<"_Check"> cost, ProgressCallback progress,
             bool refine, std::optional<double> speed, std::optional<double> turn_speed,
             std::optional<double> rate, std::optional<double> chord) {
            const PlanKeywords keywords{std::move(planner),
                                        threads,
                                        timeout,
                                        prove,
                                        evidence,
                                        std::move(check),
                                        std::move(check_motions),
                                        std::move(cost),
                                        std::move(progress)};
            return self.plan(keywords, refine, speed, turn_speed, rate, chord);
          },
          py::kw_only(), py::arg("planner") = "parallel", py::arg("threads") = 0,
          py::arg("timeout") = py::none(), py::arg("prove") = true, py::arg("evidence") = false,
          py::arg("check") = py::none(), py::arg("check_motions") = py::none(),
          py::arg("cost") = py::none(), py::arg("progress") = py::none(), py::arg("refine") = false,
          py::arg("speed") = py::none(), py::arg("turn_speed") = py::none(),
          py::arg("rate") = py::none(), py::arg("chord") = py::none(),
          "Plans; no path is a Plan, not an exception. Other threads of Python run meanwhile; "
          "Ctrl-C stops it.\n"
          "\n"
          "planner: PlannerKind or its name. threads: 0 for all cores. timeout: s, for everything. "
          "prove: prove the answer before it is returned, as check() does. "
          "evidence: find all measures, "
          "and\n"
          "all empty layers, which takes more time than many a plan.\n"
          "check(joints) -> bool (n,): own rule, asked about batches of states (n, 7), rad, that "
          "all other rules allow.\n"
          "check_motions(from, to) -> bool (n,): the same of straight motions, (n, 7) each. "
          "cost(joints) -> float64 (n,): own cost "
          "of\n"
          "states, added to that of steps. All may be called on another thread than this, never "
          "two at a time, and must depend on "
          "the\n"
          "states alone. progress(stage, done, of): now and then.\n"
          "refine: move the arm angles off the grid: cheaper and smoother, never dearer. speed "
          "(m/s), turn_speed (rad/s), rate\n"
          "(samples a second, default 250), chord (m: slower where the tool would leave its path "
          "by more between samples): make it "
          "a\n"
          "motion in time. Both keep the whole clearance between layers.\n"
          "Raises InputError, InvalidArgument, and what a function raised.")
      .def("check", py::overload_cast<const Trajectory&>(&SharedPlanner::check),
           py::arg("trajectory"),
           "Proves a trajectory, or a motion in time, from the problem alone, or says what is "
           "wrong with it: a Check.")
      .def("check", py::overload_cast<const Motion&>(&SharedPlanner::check), py::arg("trajectory"))
      .def("measure", &SharedPlanner::measure, py::arg("trajectory"),
           "What plan(evidence=True) says of its own trajectory, of any with a row at each layer: "
           "Measures.")
      .def("clearance", &SharedPlanner::clearance, py::arg("joints"), py::kw_only(),
           py::arg("timeout") = py::none(),
           "How near bodies come at states (n, 7), rad, one by one: Clearances. Raises "
           "TimeoutError.")
      .def("refine", &SharedPlanner::refine, py::arg("trajectory"), py::kw_only(),
           py::arg("timeout") = py::none(),
           "Moves the arm angles of a trajectory that plan() found off the grid: Refined. Raises "
           "TimeoutError.")
      .def("time", &SharedPlanner::time, py::arg("trajectory"), py::kw_only(),
           py::arg("speed") = py::none(), py::arg("turn_speed") = py::none(),
           py::arg("rate") = TimingOptions().rate, py::arg("chord") = py::none(),
           py::arg("timeout") = py::none(),
           "Makes a trajectory a motion in time: Motion. speed: m/s, of the tool; default "
           "limits.tool_speed. turn_speed: rad/s. "
           "rate:\n"
           "samples a second. chord: m; slower where the tool would leave its path by more between "
           "samples. Raises TimeoutError.")
      .def("_rows_of_path", &SharedPlanner::rows_of_path)
      .def("advise", &SharedPlanner::advise, py::arg("plan"), py::kw_only(),
           py::arg("timeout") = 1.0,
           "What would help a problem that has no path, found by planning it for so many seconds: "
           "a list of Advice, what helps "
           "first.")
      .def("__repr__", [](SharedPlanner& self) {
        if (self.in_use()) return std::string("<Planner, at work>");
        const PathProblem problem = self.problem();
        return "<Planner of " + py::repr(py::cast(Problem(problem))).cast<std::string>() + ">";
      });
}

}  // namespace swivel::python
