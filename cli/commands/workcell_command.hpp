// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel::cli {

/// What `swivel time` is asked to do with a workcell.
struct WorkcellTimeRequest {
  TimingOptions timing{};
  Problem cell{};
  std::string trajectory{};
  std::vector<std::string> out{};  ///< names of files; maybe none
  bool refine = false;             ///< --refine
  bool quiet = false, check = true;
};

/// Times the trajectories or the motion of a workcell that a file has, writes the motion and prints
/// its figures. `noted`: the files that were read. Returns the exit code. Throws InputError.
int time_workcell_file(const WorkcellTimeRequest& request, std::optional<io::InputFiles>& noted);

/// Returns limits whose tool speed is the lowest that an arm of a workcell has, for motions whose
/// speed the command line does not give.
[[nodiscard]] Limits limits_of_speeds(const Problem& cell);

/// Checks the trajectories or the motion of a workcell that a file has, and prints the verdict.
/// Returns the exit code. Throws InputError.
int check_workcell_file(const Problem& cell, const std::string& trajectory);

/// Verifies the certificate that a workcell has no plan, and prints the verdict. Returns the exit
/// code. Throws InputError.
int check_workcell_proof(const Problem& cell, const std::string& certificate);

}  // namespace swivel::cli
