// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "seed.hpp"

namespace swivel::test {

/// Breaks files the way that transfers, editors and attackers do. A seed gives the same bytes
/// on every machine.
class Mutator {
 public:
  /// `seeds`: good files of one format; `words`: pieces of its syntax.
  /// `mild`: numbers and lines alone, so that most files can still be read.
  Mutator(std::vector<std::string> seeds, std::vector<std::string> words, bool mild)
      : seeds_(std::move(seeds)), words_(std::move(words)), mild_(mild) {}

  /// Returns one of the good files with one to three changes, drawn by `seed_value`.
  [[nodiscard]] std::string input(std::uint64_t seed_value) const;
  /// Returns the text with one to three changes, drawn by `seed_value`.
  [[nodiscard]] std::string changed(std::string text, std::uint64_t seed_value) const;

 private:
  void change_some(std::string& text, Random& random) const;
  void change(std::string& text, Random& random) const;

  std::vector<std::string> seeds_, words_;
  bool mild_;
};

}  // namespace swivel::test
