// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/overview.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "page/page_template.hpp"
#include "swivel/report/ended_by.hpp"

namespace swivel {

using namespace detail;

namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Returns how many episodes have a path, and how many each reason ended, a line each.
std::string answer_of(const std::vector<EpisodeRow>& rows) {
  std::map<std::string, std::size_t> ended;
  std::size_t solved = 0;
  for (const EpisodeRow& row : rows)
    if (row.status == PlanStatus::kSolved)
      ++solved;
    else
      ++ended[ended_by(row.status, row.cause, row.by, row.reason)];
  std::string text =
      std::to_string(solved) + " of " + std::to_string(rows.size()) + " episodes have a path\n";
  for (const auto& [by, count] : ended)
    text += "  " + std::to_string(count) + " without one: " + by + '\n';
  return text;
}

}  // namespace

std::string to_overview(const std::vector<EpisodeRow>& rows, const CampaignFacts& facts) {
  Json episodes = Json::array();
  for (const EpisodeRow& row : rows)
    episodes.push_back({{"episode", row.episode},
                        {"status", to_string(row.status)},
                        {"cost", or_null(row.cost)},
                        {"plan_ms", row.plan_ms},
                        {"nodes_checked", row.nodes_checked},
                        {"fcl_calls", row.fcl_calls},
                        {"error_mm", or_null(row.tool_path_error_mm_max)},
                        {"failed_s", or_null(row.failed_s)},
                        {"cause", row.cause},
                        {"by", ended_by(row.status, row.cause, row.by, row.reason)},
                        {"reason", row.reason},
                        {"offsets", row.offsets}});
  const Spread spread = summarize(rows, facts.shard.size(facts.episodes)).plan_ms;
  Json data = {{"problem", facts.problem},
               {"episodes", facts.episodes},
               {"seed", facts.seed},
               {"shard", {facts.shard.index, facts.shard.count}},
               {"asked", facts.shard.size(facts.episodes)},
               {"planner", facts.planner},
               {"plan_command", facts.plan_command},
               {"coordinates", facts.coordinates},
               {"plan_ms", {{"median", spread.median}, {"p95", spread.p95}}},
               {"rows", std::move(episodes)}};
  return fill(overview_template(), std::move(data),
              {{"@@ANSWER@@", escaped_lines(facts.problem + "\n\n" + answer_of(rows))}});
}

}  // namespace swivel
