// SPDX-License-Identifier: BSD-3-Clause
// Functions that plan, prove and time problems of any kind, find advice, and read rows from files.
#include <variant>

#include "answers/answer.hpp"
#include "answers/given.hpp"
#include "base/interruptible.hpp"
#include "plan_keywords.hpp"
#include "problems/problem.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/results/given_answer.hpp"
#include "swivel/planner/problem/given_answer.hpp"
#include "swivel/planner/problem/prepared_problem.hpp"
#include "swivel/planner/problem/time_answer.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel::python {

namespace {

/// Returns the names of the joints of each arm.
std::vector<io::JointNames> joint_names_of(const swivel::Problem& problem) {
  std::vector<io::JointNames> names;
  for (const ArmTask& arm : problem.arms)
    names.push_back(build_arm(*arm.model, arm.base_link, arm.tip_link, arm.hold, arm.tool, arm.roll)
                        .chain.joint_names);
  return names;
}

/// Rows that a caller gives, and the file that has them, if one does.
struct Given {
  GivenAnswer answer;
  std::optional<std::filesystem::path> file;
};

/// Returns rows as they are stated. Throws as given_answer() and io::load_answer() do.
Given stated(const swivel::Problem& problem, const GivenRows& rows) {
  const auto* const file = std::get_if<std::filesystem::path>(&rows);
  if (file == nullptr) return {given_answer(problem, rows), {}};
  return {interruptible([&](const std::stop_token&) {
            return io::load_answer(*file, problem, joint_names_of(problem));
          }),
          *file};
}

/// Calls work(answer), and puts the name of the file before what it says of bad input.
template <class Work>
auto in_the_name_of(const std::optional<std::filesystem::path>& file, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    if (!file) throw;
    throw InputError(file->string(), error.what());
  }
}

/// Returns what is known of a problem whose rows are checked, or with `timed` timed.
PreparedProblem prepared_for(const swivel::Problem& problem, bool timed, const Budget& budget) {
  return PreparedProblem(
      timed && problem.arms.size() == 2 ? with_motion_defaults(problem) : problem, budget);
}

Answer plan(const Problem& of, const PlanKeywords& keywords, bool refine,
            const MotionKeywords& motion) {
  const swivel::Problem problem = to_core(of);
  const MotionRequest asked{refine, motion.asked_timing(problem)};
  PlanOptions options = keywords.options(problem.arms.front());
  Answer answer = made_answer(interruptible([&](const std::stop_token& stop) {
                                options.stop = stop;
                                ProblemPlanner planner(problem, asked, Budget({}, nullptr, stop));
                                return planner.plan(options);
                              }),
                              problem, asked);
  answer.own_functions = keywords.has_own_functions();
  return answer;
}

Check check(const Problem& of, const GivenRows& rows, std::optional<double> speed) {
  const swivel::Problem problem = to_core(of);
  if (speed && !(std::isfinite(*speed) && *speed > 0))
    throw py::value_error("speed: not a positive number: allowed are values above 0, or None");
  Given given = stated(problem, rows);
  return interruptible([&](const std::stop_token& stop) {
    CheckOptions options{.budget = Budget({}, nullptr, stop), .speed = speed};
    const PreparedProblem prepared =
        prepared_for(problem, given.answer.has_times(), options.budget);
    if (given.file)
      given.answer = in_the_name_of(given.file, [&] {
        return complete_answer(prepared, std::move(given.answer), options.budget);
      });
    return Check{check_answer(prepared, given.answer, options), has_strokes(problem)};
  });
}

Motion time(const Problem& of, const GivenRows& rows, const MotionKeywords& keywords, bool refine,
            std::optional<double> timeout) {
  static_cast<void>(to_timeout(timeout));
  const swivel::Problem problem = to_core(of);
  const MotionRequest asked{refine, keywords.timing(problem)};
  Given given = stated(problem, rows);
  const swivel::Problem executed = given.answer.problem;
  TimedAnswer timed = interruptible([&](const std::stop_token& stop) {
    const Budget budget(timeout, nullptr, stop);
    const PreparedProblem prepared = prepared_for(problem, true, budget);
    return in_the_name_of(given.file, [&] {
      return time_answer(prepared, std::move(given.answer), asked, true, budget);
    });
  });
  Answer answer = made_answer(std::move(timed.answer), executed, asked);
  return {.of = std::move(answer), .fault = std::move(timed.fault)};
}

AdviceList advise(const Problem& of, const Answer& answer, double timeout) {
  static_cast<void>(to_timeout(timeout));
  const swivel::Problem problem = to_core(of);
  const bool strokes = !answer.has_paths();
  if (answer.found->arms.size() != problem.arms.size() || strokes != has_strokes(problem))
    throw InvalidArgument("plan: is of another problem: allowed is an answer to this one");
  return interruptible([&](const std::stop_token& stop) {
    PlanOptions options;
    options.timeout_s = timeout;
    options.stop = stop;
    const ProblemPlanner planner(problem, {}, Budget({}, nullptr, stop));
    return planner.advise(*answer.found, options);
  });
}

// --- rows from files

/// Gives a motion of one path or of two arms its rate and duration, from the times of its rows.
void measure(ArmMotion& motion) {
  const std::vector<TimedRow>& rows = motion.rows;
  motion.duration = rows.back().t;
  motion.rate = static_cast<double>(rows.size() - 1) / (motion.duration - rows.front().t);
}

/// Returns rows that a file states, as Python holds them.
using Loaded = std::variant<Trajectory, Motion, std::vector<Part>, RowsByName>;
Loaded loaded(GivenAnswer given, const std::vector<io::JointNames>& names) {
  swivel::Answer found;
  found.status = PlanStatus::kSolved;
  found.arms.resize(given.arms.size());
  swivel::Motion motion;
  for (std::size_t k = 0; k < given.arms.size(); ++k) {
    GivenArm& arm = given.arms[k];
    found.arms[k].name = given.problem.arms[k].name;
    found.arms[k].joint_names = names[k];
    found.arms[k].parts = std::move(arm.parts);
    for (const StrokeRun& run : arm.order) found.arms[k].runs.emplace_back().run = run;
    if (!arm.motion) continue;
    if (!has_strokes(given.problem)) measure(*arm.motion);
    motion.arms.push_back(*std::move(arm.motion));
    motion.rate = motion.arms.front().rate, motion.duration = motion.arms.front().duration;
  }
  const bool timed = !motion.arms.empty();
  if (timed) found.motion.emplace().motion = std::move(motion);
  const Answer answer = made_answer(std::move(found), std::move(given.problem), {});
  if (timed) return Motion{answer};
  const auto& arms = answer.found->arms;
  if (!answer.has_paths()) {
    std::vector<Part> parts = parts_of({answer, 0}, arms[0].parts);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      parts[k].cost.reset();
      parts[k].process = given.arms[0].process[k];
    }
    return parts;
  }
  const auto rows_of = [&](std::size_t k) { return Arm{answer, k}.trajectory_of(arms[k].rows()); };
  if (arms.size() == 1) return rows_of(0);
  py::dict by_name;
  for (std::size_t k = 0; k < 2; ++k) by_name[arms[k].name.c_str()] = py::cast(rows_of(k));
  return RowsByName(by_name);
}

/// Returns the rows of a file; what it does not state is worked out from the problem.
/// `joint_names`: those of the file, where they are not the problem's; of one arm.
Loaded load_trajectory(const std::filesystem::path& file, const Problem& of,
                       const std::vector<std::string>& joint_names) {
  const swivel::Problem problem = to_core(of);
  if (!joint_names.empty() && problem.arms.size() == 2)
    throw InvalidArgument("joint_names: of two arms: allowed with one");
  const std::vector<io::JointNames> names =
      joint_names.empty()
          ? joint_names_of(problem)
          : std::vector{to_joint_names(joint_names, named_joints(joint_names_of(problem).front()))};
  return loaded(interruptible([&](const std::stop_token& stop) {
                  GivenAnswer given = io::load_answer(file, problem, names);
                  const bool whole =
                      !has_strokes(problem) &&
                      std::all_of(given.arms.begin(), given.arms.end(), [](const GivenArm& arm) {
                        return arm.motion ? arm.stated.motions() : arm.stated.rows();
                      });
                  if (whole) return given;
                  const Budget budget({}, nullptr, stop);
                  const PreparedProblem prepared = prepared_for(problem, given.has_times(), budget);
                  return in_the_name_of(
                      file, [&] { return complete_answer(prepared, std::move(given), budget); });
                }),
                names);
}

/// Returns the rows of a file that states all of them, of a problem of one path that is not known.
Loaded load_stated(const std::filesystem::path& file, const std::vector<std::string>& joint_names) {
  const io::JointNames names =
      to_joint_names(joint_names, joint_names.size() + 1 == kDof ? kDof - 1 : kDof);
  GivenAnswer given{one_path(PathProblem()), {}};
  given = io::load_answer(file, given.problem, {names});
  const Stated& stated = given.arms.front().stated;
  const bool timed = given.has_times();
  if (!(timed ? stated.motions() : stated.rows()))
    throw InputError(file.string() + ": does not state all of s, phi, branch, " +
                     (timed ? "speeds and accelerations" : "roll") +
                     ": allowed is a problem as well, by which they can be worked out");
  return loaded(std::move(given), {names});
}

}  // namespace

void bind_functions(py::module_& m) {
  m.def("_plan", with_plan_keywords<const Problem&>(&plan));
  m.def("_check", &check, py::arg("problem"), py::arg("rows").none(false), py::arg("speed"));
  m.def(
      "_time",
      [](const Problem& problem, const GivenRows& rows, std::optional<double> speed,
         std::optional<double> turn_speed, double rate, std::optional<double> chord, bool refine,
         std::optional<double> timeout) {
        return time(problem, rows, {speed, turn_speed, rate, chord}, refine, timeout);
      },
      py::arg("problem"), py::arg("rows").none(false), py::arg("speed"), py::arg("turn_speed"),
      py::arg("rate"), py::arg("chord"), py::arg("refine"), py::arg("timeout"));
  m.def("_advise", &advise);
  m.def("_load_trajectory", &load_trajectory);
  m.def("_load_stated", &load_stated);
}

}  // namespace swivel::python
