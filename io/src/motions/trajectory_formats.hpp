// SPDX-License-Identifier: BSD-3-Clause
// Reads the rows of one arm, of a job or of two arms from any format that has them.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/core/answer/given_answer.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// An arm whose rows are sought in a file.
struct ArmColumns {
  JointNames joints;
  /// Stands behind the names of columns that are no joints, such as "_left" in "s_left"; empty
  /// where the file is of one arm.
  std::string suffix = {};
  /// Returns the name that joint j has in files: the roll of an arm of six joints has the suffix.
  [[nodiscard]] std::string name(std::size_t j) const;
};

/// What a file is to be about.
struct Sought {
  std::vector<ArmColumns> arms;  ///< one, or the two of a workcell
  bool job = false;              ///< rows are those of strokes and transitions of a job
};

/// What the file of a job says of a row besides the joints.
struct RowOfJob {
  std::string stroke;    ///< name of the stroke to which the row belongs; empty in transitions
  bool process = false;  ///< whether the tool's process is on
  bool placed = false;   ///< whether the row states a place on a stroke
};

/// The rows of a file.
struct FileRows {
  std::string file;                  ///< its name
  std::vector<TrajectoryFile> arms;  ///< of each arm that is sought; rows of one number are of one
                                     ///< moment
  std::vector<int> lines = {};       ///< of the rows of a table, from 1; empty for other formats
  std::vector<RowOfJob> job = {};    ///< of each row of a job's table; empty for other formats
  /// Events that switch the process of a job, as a JointTrajectory message or an MCAP log states
  /// them; unset if the file states none or is not of a job.
  std::optional<std::vector<nlohmann::json>> events = {};
  /// Returns the place of a row for messages: the file with the line and the number of the row.
  [[nodiscard]] std::string where(std::size_t row) const;
};

/// Reads the rows of a file, whose contents tell its format. Throws InputError, one line with the
/// file and its line, row, point or message.
[[nodiscard]] FileRows read_rows(const std::filesystem::path& file, const Sought& sought);
/// Reads rows from the text of a file. Throws InputError, one line with `file` and its line, row,
/// point or message.
[[nodiscard]] FileRows read_rows(const std::string& file, const std::string& text,
                                 const Sought& sought);

/// Reads ROS 2's trajectory_msgs/msg/JointTrajectory in JSON, as Swivel writes it. Throws
/// InputError, one line with `file` and the key.
[[nodiscard]] FileRows read_joint_trajectory_json(const std::string& file, std::string_view text,
                                                  const Sought& sought);
/// Reads ROS 2's trajectory_msgs/msg/JointTrajectory in YAML, as `ros2 topic echo` and Swivel write
/// it. Throws InputError, one line with `file` and the key.
[[nodiscard]] FileRows read_joint_trajectory_yaml(const std::string& file, const std::string& text,
                                                  const Sought& sought);

/// Reads an MCAP log with one topic of ROS 2's sensor_msgs/msg/JointState in CDR, in uncompressed
/// chunks or in none. Rows are its messages, their times those of `header.stamp` since the first.
/// Throws InputError, one line with `file` and the message.
[[nodiscard]] FileRows read_mcap(const std::string& file, std::string_view text,
                                 const Sought& sought);

/// Returns what a file states about an arm that runs its only stroke and nothing else.
[[nodiscard]] GivenArm given_arm(TrajectoryFile read);

}  // namespace swivel::io
