// SPDX-License-Identifier: BSD-3-Clause
// Functions that plan, prove and time jobs.
#include <cmath>
#include <utility>

#include "interruptible.hpp"
#include "job_results.hpp"
#include "plan_keywords.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/complete_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"

namespace swivel::python {

namespace {

using Parts = std::vector<JobPart>;

PreparedRobot prepared(const swivel::Problem& job, const std::stop_token& stop) {
  return PreparedRobot(problem_of_run(job, {0, false}), Budget({}, nullptr, stop));
}

TimingOptions timing_of(std::optional<double> speed, std::optional<double> turn_speed,
                        double rate) {
  for (const auto& [value, name, unit] :
       {std::tuple(speed, "speed", "m/s"), std::tuple(turn_speed, "turn_speed", "rad/s")})
    if (value && !(*value > 0))
      throw py::value_error(std::string(name) +
                            ": not a positive number: allowed are values above 0, " + unit);
  if (!(rate > 0 && rate <= 1e5))
    throw py::value_error("rate: allowed are numbers > 0, at most 100000");
  TimingOptions options;
  options.speed = speed.value_or(0), options.turn_speed = turn_speed, options.rate = rate;
  return options;
}

/// Returns the index of the stroke with this name. Throws InvalidArgument if there is none.
std::size_t stroke_of(const swivel::Problem& job, const std::string& name) {
  if (const auto found = find_stroke(job, name)) return *found;
  std::vector<std::string> known;
  for (const swivel::Stroke& stroke : job.arm().strokes) known.push_back(stroke.name);
  throw InvalidArgument("'" + name + "' is no stroke of the job, nearest is '" +
                        nearest_name(name, known) + "'");
}

/// A run as rows have it: its name, "ring/2" of the second run of a stroke with lift-offs, the arc
/// length of the stroke at which it begins, and that of the run itself, lines included, m.
struct RunInRows {
  std::string name;
  double begin = 0, length = 0;
};

/// Returns the job whose strokes the runs are: where the job allows lift-offs and a stroke is done
/// in several runs, with its lift-offs. Throws InvalidArgument for runs that are not in their
/// order, that leave some of the stroke out, or that overlap by less than LiftOffs::overlap.
swivel::Problem executed_by(const swivel::Problem& job, const std::vector<RunInRows>& runs) {
  if (!job.arm().lift) return job;
  constexpr double kSamePlace = 1e-9;  // m
  std::vector<LiftOff> places;
  std::optional<std::size_t> stroke;
  std::size_t number = 0;
  double end = 0;
  for (const RunInRows& run : runs) {
    const std::size_t slash = run.name.rfind('/');
    const auto whole = slash == std::string::npos || find_stroke(job, run.name)
                           ? std::nullopt
                           : find_stroke(job, run.name.substr(0, slash));
    number = whole && whole == stroke ? number + 1 : 1;
    stroke = whole;
    if (!whole) continue;  // a stroke in one run; one that is not known is refused later
    if (run.name.substr(slash + 1) != std::to_string(number))
      throw InvalidArgument("'" + run.name + "': allowed is '" + run.name.substr(0, slash + 1) +
                            std::to_string(number) + "': runs of a stroke in their order");
    const double most = std::max(0.0, end - job.arm().lift->overlap);
    if (number > 1 && run.begin > most + kSamePlace)
      throw InvalidArgument("'" + run.name +
                            formatted("': begins at s = %.9g: allowed is at most %.9g, so that "
                                      "nothing of the stroke is left out and runs overlap as "
                                      "LiftOffs.overlap says",
                                      run.begin, most));
    if (number > 1) places.push_back({*whole, end, run.begin});
    const swivel::Stroke& of = job.arm().strokes[*whole];
    end = run.begin + run.length - of.approach.norm() - of.retract.norm();
  }
  return with_lift_offs(job, places);
}

swivel::Problem executed_by(const swivel::Problem& job, const Parts& parts) {
  std::vector<RunInRows> runs;
  for (const JobPart& part : parts)
    if (part.stroke)
      runs.push_back({*part.stroke, part.begin, part.rows->empty() ? 0 : part.rows->back().s});
  return executed_by(job, runs);
}

swivel::Problem executed_by(const swivel::Problem& job, const JobMotion& motion) {
  const swivel::ArmMotion& timed = *motion.motion();
  std::vector<RunInRows> runs;
  for (const StrokeRun& run : motion.order) {
    const swivel::Stroke& stroke = motion.job->arm().strokes[run.stroke];
    runs.push_back({stroke.name, s_of_piece(stroke), 0});
  }
  for (std::size_t k = 0; k < timed.rows.size(); ++k) {
    const std::size_t part = timed.part[k];
    if ((part % 2 == 1) == job.arm().home.has_value() && part / 2 < runs.size())
      runs[part / 2].length = timed.rows[k].row.s;
  }
  return executed_by(job, runs);
}

/// Returns parts for the planner. Throws InvalidArgument for a stroke that the job does not have.
std::vector<swivel::Part> to_core(const swivel::Problem& job, const Parts& parts) {
  std::vector<swivel::Part> all;
  for (const JobPart& part : parts) {
    swivel::Part& made = all.emplace_back();
    if (part.stroke) made.run = StrokeRun{stroke_of(job, *part.stroke), part.reversed};
    made.cost = part.cost.value_or(0);
    made.rows = *part.rows;
    made.barred_by = part.barred_by;
  }
  return all;
}

/// Returns the parts of a file. A stroke is run backwards if the tool begins at its last waypoint.
/// Throws InputError, also for a stroke that the job does not have.
Parts from_file(const PreparedRobot& robot, const swivel::Problem& job, io::JobTrajectory read,
                const Budget& budget) {
  std::vector<swivel::Part> rows;
  for (io::JobTrajectoryPart& one : read.parts) {
    swivel::Part& made = rows.emplace_back();
    made.rows = std::move(one.rows);
    if (one.stroke.empty()) continue;
    const auto stroke = find_stroke(job, one.stroke);
    if (!stroke)
      throw InputError(formatted("data row %zu: stroke: ", one.first_row + 1) + "'" + one.stroke +
                       "' is no stroke of the job: allowed are the names of its strokes");
    made.run = StrokeRun{*stroke, begins_at_last_waypoint(robot, job, *stroke, made.rows)};
  }
  rows = complete_parts(robot, job, std::move(rows), read.stated, budget);
  Parts parts;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const io::JobTrajectoryPart& one = read.parts[k];
    JobPart& part = parts.emplace_back();
    part.joint_names = robot.arm().chain.joint_names;
    part.process.resize(rows[k].rows.size());
    if (rows[k].run) {
      part.stroke = one.stroke;
      part.reversed = rows[k].run->reversed;
      part.begin = s_of_piece(job.arm().strokes[rows[k].run->stroke]);
      for (std::size_t i = one.first_process; i <= one.last_process; ++i) part.process[i] = true;
    }
    part.rows = std::make_shared<const std::vector<TrajectoryRow>>(std::move(rows[k].rows));
  }
  return parts;
}

/// Returns the motion of a file. A stroke is run backwards if the tool begins at its last waypoint.
/// Throws InputError.
JobMotion from_file(const PreparedRobot& robot, const swivel::Problem& job, io::JobMotionFile read,
                    const Budget& budget) {
  JobMotion motion;
  motion.joint_names = robot.arm().chain.joint_names;
  motion.job = without_surroundings(job);
  motion.order = runs_of_motion(robot, job, read.strokes, read.motion);
  auto timing = std::make_shared<MotionTiming>();
  swivel::Motion& all = timing->motion.emplace();
  all.arms.push_back(
      complete_job_motion(robot, job, motion.order, std::move(read.motion), read.stated, budget));
  all.rate = all.arms.front().rate, all.duration = all.arms.front().duration;
  motion.timing = std::move(timing);
  return motion;
}

std::variant<Parts, JobMotion> load_rows(const PreparedRobot& robot, const swivel::Problem& job,
                                         const std::filesystem::path& file, const Budget& budget) {
  auto read = io::load_executed_rows(file, job, robot.arm().chain.joint_names);
  try {
    if (auto* motion = std::get_if<io::JobMotionFile>(&read.rows))
      return from_file(robot, read.job, std::move(*motion), budget);
    return from_file(robot, read.job, std::get<io::JobTrajectory>(std::move(read.rows)), budget);
  } catch (const InputError& error) {
    throw InputError(file.string(), error.what());
  }
}

/// `job`: with the lift-offs of the parts.
AnswerCheck check_parts(const PreparedRobot& robot, const swivel::Problem& job, const Parts& parts,
                        const CheckOptions& options) {
  const std::vector<swivel::Part> all = to_core(job, parts);
  AnswerCheck result = swivel::check_job(robot, job, all, options);
  std::vector<std::vector<bool>> process;
  for (const JobPart& part : parts) process.push_back(part.process);
  check_process(job, all, process, result);
  return result;
}

/// Checks a motion whose strokes are numbered as in the job that it was made for. `job`: with the
/// lift-offs of the motion.
AnswerCheck check_timed(const PreparedRobot& robot, const swivel::Problem& job,
                        const JobMotion& motion, const CheckOptions& options) {
  const auto number = [&](std::size_t k) {
    return stroke_of(job, motion.job->arm().strokes[k].name);
  };
  std::vector<StrokeRun> order = motion.order;
  swivel::ArmMotion timed = *motion.motion();
  for (StrokeRun& run : order) run.stroke = number(run.stroke);
  for (ProcessEvent& event : timed.events) event.stroke = number(event.stroke);
  return check_job_motion(robot, job, order, timed, options);
}

using Checked = std::variant<JobPlan, JobMotion, Parts, std::filesystem::path>;
JobCheck check(const ProblemOrFile& of, const Checked& rows, std::optional<double> speed) {
  const swivel::Problem job = to_core(of);
  if (speed && !(std::isfinite(*speed) && *speed > 0))
    throw py::value_error("speed: not a positive number: allowed are values above 0, or None");
  return interruptible([&](const std::stop_token& stop) -> JobCheck {
    const PreparedRobot robot = prepared(job, stop);
    CheckOptions options;
    options.budget = Budget({}, nullptr, stop);
    options.speed = speed;
    std::variant<Parts, JobMotion> given;
    if (const auto* file = std::get_if<std::filesystem::path>(&rows))
      given = load_rows(robot, job, *file, options.budget);
    else if (const auto* plan = std::get_if<JobPlan>(&rows))
      given = parts_of(*plan, plan->result().arm().parts);
    else if (const auto* motion = std::get_if<JobMotion>(&rows))
      given = *motion;
    else
      given = std::get<Parts>(rows);
    if (const auto* const parts = std::get_if<Parts>(&given))
      return {check_parts(robot, executed_by(job, *parts), *parts, options),
              robot.arm().chain.joint_names};
    const JobMotion& motion = std::get<JobMotion>(given);
    return {check_timed(robot, executed_by(job, motion), motion, options),
            robot.arm().chain.joint_names};
  });
}

JobPlan plan(const ProblemOrFile& of, PlanOptions options,
             const std::optional<TimingOptions>& timing) {
  const swivel::Problem job = to_core(of);
  JobPlan plan;
  plan.plan = std::make_shared<const Answer>(interruptible([&](const std::stop_token& stop) {
    options.stop = stop;
    if (!timing) return swivel::plan_job(job, options);
    return plan_job_motion(prepared(job, stop), job, options, *timing);
  }));
  plan.job = without_surroundings(executed_problem(job, *plan.plan));
  plan.timing = timing;
  plan.given = std::make_shared<const swivel::Problem>(job);
  return plan;
}

using Timeable = std::variant<JobPlan, Parts, std::filesystem::path>;

/// Parts that are proved, and the job of which they are, with its lift-offs.
struct ProvedParts {
  swivel::Problem job;
  std::vector<swivel::Part> parts;
};

/// Returns the parts of a file, or made by hand, with rows at the layers of each run. Throws
/// InputError unless they are proved to be the job's.
ProvedParts proved_parts(const PreparedRobot& robot, const swivel::Problem& of,
                         const Timeable& rows, const Budget& budget) {
  CheckOptions options;
  options.margins = false, options.budget = budget;
  std::string source;
  const auto require = [&](const AnswerCheck& check) {
    if (!check.passed)
      throw InputError(source, check.failures.front() + ": allowed is a job that passes check()");
  };
  std::variant<Parts, JobMotion> read;
  if (const auto* file = std::get_if<std::filesystem::path>(&rows)) {
    source = file->string();
    read = load_rows(robot, of, *file, budget);
  } else {
    read = std::get<Parts>(rows);
  }
  if (const auto* motion = std::get_if<JobMotion>(&read)) {
    ProvedParts proved{executed_by(of, *motion), {}};
    proved.parts = parts_of_motion(robot, proved.job, motion->order, *motion->motion(), budget);
    // The rows are on the paths as motions follow them.
    require(swivel::check_job(robot, with_motion_defaults(proved.job), proved.parts, options));
    return proved;
  }
  const Parts& given = std::get<Parts>(read);
  ProvedParts proved{executed_by(of, given), {}};
  const swivel::Problem& job = proved.job;
  require(check_parts(robot, job, given, options));
  proved.parts = to_core(job, given);
  for (swivel::Part& part : proved.parts)
    if (part.run)
      part.rows = rows_at_layers(robot, problem_of_run(job, *part.run), part.rows, {}, budget);
  return proved;
}

JobMotion time(const ProblemOrFile& of, const Timeable& rows, const TimingOptions& timing,
               std::optional<double> timeout) {
  if (timeout && !(*timeout > 0))
    throw py::value_error("timeout: not a positive number: allowed are values above 0, or None");
  const swivel::Problem given = to_core(of);
  return interruptible([&](const std::stop_token& stop) {
    const Budget budget(timeout, nullptr, stop);
    const PreparedRobot robot = prepared(given, stop);
    ProvedParts proved;
    if (const auto* const plan = std::get_if<JobPlan>(&rows)) {
      proved.job = executed_problem(given, plan->result());
      proved.parts = to_core(proved.job, parts_of(*plan, plan->result().arm().parts));
    } else {
      proved = proved_parts(robot, given, rows, budget);
    }
    const auto& [job, parts] = proved;
    JobMotion motion;
    motion.job = without_surroundings(job);
    motion.joint_names = robot.arm().chain.joint_names;
    for (const swivel::Part& part : parts)
      if (part.run) motion.order.push_back(*part.run);
    auto result =
        std::make_shared<MotionTiming>(swivel::time_job(robot, job, parts, timing, budget));
    motion.timing = result;
    if (!result->motion) return motion;
    // Motions keep more clearance between rows than trajectories do: transitions may lack it.
    CheckOptions options;
    options.margins = false, options.budget = budget;
    if (timing.speed > 0) options.speed = timing.speed;
    const AnswerCheck check = check_timed(robot, job, motion, options);
    if (check.passed) return motion;
    motion.fault = check.failures.front();
    result->motion.reset();
    return motion;
  });
}

void bind_plan_job(py::module_& m) {
  m.def(
      "_plan_strokes",
      [](const ProblemOrFile& job, const OrName<PlannerKind>& planner, int threads,
         std::optional<double> timeout, bool prove, bool evidence, const ProgressCallback& progress,
         std::optional<double> speed, std::optional<double> turn_speed,
         std::optional<double> rate) {
        PlanOptions options = to_plan_options(planner, threads, timeout, prove);
        if (evidence) options.evidence = Evidence::all();
        options.progress = to_progress(progress);
        std::optional<TimingOptions> timing;
        if (speed || turn_speed || rate)
          timing = timing_of(speed, turn_speed, rate.value_or(TimingOptions().rate));
        return plan(job, options, timing);
      },
      py::arg("job").none(false), py::kw_only(), py::arg("planner") = "parallel",
      py::arg("threads") = 0, py::arg("timeout") = py::none(), py::arg("prove") = true,
      py::arg("evidence") = false, py::arg("progress") = py::none(), py::arg("speed") = py::none(),
      py::arg("turn_speed") = py::none(), py::arg("rate") = py::none());
}

}  // namespace

void bind_job_functions(py::module_& m) {
  bind_plan_job(m);
  m.def("_check_strokes", &check, py::arg("job"), py::arg("rows").none(false), py::kw_only(),
        py::arg("speed"));
  m.def(
      "_time_strokes",
      [](const ProblemOrFile& job, const Timeable& rows, std::optional<double> speed,
         std::optional<double> turn_speed, double rate, std::optional<double> timeout) {
        return time(job, rows, timing_of(speed, turn_speed, rate), timeout);
      },
      py::arg("job"), py::arg("rows").none(false), py::kw_only(), py::arg("speed"),
      py::arg("turn_speed"), py::arg("rate"), py::arg("timeout"));
  m.def("_load_parts", [](const std::filesystem::path& file, const ProblemOrFile& of) {
    const swivel::Problem job = to_core(of);
    return interruptible([&](const std::stop_token& stop) {
      return load_rows(prepared(job, stop), job, file, Budget({}, nullptr, stop));
    });
  });
}

}  // namespace swivel::python
