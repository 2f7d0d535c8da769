// SPDX-License-Identifier: BSD-3-Clause
#include "output/check_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "options/search_options.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// What is said of rows without times where the problem asks for speeds of the tool.
constexpr const char* kSpeedsNotChecked =
    "speeds of the tool were not checked: rows have no times\n";

/// Returns the text of a failure without its numbers, in which failures of one kind differ. Numbers
/// within quoted names stay.
std::string kind_of(const std::string& failure) {
  std::string kind;
  bool quoted = false, number = false;
  for (const char c : failure) {
    if (c == '\'') quoted = !quoted;
    number = !quoted && (std::strchr("0123456789.+-", c) != nullptr || (number && c == 'e'));
    if (!number) kind += c;
  }
  return kind;
}

/// Prints one line for each kind of failure, with the number of further failures of that kind, and
/// how many of the `count` failures are not listed.
void print_failures(const std::vector<std::string>& failures, std::int64_t count) {
  std::vector<std::pair<std::string, std::size_t>> kinds;  // and how many there are
  std::vector<const std::string*> first;
  for (const std::string& failure : failures) {
    const std::string kind = kind_of(failure);
    const auto known = std::find_if(kinds.begin(), kinds.end(),
                                    [&](const auto& one) { return one.first == kind; });
    if (known != kinds.end()) {
      ++known->second;
      continue;
    }
    kinds.emplace_back(kind, 1);
    first.push_back(&failure);
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    say("  %s", first[k]->c_str());
    if (kinds[k].second > 1) say(" (and %zu more like it)", kinds[k].second - 1);
    say("\n");
  }
  const auto listed = static_cast<std::int64_t>(failures.size());
  if (count > listed)
    say("  and %lld more failure%s\n", static_cast<long long>(count - listed),
        count - listed == 1 ? "" : "s");
}

/// Prints how deep bodies that may touch are in each other, or that it was not measured. Prints
/// nothing where none touch.
void print_contact(const CheckResult& result) {
  if (result.deepest_contact_status == Known::kNotMeasured) say(", depth of contact not measured");
  const auto& contact = result.deepest_contact;
  if (!contact) return;
  say(", %s - %s at least %.3f mm", contact->bodies[0].c_str(), contact->bodies[1].c_str(),
      1e3 * contact->depth);
  if (contact->at_most) say(" and at most %.3f mm", 1e3 * *contact->at_most);
  say(" deep in each other (%s)",
      contact->allowed ? formatted("allowed %.3f mm", 1e3 * *contact->allowed).c_str()
                       : "allowed however deep");
}

/// Prints the least clearance and margin, where they are known, and the deepest contact.
void print_nearness(const CheckResult& result) {
  if (result.min_clearance)
    say(", clearance at least %.3f mm, %.3f mm more than asked", 1e3 * *result.min_clearance,
        1e3 * *result.min_margin);
  print_contact(result);
}

/// Prints the number of failures, if there are any.
void print_count(bool passed, std::int64_t failures) {
  if (passed) return;
  say(", %lld failure%s", static_cast<long long>(failures), failures == 1 ? "" : "s");
}

/// Prints what was proved of one path, and how near it is to failing.
void print_margins(const PathProblem& problem, const Chain& chain, const CheckResult& result) {
  say("tool within %.2g m and %.2g rad of the path at rows", result.worst_position,
      result.worst_angle);
  // Where no row and the next could both be measured, nothing is known of what lies between.
  if (result.largest_step > 0 || result.worst_path_error > 0 || result.worst_path_angle > 0) {
    say(", within %.3f mm", 1e3 * result.worst_path_error);
    if (problem.limits.tool_path_error)
      say(" (allowed %.3f)", 1e3 * *problem.limits.tool_path_error);
    say(" and %.3g rad", result.worst_path_angle);
    if (problem.limits.tool_angle_error) say(" (allowed %.3g)", *problem.limits.tool_angle_error);
    say(" between, joint moves within %s of what is allowed", percent(result.largest_step).c_str());
  }
  if (result.nearest_limit)
    say(", '%s' %.2f deg from its limit at row %zu",
        chain.joint_names[result.nearest_limit->joint].c_str(),
        result.nearest_limit->by * 180 / kPi, result.nearest_limit->row);
  if (result.nearest_slide_limit)
    say(", '%s' %.2f mm from its limit at row %zu",
        chain.joint_names[result.nearest_slide_limit->joint].c_str(),
        1e3 * result.nearest_slide_limit->by, result.nearest_slide_limit->row);
  print_nearness(result);
  say(", cost %.9g\n", result.cost);
  if (!result.motion) return;
  const char* const names[] = {"speed", "acceleration", "jerk"};
  say("motion: %.3f s, tool at most %.6g mm/s and %.4g rad/s", result.motion->duration,
      1e3 * result.motion->tool_speed, result.motion->turn_speed);
  for (std::size_t k = 0; k < 3; ++k)
    say(", %s at most %.2f %% of what '%s' can do", names[k], 100 * result.motion->peaks[k].ratio,
        chain.joint_names[static_cast<std::size_t>(result.motion->peaks[k].joint)].c_str());
  say("\n");
}

/// Returns true if joint j of the chain may be at `value`, rad.
bool within_limit(const Chain& chain, std::size_t j, double value) {
  const JointLimit& limit = chain.limit[j];
  return limit.continuous || (value >= limit.lower && value <= limit.upper);
}

/// Returns true if the joints of all rows are within their limits when read as degrees, while one
/// of them, read as radians, the unit of every file of joints, is outside and beyond a whole turn.
/// Joints in radians that are outside by little are within their limits as degrees, too.
bool look_like_degrees(const Chain& chain, const std::vector<TrajectoryRow>& rows) {
  bool beyond_a_turn = false;
  for (const TrajectoryRow& row : rows)
    for (std::size_t j = 0; j < kDof; ++j) {
      const double value = row.q[static_cast<Eigen::Index>(j)];
      if (!within_limit(chain, j, value / kDegrees)) return false;
      beyond_a_turn |= !within_limit(chain, j, value) && std::abs(value) > 2 * kPi;
    }
  return beyond_a_turn;
}

/// Returns what all runs of strokes show together.
CheckResult summary_of(const AnswerCheck& check) {
  CheckResult all;
  bool measured = true;
  const auto lower = [](std::optional<double>& least, const std::optional<double>& value) {
    if (value && (!least || *value < *least)) least = value;
  };
  for (const CheckResult& run : check.runs) {
    all.worst_position = std::max(all.worst_position, run.worst_position);
    all.worst_angle = std::max(all.worst_angle, run.worst_angle);
    all.worst_path_error = std::max(all.worst_path_error, run.worst_path_error);
    all.worst_path_angle = std::max(all.worst_path_angle, run.worst_path_angle);
    lower(all.min_clearance, run.min_clearance);
    lower(all.min_margin, run.min_margin);
    if (run.deepest_contact &&
        (!all.deepest_contact || run.deepest_contact->depth > all.deepest_contact->depth))
      all.deepest_contact = run.deepest_contact;
    measured &= run.deepest_contact_status != Known::kNotMeasured;
    if (!run.motion) continue;
    if (!all.motion) all.motion.emplace();
    all.motion->tool_speed = std::max(all.motion->tool_speed, run.motion->tool_speed);
    all.motion->turn_speed = std::max(all.motion->turn_speed, run.motion->turn_speed);
  }
  all.deepest_contact_status = known(measured, all.deepest_contact.has_value());
  return all;
}

/// Prints how far the tool of a run, or of all runs, is from the path.
void print_path_errors(const CheckResult& of) {
  say("tool within %.2g m and %.2g rad of the path at rows, within %.3f mm and %.3g rad between",
      of.worst_position, of.worst_angle, 1e3 * of.worst_path_error, of.worst_path_angle);
}

/// Returns the rows of an answer to one path.
std::vector<TrajectoryRow> rows_of(const GivenArm& arm) {
  if (!arm.motion) return arm.parts.front().rows;
  std::vector<TrajectoryRow> rows;
  for (const TimedRow& row : arm.motion->rows) rows.push_back(row.row);
  return rows;
}

void print_check_of_path(const AnswerCheck& check, const GivenAnswer& given,
                         const PreparedRobot& robot) {
  const PathProblem problem = problem_of_run(given.problem, {0, false});
  const Chain& chain = robot.arm().chain;
  const std::vector<HeldJoint>& held = robot.arm().held;
  const std::vector<TrajectoryRow> rows = rows_of(given.arms.front());
  const CheckResult& result = check.runs.front();
  say("%s: %zu rows", result.passed ? "passed" : "failed", rows.size());
  print_count(result.passed, result.failure_count);
  if (result.rounded) say(", on the path as motions follow it, its corners rounded");
  if (!held.empty()) say(", held: %s", words(held).c_str());
  say("; ");
  const bool all = result.rows_examined == static_cast<std::int64_t>(rows.size());
  if (result.rows_examined == 0 && result.worst_position == 0) {
    say("no row could be measured\n");
  } else {
    if (!all) say("of the rows that could be measured: ");
    print_margins(problem, chain, result);
  }
  const bool asks_speed = problem.limits.tool_speed || problem.limits.tool_turn_speed;
  if (!given.has_times() && asks_speed) say("%s", kSpeedsNotChecked);
  if (look_like_degrees(chain, rows))
    say("  joints would be within their limits as degrees: allowed are radians\n");
  print_failures(result.failures, result.failure_count);
}

void print_check_of_strokes(const AnswerCheck& check, const GivenAnswer& given,
                            const PreparedRobot& robot) {
  const std::vector<HeldJoint>& held = robot.arm().held;
  const std::size_t runs = given.runs();
  const std::size_t strokes = runs - std::min(runs, lift_off_count(given.problem));
  say("%s: %zu stroke%s", check.passed ? "passed" : "failed", strokes, strokes == 1 ? "" : "s");
  if (runs > strokes) say(" in %zu runs", runs);
  say(", %zu rows", given.rows());
  print_count(check.passed, check.failure_count);
  if (!held.empty()) say(", held: %s", words(held).c_str());
  if (check.runs.empty()) {
    say("; no stroke could be measured\n");
  } else {
    const CheckResult all = summary_of(check);
    say("; on strokes ");
    print_path_errors(all);
    print_nearness(all);
    say(", cost %.9g\n", check.cost);
    if (all.motion)
      say("motion: %.3f s, tool on strokes at most %.6g mm/s and %.4g rad/s\n",
          given.arms.front().motion->duration, 1e3 * all.motion->tool_speed,
          all.motion->turn_speed);
  }
  print_failures(check.failures, check.failure_count);
  if (!given.has_times()) say("%s", kSpeedsNotChecked);
}

/// Prints the highest rates of an arm's timed motion.
void print_rates(const CheckResult::Motion& motion,
                 const std::array<std::string, kDof>& joint_names) {
  say("    tool at up to %.6g m/s in the base frame", motion.tool_speed);
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    const CheckResult::Motion::Peak& peak = motion.peaks[static_cast<std::size_t>(rate)];
    say("; %s of '%s' at %s of its limit", to_string(rate),
        joint_names[static_cast<std::size_t>(peak.joint)].c_str(), percent(peak.ratio).c_str());
  }
  say("\n");
}

void print_check_of_two_arms(const AnswerCheck& check, const GivenAnswer& given,
                             const PreparedProblem& prepared) {
  std::int64_t failures = check.failure_count;
  for (const CheckResult& arm : check.runs) failures += arm.failure_count;
  say("%s: two arms, %zu rows", check.passed ? "passed" : "failed", given.rows());
  if (given.has_times()) say(", %.3f s", given.arms.front().motion->rows.back().t);
  print_count(check.passed, failures);
  if (const auto& nearest = check.between)
    say("; the arms are nearest to each other by %.3f mm, %.3f mm more than asked: %s and %s",
        1e3 * nearest->clearance, 1e3 * nearest->margin, nearest->bodies[0].c_str(),
        nearest->bodies[1].c_str());
  say("\n");
  for (std::size_t k = 0; k < 2; ++k) {
    const CheckResult& arm = check.runs[k];
    say("  %s: ", given.problem.arms[k].name.c_str());
    print_path_errors(arm);
    print_nearness(arm);
    say(", cost %.9g\n", arm.cost);
    if (arm.motion) print_rates(*arm.motion, prepared.joint_names(k));
    print_failures(arm.failures, arm.failure_count);
  }
  const auto asks_speed = [](const ArmTask& arm) {
    return arm.path().limits.tool_speed || arm.path().limits.tool_turn_speed;
  };
  const std::vector<ArmTask>& arms = given.problem.arms;
  if (!given.has_times() && std::any_of(arms.begin(), arms.end(), asks_speed))
    say("%s", kSpeedsNotChecked);
  print_failures(check.failures, check.failure_count);
}

}  // namespace

void print_check(const AnswerCheck& check, const GivenAnswer& given,
                 const PreparedProblem& prepared) {
  if (prepared.has_two_arms())
    print_check_of_two_arms(check, given, prepared);
  else if (is_path(given.problem))
    print_check_of_path(check, given, prepared.robot());
  else
    print_check_of_strokes(check, given, prepared.robot());
}

}  // namespace swivel::cli
