// SPDX-License-Identifier: BSD-3-Clause
#include "commands/workcell_command.hpp"

#include <unistd.h>

#include <optional>
#include <set>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/check_output.hpp"
#include "output/workcell_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/workcell_view.hpp"
#include "swivel/report/workcell_page.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Prints the answer, times and work counts of a workcell; warnings go to standard error.
void print_workcell(const WorkcellResult& result) {
  say_text(workcell_text(result));
  std::string stages;
  for (const char* const stage : {"load", "prepare", "lattice", "search", "check", "report"})
    if (const auto found = result.time_ms.find(stage); found != result.time_ms.end())
      stages += formatted("%s%s %.1f ms", stages.empty() ? "" : ", ", stage, found->second);
  long long nodes = 0, edges = 0, calls = 0;
  for (const PlanResult& arm : result.arms) {
    nodes += arm.counters.nodes_checked;
    edges += arm.counters.edges_checked;
    calls += arm.counters.fcl_calls;
  }
  say("%s, %d thread%s: %s; %lld nodes and %lld edges of the arms checked, %lld pairs of nodes and "
      "%lld of motions, %lld FCL calls\n",
      result.planner.c_str(), result.threads, result.threads == 1 ? "" : "s", stages.c_str(), nodes,
      edges, static_cast<long long>(result.counters.node_pairs),
      static_cast<long long>(result.counters.move_pairs), calls);
  std::set<std::string> said;
  const auto warn = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
      if (said.insert(warning).second) complain("swivel: warning: %s\n", warning.c_str());
  };
  warn(result.warnings);
  for (const PlanResult& arm : result.arms) warn(arm.warnings);
}

/// Returns the page of --report; unset where there is neither a plan nor a verdict, or where time
/// is up first, of which a warning tells.
std::optional<std::string> page_of(const WorkcellRequest& request, const PreparedWorkcell& prepared,
                                   const WorkcellView& view, const Budget& budget,
                                   WorkcellResult& result) {
  if (!request.report || view.arms.empty()) return std::nullopt;
  try {
    return to_workcell_page({prepared, request.cell, result, view}, io::to_workcell_json(result),
                            budget, {.which = "", .answer = workcell_text(result)});
  } catch (const Stopped&) {
    result.warnings.push_back("stopped before the page was made: there is no report");
    return std::nullopt;
  }
}

}  // namespace

int plan_workcell_file(WorkcellRequest request, io::OutputFiles& outputs) {
  catch_interrupts();
  ProgressLine progress(!request.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  const Budget budget = request.options.budget();  // of the page; the plan has its own
  const PreparedWorkcell prepared(request.cell);
  WorkcellView view;
  WorkcellResult result =
      plan_workcell(prepared, request.options, request.report ? &view : nullptr);
  result.time_ms["load"] = request.load_ms;
  std::optional<std::string> page = page_of(request, prepared, view, budget, result);
  progress.clear();
  if (result.arms[0].trajectory.empty())
    outputs.remove("--out");
  else
    outputs.write("--out", io::to_workcell_csv(result));
  if (page)
    outputs.write("--report", std::move(*page));
  else
    outputs.remove("--report");
  if (outputs.wants("--json")) outputs.write("--json", io::to_workcell_json(result) + "\n");
  const bool infeasible = result.status == PlanStatus::kInfeasible;
  deliver(outputs, infeasible ? "there is no plan now" : "the search was stopped", [&] {
    if (!request.quiet && !outputs.takes_standard_output()) print_workcell(result);
  });
  if (infeasible) return kNo;
  return result.status == PlanStatus::kSolved ? kOk : kStopped;
}

int check_workcell_file(const Workcell& cell, const std::string& trajectory) {
  const PreparedWorkcell prepared(cell);
  for (std::size_t k = 0; k < 2; ++k) warn_of_held(prepared.robot(k).arm().held);
  const auto rows = io::load_workcell_csv(
      trajectory, {cell.arms[0].name, cell.arms[1].name},
      {prepared.robot(0).arm().chain.joint_names, prepared.robot(1).arm().chain.joint_names});
  const WorkcellCheckResult result = check_workcell(prepared, rows);
  std::int64_t failures = result.failure_count;
  for (const CheckResult& arm : result.arms) failures += arm.failure_count;
  say("%s: two arms, %zu rows", result.passed ? "passed" : "failed", rows[0].size());
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
    say(", cost %.9g\n", arm.cost);
    print_failures(arm.failures, arm.failure_count);
  }
  print_failures(result.failures, result.failure_count);
  return result.passed ? kOk : kNo;
}

}  // namespace swivel::cli
