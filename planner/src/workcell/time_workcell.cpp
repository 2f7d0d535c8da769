// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/time_workcell.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "plan/stopwatch.hpp"
#include "refine/motion_faults.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/timing/time_arms.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "verify/between_samples.hpp"
#include "workcell/plan_and_measure.hpp"
#include "workcell/timed_workcell.hpp"

namespace swivel {

namespace {

/// Returns the timing options of an arm, within what its limits allow its tool. Those of a follower
/// stay as they are: limits are of the base frame, the speed asked for is that on the leader's
/// tool.
TimingOptions options_of(const PreparedWorkcell& prepared, std::size_t arm,
                         const TimingOptions& asked, std::vector<std::string>& warnings) {
  if (static_cast<int>(arm) == prepared.follower()) return asked;
  return within_limits(asked, prepared.problem(arm).limits, warnings);
}

/// Returns the rows of a trajectory at the layers of a path, one for each, with the s of these:
/// those of a follower move a little with the corners that its leader rounds. Throws InputError
/// for rows that are at no layer.
std::vector<TrajectoryRow> at_layers(const PathProblem& problem, const ToolPath& path,
                                     std::vector<TrajectoryRow> rows) {
  constexpr double kNear = 1e-3;  // m
  if (rows.size() != static_cast<std::size_t>(path.size()))
    throw InputError(problem.source,
                     formatted("%zu rows: allowed is one at each layer of the path, "
                               "%d",
                               rows.size(), path.size()));
  for (int i = 0; i < path.size(); ++i) {
    TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
    const double s = path.layer(i).s;
    if (!(std::abs(row.s - s) <= kNear) || !row.q.allFinite())
      throw InputError(problem.source,
                       formatted("row %d: s is %.9g: allowed are finite joints and the s of layer "
                                 "%d, %.9g",
                                 i, row.s, i, s));
    row.s = s;
  }
  return rows;
}

/// What times one arm of a workcell.
struct ArmToTime {
  ArmToTime(const PreparedWorkcell& prepared, std::size_t arm,
            const std::vector<TrajectoryRow>& trajectory, const TimingOptions& asked,
            const Budget& budget)
      : problem(prepared.problem(arm)),
        robot(prepared.robot(arm)),
        options(options_of(prepared, arm, asked, lowered)),
        path(problem_path(problem, robot.arm().chain, budget, PathSmoothing{})),
        rows(at_layers(problem, path, trajectory)),
        rates(joint_rates(robot.arm().chain, problem.limits, problem.source)),
        of_samples(problem_of_samples(problem)) {}

  const PathProblem& problem;
  const PreparedRobot& robot;
  std::vector<std::string> lowered;  ///< warnings about speeds that were lowered
  TimingOptions options;
  ToolPath path;
  std::vector<TrajectoryRow> rows;
  JointRates rates;
  PathProblem of_samples;
  // How the motion goes through the rows: through those at least `apart` apart (m of travel) and
  // through the postures `between`, `off_limits` inside joint limits (rad).
  double apart = 0, off_limits = 0;
  std::vector<BetweenRow> between;
  std::optional<Bisection> bisection;
  int tries = 0;
};

/// What is wrong with a motion that was tried.
struct TriedFault {
  Fault fault;
  std::size_t arm = 0;
  bool of_both = false;   // of the arms between each other
  bool no_other = false;  // another motion through the rows would not help
  bool at_sample = false;
};

/// Times two trajectories, and proves the motion's samples. Tries several motions through the rows,
/// the smoothest first, until one is without fault.
class WorkcellTimer {
 public:
  WorkcellTimer(const PreparedWorkcell& prepared,
                const std::array<std::vector<TrajectoryRow>, 2>& rows, const TimingOptions& options,
                const Budget& budget)
      : prepared_(prepared), budget_(budget), world_(prepared.between_samples(budget)) {
    for (std::size_t k = 0; k < 2; ++k) {
      arms_[k] = std::make_unique<ArmToTime>(prepared, k, rows[k], options, budget);
      set(*arms_[k], kApart, kOffLimits);
    }
  }

  MotionTiming run() {
    constexpr int kMost = 80;
    std::optional<TriedFault> tried;
    for (int tries = 0; tries < kMost; ++tries) {
      tried = attempt();
      if (!tried || !change(*tried)) break;
    }
    if (tried) {
      result_.failure = std::move(tried->fault.what);
      result_.failed_arm = tried->arm;
    } else {
      finish();
    }
    return std::move(result_);
  }

 private:
  static constexpr double kApart = 0.005, kOffLimits = 1e-3;  // m, rad
  static constexpr double kReach = 0.02;                      // m, of a blend at a waypoint

  static void set(ArmToTime& arm, double apart, double off_limits) {
    arm.apart = apart;
    arm.off_limits = off_limits;
  }

  /// Times the arms with what is chosen for each. Returns what is wrong with the motion, which is
  /// that of result_ otherwise.
  std::optional<TriedFault> attempt() {
    Stopwatch watch;
    std::array<std::unique_ptr<PathMotion>, 2> motions;
    for (std::size_t k = 0; k < 2; ++k) {
      const ArmToTime& arm = *arms_[k];
      motions[k] = make_path_motion(arm.robot.arm().chain, arm.robot.arm_class(), arm.path,
                                    arm.rows, arm.apart,
                                    arm.problem.limits.joint_margin + arm.off_limits, arm.between);
      all_rows_[k] = motions[k]->knots().size() == arm.rows.size();
    }
    const CommonParameter common =
        common_parameter({&arms_[0]->path, &arms_[1]->path}, prepared_.follower(), reach_);
    blended_ = static_cast<int>(common.blended.size());
    samples_.clear();
    std::optional<TriedFault> fault = time(motions, common);
    result_.time_ms += watch.lap();
    if (!fault) fault = first_fault_of_samples();
    result_.check_ms += watch.lap();
    return fault;
  }

  /// Times the motions. Where a tool would leave its path's tolerances between samples, as it may
  /// at few samples a second, the motion is slower.
  std::optional<TriedFault> time(const std::array<std::unique_ptr<PathMotion>, 2>& motions,
                                 const CommonParameter& common) {
    std::array<TimingOptions, 2> options{arms_[0]->options, arms_[1]->options};
    std::array<TimedArm, 2> timed;
    for (std::size_t k = 0; k < 2; ++k)
      timed[k] = {motions[k].get(), &arms_[k]->rates, &options[k], &common.travel[k]};
    if (prepared_.follower() >= 0) {
      const auto follower = static_cast<std::size_t>(prepared_.follower());
      timed[follower].leader = &timed[1 - follower];
      timed[follower].most_speed = arms_[follower]->problem.limits.tool_speed;
      timed[follower].most_turn_speed = arms_[follower]->problem.limits.tool_turn_speed;
    }
    for (bool slowed = false;; slowed = true) {
      ArmsTiming timing = time_arms(timed, common.rests, budget_);
      if (timing.failure) {
        const std::size_t arm = timing.failed_arm;
        return TriedFault{{*std::move(timing.failure), 0},
                          arm,
                          false,
                          all_rows_[arm] || !motions[arm]->jumps().empty()};
      }
      samples_ = std::move(timing.motions);
      bool strays = false;
      for (std::size_t k = 0; k < 2; ++k) {
        const ArmToTime& arm = *arms_[k];
        if (!strays_between(arm.robot, arm.problem, samples_[k], budget_)) continue;
        const auto& tolerance = arm.problem.limits.tool_path_error;
        if (slowed || !(tolerance && *tolerance > 0))
          return TriedFault{{{0,
                              "the tool would leave its path's tolerances between samples: a "
                              "higher rate brings less"},
                             0},
                            k,
                            false,
                            true};
        options[k].chord = std::min(*tolerance / 2, options[k].chord.value_or(*tolerance));
        strays = true;
      }
      if (!strays) {
        for (std::size_t k = 0; slowed && k < 2; ++k)
          if (options[k].chord != arms_[k]->options.chord)
            samples_[k].warnings.emplace_back(
                "the motion is slowed down: at this rate the tool would leave "
                "limits.tool_path_error between samples");
        return std::nullopt;
      }
    }
  }

  /// Returns the first fault of the samples: of an arm by itself, or of both between each other.
  std::optional<TriedFault> first_fault_of_samples() {
    for (std::size_t k = 0; k < 2; ++k)
      if (auto fault =
              first_fault(arms_[k]->robot, arms_[k]->of_samples, samples_[k].rows, budget_))
        return TriedFault{*std::move(fault), k, false, false, true};
    InterArmWorld::Query query(world_);
    const std::array<std::array<double, kDof>, 2> radii{arms_[0]->robot.radii(),
                                                        arms_[1]->robot.radii()};
    const bool moves = arms_[0]->problem.limits.edges == EdgeMode::kContinuous ||
                       arms_[1]->problem.limits.edges == EdgeMode::kContinuous;
    std::array<Config, 2> before;
    for (std::size_t row = 0; row < samples_[0].rows.size(); ++row) {
      budget_.poll();
      const std::array<Config, 2> q{samples_[0].rows[row].row.q, samples_[1].rows[row].row.q};
      auto pair = query.find_violating_pair(q, ClearanceRule::kNode, kVerdictBand);
      const bool between = !pair && moves && row > 0;
      if (between) pair = query.find_pair_blocking_motion(radii, before, q, kVerdictBand, budget_);
      if (pair) return too_near(row, *pair, between);
      before = q;
    }
    return std::nullopt;
  }
  [[nodiscard]] TriedFault too_near(std::size_t row, const BodyPair& pair, bool between) const {
    const auto names = world_.names(pair);
    NoMotion what{samples_[0].rows[row].row.s,
                  "'" + names[0] + "' of '" + prepared_.name(0) + "' and '" + names[1] + "' of '" +
                      prepared_.name(1) + "' come too near" + (between ? " between samples" : ""),
                  true};
    return {{std::move(what), row}, 0, true, false, true};
  }

  /// Chooses another motion after a fault. Returns false if there is none left.
  bool change(const TriedFault& tried) {
    if (tried.of_both) {
      // A blend lets one tool come early and the other late: stop there instead.
      if (reach_ > 0 && blended_ > 0) {
        reach_ = 0;
        return true;
      }
      const bool more = !all_rows_[0] || !all_rows_[1];
      for (auto& arm : arms_) arm->apart = 0;
      return more;
    }
    if (tried.no_other) return false;
    ArmToTime& arm = *arms_[tried.arm];
    switch (arm.tries++) {
      case 0:  // through every row is less smooth, so it comes second
        if (!all_rows_[tried.arm]) {
          set(arm, 0, kOffLimits);
          return true;
        }
        ++arm.tries;
        [[fallthrough]];
      case 1:  // as far off limits as splines through a jagged path overshoot
        if (!tried.fault.what.too_near && !arm.robot.arm_class().srs) {
          set(arm, kApart, kFarOff);
          return true;
        }
        ++arm.tries;
        [[fallthrough]];
      case 2:
        set(arm, kApart, kOffLimits);
        arm.bisection.emplace(arm.robot, arm.of_samples, arm.path, budget_);
        return true;
      default:
        return lead_between(arm, tried);
    }
  }
  /// Leads the motion of an arm through another posture at the sample at fault.
  bool lead_between(ArmToTime& arm, const TriedFault& tried) {
    constexpr std::size_t kMost = 64;
    if (!tried.at_sample || arm.between.size() >= kMost) return false;
    const auto posture = arm.bisection->posture(samples_[tried.arm].rows, tried.fault.row);
    if (posture) arm.between.push_back(*posture);
    return posture.has_value();
  }

  void finish() {
    Motion& motion = result_.motion.emplace();
    for (std::size_t k = 0; k < 2; ++k) {
      ArmMotion& arm = motion.arms.emplace_back();
      static_cast<TimedPath&>(arm) = std::move(samples_[k]);
      arm.name = prepared_.name(k);
      auto& warnings = arm.warnings;
      warnings.insert(warnings.begin(), arms_[k]->lowered.begin(), arms_[k]->lowered.end());
      if (!arms_[k]->between.empty())
        warnings.push_back("the motion would be at fault between layers: it is led through " +
                           std::to_string(arms_[k]->between.size()) + " other posture(s) there");
    }
    motion.rate = motion.arms[0].rate;
    motion.duration = motion.arms[0].duration;
    motion.ideal = motion.arms[0].ideal;
    motion.blended = blended_;
    if (prepared_.follower() >= 0) measure_follower(motion);
  }
  void measure_follower(Motion& motion) const {
    const auto follower = static_cast<std::size_t>(prepared_.follower());
    motion.follower = follower;
    const FollowerMeter meter(prepared_, budget_);
    for (std::size_t k = 0; k < motion.arms[0].rows.size(); ++k) {
      const FollowerError error =
          meter.at({motion.arms[0].rows[k].row.q, motion.arms[1].rows[k].row.q},
                   motion.arms[1 - follower].rows[k].row.s);
      motion.follower_position = std::max(motion.follower_position, error.position);
      motion.follower_angle = std::max(motion.follower_angle, error.angle);
    }
  }

  static constexpr double kFarOff = 0.03;  // rad

  const PreparedWorkcell& prepared_;
  const Budget& budget_;
  InterArmWorld world_;
  std::array<std::unique_ptr<ArmToTime>, 2> arms_;
  double reach_ = kReach;
  // What the last motion that was tried is like.
  std::array<bool, 2> all_rows_{};
  int blended_ = 0;
  std::vector<TimedPath> samples_;
  MotionTiming result_;
};

}  // namespace

MotionTiming time_workcell(const PreparedWorkcell& prepared,
                           const std::array<std::vector<TrajectoryRow>, 2>& rows,
                           const TimingOptions& options, const Budget& budget) {
  const TraceSpan span("time workcell");
  require_positive(options);
  if (!options.speeds.empty())
    throw InvalidArgument("TimingOptions: speeds: allowed for workcells are none");
  require_tool_speed_of_arms(prepared, options.speed);
  require_motion_defaults(prepared);
  return WorkcellTimer(prepared, rows, options, budget).run();
}

RefinedWorkcellMotion refine_and_time_workcell(
    const PreparedWorkcell& prepared, const std::array<std::vector<TrajectoryRow>, 2>& rows,
    const TimingOptions& options, const Budget& budget) {
  require_positive(options);
  require_tool_speed_of_arms(prepared, options.speed);
  require_motion_defaults(prepared);
  std::array<std::vector<TrajectoryRow>, 2> laid;
  for (std::size_t k = 0; k < 2; ++k) {
    const PathProblem& problem = prepared.problem(k);
    const ToolPath path =
        problem_path(problem, prepared.robot(k).arm().chain, budget, PathSmoothing{});
    laid[k] = rows_on_path(prepared.robot(k), problem, at_layers(problem, path, rows[k]));
  }
  return refine_until_timed(prepared, laid, options, budget);
}

}  // namespace swivel
