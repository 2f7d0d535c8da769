// SPDX-License-Identifier: BSD-3-Clause
#include "jobs/job_rows.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/results/result.hpp"
#include "workcells/workcell_csv.hpp"

namespace swivel::io {

std::string motion_text(const Answer& answer, const Problem& problem,
                        const std::filesystem::path& file) {
  const Motion& motion = *answer.timed();
  const std::string& frame_id = problem.arm().base_link;
  if (answer.arms.size() == 2)
    return workcell_motion_text(motion, joint_names_of_arms(answer), frame_id, file);
  const JointNames& names = answer.arm().joint_names;
  if (!is_path(problem))
    return job_motion_text(motion.arms.front(), problem, names, frame_id, file);
  return motion_text(motion.arms.front(), names, frame_id, file);
}

}  // namespace swivel::io
