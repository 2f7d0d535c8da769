// SPDX-License-Identifier: BSD-3-Clause
#include "options/job_options.hpp"

#include "swivel/core/messages/input_error.hpp"

namespace swivel::cli {

void refuse_options(const std::string& kind, const std::string& file,
                    const std::vector<std::pair<bool, const char*>>& options) {
  for (const auto& [given, name] : options)
    if (given)
      throw InputError(std::string(name) + ": is not supported yet for " + kind + ", as " + file +
                       " is one: allowed are problems with one path");
}

void require_planner_of(const std::string& kind, const SearchOptions& search) {
  const PlannerKind planner = search.plan_options().planner;
  if (planner == PlannerKind::kEager || planner == PlannerKind::kEagerDp)
    throw InputError("--planner: " + search.planner + " is not supported for " + kind +
                     ": allowed are lazy, parallel");
}

Job chosen_job(Job job, const LatticeOptions& lattice, const EpisodeChoice& episode) {
  job = episode.apply(job);
  for (Stroke& stroke : job.strokes) lattice.apply(stroke);
  return job;
}

}  // namespace swivel::cli
