// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel::cli {

/// What is moved and by how much, the same words for `place` and for the commands that take one
/// placement.
struct PlacementOptions {
  std::string object;
  bool path = false, base = false;
  std::array<std::string, 6> coordinates;  ///< of kCoordinates, as given

  /// `values` completes "--x: ..." in the help.
  void add_to(CLI::App& command, const std::string& values);
  /// Throws InputError unless exactly one thing is named, and it is one of the problem's.
  [[nodiscard]] Movable thing(const Problem& problem) const;
  /// Those that are given, in the order of kCoordinates: FROM:TO:STEP, FROM:TO (count 0) or a
  /// number (count 1). Throws InputError.
  [[nodiscard]] std::vector<PlacementAxis> axes() const;
  /// The problem with one thing moved by one number a coordinate; as it is where nothing is named.
  [[nodiscard]] Problem apply(const Problem& problem) const;
  /// The words that ask for this one placement, with a space before each.
  [[nodiscard]] std::string words(const Offset& offset) const;
};

}  // namespace swivel::cli
