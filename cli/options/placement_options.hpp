// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel::cli {

/// The options that say what is moved and by how much: those of `place`, and of the commands that
/// take one placement.
struct PlacementOptions {
  std::string object, arm;
  bool path = false, base = false;
  std::array<std::string, 6> coordinates;  ///< values of kCoordinates, as given
  std::vector<std::string> hold;           ///< JOINT=VALUES, as given
  std::set<std::string> slides;            ///< which of these joints are prismatic

  /// Adds the options to a command. `values` completes "--x: ..." in the help.
  void add_to(CLI::App& command, const std::string& values);
  /// Returns what is to be moved: nothing where joints alone are held elsewhere. Throws InputError
  /// unless otherwise exactly one thing is named and the scene has it. `source`: the problem file,
  /// for messages.
  [[nodiscard]] Movable thing(const Robot& robot, const std::vector<SceneObject>& scene,
                              const std::string& source) const;
  /// Lists the joints that are given, then the coordinates in the order of kCoordinates:
  /// FROM:TO:STEP, FROM:TO (count 0) or a number (count 1). Throws InputError.
  [[nodiscard]] std::vector<PlacementAxis> axes() const;
  /// Returns the problem with joints held, and one thing moved, by one number for each joint and
  /// coordinate that is given; itself if nothing is named. Throws InputError.
  [[nodiscard]] Problem apply(const Problem& problem) const;
  /// Returns true if a thing or a coordinate is named.
  [[nodiscard]] bool given() const { return any(); }
  /// Returns the words of a command line that ask for one placement, with a space before each.
  [[nodiscard]] std::string words(const Offset& offset, const HeldPositions& held) const;

 private:
  /// Returns true if a thing or a coordinate is named.
  [[nodiscard]] bool any() const;
  /// Returns the placement that has one number for each joint and coordinate given. Throws
  /// InputError.
  [[nodiscard]] Placement one_placement() const;
};

}  // namespace swivel::cli
