// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// How the roll of an arm of six joints is named in a table of two arms.
enum class RollColumns {
  kOfArms,  ///< after its arm, such as roll_left
  kPlain,   ///< roll, even twice, as Swivel 1.0 wrote it
};
/// Returns the columns of the trajectories of a workcell: for each arm s, phi and branch, named
/// after it, then the joints of both. `names` and `joint_names` are those of both arms.
[[nodiscard]] std::vector<std::string> workcell_columns(const std::array<std::string, 2>& names,
                                                        const std::array<JointNames, 2>& joints,
                                                        RollColumns rolls = RollColumns::kOfArms);
/// Returns true if an arm has a roll, whose column earlier files name otherwise.
[[nodiscard]] bool have_roll(const std::array<JointNames, 2>& joints);
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
