// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/problem/prepared_problem.hpp"

#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

namespace {

std::variant<PreparedRobot, PreparedWorkcell> prepare(const Problem& problem,
                                                      const Budget& budget) {
  if (problem.arms.size() == 2) return PreparedWorkcell(problem, budget);
  return PreparedRobot(problem_of_run(problem, {0, false}), budget);
}

}  // namespace

PreparedProblem::PreparedProblem(const Problem& problem, const Budget& budget)
    : prepared_(prepare(problem, budget)) {}

std::vector<std::array<std::string, kDof>> PreparedProblem::joint_names() const {
  std::vector<std::array<std::string, kDof>> names;
  for (std::size_t arm = 0; arm < arms(); ++arm) names.push_back(joint_names(arm));
  return names;
}

const std::array<std::string, kDof>& PreparedProblem::joint_names(std::size_t arm) const {
  return robot(arm).arm().chain.joint_names;
}

}  // namespace swivel
