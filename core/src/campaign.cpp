// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/campaign.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace swivel {

namespace {

template <class Value>
Spread spread(const std::vector<EpisodeRow>& rows, Value EpisodeRow::*member) {
  std::vector<double> values;
  for (const EpisodeRow& row : rows) values.push_back(static_cast<double>(row.*member));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) {
    const double position = q * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    return std::lerp(values[below], values[std::min(below + 1, values.size() - 1)], position - static_cast<double>(below));
  };
  return {quantile(0.5), quantile(0.05), quantile(0.95)};
}

}  // namespace

EpisodeRow::EpisodeRow(std::uint64_t number, const PlanResult& result)
    : episode(number), status(result.status), nodes_checked(result.counters.nodes_checked), fcl_calls(result.counters.fcl_calls) {
  if (const auto plan = result.time_ms.find("plan"); plan != result.time_ms.end()) plan_ms = plan->second;
  if (status == PlanStatus::kSolved) {
    cost = result.cost;
    tool_path_error_mm_mean = result.tool_path_error_mm.mean;
    tool_path_error_mm_max = result.tool_path_error_mm.max;
  } else if (status == PlanStatus::kInfeasible) {
    failed_s = result.diagnosis.reached_s;
    reason = words(result.diagnosis.cause);
  }
}

EpisodeRow::EpisodeRow(std::uint64_t number, std::string error_message)
    : episode(number), status(PlanStatus::kError), reason(std::move(error_message)) {}

CampaignSummary summarize(const std::vector<EpisodeRow>& rows, std::uint64_t episodes) {
  CampaignSummary summary;
  summary.episodes = episodes;
  for (const EpisodeRow& row : rows) {
    summary.solved += row.status == PlanStatus::kSolved;
    summary.infeasible += row.status == PlanStatus::kInfeasible;
    summary.errors += row.status == PlanStatus::kError;
  }
  summary.plan_ms = spread(rows, &EpisodeRow::plan_ms);
  summary.nodes_checked = spread(rows, &EpisodeRow::nodes_checked);
  summary.fcl_calls = spread(rows, &EpisodeRow::fcl_calls);
  return summary;
}

}  // namespace swivel
