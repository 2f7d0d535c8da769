// SPDX-License-Identifier: BSD-3-Clause
// Problems and robots with changed numbers and lines: what the readers take is planned, coarsely
// and for a tenth of a second, and must end with an answer, a time-out, or an InputError.
// SWIVEL_TEST_TRIALS over 10 inputs (200 unless given).
#include <gtest/gtest.h>

#include "robots.hpp"
#include "seed.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "trial.hpp"

namespace swivel::test {
namespace {

void plan_coarsely(PathProblem problem) {
  double length = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    length += (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
  problem.resolution = {std::max(0.05, length / 100), 0.5, 0.5};
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.timeout_s = 0.1;
  (void)plan(problem, options);
}

TEST(Fuzz, WhatIsReadCanBePlanned) {
  const TempFolder folder;
  prepare(folder);
  const auto plan_problem = [&](const std::string& text) {
    plan_coarsely(io::load_path_problem(folder.write("problems/p.yaml", text)));
  };
  const auto plan_robot = [&](const std::string& text) {
    PathProblem problem = io::load_path_problem(folder.path() / "problems" / "good.yaml");
    problem.model = io::load_robot(folder.write("robot.urdf", text));
    plan_coarsely(problem);
  };
  fuzz("Fuzz planned",
       {{"problem",
         {kProblem, data("problems/experiment_a_start.yaml"), data("problems/experiment_b.yaml")},
         kYamlWords,
         plan_problem},
        {"urdf", {data("robots/iiwa14.urdf")}, kXmlWords, plan_robot}},
       trials(2000) / 10, true);
}

}  // namespace
}  // namespace swivel::test
