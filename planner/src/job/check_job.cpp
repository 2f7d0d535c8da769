// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/job/check_job.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "job/process_range.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "verify/check_rates.hpp"
#include "verify/move_cost.hpp"

namespace swivel {

namespace {

constexpr double kSame = 1e-9;          // rad
constexpr std::size_t kMostLines = 20;  // of failures

class JobCheck {
 public:
  /// Prepares the check of a job's parts; `timed` holds their rows with times, or is null.
  JobCheck(const PreparedRobot& robot, const Problem& job, const std::vector<Part>& parts,
           const CheckOptions& options, const std::vector<std::vector<TimedRow>>* timed = nullptr)
      : robot_(robot),
        chain_(robot.arm().chain),
        job_(job),
        parts_(parts),
        timed_(timed),
        options_(options),
        margin_(limits_of_transitions(job).joint_margin) {
    PathProblem between = problem_of_run(job, {0, false});
    between.limits = limits_of_transitions(job);
    if (timed)
      between.limits.edge_tolerance = std::min(between.limits.edge_tolerance, kVerdictBand);
    world_.emplace(robot.world(), between, options.budget, kVerdictBand);
    rule_ = world_->edge_rule(robot.radii());
    query_.emplace(*world_, options.margins ? DistanceProofs::kOff : DistanceProofs::kOn);
  }

  AnswerCheck run() {
    if (examine_order())
      for (std::size_t k = 0; k < parts_.size(); ++k)
        parts_[k].run ? examine_run(k) : examine_transition(k);
    if (job_.arm().lift)
      result_.cost += static_cast<double>(lift_off_count(job_)) * job_.arm().lift->cost;
    result_.passed = result_.failure_count == 0;
    return std::move(result_);
  }

 private:
  void fail(const std::string& line) {
    ++result_.failure_count;
    if (result_.failures.size() < kMostLines) result_.failures.push_back(line);
  }
  /// Returns the name of a part for messages.
  [[nodiscard]] std::string name(std::size_t k) const {
    if (parts_[k].run) return "stroke '" + job_.arm().strokes[parts_[k].run->stroke].name + "'";
    if (k + 1 < parts_.size() && parts_[k + 1].run)
      return "transition to '" + job_.arm().strokes[parts_[k + 1].run->stroke].name + "'";
    return "transition home";
  }

  /// Examines which parts there are. Returns false if they cannot be examined further.
  bool examine_order() {
    std::vector<StrokeRun> runs;
    bool alternate = true;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const bool transition = !parts_[k].run;
      alternate = alternate && transition == ((k % 2 == 0) == job_.arm().home.has_value());
      if (transition) continue;
      if (parts_[k].run->stroke >= job_.arm().strokes.size()) {
        fail("part " + std::to_string(k + 1) + ": the job has no such stroke");
        return false;
      }
      runs.push_back(*parts_[k].run);
    }
    if (parts_.empty() || (parts_.size() % 2 == 1) == false || !alternate) {
      fail(job_.arm().home
               ? "parts: allowed are a transition, a stroke, a transition, ..., a transition"
               : "parts: allowed are a stroke, a transition, a stroke, ..., a stroke");
      return false;
    }
    std::vector<int> times(job_.arm().strokes.size());
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const Stroke& stroke = job_.arm().strokes[runs[k].stroke];
      ++times[runs[k].stroke];
      if (runs[k].reversed && !stroke.reversible)
        fail("stroke '" + stroke.name + "' is run backwards: allowed is its own direction");
      if (job_.arm().order == StrokeOrder::kGiven && runs[k].stroke != k)
        fail("stroke '" + stroke.name + "' is number " + std::to_string(k + 1) +
             ": allowed is the given order, in which it is number " +
             std::to_string(runs[k].stroke + 1));
    }
    for (std::size_t k = 0; k < times.size(); ++k)
      if (times[k] != 1)
        fail("stroke '" + job_.arm().strokes[k].name + "' is run " + std::to_string(times[k]) +
             " times: allowed is once");
    return true;
  }

  void examine_run(std::size_t k) {
    const PathProblem problem = problem_of_run(job_, *parts_[k].run);
    CheckResult result = timed_ ? check_motion(robot_, problem, (*timed_)[k], options_)
                                : check_trajectory(robot_, problem, parts_[k].rows, options_);
    for (const std::string& line : result.failures) fail(name(k) + ": " + line);
    if (timed_) examine_speeds(k, problem);
    result_.failure_count +=
        result.failure_count - static_cast<std::int64_t>(result.failures.size());
    result_.cost += result.cost;
    result_.runs.push_back(std::move(result));
  }

  /// Examines how fast the tool is on a timed run.
  void examine_speeds(std::size_t k, const PathProblem& problem) {
    constexpr double kFaster = 1.001;    // of what is asked, as of limits.tool_speed
    constexpr double kSamePlace = 1e-6;  // m
    const StrokeRun& run = *parts_[k].run;
    const std::optional<RunSpeeds> asked = speeds_of_run(job_, run, problem, options_.speed);
    if (!asked) return;
    const std::vector<TimedRow>& rows = (*timed_)[k];
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const TimedRow &from = rows[i - 1], &to = rows[i];
      double allowed = -1;  // the fastest speed asked for between the two places
      for (std::size_t n = 0; n <= asked->from.size(); ++n) {
        const bool first = n == 0, last = n == asked->from.size();
        if (!first && asked->from[n - 1].s > to.row.s + kSamePlace) continue;
        if (!last && asked->from[n].s < from.row.s - kSamePlace) continue;
        allowed = std::max(allowed, first ? asked->first : asked->from[n - 1].speed);
      }
      const double way =
          (chain_.tool(to.row.q).translation() - chain_.tool(from.row.q).translation()).norm();
      // what check_motion() refuses has failed already
      if (!(to.t > from.t) || allowed < 0 || !(way > kFaster * allowed * (to.t - from.t))) continue;
      fail(name(k) + formatted(": rows %zu-%zu: the tool moves at %.6g m/s at s = %.6g m: allowed "
                               "is %.6g, the speed asked for there",
                               i - 1, i, way / (to.t - from.t), from.row.s, allowed));
    }
  }

  void examine_transition(std::size_t k) {
    const std::vector<TrajectoryRow>& rows = parts_[k].rows;
    if (rows.size() < 2) return fail(name(k) + ": allowed are at least two rows");
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!rows[i].q.allFinite())
        return fail(name(k) + ": row " + std::to_string(i) + ": joints are not finite");
    examine_end(k, rows.front().q, k > 0 ? before(k) : job_.arm().home, "begins");
    examine_end(k, rows.back().q, k + 1 < parts_.size() ? after(k) : job_.arm().home, "ends");
    for (std::size_t i = 0; i < rows.size(); ++i) examine_limits(k, i);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const auto pair = edge_blocked(*query_, rule_, rows[i - 1].q, rows[i].q, options_.budget);
      if (!pair) continue;
      const auto names = world_->names(*pair);
      fail(name(k) + ": " +
           formatted("rows %zu-%zu: '%s' and '%s' come closer than %.3f mm", i - 1, i,
                     names[0].c_str(), names[1].c_str(),
                     1e3 * world_->required_clearance(*pair).motion));
    }
    if (timed_) examine_times(k);
    result_.cost += cost_of(rows);
  }
  /// Examines the rates of a timed transition.
  void examine_times(std::size_t k) {
    Limits limits = job_.arm().transition_limits;
    limits.tool_speed.reset();
    limits.tool_turn_speed.reset();
    const JointRates rates = joint_rates(chain_, limits, job_.source);
    limits.joint_speed.emplace();
    for (std::size_t j = 0; j < kDof; ++j)
      (*limits.joint_speed)[j] = job_.arm().rapid * rates.speed[static_cast<Eigen::Index>(j)];
    std::vector<Pose> tools;
    for (const TimedRow& row : (*timed_)[k]) tools.push_back(chain_.tool(row.row.q));
    static_cast<void>(examine_rates(chain_, limits, job_.source, (*timed_)[k], tools,
                                    [&](const std::string& line) { fail(name(k) + ": " + line); }));
  }
  [[nodiscard]] std::optional<Config> before(std::size_t k) const {
    if (parts_[k - 1].rows.empty()) return std::nullopt;
    return parts_[k - 1].rows.back().q;
  }
  [[nodiscard]] std::optional<Config> after(std::size_t k) const {
    if (parts_[k + 1].rows.empty()) return std::nullopt;
    return parts_[k + 1].rows.front().q;
  }
  void examine_end(std::size_t k, const Config& q, const std::optional<Config>& other,
                   const char* what) {
    if (!other) return;
    for (std::size_t j = 0; j < kDof; ++j) {
      if (chain_.roll && j + 1 == kDof) continue;
      const auto i = static_cast<Eigen::Index>(j);
      const bool home = (k == 0 && *what == 'b') || (k + 1 == parts_.size() && *what == 'e');
      const JointLimit& limit = chain_.limit[j];
      double off = q[i] - (*other)[i];
      // a continuous joint is at home whatever its turn
      if (home && (limit.continuous || limit.wide())) off = std::remainder(off, kTwoPi);
      if (std::abs(off) <= kSame) continue;
      fail(name(k) + ": " + what +
           formatted(" %.3g rad away from %s, by joint '%s': allowed is no jump", std::abs(off),
                     home ? "home" : "the stroke", chain_.joint_names[j].c_str()));
      return;
    }
  }
  void examine_limits(std::size_t k, std::size_t row) {
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_.limit[j];
      if (limit.continuous || limit.wide() || (chain_.roll && j + 1 == kDof)) continue;
      const double x = parts_[k].rows[row].q[static_cast<Eigen::Index>(j)];
      const double lower = limit.lower + margin_, upper = limit.upper - margin_;
      if (x >= lower - kSame && x <= upper + kSame) continue;
      fail(name(k) + ": " +
           formatted("row %zu: joint '%s' is at %.6g %s: allowed is %.6g to %.6g", row,
                     chain_.joint_names[j].c_str(), x, limit.slides ? "m" : "rad", lower, upper));
    }
  }
  /// Returns what the moves of a transition cost. The roll of a six-joint arm costs nothing.
  [[nodiscard]] double cost_of(const std::vector<TrajectoryRow>& rows) const {
    double sum = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      Config move = rows[i].q - rows[i - 1].q;
      if (chain_.roll) move[kDof - 1] = 0;
      sum += move_cost(job_.arm().strokes.front().cost, chain_, move);
    }
    return sum;
  }

  const PreparedRobot& robot_;
  const Chain& chain_;
  const Problem& job_;
  const std::vector<Part>& parts_;
  const std::vector<std::vector<TimedRow>>* timed_;  // by part
  const CheckOptions& options_;
  double margin_;  // rad, of transitions
  std::optional<World> world_;
  EdgeRule rule_;
  std::optional<World::Query> query_;
  AnswerCheck result_;
};

}  // namespace

AnswerCheck check_job(const PreparedRobot& robot, const Problem& job,
                      const std::vector<Part>& parts, const CheckOptions& options) {
  validate(job);
  robot.require_prepared_for(problem_of_run(job, {0, false}));
  return JobCheck(robot, job, parts, options).run();
}

namespace {

/// Says what is wrong with the events of a timed job, if anything is.
std::optional<std::string> fault_of_events(const Problem& job, const std::vector<StrokeRun>& order,
                                           const ArmMotion& motion) {
  std::vector<ProcessEvent> expected;
  std::size_t next = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t part = job.arm().home ? 2 * k + 1 : 2 * k;
    while (next < motion.rows.size() && motion.part[next] < part) ++next;
    std::size_t end = next;
    while (end < motion.rows.size() && motion.part[end] == part) ++end;
    const std::size_t first = next > 0 ? next - 1 : 0;  // the part begins at rest, where it was
    if (first == end) return "stroke '" + job.arm().strokes[order[k].stroke].name + "' has no rows";
    const auto events = events_of_run(job, order[k], problem_of_run(job, order[k]),
                                      std::span(motion.rows).subspan(first, end - first));
    expected.insert(expected.end(), events.begin(), events.end());
  }
  if (motion.events.size() != expected.size())
    return formatted("%zu events: allowed are %zu", motion.events.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const ProcessEvent &is = motion.events[k], &should = expected[k];
    const std::string& name = job.arm().strokes[should.stroke].name;
    if (is.stroke != should.stroke || is.on != should.on || std::abs(is.t - should.t) > 1e-9 ||
        std::abs(is.s - should.s) > 1e-9)
      return formatted("event %zu: allowed is process %s of stroke '%s' at t = %.9g s", k + 1,
                       should.on ? "on" : "off", name.c_str(), should.t);
  }
  return std::nullopt;
}

}  // namespace

AnswerCheck check_job_motion(const PreparedRobot& robot, const Problem& given,
                             const std::vector<StrokeRun>& order, const ArmMotion& motion,
                             const CheckOptions& options) {
  validate(given);
  robot.require_prepared_for(problem_of_run(given, {0, false}));
  const Problem job = with_motion_defaults(given);
  const std::size_t count = job.arm().home ? 2 * order.size() + 1 : 2 * order.size() - 1;
  std::vector<Part> parts(count);
  std::vector<std::vector<TimedRow>> timed(count);
  for (std::size_t k = 0; k < order.size(); ++k)
    parts[job.arm().home ? 2 * k + 1 : 2 * k].run = order[k];
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    const std::size_t part = motion.part[k];
    if (part >= count || (k > 0 && part < motion.part[k - 1]))
      throw InvalidArgument("ArmMotion: part: allowed are indices of parts that ascend");
    if (timed[part].empty() && k > 0) timed[part].push_back(motion.rows[k - 1]);
    timed[part].push_back(motion.rows[k]);
  }
  for (std::size_t k = 0; k < count; ++k)
    for (const TimedRow& row : timed[k]) parts[k].rows.push_back(row.row);
  AnswerCheck result = JobCheck(robot, job, parts, options, &timed).run();
  if (const auto fault = fault_of_events(job, order, motion)) {
    result.failures.push_back(*fault);
    ++result.failure_count;
    result.passed = false;
  }
  return result;
}

void check_process(const Problem& job, const std::vector<Part>& parts,
                   const std::vector<std::vector<bool>>& process, AnswerCheck& result) {
  if (process.size() != parts.size())
    throw InvalidArgument(formatted("process: of %zu parts: allowed is one item for each of %zu",
                                    process.size(), parts.size()));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::vector<bool>& is = process[k];
    if (!parts[k].run || parts[k].run->stroke >= job.arm().strokes.size() || is.empty()) continue;
    const std::vector<bool> should = process_of_rows(parts[k], job);
    if (is.size() != should.size())
      throw InvalidArgument(
          formatted("process: of %zu rows of part %zu: allowed is one item for each of %zu",
                    is.size(), k + 1, should.size()));
    const auto first = std::mismatch(is.begin(), is.end(), should.begin()).first;
    if (first == is.end()) continue;
    const auto row = static_cast<std::size_t>(first - is.begin());
    result.failures.push_back("stroke '" + job.arm().strokes[parts[k].run->stroke].name +
                              formatted("': row %zu: process is %d: allowed is %d", row,
                                        static_cast<int>(is[row]), static_cast<int>(!is[row])));
    ++result.failure_count;
    result.passed = false;
  }
}

namespace {

/// A place of the tool and its z axis.
struct ToolAxis {
  Vector3d position, axis;
  /// Returns how far another one is, m. A turn of the axis by a radian counts as 50 mm.
  [[nodiscard]] double distance(const ToolAxis& other) const {
    constexpr double kPerRadian = 0.05;  // m
    const double angle = std::atan2(axis.cross(other.axis).norm(), axis.dot(other.axis));
    return (other.position - position).norm() + kPerRadian * angle;
  }
  /// Returns what lies between this and another one: straight, the axis in its plane.
  [[nodiscard]] ToolAxis towards(const ToolAxis& other, double share) const {
    const Quaterniond turn = Quaterniond::FromTwoVectors(axis, other.axis);
    return {position + share * (other.position - position),
            Quaterniond::Identity().slerp(share, turn) * axis};
  }
};

/// Returns the mean distance (m) of the tool at rows from where it would be on the straight lines
/// between the waypoints of a run after as long a way (ToolAxis::distance); of rows that are
/// finite.
double deviation_along(const PreparedRobot& robot, const PathProblem& run,
                       const std::vector<TrajectoryRow>& rows) {
  std::vector<ToolAxis> waypoints;
  for (const Waypoint& waypoint : given_waypoints_in_base(run))
    waypoints.push_back({waypoint.position, waypoint.orientation * Vector3d::UnitZ()});
  std::size_t at = 1;  // the waypoint ahead
  double behind = 0;   // length of the lines before that to it, m
  double way = 0, sum = 0;
  std::optional<ToolAxis> before;
  for (const TrajectoryRow& row : rows) {
    if (!row.q.allFinite()) continue;
    const Pose pose = robot.arm().chain.tool(row.q);
    const ToolAxis tool{pose.translation(), pose.linear().col(2)};
    if (before) way += before->distance(tool);
    before = tool;
    double length = waypoints[at - 1].distance(waypoints[at]);
    while (at + 1 < waypoints.size() && behind + length < way) {
      behind += length;
      ++at;
      length = waypoints[at - 1].distance(waypoints[at]);
    }
    const double share = length > 0 ? std::min(1.0, (way - behind) / length) : 1;
    sum += waypoints[at - 1].towards(waypoints[at], share).distance(tool);
  }
  return sum / static_cast<double>(std::max<std::size_t>(rows.size(), 1));
}

}  // namespace

bool begins_at_last_waypoint(const PreparedRobot& robot, const Problem& job, std::size_t stroke,
                             const std::vector<TrajectoryRow>& rows) {
  if (rows.empty() || !rows.front().q.allFinite()) return false;
  const Pose tool = robot.arm().chain.tool(rows.front().q);
  const auto distance = [&](bool reversed) {
    const Waypoint first = given_waypoints_in_base(problem_of_run(job, {stroke, reversed})).front();
    return std::pair((first.position - tool.translation()).norm(),
                     Quaterniond(tool.linear()).angularDistance(first.orientation));
  };
  const auto forward = distance(false), backward = distance(true);
  if (std::abs(forward.first - backward.first) > 1e-6) return backward.first < forward.first;
  if (std::abs(forward.second - backward.second) > 1e-6) return backward.second < forward.second;
  if (!job.arm().strokes[stroke].reversible) return false;
  return deviation_along(robot, problem_of_run(job, {stroke, true}), rows) <
         deviation_along(robot, problem_of_run(job, {stroke, false}), rows);
}

std::vector<StrokeRun> runs_of_motion(const PreparedRobot& robot, const Problem& job,
                                      const std::vector<std::size_t>& strokes,
                                      const ArmMotion& motion) {
  std::vector<StrokeRun> runs;
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::size_t part = job.arm().home ? 2 * k + 1 : 2 * k;
    const auto own = std::find(motion.part.begin(), motion.part.end(), part);
    // A run begins with the last row of the transition before it.
    const auto row = static_cast<std::size_t>(own - motion.part.begin());
    std::vector<TrajectoryRow> rows{motion.rows.at(row > 0 ? row - 1 : 0).row};
    for (std::size_t i = row; i < motion.part.size() && motion.part[i] == part; ++i)
      rows.push_back(motion.rows[i].row);
    runs.push_back({strokes[k], begins_at_last_waypoint(robot, job, strokes[k], rows)});
  }
  return runs;
}

}  // namespace swivel
