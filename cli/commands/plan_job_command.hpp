// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/problem/problem.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel::cli {

/// What `swivel plan` is asked to do with a job.
struct JobRequest {
  Problem job{};
  PlanOptions options{};
  std::optional<JobTimingOptions> timing{};  ///< set: the job is timed
  std::optional<double> advise_s{};          ///< s, time for all trials of --advise
  std::string which{};                       ///< of the jobs that one file describes, for the page
  bool report = false;                       ///< --report asks for a page
  bool quiet = false;
  double load_ms = 0;  ///< time that loading took
};

/// Plans a job, writes its trajectory or motion and its result, and prints the answer. `outputs`
/// has --out, --report, --certificate and --json. Returns the exit code. Throws InputError.
int plan_job_file(JobRequest request, io::OutputFiles& outputs);

}  // namespace swivel::cli
