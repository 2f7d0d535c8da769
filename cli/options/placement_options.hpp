// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel::cli {

/// The options that say what is moved and by how much: those of `place`, and of the commands that
/// take one placement.
struct PlacementOptions {
  std::string object;
  bool path = false, base = false;
  std::array<std::string, 6> coordinates;  ///< values of kCoordinates, as given

  /// Adds the options to a command. `values` completes "--x: ..." in the help.
  void add_to(CLI::App& command, const std::string& values);
  /// Returns what is to be moved. Throws InputError unless exactly one thing is named and the
  /// problem has it.
  [[nodiscard]] Movable thing(const Problem& problem) const;
  /// Lists the coordinates that are given, in the order of kCoordinates: FROM:TO:STEP, FROM:TO
  /// (count 0) or a number (count 1). Throws InputError.
  [[nodiscard]] std::vector<PlacementAxis> axes() const;
  /// Returns the problem with one thing moved by one number for each given coordinate; the problem
  /// itself if nothing is named. Throws InputError.
  [[nodiscard]] Problem apply(const Problem& problem) const;
  /// Returns the words of a command line that ask for one placement, with a space before each.
  [[nodiscard]] std::string words(const Offset& offset) const;
};

}  // namespace swivel::cli
