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

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& what, const std::string& allowed) {
  throw InputError("--" + option + ": '" + text + "'" + what + ": allowed is " + allowed);
}

constexpr const char* kValues =
    "a number, or FROM:TO:STEP with FROM <= TO and STEP > 0, numbers from -1000 to 1000";

double number(const std::string& option, const std::string& text, const std::string& word) {
  double value = 0;
  const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kMostMetres))
    refuse(option, text, "", kValues);
  return value + 0.0;  // turns -0 into 0
}

/// Returns the axis with the values of a text, of x or of a joint: its coordinate is not set.
PlacementAxis axis_from(const std::string& option, const std::string& joint,
                        const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text)
    if (c == ':')
      words.emplace_back();
    else
      words.back() += c;
  if (words.size() > 3) refuse(option, text, "", kValues);
  PlacementAxis axis;
  axis.joint = joint;
  axis.from = axis.to = number(option, text, words[0]);
  if (words.size() == 1) return axis;
  axis.to = number(option, text, words[1]);
  if (axis.from > axis.to) refuse(option, text, "", kValues);
  axis.count = 0;
  if (words.size() == 2) return axis;
  axis.step = number(option, text, words[2]);
  if (!(axis.step > 0)) refuse(option, text, "", kValues);
  try {
    axis.count = placement_axis(0, axis.from, axis.to, axis.step).count;
  } catch (const InvalidArgument&) {
    refuse(option, text, " has too many values", "a larger STEP");
  }
  return axis;
}

/// Returns the axis of JOINT=VALUES.
PlacementAxis held_axis_from(const std::string& given) {
  const std::size_t equals = given.rfind('=');
  if (equals == std::string::npos || equals == 0)
    refuse("hold", given, "", "JOINT=VALUE, or JOINT=FROM:TO:STEP");
  return axis_from("hold", given.substr(0, equals), given.substr(equals + 1));
}

/// Returns the problem with joints held. Throws InputError.
Problem held_as(Problem problem, const HeldPositions& positions) {
  try {
    hold_joints(problem, positions);
  } catch (const InvalidArgument& error) {
    throw InputError(std::string("--hold: ") + error.what());
  }
  return problem;
}

/// Returns what `place` makes. Throws InputError in the name of an option.
template <class Place>
auto in_the_name_of_options(const Place& place) {
  try {
    return place();
  } catch (const InvalidArgument& error) {
    throw InputError(std::string("--") + error.what());
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
  command.add_option("--arm", arm, "with --path, in a workcell: move the path of this arm alone")
      ->group(group);
  command.add_flag("--base", base, "move the robot")->group(group);
  command
      .add_option("--hold", hold,
                  "JOINT=VALUE: hold a joint that is not planned elsewhere, rad or m" + values)
      ->allow_extra_args(false)
      ->group(group);
  for (std::size_t k = 0; k < kCoordinates.size(); ++k)
    command
        .add_option(std::string("--") + kCoordinates[k], coordinates[k],
                    (k < 3 ? "along the base frame's axis, m"
                           : "about the base frame's axis, through the thing's own origin, rad") +
                        values)
        ->group(group);
}

Movable PlacementOptions::thing(const Robot& robot, const std::vector<SceneObject>& scene,
                                const std::string& source) const {
  if (!arm.empty() && !path)
    throw InputError("--arm: '" + arm + "': allowed with --path, of which it says whose it is");
  const bool moves = std::any_of(coordinates.begin(), coordinates.end(),
                                 [](const std::string& given) { return !given.empty(); });
  if (!hold.empty() && !moves && object.empty() && !path && !base)
    return {Movable::Kind::kNothing, ""};
  if (static_cast<int>(!object.empty()) + static_cast<int>(path) + static_cast<int>(base) != 1)
    throw InputError("--object, --path, --base: what is to be moved is " +
                     std::string(object.empty() && !path && !base ? "not said" : "said twice") +
                     ": allowed is exactly one of them");
  if (path) return {Movable::Kind::kPath, "", arm};
  if (base) return {Movable::Kind::kBase, ""};
  for (const AttachedBody& body : robot.attached)
    if (body.name == object)
      throw InputError("--object: '" + object + "' is fixed to link '" + body.link +
                       "' and moves with it alone: allowed are objects of the scene of " + source +
                       " in the frame of '" + robot.base_link + "'");
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
  for (const std::string& given : hold) {
    PlacementAxis axis = held_axis_from(given);
    axis.slides = slides.contains(axis.joint);
    if (std::any_of(axes.begin(), axes.end(),
                    [&](const PlacementAxis& other) { return other.joint == axis.joint; }))
      refuse("hold", given, " names a joint again", "each joint once");
    axes.push_back(std::move(axis));
  }
  for (std::size_t k = 0; k < coordinates.size(); ++k)
    if (!coordinates[k].empty()) {
      axes.push_back(axis_from(kCoordinates[k], "", coordinates[k]));
      axes.back().coordinate = static_cast<int>(k);
    }
  return axes;
}

bool PlacementOptions::any() const {
  return !axes().empty() || !object.empty() || !arm.empty() || path || base;
}

Problem PlacementOptions::apply(const Problem& problem) const {
  if (!any()) return problem;
  const Movable what = thing(problem.arm(), problem.scene, problem.source);
  const Placement at = one_placement();
  return in_the_name_of_options(
      [&] { return placed_problem(held_as(problem, at.hold), what, at.offset); });
}

Placement PlacementOptions::one_placement() const {
  Placement placement;
  for (const PlacementAxis& axis : axes()) {
    if (axis.count != 1 || axis.step != 0)
      refuse(
          axis.joint.empty() ? axis.name() : "hold",
          axis.joint.empty() ? coordinates[static_cast<std::size_t>(axis.coordinate)] : axis.joint,
          "", "one number; swivel place takes FROM:TO:STEP");
    if (axis.joint.empty())
      placement.offset[static_cast<std::size_t>(axis.coordinate)] = axis.from;
    else
      placement.hold[axis.joint] = axis.from;
  }
  return placement;
}

std::string PlacementOptions::words(const Offset& offset, const HeldPositions& held) const {
  std::string words = path             ? " --path"
                      : base           ? " --base"
                      : object.empty() ? ""
                                       : " --object " + quoted(object);
  if (!arm.empty()) words += " --arm " + quoted(arm);
  for (const auto& [joint, position] : held)
    words += " --hold " + quoted(joint) + "=" + shortest(position);
  for (std::size_t k = 0; k < offset.size(); ++k)
    if (offset[k] != 0) words += std::string(" --") + kCoordinates[k] + " " + shortest(offset[k]);
  return words;
}

}  // namespace swivel::cli
