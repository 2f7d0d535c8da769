// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/campaign.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "study/episode_draw.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/core/study/study_failure.hpp"

namespace swivel {

namespace {

/// Returns true if the k-th of kCoordinates varies.
bool varies(const Variation& vary, int k) {
  return (k < 3 ? vary.xyz[k] : vary.rpy[k - 3]) != 0;
}

/// Moves the objects of a scene that vary as they stand in an episode.
void draw_scene(const std::vector<Variation>& vary, std::uint64_t seed, std::uint64_t episode,
                std::vector<SceneObject>& scene) {
  draw_episode(vary, seed, episode,
               [&](const Variation& one, const Vector3d& offset, const Vector3d& rpy) {
                 for (SceneObject& object : scene)
                   if (object.name == one.object) {
                     object.pose.translation() += offset;
                     object.pose.linear() = from_rpy(rpy).toRotationMatrix() * object.pose.linear();
                   }
               });
}

template <class Value>
Spread spread(const std::vector<EpisodeRow>& rows, Value EpisodeRow::*member) {
  std::vector<double> values;
  for (const EpisodeRow& row : rows) values.push_back(static_cast<double>(row.*member));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) {
    const double position = q * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    return std::lerp(values[below], values[std::min(below + 1, values.size() - 1)],
                     position - static_cast<double>(below));
  };
  return {quantile(0.5), quantile(0.05), quantile(0.95)};
}

}  // namespace

PathProblem episode_problem(const PathProblem& problem, std::uint64_t seed, std::uint64_t episode) {
  PathProblem result = problem;
  draw_scene(problem.vary, seed, episode, result.scene);
  return result;
}

Problem episode_problem(const Problem& problem, std::uint64_t seed, std::uint64_t episode) {
  Problem result = problem;
  draw_scene(problem.vary, seed, episode, result.scene);
  return result;
}

std::vector<std::string> varied_coordinates(const std::vector<Variation>& vary) {
  std::vector<std::string> names;
  for (const Variation& one : vary)
    for (int k = 0; k < 6; ++k)
      if (varies(one, k))
        names.push_back(one.object + "." + kCoordinates[static_cast<std::size_t>(k)]);
  return names;
}

std::vector<double> episode_offsets(const std::vector<Variation>& vary, std::uint64_t seed,
                                    std::uint64_t episode) {
  std::vector<double> offsets;
  draw_episode(vary, seed, episode,
               [&](const Variation& one, const Vector3d& offset, const Vector3d& rpy) {
                 for (int k = 0; k < 6; ++k)
                   if (varies(one, k)) offsets.push_back(k < 3 ? offset[k] : rpy[k - 3]);
               });
  return offsets;
}

EpisodeRow::EpisodeRow(std::uint64_t number, const PlanResult& result, const PathProblem& problem)
    : episode(number),
      status(result.status),
      nodes_checked(result.counters.nodes_checked),
      fcl_calls(result.counters.fcl_calls) {
  if (const auto plan = result.time_ms.find("plan"); plan != result.time_ms.end())
    plan_ms = plan->second;
  if (status == PlanStatus::kSolved) {
    cost = result.cost;
    checked = result.checked;
    tool_path_error_mm_mean = result.tool_path_error_mm.mean;
    tool_path_error_mm_max = result.tool_path_error_mm.max;
  } else if (status == PlanStatus::kInfeasible) {
    failed_s = result.diagnosis.reached_s;
    if (result.diagnosis.cause.kind != Cause::Kind::kNone)
      cause = to_string(result.diagnosis.cause.kind);
    by = subject_of(result.diagnosis.cause, problem.scene);
    reason = words(result.diagnosis.cause);
  }
}

EpisodeRow::EpisodeRow(std::uint64_t number, const JobResult& result, const Problem& job)
    : episode(number),
      status(result.status),
      nodes_checked(result.counters.nodes_checked),
      fcl_calls(result.counters.fcl_calls) {
  for (const char* const stage : {"lattice", "find", "order"})
    if (const auto time = result.time_ms.find(stage); time != result.time_ms.end())
      plan_ms += time->second;
  if (status == PlanStatus::kSolved) {
    cost = result.cost;
    checked = result.checked;
    double sum = 0, steps = 0, most = 0;
    std::size_t run = 0;
    for (const JobPart& part : result.parts) {
      if (!part.run) continue;
      const auto& error = result.runs[run++].measures.tool_path_error_mm;
      const double weight = static_cast<double>(part.rows.size()) - 1;
      sum += weight * error.mean;
      steps += weight;
      most = std::max(most, error.max);
    }
    tool_path_error_mm_mean = sum / steps;
    tool_path_error_mm_max = most;
  } else if (status == PlanStatus::kInfeasible) {
    failure_of(result, job).tell(*this);
  }
}

EpisodeRow::EpisodeRow(std::uint64_t number, const WorkcellResult& result, const Problem& cell)
    : episode(number), status(result.status) {
  for (const char* const stage : {"lattice", "search"})
    if (const auto time = result.time_ms.find(stage); time != result.time_ms.end())
      plan_ms += time->second;
  for (const PlanResult& arm : result.arms) {
    nodes_checked += arm.counters.nodes_checked;
    fcl_calls += arm.counters.fcl_calls;
  }
  if (status == PlanStatus::kSolved) {
    cost = result.cost;
    checked = result.checked;
    const PlanResult &first = result.arms[0], &second = result.arms[1];  // of as many steps
    tool_path_error_mm_mean = (first.tool_path_error_mm.mean + second.tool_path_error_mm.mean) / 2;
    tool_path_error_mm_max = std::max(first.tool_path_error_mm.max, second.tool_path_error_mm.max);
  } else if (status == PlanStatus::kInfeasible) {
    failure_of(result, cell).tell(*this);
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
