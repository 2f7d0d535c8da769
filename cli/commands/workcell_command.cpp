// SPDX-License-Identifier: BSD-3-Clause
#include "commands/workcell_command.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/check_output.hpp"
#include "output/motion_output.hpp"
#include "output/workcell_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

std::array<io::JointNames, 2> joint_names_of(const PreparedWorkcell& prepared) {
  return {prepared.robot(0).arm().chain.joint_names, prepared.robot(1).arm().chain.joint_names};
}

io::WorkcellRows rows_of_file(const PreparedWorkcell& prepared, const std::string& file) {
  return io::load_workcell_rows(file, {prepared.name(0), prepared.name(1)},
                                joint_names_of(prepared));
}

/// Returns rows at the layers of both arms' paths, from a trajectory or a motion, whose times are
/// left aside. `prepared` is that of the workcell with_motion_defaults(). Throws InputError.
std::array<std::vector<TrajectoryRow>, 2> rows_to_time(const PreparedWorkcell& prepared,
                                                       const Problem& cell, io::WorkcellRows read,
                                                       const Budget& budget) {
  if (!read.timed[0].empty()) return rows_at_layers(prepared, read.timed, read.stated, budget);
  if (read.stated[0].rows() && read.stated[1].rows()) return std::move(read.rows);
  return complete_rows(PreparedWorkcell(cell, budget), std::move(read.rows), read.stated, budget);
}

/// Prints the highest rates of an arm's timed motion.
void print_rates(const CheckResult::Motion& motion, const io::JointNames& names) {
  say("    tool at up to %.6g m/s in the base frame", motion.tool_speed);
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    const CheckResult::Motion::Peak& peak = motion.peaks[static_cast<std::size_t>(rate)];
    say("; %s of '%s' at %s of its limit", to_string(rate),
        names[static_cast<std::size_t>(peak.joint)].c_str(), percent(peak.ratio).c_str());
  }
  say("\n");
}

}  // namespace

Limits limits_of_speeds(const Problem& cell) {
  Limits limits;
  for (const ArmTask& arm : cell.arms)
    if (arm.path().limits.tool_speed)
      limits.tool_speed = std::min(*arm.path().limits.tool_speed,
                                   limits.tool_speed.value_or(*arm.path().limits.tool_speed));
  return limits;
}

int time_workcell_file(const WorkcellTimeRequest& request, std::optional<io::InputFiles>& noted) {
  const PreparedWorkcell prepared(with_motion_defaults(request.cell));
  if (!request.quiet)
    for (std::size_t k = 0; k < 2; ++k) warn_of_held(prepared.robot(k).arm().held);
  const io::WorkcellRows read = rows_of_file(prepared, request.trajectory);
  io::OutputFiles outputs(noted->files());
  noted.reset();
  for (const std::string& file : request.out) outputs.add("--out", file);
  catch_interrupts();
  std::optional<MotionTiming> timed;
  std::optional<RefinedArms> refined;
  try {
    timed = in_the_name_of(request.trajectory, [&] {
      const Budget budget(std::nullopt, &interrupted);
      MotionTiming made;
      const auto rows = rows_to_time(prepared, request.cell, read, budget);
      if (request.refine) {
        auto found = refine_and_time_workcell(prepared, rows, request.timing, budget);
        refined = std::move(found.refinement);
        made = std::move(found.timing);
      } else {
        made = time_workcell(prepared, rows, request.timing, budget);
      }
      if (made.motion && request.check)
        require_passed(check_workcell_motion(prepared,
                                             {made.motion->arms[0].rows, made.motion->arms[1].rows},
                                             {.margins = false, .budget = budget}));
      return made;
    });
  } catch (const Stopped&) {
  }
  const bool executable = timed && timed->motion;
  if (!executable)
    outputs.remove("--out");
  else
    outputs.write_each("--out", [&](const std::filesystem::path& file) {
      return io::workcell_motion_text(*timed->motion, joint_names_of(prepared),
                                      prepared.problem(0).base_link, file);
    });
  deliver(outputs, timed ? "there is no motion now" : "the work was stopped", [&] {
    if (!timed) return say("stopped\n");
    if (executable && (request.quiet || outputs.takes_standard_output())) return;
    if (refined) say_text(refined_workcell_text(*refined, {prepared.name(0), prepared.name(1)}));
    say_text(workcell_motion_text(*timed, joint_names_of(prepared),
                                  {prepared.name(0), prepared.name(1)}));
    if (executable) warn_of(*timed->motion);
  });
  return !timed ? kStopped : executable ? kOk : kNo;
}

int check_workcell_file(const Problem& cell, const std::string& trajectory) {
  std::optional<PreparedWorkcell> prepared(cell);
  for (std::size_t k = 0; k < 2; ++k) warn_of_held(prepared->robot(k).arm().held);
  io::WorkcellRows read = rows_of_file(*prepared, trajectory);
  const bool timed = !read.timed[0].empty();
  if (timed) prepared.emplace(with_motion_defaults(cell));
  in_the_name_of(trajectory, [&] {
    if (timed)
      read.timed = complete_motion(*prepared, std::move(read.timed), read.stated);
    else
      read.rows = complete_rows(*prepared, std::move(read.rows), read.stated);
  });
  const WorkcellCheckResult result =
      timed ? check_workcell_motion(*prepared, read.timed) : check_workcell(*prepared, read.rows);
  std::int64_t failures = result.failure_count;
  for (const CheckResult& arm : result.arms) failures += arm.failure_count;
  say("%s: two arms, %zu rows", result.passed ? "passed" : "failed", read.rows[0].size());
  if (timed) say(", %.3f s", read.timed[0].back().t);
  if (!result.passed)
    say(", %lld failure%s", static_cast<long long>(failures), failures == 1 ? "" : "s");
  if (const auto& nearest = result.between)
    say("; the arms are nearest to each other by %.3f mm, %.3f mm more than asked: %s and %s",
        1e3 * nearest->clearance, 1e3 * nearest->margin, nearest->bodies[0].c_str(),
        nearest->bodies[1].c_str());
  say("\n");
  for (std::size_t k = 0; k < 2; ++k) {
    const CheckResult& arm = result.arms[k];
    say("  %s: tool within %.2g m and %.2g rad of the path at rows, within %.3f mm and %.3g rad "
        "between",
        cell.arms[k].name.c_str(), arm.worst_position, arm.worst_angle, 1e3 * arm.worst_path_error,
        arm.worst_path_angle);
    if (arm.min_clearance)
      say(", clearance at least %.3f mm, %.3f mm more than asked", 1e3 * *arm.min_clearance,
          1e3 * *arm.min_margin);
    print_contact(arm);
    say(", cost %.9g\n", arm.cost);
    if (arm.motion) print_rates(*arm.motion, prepared->robot(k).arm().chain.joint_names);
    print_failures(arm.failures, arm.failure_count);
  }
  const auto asks_speed = [](const ArmTask& arm) {
    return arm.path().limits.tool_speed || arm.path().limits.tool_turn_speed;
  };
  if (!timed && std::any_of(cell.arms.begin(), cell.arms.end(), asks_speed))
    say("%s", kSpeedsNotChecked);
  print_failures(result.failures, result.failure_count);
  return result.passed ? kOk : kNo;
}

int check_workcell_proof(const Problem& cell, const std::string& file) {
  catch_interrupts();
  const WorkcellCertificate certificate = io::load_workcell_certificate(file);
  WorkcellCertificateCheck result;
  try {
    const Budget budget(std::nullopt, &interrupted);
    const PreparedWorkcell prepared(cell, budget);
    for (std::size_t k = 0; k < 2; ++k) warn_of_held(prepared.robot(k).arm().held);
    result = verify_certificate(prepared, certificate, budget);
  } catch (const Stopped&) {
    say("stopped\n");
    return kStopped;
  }
  if (!result.passed) {
    say("failed: this certificate proves nothing\n  %s\n", result.failure.c_str());
    return kNo;
  }
  say("passed: no two paths without conflict at this resolution%s: %lld region%s of conflict, %lld "
      "cut%s; %lld pairs of nodes or motions of both arms, %lld nodes and %lld edges asked\n",
      result.complete ? "" : ", among the solutions that were found",
      static_cast<long long>(result.regions), result.regions == 1 ? "" : "s",
      static_cast<long long>(result.cuts), result.cuts == 1 ? "" : "s",
      static_cast<long long>(result.pairs), static_cast<long long>(result.nodes),
      static_cast<long long>(result.edges));
  return kOk;
}

}  // namespace swivel::cli
