// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "swivel/io/tables/campaign.hpp"

namespace swivel::io {

/// Begins the line of settings, behind which the command's name and JSON follow.
inline constexpr const char* kRunMark = "# swivel ";

/// The keys "settings" and "files".
[[nodiscard]] nlohmann::ordered_json to_json(const RunSettings& settings);
/// None where the two keys are not as to_json() writes them.
[[nodiscard]] std::optional<RunSettings> settings_from(const nlohmann::ordered_json& json);

/// The list that results have under "held".
[[nodiscard]] nlohmann::ordered_json held_json(const std::vector<HeldJoint>& held);
/// None where the list is not as held_json() writes it.
[[nodiscard]] std::optional<std::vector<HeldJoint>> held_from(const nlohmann::ordered_json& json);

/// The first thing that two settings do not share. `first` and `second`: what each says, none where
/// it does not say it. Both are none of a file whose contents differ.
struct Difference {
  std::string name;
  bool file = false;
  std::optional<std::string> first, second;
};
[[nodiscard]] std::optional<Difference> difference(const RunSettings& first,
                                                   const RunSettings& second);

}  // namespace swivel::io
