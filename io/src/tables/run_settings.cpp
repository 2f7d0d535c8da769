// SPDX-License-Identifier: BSD-3-Clause
#include "tables/run_settings.hpp"

#include <algorithm>

namespace swivel::io {

namespace {

using Json = nlohmann::ordered_json;

template <class Value>
const Value* find(const std::vector<std::pair<std::string, Value>>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.first == name; });
  return found == all.end() ? nullptr : &found->second;
}

}  // namespace

Json to_json(const RunSettings& settings) {
  Json json = {{"settings", Json::object()}, {"files", Json::object()}};
  for (const auto& [name, value] : settings.values) json["settings"][name] = value;
  for (const auto& [name, hash] : settings.files) json["files"][name] = hash;
  return json;
}

std::optional<RunSettings> settings_from(const Json& json) {
  const auto object = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_object();
  };
  if (!object("settings") || !object("files")) return std::nullopt;
  RunSettings settings;
  for (const auto& [name, value] : json["settings"].items()) {
    if (!value.is_string()) return std::nullopt;
    settings.values.emplace_back(name, value.get<std::string>());
  }
  for (const auto& [name, hash] : json["files"].items()) {
    if (!hash.is_number_unsigned()) return std::nullopt;
    settings.files.emplace_back(name, hash.get<std::uint64_t>());
  }
  return settings;
}

Json held_json(const std::vector<HeldJoint>& held) {
  Json list = Json::array();
  for (const HeldJoint& joint : held)
    list.push_back({{"joint", joint.name},
                    {"position", joint.position},
                    {"unit", joint.slides ? "m" : "rad"},
                    {"given", joint.given},
                    {"mimics", joint.leader.empty() ? Json(nullptr) : Json(joint.leader)}});
  return list;
}

std::optional<std::vector<HeldJoint>> held_from(const Json& json) {
  if (!json.is_array()) return std::nullopt;
  std::vector<HeldJoint> held;
  for (const Json& one : json) {
    const auto is = [&](const char* key, auto type) {
      return one.contains(key) && (one[key].*type)();
    };
    if (!one.is_object() || !is("joint", &Json::is_string) || !is("position", &Json::is_number) ||
        !is("unit", &Json::is_string) || !is("given", &Json::is_boolean) ||
        !one.contains("mimics") || !(one["mimics"].is_null() || one["mimics"].is_string()))
      return std::nullopt;
    held.push_back({one["joint"].get<std::string>(), one["position"].get<double>(),
                    one["unit"].get<std::string>() == "m", one["given"].get<bool>(),
                    one["mimics"].is_null() ? "" : one["mimics"].get<std::string>()});
  }
  return held;
}

std::optional<Difference> difference(const RunSettings& first, const RunSettings& second) {
  for (const auto& [name, value] : second.values) {
    const std::string* const other = find(first.values, name);
    if (other == nullptr) return Difference{name, false, {}, value};
    if (*other != value) return Difference{name, false, *other, value};
  }
  for (const auto& [name, hash] : second.files) {
    const std::uint64_t* const other = find(first.files, name);
    if (other == nullptr) return Difference{name, true, {}, ""};
    if (*other != hash) return Difference{name, true, {}, {}};
  }
  if (first.coordinates != second.coordinates) return Difference{"what varies", true, {}, {}};
  for (const auto& [name, value] : first.values)
    if (find(second.values, name) == nullptr) return Difference{name, false, value, {}};
  for (const auto& [name, hash] : first.files)
    if (find(second.files, name) == nullptr) return Difference{name, true, "", {}};
  return std::nullopt;
}

}  // namespace swivel::io
