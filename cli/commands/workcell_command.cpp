// SPDX-License-Identifier: BSD-3-Clause
#include "commands/workcell_command.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/advice_or_warning.hpp"
#include "output/check_output.hpp"
#include "output/workcell_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "swivel/planner/workcell/workcell_view.hpp"
#include "swivel/report/workcell_page.hpp"
#include "terminal/progress.hpp"
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

/// Prints the warnings of a motion on standard error.
void warn_of_motion(const WorkcellMotion& motion) {
  for (const std::string& warning : motion.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
  for (std::size_t k = 0; k < 2; ++k)
    for (const std::string& warning : motion.arms[k].warnings)
      complain("swivel: warning: arm '%s': %s\n", motion.names[k].c_str(), warning.c_str());
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

/// Gives --out its text: the motion where one is asked for, else the trajectory. Marks an earlier
/// file for removal if there is none.
void write_rows(const WorkcellRequest& request, const WorkcellMotionPlan& plan,
                io::OutputFiles& outputs) {
  const bool motion = plan.timing && plan.timing->motion;
  if (!plan.result.has_rows() || (request.timing && !motion)) {
    outputs.remove("--out");
    return;
  }
  outputs.write_each("--out", [&](const std::filesystem::path& file) {
    return motion ? io::workcell_motion_text(*plan.timing->motion, joint_names_of_arms(plan.result),
                                             request.cell.arms[0].base_link, file)
                  : io::to_csv(plan.result, request.cell);
  });
}

/// What was found.
struct WorkcellAnswer {
  WorkcellMotionPlan plan;
  std::optional<AdviceOnWorkcell> advice{};  ///< with --advise, where there is no plan
};

/// Where there is no plan, seeks changes that would help, within --advise and what is left of
/// --timeout, that of `budget`.
void find_advice(const WorkcellRequest& request, const Budget& budget, WorkcellAnswer& answer) {
  if (!request.advise_s || answer.plan.result.status != PlanStatus::kInfeasible) return;
  PlanOptions trials = request.options;
  trials.timeout_s = std::min(budget.seconds_left().value_or(*request.advise_s), *request.advise_s);
  answer.advice = advice_or_warning(answer.plan.result.warnings, [&] {
    return advise_workcell(request.cell, answer.plan.result, trials);
  });
}

/// Returns the answer of a workcell for people, with its advice, its refinement and its motion.
std::string plan_text(const WorkcellAnswer& answer, const Problem& problem) {
  const WorkcellMotionPlan& plan = answer.plan;
  const Answer& result = plan.result;
  std::string text = answer_text(result, problem);
  if (answer.advice) text += advice_text(*answer.advice);
  if (plan.refinement) text += refined_workcell_text(*plan.refinement, names_of_arms(result));
  if (plan.timing)
    text += workcell_motion_text(*plan.timing, joint_names_of_arms(result), names_of_arms(result));
  return text;
}

/// Returns what followed the plan, for the result file. It points into `answer`.
io::WorkcellExtras extras_of(const WorkcellRequest& request, const WorkcellAnswer& answer) {
  const WorkcellMotionPlan& plan = answer.plan;
  return {plan.refinement ? &*plan.refinement : nullptr, plan.timing ? &*plan.timing : nullptr,
          request.timing.value_or(TimingOptions{}), answer.advice ? &*answer.advice : nullptr,
          plan.stopped && request.timing};
}

/// Prints the answer, times and work counts of a workcell; warnings go to standard error.
void print_workcell(const WorkcellAnswer& answer, const Problem& problem) {
  const WorkcellMotionPlan& plan = answer.plan;
  const Answer& result = plan.result;
  say_text(plan_text(answer, problem));
  std::string stages;
  for (const char* const stage :
       {"load", "prepare", "lattice", "search", "refine", "time", "check", "report", "certificate"})
    if (const auto found = result.time_ms.find(stage); found != result.time_ms.end())
      stages += formatted("%s%s %.1f ms", stages.empty() ? "" : ", ", stage, found->second);
  long long nodes = 0, edges = 0, calls = 0;
  for (const ArmAnswer& arm : result.arms) {
    nodes += arm.counters.nodes_checked;
    edges += arm.counters.edges_checked;
    calls += arm.counters.fcl_calls;
  }
  say("%s, %d thread%s: %s; %lld nodes and %lld edges of the arms checked, %lld pairs of nodes and "
      "%lld of motions, %lld FCL calls\n",
      result.planner.c_str(), result.threads, result.threads == 1 ? "" : "s", stages.c_str(), nodes,
      edges, static_cast<long long>(result.pair.counters.node_pairs),
      static_cast<long long>(result.pair.counters.move_pairs), calls);
  std::set<std::string> said;
  const auto warn = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
      if (said.insert(warning).second) complain("swivel: warning: %s\n", warning.c_str());
  };
  warn(result.warnings);
  for (const ArmAnswer& arm : result.arms) warn(arm.warnings);
  if (plan.timing && plan.timing->motion) warn_of_motion(*plan.timing->motion);
}

/// Returns the page of --report; unset where there is neither a plan nor a verdict, or where time
/// is up first, of which a warning tells.
std::optional<std::string> page_of(const WorkcellRequest& request, const PreparedWorkcell& prepared,
                                   const WorkcellView& view, const Budget& budget,
                                   WorkcellAnswer& answer) {
  WorkcellMotionPlan& plan = answer.plan;
  if (!request.report || view.arms.empty()) return std::nullopt;
  try {
    const auto& timing = plan.timing;
    const WorkcellMotion* motion = timing && timing->motion ? &*timing->motion : nullptr;
    const io::VisualRobot visual = io::load_visuals(*request.cell.arms[0].model);
    return to_workcell_page(
        {prepared, request.cell, plan.result, view, motion},
        io::to_workcell_json(plan.result, extras_of(request, answer)), budget,
        {request.which, plan_text(answer, request.cell), visual.model.get(), visual.left_out});
  } catch (const Stopped&) {
    plan.result.warnings.push_back("stopped before the page was made: there is no report");
    return std::nullopt;
  }
}

/// Proves that a workcell has no plan, for --certificate. Adds a warning to the result if the
/// budget is spent before.
std::string proof_of(const PreparedWorkcell& prepared, const Budget& budget, Answer& result) {
  const auto start = std::chrono::steady_clock::now();
  std::string text;
  try {
    text = io::to_json(prove_infeasible(prepared, budget));
  } catch (const Stopped&) {
    result.warnings.push_back("stopped before the certificate was found: there is none");
  }
  result.time_ms["certificate"] =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return text;
}

}  // namespace

int plan_workcell_file(WorkcellRequest request, io::OutputFiles& outputs) {
  catch_interrupts();
  ProgressLine progress(!request.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  const Budget budget = request.options.budget();  // of page and proof; the plan has its own
  const PreparedWorkcell prepared(request.cell);
  WorkcellView view;
  WorkcellAnswer answer{plan_workcell_motion(prepared, request.options, request.refine,
                                             request.timing, request.report ? &view : nullptr)};
  WorkcellMotionPlan& plan = answer.plan;
  const Answer& result = plan.result;
  plan.result.time_ms["load"] = request.load_ms;
  find_advice(request, budget, answer);
  std::optional<std::string> page = page_of(request, prepared, view, budget, answer);
  const bool infeasible = result.status == PlanStatus::kInfeasible;
  std::string proof;
  if (outputs.wants("--certificate") && infeasible) proof = proof_of(prepared, budget, plan.result);
  progress.clear();
  write_rows(request, plan, outputs);
  if (page)
    outputs.write("--report", std::move(*page));
  else
    outputs.remove("--report");
  if (outputs.wants("--json"))
    outputs.write("--json", io::to_workcell_json(result, extras_of(request, answer)) + "\n");
  const std::size_t bytes = proof.size();
  if (bytes > 0)
    outputs.write("--certificate", std::move(proof));
  else
    outputs.remove("--certificate");
  const bool no_motion = plan.timing && !plan.timing->motion;
  const bool whole = result.status == PlanStatus::kSolved && !(plan.stopped && request.timing);
  deliver(outputs,
          infeasible  ? "there is no plan now"
          : no_motion ? "there is no motion now"
          : whole     ? "there is a plan now"
                      : "the search was stopped",
          [&] {
            if (request.quiet || outputs.takes_standard_output()) return;
            print_workcell(answer, request.cell);
            if (bytes > 0) say("certificate: %zu bytes\n", bytes);
          });
  if (infeasible || no_motion) return kNo;
  return whole ? kOk : kStopped;
}

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
  std::optional<WorkcellTiming> timed;
  std::optional<RefinedWorkcell> refined;
  try {
    timed = in_the_name_of(request.trajectory, [&] {
      const Budget budget(std::nullopt, &interrupted);
      WorkcellTiming made;
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
    if (executable) warn_of_motion(*timed->motion);
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
