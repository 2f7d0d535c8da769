// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/problem/workcell.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel::cli {

/// What `swivel plan` is asked to do with a workcell.
struct WorkcellRequest {
  Workcell cell{};
  PlanOptions options{};
  bool report = false;  ///< whether the page of --report is made
  bool quiet = false;
  double load_ms = 0;  ///< time that loading took
};

/// Plans a workcell, writes its trajectories and its result, and prints the answer. `outputs` has
/// --out, --report and --json. Returns the exit code. Throws InputError.
int plan_workcell_file(WorkcellRequest request, io::OutputFiles& outputs);

/// Checks the trajectories of a workcell that a CSV file has, and prints the verdict. Returns the
/// exit code. Throws InputError.
int check_workcell_file(const Workcell& cell, const std::string& trajectory);

}  // namespace swivel::cli
