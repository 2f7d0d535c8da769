// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/results/given_answer.hpp"

#include "jobs/job_rows.hpp"
#include "motions/trajectory_formats.hpp"
#include "workcells/workcell_csv.hpp"

namespace swivel::io {

GivenAnswer load_answer(const std::filesystem::path& file, const Problem& problem,
                        const std::vector<JointNames>& joint_names) {
  if (problem.arms.size() == 2)
    return load_two_arms(file, problem, {joint_names.at(0), joint_names.at(1)});
  if (!is_path(problem)) return load_strokes(file, problem, joint_names.front());
  return {problem, {given_arm(load_trajectory_file(file, joint_names.front()))}};
}

}  // namespace swivel::io
