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

/// Returns the time that lattices, search and order took: the stage "plan", or where that is not
/// noted the sum of its stages.
double planning_ms(const std::map<std::string, double>& time_ms) {
  if (const auto plan = time_ms.find("plan"); plan != time_ms.end()) return plan->second;
  double sum = 0;
  for (const char* const stage : {"lattice", "find", "search", "order"})
    if (const auto time = time_ms.find(stage); time != time_ms.end()) sum += time->second;
  return sum;
}

/// Returns the mean tool-path error of an arm's rows, mm: of several runs weighted by their steps.
double mean_tool_path_error(const ArmAnswer& arm) {
  if (arm.runs.size() == 1) return arm.run().tool_path_error_mm.mean;
  double sum = 0, steps = 0;
  std::size_t run = 0;
  for (const Part& part : arm.parts) {
    if (!part.run) continue;
    const double weight = static_cast<double>(part.rows.size()) - 1;
    sum += weight * arm.runs[run++].tool_path_error_mm.mean;
    steps += weight;
  }
  return sum / steps;
}

/// Sets the tool-path errors of a row. Two arms have as many steps.
void take_tool_path_errors(const Answer& answer, EpisodeRow& row) {
  double sum = 0, most = 0;
  for (const ArmAnswer& arm : answer.arms) {
    sum += mean_tool_path_error(arm);
    for (const RunAnswer& run : arm.runs) most = std::max(most, run.tool_path_error_mm.max);
  }
  row.tool_path_error_mm_mean = sum / static_cast<double>(answer.arms.size());
  row.tool_path_error_mm_max = most;
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

EpisodeRow::EpisodeRow(std::uint64_t number, const Answer& answer, const Problem& problem)
    : episode(number), status(answer.status), plan_ms(planning_ms(answer.time_ms)) {
  for (const ArmAnswer& arm : answer.arms) {
    nodes_checked += arm.counters.nodes_checked;
    fcl_calls += arm.counters.fcl_calls;
  }
  if (status == PlanStatus::kSolved) {
    cost = answer.cost;
    checked = answer.checked;
    take_tool_path_errors(answer, *this);
  } else if (status == PlanStatus::kInfeasible) {
    failure_of(answer, problem).tell(*this);
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
