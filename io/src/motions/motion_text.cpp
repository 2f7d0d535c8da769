// SPDX-License-Identifier: BSD-3-Clause
#include "files/bad_input.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

void require_motion_format(const std::filesystem::path& file) {
  for (const char* known : {".csv", ".json", ".yaml", ".mcap"})
    if (file.extension() == known) return;
  bad_input(file.string(), "unknown format", "names that end in .csv, .json, .yaml or .mcap");
}

std::string motion_text(const TimedPath& motion, const JointNames& joint_names,
                        const std::string& frame_id, const std::filesystem::path& file) {
  require_motion_format(file);
  const std::string format = file.extension().string();
  if (format == ".json") return to_trajectory_json(motion, joint_names, frame_id);
  if (format == ".yaml") return to_trajectory_yaml(motion, joint_names, frame_id);
  if (format == ".mcap") return to_mcap(motion, joint_names, frame_id);
  return to_timed_csv(motion, joint_names);
}

}  // namespace swivel::io
