// SPDX-License-Identifier: BSD-3-Clause
// Bindings of the planner, with the caller's own checks and costs.
#include "swivel/planner/plan/planner.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <variant>

#include "answers/answer.hpp"
#include "answers/given.hpp"
#include "base/interruptible.hpp"
#include "plan_keywords.hpp"
#include "problems/problem.hpp"
#include "states.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/measure/measure.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::python {

namespace {

PathProblem problem_of(const Robot& robot, const std::optional<Task>& task,
                       const SceneObjects& scene) {
  PathProblem problem;
  static_cast<Robot&>(problem) = robot;
  if (task) static_cast<Task&>(problem) = task_to_core(*task, robot);
  pass_half_turns(problem, problem.waypoints);
  for (const py::handle object : scene) problem.scene.push_back(object.cast<const SceneObject&>());
  return problem;
}

/// Plans a problem with strokes or two arms again and again.
class KeptProblem {
 public:
  explicit KeptProblem(swivel::Problem problem) : problem_(std::move(problem)) {
    validate(problem_);
  }
  [[nodiscard]] const swivel::Problem& problem() const { return problem_; }
  void set_problem(swivel::Problem problem) {
    validate(problem);
    problem_ = std::move(problem);
  }
  template <class Change>
  void change_scene(const Change& change) {
    swivel::Problem changed = problem_;
    change(changed.scene);
    set_problem(std::move(changed));
  }
  void prepare() {
    interruptible([&](const std::stop_token& stop) {
      take({}, Budget({}, nullptr, stop));
      return &*planner_;
    });
  }
  Answer plan(const PlanKeywords& keywords, bool refined, const MotionKeywords& motion) {
    PlanOptions options = keywords.options(problem_.arms.front());
    const MotionRequest asked{refined, motion.asked_timing(problem_)};
    Answer answer = made_answer(interruptible([&](const std::stop_token& stop) {
                                  options.stop = stop;
                                  take(asked, Budget({}, nullptr, stop));
                                  return planner_->plan(options);
                                }),
                                problem_, asked);
    answer.own_functions = keywords.has_own_functions();
    return answer;
  }
  AdviceList advise(const Answer& answer, double timeout) {
    static_cast<void>(to_timeout(timeout));
    if (answer.found->arms.size() != problem_.arms.size() ||
        answer.has_paths() != (problem_.arms.size() == 2))
      throw InvalidArgument("plan: is of another problem: allowed is an answer to this one");
    return interruptible([&](const std::stop_token& stop) {
      PlanOptions options;
      options.timeout_s = timeout;
      options.stop = stop;
      take({}, Budget({}, nullptr, stop));
      return planner_->advise(*answer.found, options);
    });
  }

 private:
  /// Makes planner_ one of the problem as it is now.
  void take(const MotionRequest& asked, const Budget& budget) {
    if (planner_)
      planner_->set_problem(problem_, asked, budget);
    else
      planner_.emplace(problem_, asked, budget);
  }
  swivel::Problem problem_;
  std::optional<ProblemPlanner> planner_;
};

/// Returns the place of an object in a scene. Throws InvalidArgument for an unknown name.
std::vector<SceneObject>::iterator object_in(std::vector<SceneObject>& scene,
                                             const std::string& name) {
  const auto found = std::find_if(scene.begin(), scene.end(),
                                  [&](const SceneObject& object) { return object.name == name; });
  if (found == scene.end())
    throw InvalidArgument("'" + name + "': no such object: allowed are names of the scene");
  return found;
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
    static_cast<void>(to_timeout(timeout));
    of_path().set_task(task_to_core(task_, of_path().problem()));
    return interruptible([&](const std::stop_token& stop) {
      const Budget budget(timeout, nullptr, stop);
      return work(of_path().prepare(budget), of_path().problem(), budget);
    });
  }

 public:
  explicit SharedPlanner(Planner planner)
      : path_(std::move(planner)), task_(task_from_core(path_->problem(), path_->problem())) {}
  /// Plans a problem of any kind.
  explicit SharedPlanner(const Problem& problem) { take(problem); }

  /// Returns a copy of the problem, of any kind.
  [[nodiscard]] Problem whole_problem() {
    if (path_) return Problem(problem());
    const Use use(*this);
    return from_core(kept_->problem());
  }
  [[nodiscard]] PathProblem problem() {
    const Use use(*this);
    PathProblem problem = of_path().problem();
    static_cast<Task&>(problem) = task_;
    return problem;
  }
  [[nodiscard]] bool in_use() const { return in_use_; }
  [[nodiscard]] std::unique_ptr<SharedPlanner> clone() {
    if (!path_) return std::make_unique<SharedPlanner>(whole_problem());
    const Use use(*this);
    of_path().set_task(task_to_core(task_, of_path().problem()));
    return std::make_unique<SharedPlanner>(of_path().clone());
  }
  void set_task(Task task) {
    const Use use(*this);
    pass_half_turns(of_path().problem(), task.waypoints);
    of_path().set_task(task_to_core(task, of_path().problem()));
    task_ = task_from_core(of_path().problem(), of_path().problem());
  }
  /// Prepares a problem with strokes or two arms. Returns false for one path.
  bool prepare_kept() {
    const Use use(*this);
    if (kept_) kept_->prepare();
    return kept_.has_value();
  }
  /// Applies a change of robot or scene.
  template <class Change>
  void change(const Change& change) {
    const Use use(*this);
    change(of_path());
  }
  void set_problem(const Problem& problem) {
    const Use use(*this);
    take(problem);
  }
  /// Applies a change to the scene: as `of_path` does it of one path, else as `of_scene` does it.
  template <class OfPath, class OfScene>
  void change_scene(const OfPath& of_path, const OfScene& of_scene) {
    const Use use(*this);
    path_ ? of_path(*path_) : kept_->change_scene(of_scene);
  }
  /// Returns the number of rows that a trajectory of the whole path has.
  int rows_of_path() {
    return prepared(
        [](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return problem_path(problem, robot.arm().chain, budget).size();
        });
  }
  Answer plan(const PlanKeywords& keywords, bool refined, const MotionKeywords& motion) {
    const Use use(*this);
    if (kept_) return kept_->plan(keywords, refined, motion);
    PlanOptions options = keywords.options(of_path().problem());
    of_path().set_task(task_to_core(task_, of_path().problem()));
    const swivel::Problem given = one_path(of_path().problem());
    const MotionRequest asked{refined, motion.asked_timing(given)};
    if (asked.timing) {
      of_path().set_task(with_motion_defaults(of_path().problem()));
    } else if (refined) {
      Task task = task_to_core(task_, of_path().problem());
      keep_clearance_between_layers(task.limits);
      of_path().set_task(task);
    }
    Answer answer = made_answer(
        interruptible([&](const std::stop_token& stop) {
          options.stop = stop;
          return answer_of(plan_motion(of_path(), options, refined, asked.timing), asked.timing);
        }),
        given, asked);
    answer.own_functions = keywords.has_own_functions();
    return answer;
  }
  Check check(const std::variant<Answer, python::Motion, Trajectory>& rows) {
    const GivenAnswer given = std::visit(
        [&](const auto& one) { return given_answer(to_core(whole_problem()), one); }, rows);
    const GivenArm& arm = given.arms.front();
    return prepared([&](const PreparedRobot& robot, const PathProblem& problem, const Budget&) {
      Check check;
      const CheckResult& run = check.result.runs.emplace_back(
          arm.motion ? check_motion(robot, problem, arm.motion->rows)
                     : check_trajectory(robot, problem, arm.parts.front().rows));
      check.result.passed = run.passed;
      check.result.cost = run.cost;
      return check;
    });
  }
  Measures measure(const Trajectory& trajectory) {
    return prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return swivel::measure(robot, problem, *trajectory.rows, Evidence::all(), budget);
        });
  }
  Clearances clearance(const ArrayLike& joints, std::optional<double> timeout) {
    const std::vector<Config> states =
        to_states(joints, arm_of(of_path().problem()).chain.coordinates());
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
  python::Motion time(const Trajectory& trajectory, const MotionKeywords& keywords,
                      std::optional<double> timeout) {
    const swivel::Problem given = to_core(whole_problem());
    const MotionRequest asked{.timing = keywords.timing(given)};
    MotionPlan timed;
    timed.result.joint_names = trajectory.joint_names;
    timed.motion = prepared(
        [&](const PreparedRobot& robot, const PathProblem& problem, const Budget& budget) {
          return time_trajectory(robot, problem, *trajectory.rows, *asked.timing, budget);
        },
        timeout);
    return {made_answer(answer_of(std::move(timed), asked.timing), given, asked)};
  }
  AdviceList advise(const Answer& answer, double timeout) {
    const Use use(*this);
    if (kept_) return kept_->advise(answer, timeout);
    require_path(answer, "advise");
    static_cast<void>(to_timeout(timeout));
    of_path().set_task(task_to_core(task_, of_path().problem()));
    return interruptible([&](const std::stop_token& stop) {
      PlanOptions options;
      options.timeout_s = timeout;
      options.stop = stop;
      return AdviceList{swivel::advise(of_path(), answer.found->arm().run(), options), {}};
    });
  }

 private:
  /// Returns the planner of one path. Throws InvalidArgument for a problem of another kind.
  Planner& of_path() {
    if (!path_)
      throw InvalidArgument(
          "this planner is of a problem with strokes or two arms: allowed are plan, advise, clone, "
          "prepare, set_problem, set_scene, add, move and remove, and the functions of swivel");
    return *path_;
  }
  /// Takes a problem of any kind; of one path keeps what serves it.
  void take(const Problem& problem) {
    swivel::Problem core = to_core(problem);
    if (!is_path(core)) {
      if (kept_) return kept_->set_problem(std::move(core));
      kept_.emplace(std::move(core));
      path_.reset();
      return;
    }
    PathProblem path = problem_of_run(core, {0, false});
    pass_half_turns(path, path.waypoints);
    if (path_ && path_->prepare().difference_from(path) == nullptr)
      path_->set_problem(std::move(path));
    else
      path_.emplace(std::move(path));
    task_ = task_from_core(path_->problem(), path_->problem());
    kept_.reset();
  }

  std::optional<Planner> path_;      // of one path
  std::optional<KeptProblem> kept_;  // of strokes and two arms, instead
  Task task_;
  std::atomic<bool> in_use_ = false;
};

}  // namespace

void bind_planner(py::module_& m) {
  bind_enum<PlannerKind>(
      m, "PlannerKind",
      "The same question, answered four ways; all give the same trajectory, bit for bit.",
      {{"eager", PlannerKind::kEager},
       {"eager_dp", PlannerKind::kEagerDp},
       {"lazy", PlannerKind::kLazy},
       {"parallel", PlannerKind::kParallel}});
  py::class_<SharedPlanner>(m, "Planner",
                            "Plans a problem of any kind again and again. It holds scene and task, "
                            "which may change between plans, and re-uses what did\n"
                            "not change: of strokes and two arms the robot; answers never depend "
                            "on the plans before. For one thread "
                            "at a time: others take a clone().")
      .def(
          py::init([](const Problem& problem) { return std::make_unique<SharedPlanner>(problem); }),
          py::arg("problem"), "Raises InvalidArgument and InputError.")
      .def(
          py::init(
              [](const Robot& robot, const std::optional<Task>& task, const SceneObjects& scene) {
                return std::make_unique<SharedPlanner>(Planner(problem_of(robot, task, scene)));
              }),
          py::arg("robot"), py::arg("task") = py::none(), py::arg("scene") = py::tuple(),
          "scene: a Scene, or any sequence of SceneObjects. Raises InvalidArgument and InputError.")
      .def_property_readonly(
          "problem", [](SharedPlanner& self) { return self.whole_problem(); },
          "A copy of what it holds; change it with the methods below.")
      .def("set_problem", &SharedPlanner::set_problem, py::arg("problem"),
           "Replaces the problem by another of any kind: with another home, order, start or part, "
           "say. Keeps what is known of a robot that stays.")
      .def("clone", &SharedPlanner::clone,
           "A planner of the same problem that remembers no plan, for another thread.")
      .def(
          "prepare",
          [](SharedPlanner& self) {
            if (self.prepare_kept()) return;
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
            self.change_scene([&](Planner& planner) { planner.set_scene(std::move(objects)); },
                              [&](std::vector<SceneObject>& all) { all = std::move(objects); });
          },
          py::arg("scene"))
      .def(
          "add",
          [](SharedPlanner& self, SceneObject object) {
            self.change_scene(
                [&](Planner& planner) { planner.add(std::move(object)); },
                [&](std::vector<SceneObject>& all) { all.push_back(std::move(object)); });
          },
          py::arg("object"), "Adds a SceneObject.")
      .def(
          "move",
          [](SharedPlanner& self, const std::string& name, const Pose& pose) {
            self.change_scene(
                [&](Planner& planner) { planner.move(name, pose); },
                [&](std::vector<SceneObject>& all) { object_in(all, name)->pose = pose; });
          },
          py::arg("name"), py::arg("pose"),
          "pose: in the base frame. Raises InvalidArgument for an unknown name.")
      .def(
          "remove",
          [](SharedPlanner& self, const std::string& name) {
            self.change_scene(
                [&](Planner& planner) { planner.remove(name); },
                [&](std::vector<SceneObject>& all) { all.erase(object_in(all, name)); });
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
          with_plan_keywords<SharedPlanner&>(
              [](SharedPlanner& self, const PlanKeywords& keywords, bool refine,
                 const MotionKeywords& motion) { return self.plan(keywords, refine, motion); }),
          py::kw_only(), py::arg("planner") = "parallel", py::arg("threads") = 0,
          py::arg("timeout") = py::none(), py::arg("prove") = true, py::arg("evidence") = false,
          py::arg("check") = py::none(), py::arg("check_motions") = py::none(),
          py::arg("cost") = py::none(), py::arg("progress") = py::none(), py::arg("refine") = false,
          py::arg("speed") = py::none(), py::arg("turn_speed") = py::none(),
          py::arg("rate") = py::none(), py::arg("chord") = py::none(),
          "Plans; no path is an Answer, not an exception. Other threads of Python run meanwhile; "
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
      .def("check", &SharedPlanner::check, py::arg("rows"),
           "Proves rows, or a motion in time, from the problem alone, or says what is wrong with "
           "them: a Check.")
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
      .def(
          "time",
          [](SharedPlanner& self, const Trajectory& trajectory, std::optional<double> speed,
             std::optional<double> turn_speed, double rate, std::optional<double> chord,
             std::optional<double> timeout) {
            return self.time(trajectory, {speed, turn_speed, rate, chord}, timeout);
          },
          py::arg("trajectory"), py::kw_only(), py::arg("speed") = py::none(),
          py::arg("turn_speed") = py::none(), py::arg("rate") = TimingOptions().rate,
          py::arg("chord") = py::none(), py::arg("timeout") = py::none(),
          "Makes a trajectory a motion in time: Motion. speed: m/s, of the tool; default "
          "limits.tool_speed. turn_speed: rad/s. "
          "rate:\n"
          "samples a second. chord: m; slower where the tool would leave its path by more between "
          "samples. Raises TimeoutError.")
      .def("_rows_of_path", &SharedPlanner::rows_of_path)
      .def("advise", &SharedPlanner::advise, py::arg("plan"), py::kw_only(),
           py::arg("timeout") = 1.0,
           "What would help a problem that has no path, found by planning it for so many seconds: "
           "an AdviceList.")
      .def("__repr__", [](SharedPlanner& self) {
        if (self.in_use()) return std::string("<Planner, at work>");
        return "<Planner of " + py::repr(py::cast(self.whole_problem())).cast<std::string>() + ">";
      });
}

}  // namespace swivel::python
