// SPDX-License-Identifier: BSD-3-Clause
// Finds keys of a problem that the lattice of its arm does not read, so that they would be given in
// vain.
#pragma once
#include <string>
#include <vector>

#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// A key of a problem that no lattice of an arm reads.
struct UnusedKey {
  std::string section, key;  ///< such as "resolution" and "dphi"
  std::string why;           ///< such as "the arm has no arm angle, since it is not S-R-S"
};

/// Returns the keys of `resolution` and `limits` that no lattice of the arm reads: those of the arm
/// angle where it has none, that of self-motion where it has one, and those of a roll that is not
/// free.
[[nodiscard]] std::vector<UnusedKey> unused_keys(const Chain& chain, const ArmClass& arm);
/// Returns `resolution.knot` where the lattice of a path, a stroke or an arm of two has nodes at
/// every layer all the same. `what` names those of which it is one.
[[nodiscard]] std::vector<UnusedKey> unused_knot(const char* what);
/// Returns the keys that are in both lists.
[[nodiscard]] std::vector<UnusedKey> unused_by_both(const std::vector<UnusedKey>& one,
                                                    const std::vector<UnusedKey>& other);
/// Returns one warning for each of the keys whose value in the task is not the default.
[[nodiscard]] std::vector<std::string> unused_key_warnings(const std::vector<UnusedKey>& keys,
                                                           const Task& task);

}  // namespace swivel
