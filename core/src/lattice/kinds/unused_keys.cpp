// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/unused_keys.hpp"

#include <algorithm>

namespace swivel {

namespace {

/// Returns whether a task has another value than the default at a key.
bool is_given(const UnusedKey& key, const Task& task) {
  static const Resolution resolution;
  static const Limits limits;
  if (key.key == "dphi") return task.resolution.dphi != resolution.dphi;
  if (key.key == "arcs") return task.resolution.arcs != resolution.arcs;
  if (key.key == "arc") return task.resolution.arc.has_value();
  if (key.key == "droll") return task.resolution.droll != resolution.droll;
  if (key.key == "knot") return task.resolution.knot.value_or(0) > 0;
  if (key.key == "roll_slope") return task.limits.roll_slope != limits.roll_slope;
  return false;  // limits.arm_slope and limits.step_error, which the lattice refuses
}

}  // namespace

std::vector<UnusedKey> unused_keys(const Chain& chain, const ArmClass& arm) {
  const char* const no_angle = "the arm has no arm angle, since it is not S-R-S";
  std::vector<UnusedKey> keys;
  if (!arm.srs)
    keys = {{"resolution", "dphi", no_angle},
            {"resolution", "arcs", no_angle},
            {"limits", "arm_slope", no_angle},
            {"limits", "step_error", no_angle}};
  else
    keys = {{"resolution", "arc", "the arm is S-R-S, and `dphi` divides its self-motion"}};
  if (chain.roll_fixed)
    keys.push_back({"resolution", "knot",
                    "the arm has six joints and a tool that may not turn: nothing to spare"});
  const char* const no_roll = "no roll of an arm of seven joints is free";
  if (chain.free_roll)
    keys.push_back({"resolution", "arcs",
                    "nodes of an arm of seven joints with a free roll stand "
                    "at angles of the grid alone"});
  else
    keys.push_back({"resolution", "droll", no_roll});
  if (!chain.tool_may_turn()) keys.push_back({"limits", "roll_slope", "no roll is free"});
  return keys;
}

std::vector<UnusedKey> unused_knot(const char* what) {
  return {{"resolution", "knot", std::string(what) + " have nodes at every layer of the path"}};
}

std::vector<UnusedKey> unused_by_both(const std::vector<UnusedKey>& one,
                                      const std::vector<UnusedKey>& other) {
  std::vector<UnusedKey> both;
  for (const UnusedKey& key : one)
    if (std::any_of(other.begin(), other.end(), [&](const UnusedKey& any) {
          return any.section == key.section && any.key == key.key;
        }))
      both.push_back(key);
  return both;
}

std::vector<std::string> unused_key_warnings(const std::vector<UnusedKey>& keys, const Task& task) {
  std::vector<std::string> warnings;
  for (const UnusedKey& key : keys)
    if (is_given(key, task))
      warnings.push_back(key.section + "." + key.key + " is given in vain: " + key.why);
  return warnings;
}

}  // namespace swivel
