// SPDX-License-Identifier: BSD-3-Clause
#include "options/placement_options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "options/search_options.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::cli {

namespace {

[[noreturn]] void refuse(std::size_t coordinate, const std::string& text, const std::string& what,
                         const std::string& allowed) {
  throw InputError(std::string("--") + kCoordinates[coordinate] + ": '" + text + "'" + what +
                   ": allowed is " + allowed);
}

constexpr const char* kValues =
    "a number, or FROM:TO:STEP with FROM <= TO and STEP > 0, numbers from -1000 to 1000";

double number(std::size_t coordinate, const std::string& text, const std::string& word) {
  double value = 0;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kMostMetres))
    refuse(coordinate, text, "", kValues);
  return value + 0.0;  // turns -0 into 0
}

PlacementAxis axis_from(std::size_t coordinate, const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text)
    if (c == ':')
      words.emplace_back();
    else
      words.back() += c;
  if (words.size() > 3) refuse(coordinate, text, "", kValues);
  PlacementAxis axis;
  axis.coordinate = static_cast<int>(coordinate);
  axis.from = axis.to = number(coordinate, text, words[0]);
  if (words.size() == 1) return axis;
  axis.to = number(coordinate, text, words[1]);
  if (axis.from > axis.to) refuse(coordinate, text, "", kValues);
  axis.count = 0;
  if (words.size() == 2) return axis;
  axis.step = number(coordinate, text, words[2]);
  if (!(axis.step > 0)) refuse(coordinate, text, "", kValues);
  try {
    return placement_axis(axis.coordinate, axis.from, axis.to, axis.step);
  } catch (const InvalidArgument&) {
    refuse(coordinate, text, " has too many values", "a larger STEP");
  }
}

}  // namespace

void PlacementOptions::add_to(CLI::App& command, const std::string& values) {
  const char* const group = "Placement";
  command
      .add_option("--object", object,
                  "move this object of the scene, and the path where it is in its frame")
      ->group(group);
  command.add_flag("--path", path, "move the path alone")->group(group);
  command.add_flag("--base", base, "move the robot")->group(group);
  for (std::size_t k = 0; k < kCoordinates.size(); ++k)
    command
        .add_option(std::string("--") + kCoordinates[k], coordinates[k],
                    (k < 3 ? "along the base frame's axis, m"
                           : "about the base frame's axis, through the thing's own origin, rad") +
                        values)
        ->group(group);
}

Movable PlacementOptions::thing(const std::vector<SceneObject>& scene,
                                const std::string& source) const {
  if (static_cast<int>(!object.empty()) + static_cast<int>(path) + static_cast<int>(base) != 1)
    throw InputError("--object, --path, --base: what is to be moved is " +
                     std::string(object.empty() && !path && !base ? "not said" : "said twice") +
                     ": allowed is exactly one of them");
  if (path) return {Movable::Kind::kPath, ""};
  if (base) return {Movable::Kind::kBase, ""};
  std::vector<std::string> names;
  for (const SceneObject& known : scene) names.push_back(known.name);
  if (std::find(names.begin(), names.end(), object) == names.end())
    throw InputError("--object: unknown object '" + object + "'" +
                     (names.empty() ? "" : ", nearest is '" + nearest_name(object, names) + "'") +
                     ": allowed are objects of the scene of " + source);
  return {Movable::Kind::kObject, object};
}

std::vector<PlacementAxis> PlacementOptions::axes() const {
  std::vector<PlacementAxis> axes;
  for (std::size_t k = 0; k < coordinates.size(); ++k)
    if (!coordinates[k].empty()) axes.push_back(axis_from(k, coordinates[k]));
  return axes;
}

bool PlacementOptions::any() const {
  return !axes().empty() || !object.empty() || path || base;
}

Problem PlacementOptions::apply(const Problem& problem) const {
  if (!any()) return problem;
  const Movable what = thing(problem.scene, problem.source);
  return placed_problem(problem, what, one_offset());
}

Job PlacementOptions::apply(const Job& job) const {
  if (!any()) return job;
  const Movable what = thing(job.scene, job.source);
  return placed_job(job, what, one_offset());
}

Workcell PlacementOptions::apply(const Workcell& cell) const {
  if (!any()) return cell;
  const Movable what = thing(cell.scene, cell.source);
  const Offset offset = one_offset();
  try {
    return placed_workcell(cell, what, offset);
  } catch (const InvalidArgument& error) {
    throw InputError(std::string("--") + error.what());
  }
}

Offset PlacementOptions::one_offset() const {
  Offset offset{};
  for (const PlacementAxis& axis : axes()) {
    const auto k = static_cast<std::size_t>(axis.coordinate);
    if (axis.count != 1 || axis.step != 0)
      refuse(k, coordinates[k], "", "one number; swivel place takes FROM:TO:STEP");
    offset[k] = axis.from;
  }
  return offset;
}

std::string PlacementOptions::words(const Offset& offset) const {
  std::string words = path ? " --path" : base ? " --base" : " --object " + quoted(object);
  for (std::size_t k = 0; k < offset.size(); ++k)
    if (offset[k] != 0) words += std::string(" --") + kCoordinates[k] + " " + shortest(offset[k]);
  return words;
}

}  // namespace swivel::cli
