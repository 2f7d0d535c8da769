// SPDX-License-Identifier: BSD-3-Clause
#include "jobs/job_rows.hpp"
#include "motions/messages.hpp"

namespace swivel::io {

std::string job_motion_text(const ArmMotion& motion, const Problem& job,
                            const JointNames& joint_names, const std::string& frame_id,
                            const std::filesystem::path& file) {
  require_motion_format(file);
  const std::string format = file.extension().string();
  if (format == ".csv") return to_job_motion_csv(motion, job, joint_names);
  const std::vector<EventMessage> events = event_messages(motion, job);
  const MotionMessages messages{motion.rows, motion.roll, joint_names, frame_id, &events};
  if (format == ".json") return trajectory_json(messages);
  if (format == ".yaml") return trajectory_yaml(messages);
  return mcap_log(messages);
}

}  // namespace swivel::io
