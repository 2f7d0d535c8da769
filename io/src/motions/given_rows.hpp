// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "motions/trajectory_formats.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Returns both arms of a workcell as files of their trajectories name their columns: joints by
/// their own names, what else there is after its arm, such as s_left. `names` and `joints` are
/// those of both arms.
[[nodiscard]] std::vector<ArmColumns> arms_of_workcell(const std::array<std::string, 2>& names,
                                                       const std::array<JointNames, 2>& joints);
/// Returns the columns of the trajectories of a workcell as they are written: for each arm s, phi
/// and branch, then the joints of both.
[[nodiscard]] std::vector<std::string> workcell_columns(const std::vector<ArmColumns>& arms);
/// Loads the rows of a motion that is given for arm `arm` of a workcell: its joints, rad, from a
/// trajectory without times that load_trajectory_file() reads, or from the trajectories of both
/// arms. What else the file says of a row follows from the joints, and is not read. `six_joints`:
/// the arm's last joint is the roll of its tool, which the file may leave out: it is 0 then. Throws
/// InputError.
[[nodiscard]] std::vector<Config> load_given_rows(const std::filesystem::path& file,
                                                  std::size_t arm, bool six_joints,
                                                  const std::array<std::string, 2>& names,
                                                  const std::array<JointNames, 2>& joints);

}  // namespace swivel::io
