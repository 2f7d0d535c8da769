// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/problem/problem.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/planner/job/time_job.hpp"

namespace swivel::cli {

/// What `swivel time` is asked to do with a job.
struct JobTimeRequest {
  Problem job{};
  JobTimingOptions timing{};
  std::string trajectory{};
  std::vector<std::string> out{};  ///< names of files; maybe none
  bool quiet = false, check = true;
};

/// Makes the trajectory of a job, or its motion, a motion in time, writes it, and prints its main
/// figures. `noted` has the files that were read before, which the motion may not replace; it ends
/// once all are read. Returns the exit code. Throws InputError.
int time_job_file(const JobTimeRequest& request, std::optional<io::InputFiles>& noted);

}  // namespace swivel::cli
