// SPDX-License-Identifier: BSD-3-Clause
#include "options/job_options.hpp"

#include <algorithm>

#include "swivel/core/messages/input_error.hpp"

namespace swivel::cli {

void refuse_options_of_jobs(const std::string& job_file,
                            const std::vector<std::pair<bool, const char*>>& options) {
  for (const auto& [given, name] : options)
    if (given)
      throw InputError(std::string(name) + ": is not supported yet for jobs, as " + job_file +
                       " is one: allowed are problems with one path");
}

Job chosen_job(Job job, const LatticeOptions& lattice, const EpisodeChoice& episode) {
  const PlacementOptions& placement = episode.placement;
  const bool placed = !placement.object.empty() || placement.path || placement.base ||
                      std::any_of(placement.coordinates.begin(), placement.coordinates.end(),
                                  [](const std::string& value) { return !value.empty(); });
  refuse_options_of_jobs(job.source, {{placed, "--object, --path, --base"}});
  job.scene = episode.apply(problem_of_run(job, {})).scene;
  for (Stroke& stroke : job.strokes) lattice.apply(stroke);
  return job;
}

}  // namespace swivel::cli
