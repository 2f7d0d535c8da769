// SPDX-License-Identifier: BSD-3-Clause
#include "output/campaign_output.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "swivel/report/ended_by.hpp"
#include "swivel/report/overview.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Prints what ended the paths of the episodes that have none, each with how many, most first.
void print_ends(const std::vector<EpisodeRow>& rows) {
  std::map<std::string, std::size_t> counts;
  for (const EpisodeRow& row : rows)
    if (row.status == PlanStatus::kInfeasible)
      ++counts[ended_by(row.status, row.cause, row.by, row.reason)];
  std::vector<std::pair<std::string, std::size_t>> ends(counts.begin(), counts.end());
  std::ranges::stable_sort(ends, std::greater(), [](const auto& end) { return end.second; });
  for (const auto& [by, count] : ends) say("  %zu without a path: %s\n", count, by.c_str());
}

void print_summary(const CampaignSummary& summary, const std::vector<EpisodeRow>& rows,
                   const std::vector<HeldJoint>& held) {
  say("%llu of %llu episodes answered: %llu solved, %llu infeasible",
      static_cast<unsigned long long>(summary.answered()),
      static_cast<unsigned long long>(summary.episodes),
      static_cast<unsigned long long>(summary.solved),
      static_cast<unsigned long long>(summary.infeasible));
  if (summary.errors > 0)
    say(", %llu with an internal error", static_cast<unsigned long long>(summary.errors));
  if (!held.empty()) say(", held: %s", words(held).c_str());
  say("\n");
  print_ends(rows);
  if (summary.answered() == 0) return;
  say("plan %.1f ms in the median (5 %% below %.1f, 5 %% above %.1f); nodes checked %.0f, FCL "
      "calls %.0f in the median\n",
      summary.plan_ms.median, summary.plan_ms.p5, summary.plan_ms.p95, summary.nodes_checked.median,
      summary.fcl_calls.median);
}

}  // namespace

void show_campaign(io::OutputFiles& outputs, const std::vector<EpisodeRow>& rows,
                   const io::ShardRecord& record) {
  const CampaignSummary summary = summarize(rows, record.shard.size(record.total));
  if (outputs.wants("--report"))
    outputs.write("--report", to_overview(rows, {record.problem, record.total,
                                                 std::stoull(record.setting("seed")), record.shard,
                                                 record.setting("planner"), record.plan_command,
                                                 record.settings.coordinates}));
  outputs.write("--json", io::to_json(summary, record.held));
  outputs.stage();
  if (!outputs.takes_standard_output()) print_summary(summary, rows, record.held);
  flush_standard_output();
  outputs.commit();
}

int campaign_exit_code(const std::vector<EpisodeRow>& rows, const io::ShardRecord& record) {
  const auto failed = [](const EpisodeRow& row) { return row.status == PlanStatus::kError; };
  const auto first = std::find_if(rows.begin(), rows.end(), failed);
  if (first == rows.end()) return rows.size() == record.shard.size(record.total) ? kOk : kStopped;
  complain("swivel: internal error in %llu episodes, the first in episode %llu: %s\n",
           static_cast<unsigned long long>(std::count_if(rows.begin(), rows.end(), failed)),
           static_cast<unsigned long long>(first->episode), first->reason.c_str());
  return kInternalError;
}

}  // namespace swivel::cli
