// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "swivel/core/motion/time_path.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/results/result.hpp"

namespace swivel::cli {

/// How fast, and how a motion is written: the same words for `time` and `plan`.
struct MotionOptions {
  std::optional<double> speed, turn_speed;
  std::optional<double> rate, chord;
  void add_to(CLI::App& command);
  /// What is asked for where --speed is given; the others are bad input without it.
  [[nodiscard]] std::optional<TimingOptions> asked_timing(const Problem& problem) const;
  /// The problem's tool speeds where none are given. Throws InputError where there is no speed.
  [[nodiscard]] TimingOptions timing(const Problem& problem) const;
};

/// Throws InputError where io::motion_text() knows no format of that name; nothing is said of an
/// empty name.
void require_motion_format(const std::string& file);

/// What became of a plan's path, in a line each, on standard output; warnings on standard error.
void print_plan_extras(const io::PlanExtras& extras, const io::JointNames& joint_names);

/// What is worth knowing of a motion, on standard output; warnings on standard error.
void print_motion(const TimedPath& motion, const io::JointNames& joint_names);

}  // namespace swivel::cli
