// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/job/time_job.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "job/job_refiner.hpp"
#include "job/process_range.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/motion/joint_moves.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// Returns the speed that holds along all strokes, m/s; unset where each has its own.
std::optional<double> common_speed(const TimingOptions& options) {
  return options.speed > 0 ? std::optional(options.speed) : std::nullopt;
}

/// Returns speeds_of_run(). Throws InputError if the stroke has no speed at all.
RunSpeeds required_speeds(const Problem& job, const StrokeRun& run, const PathProblem& problem,
                          const TimingOptions& options) {
  if (auto speeds = speeds_of_run(job, run, problem, common_speed(options)))
    return *std::move(speeds);
  throw InputError(job.source, "stroke '" + job.arm().strokes[run.stroke].name +
                                   "' has no speed: allowed are process_speed, a column feed of "
                                   "its path, limits.tool_speed, or one speed for all (--speed)");
}

/// Times the run that is the k-th part.
using TimeRun =
    std::function<MotionResult(std::size_t k, const PathProblem&, const TimingOptions&)>;

/// Joins timed parts to one motion.
class JobTimer {
 public:
  JobTimer(const Chain& chain, const Problem& job, const std::vector<Part>& parts,
           const TimingOptions& options, TimeRun time_run, const Budget& budget)
      : chain_(chain),
        job_(job),
        parts_(parts),
        options_(options),
        time_run_(std::move(time_run)),
        budget_(budget),
        rates_(joint_rates(chain_, job.arm().transition_limits, job.source)) {}

  MotionTiming run() {
    MotionTiming result;
    motion_.rate = options_.rate;
    motion_.roll = chain_.roll;
    for (const JointRates::Assumed& assumed : rates_.assumed)
      motion_.warnings.push_back(assumed.text);
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      budget_.poll();
      const std::optional<NoMotion> failure = parts_[k].run ? add_run(k) : add_transition(k);
      if (!failure) continue;
      result.failure = failure;
      result.failed_part = k;
      return result;
    }
    motion_.duration = motion_.rows.back().t;
    Motion& motion = result.motion.emplace();
    motion.rate = motion_.rate;
    motion.duration = motion_.duration;
    motion.arms.push_back(std::move(motion_));
    return result;
  }

 private:
  /// Adds the rows of a part after those before it. Its first row is at the same time as the last
  /// one before it, and takes its place if it is that of a run, which says more.
  void append(std::size_t k, const std::vector<TimedRow>& rows) {
    const bool first = motion_.rows.empty();
    const auto before =
        first ? 0 : static_cast<std::int64_t>(std::llround(motion_.rows.back().t * motion_.rate));
    if (!first && parts_[k].run) {
      const double t = motion_.rows.back().t;
      motion_.rows.back() = rows.front();
      motion_.rows.back().t = t;
    }
    for (std::size_t i = first ? 0 : 1; i < rows.size(); ++i) {
      TimedRow row = rows[i];
      row.t = static_cast<double>(before + static_cast<std::int64_t>(i)) / motion_.rate;
      motion_.rows.push_back(row);
      motion_.part.push_back(k);
    }
  }

  std::optional<NoMotion> add_transition(std::size_t k) {
    std::vector<Config> corners;
    for (const TrajectoryRow& row : parts_[k].rows) corners.push_back(row.q);
    std::vector<TimedRow> rows = time_joint_moves(corners, rates_, job_.arm().rapid, options_.rate);
    // Where nothing moves the arm rests for a sample, so that each part has a row of its own.
    if (rows.size() == 1) rows.push_back(rows.front());
    append(k, rows);
    return std::nullopt;
  }

  std::optional<NoMotion> add_run(std::size_t k) {
    const StrokeRun& run = *parts_[k].run;
    const PathProblem problem = problem_of_run(job_, run);
    MotionResult timed = time_run_(k, problem, timing_of(run, problem));
    if (!timed.motion) return timed.failure;
    const std::size_t first = motion_.rows.empty() ? 0 : motion_.rows.size() - 1;
    append(k, timed.motion->rows);
    add_events(run, problem, first);
    for (const std::string& warning : timed.motion->warnings) {
      const auto said_of_job = [&](const std::string& line) { return warning.starts_with(line); };
      if (std::none_of(motion_.warnings.begin(), motion_.warnings.end(), said_of_job))
        motion_.warnings.push_back("stroke '" + job_.arm().strokes[run.stroke].name +
                                   "': " + warning);
    }
    timed.motion->rows.clear();
    timed.motion->speed = fastest_of(run, problem);
    motion_.runs.push_back(std::move(*timed.motion));
    return std::nullopt;
  }

  [[nodiscard]] TimingOptions timing_of(const StrokeRun& run, const PathProblem& problem) const {
    RunSpeeds speeds = required_speeds(job_, run, problem, options_);
    TimingOptions timing;
    timing.rate = options_.rate;
    timing.turn_speed = options_.turn_speed;
    timing.chord = options_.chord;
    timing.speed = speeds.first;
    timing.speeds = std::move(speeds.from);
    return timing;
  }
  /// Returns the largest speed asked for along the stroke of a run, m/s, its approach and retract
  /// aside.
  [[nodiscard]] double fastest_of(const StrokeRun& run, const PathProblem& problem) const {
    // Each waypoint but the last begins a stretch; where the tool retracts, one more follows.
    const std::vector<SpeedFrom> speeds = required_speeds(job_, run, problem, options_).from;
    const std::size_t stretches = job_.arm().strokes[run.stroke].waypoints.size() - 1;
    double fastest = 0;
    for (std::size_t k = 0; k < stretches; ++k) fastest = std::max(fastest, speeds[k].speed);
    return std::min(fastest, problem.limits.tool_speed.value_or(fastest));
  }
  /// Adds the events of a run whose rows begin at motion_.rows[first].
  void add_events(const StrokeRun& run, const PathProblem& problem, std::size_t first) {
    for (const ProcessEvent& event :
         events_of_run(job_, run, problem, std::span(motion_.rows).subspan(first)))
      motion_.events.push_back(event);
  }

  const Chain& chain_;
  const Problem& job_;
  const std::vector<Part>& parts_;
  const TimingOptions& options_;
  const TimeRun time_run_;
  const Budget& budget_;
  JointRates rates_;
  ArmMotion motion_;
};

}  // namespace

void require_speeds(const Problem& job, const TimingOptions& options) {
  if (!(options.speed >= 0 && std::isfinite(options.speed)))
    throw InvalidArgument("speed: allowed are numbers > 0, m/s, and 0 for those of the strokes");
  if (!options.speeds.empty())
    throw InvalidArgument("speeds: are of one path: allowed for strokes are none");
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k)
    static_cast<void>(required_speeds(job, {k, false}, problem_of_run(job, {k, false}), options));
  if (options.speed == 0) return;
  require_tool_speed(build_arm(*job.arm().model, job.arm().base_link, job.arm().tip_link,
                               job.arm().hold, job.arm().tool, job.arm().roll)
                         .chain,
                     options.speed, "speed");
}

namespace {

/// Throws as time_job() says.
void require_timeable(const PreparedRobot& robot, const Problem& job,
                      const TimingOptions& options) {
  validate(job);
  robot.require_prepared_for(problem_of_run(job, {0, false}));
  require_speeds(job, options);
  if (!(options.rate > 0 && std::isfinite(options.rate)))
    throw InvalidArgument("rate: allowed are numbers above 0, samples a second");
}

}  // namespace

MotionTiming time_job(const PreparedRobot& robot, const Problem& job,
                      const std::vector<Part>& parts, const TimingOptions& options,
                      const Budget& budget) {
  const TraceSpan span("time job");
  require_timeable(robot, job, options);
  const auto time_run = [&](std::size_t k, const PathProblem& problem,
                            const TimingOptions& timing) {
    return time_trajectory(robot, problem, parts[k].rows, timing, budget);
  };
  return JobTimer(robot.arm().chain, with_motion_defaults(job), parts, options, time_run, budget)
      .run();
}

RefinedJobMotion refine_and_time_job(const PreparedRobot& robot, const Problem& job,
                                     std::vector<Part> parts, const TimingOptions& options,
                                     const RefineOptions& refining, const Budget& budget) {
  const TraceSpan span("refine and time job");
  require_timeable(robot, job, options);
  const Problem completed = with_motion_defaults(job);
  RefinedJobMotion found;
  found.parts = std::move(parts);
  JobRefiner refiner(robot, completed, found.parts, refining, budget);
  const auto time_run = [&](std::size_t k, const PathProblem&, const TimingOptions& timing) {
    return *refiner.refine(k, timing);
  };
  found.timing =
      JobTimer(robot.arm().chain, completed, found.parts, options, time_run, budget).run();
  if (found.timing.failure) refiner.refine_others();
  found.refinement = refiner.runs();
  found.refine_ms = refiner.refine_ms();
  return found;
}

}  // namespace swivel
