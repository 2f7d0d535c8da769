// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"

namespace swivel {

/// One change of a job that cannot be planned, and what planning the changed job gave.
struct JobAdvice {
  enum class Change {
    kWithoutStrokes,  ///< some strokes left out
    kReversed,        ///< a stroke run from its last waypoint to its first
    kBestOrder,       ///< order: best
    kHome,            ///< another home
    kApproach,        ///< a longer approach of a stroke, against the tool's z axis
    kRetract,         ///< a longer retract of a stroke, against the tool's z axis
    kLines,           ///< longer approaches and retracts of all strokes
  };
  Change change = Change::kWithoutStrokes;
  std::vector<std::string> strokes;  ///< names; of kHome, kBestOrder and kLines none
  std::optional<double> length;      ///< of kApproach, kRetract and kLines, m
  std::optional<Config> home;        ///< of kHome, rad; none where no home was found to try
  /// kSolved: there is a job; kNoHelp: there is none; kUnknown: not decided in time, or not tried.
  Advice::Outcome outcome = Advice::Outcome::kUnknown;
  std::optional<double> cost;  ///< of kSolved
};

/// What would help a stroke of a job by itself, which has no path.
struct StrokeAdvice {
  std::string stroke;
  std::vector<Advice> advice;
};

/// What would help a job that cannot be planned.
struct AdviceOnJob {
  std::vector<JobAdvice> job;
  std::vector<StrokeAdvice> strokes;
};

/// Returns the name of a change in files: "without_strokes", "reversed", "best_order", "home",
/// "approach", "retract", "lines".
[[nodiscard]] const char* to_string(JobAdvice::Change change);
/// Returns the change in a phrase: "stroke 'ring' left out", "a retract of 50 mm behind stroke
/// 'ring'".
[[nodiscard]] std::string words(const JobAdvice& advice);
/// Returns the advice for the terminal, a line for each change.
[[nodiscard]] std::string advice_text(const AdviceOnJob& advice);

}  // namespace swivel
