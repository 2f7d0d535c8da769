// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/report/page.hpp"

namespace swivel {

/// A job that was planned, and what became of it.
struct PlannedJob {
  const PreparedRobot& robot;
  const Problem& job;
  const Answer& result;
  const ProblemView& view;
  std::span<const RunMap> maps;       ///< those of make_maps() of the view
  const ArmMotion* motion = nullptr;  ///< null where the job was not timed or has no motion
};

/// Returns one HTML file that needs nothing else: the arm among the scene in three dimensions,
/// strokes and transitions in the order in which they are executed, the (s, phi) map of each
/// stroke, plots, tables. `result_json`: the result in the format of `--json`. The file is made
/// after planning: clearances along the strokes are asked for again. page_available() says whether
/// this build can make the file. Throws Stopped.
[[nodiscard]] std::string to_job_page(const PlannedJob& planned, const std::string& result_json,
                                      const Budget& budget = {}, const PageWords& words = {});

}  // namespace swivel
