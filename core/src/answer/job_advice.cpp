// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// Returns names in quotation marks, separated by commas.
std::string quoted_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

std::string stroke_or_strokes(const std::vector<std::string>& names) {
  return (names.size() == 1 ? "stroke " : "strokes ") + quoted_names(names);
}

/// One change of several strokes, each planned by itself.
struct ChangeOfStrokes {
  Advice::Outcome outcome;
  std::string change;
  std::vector<std::string> strokes;
};

/// Returns what helps strokes by themselves, a line for each change with the strokes that it is
/// about, what helps most of them first.
std::string advice_on_strokes(const std::vector<StrokeAdvice>& advice) {
  std::vector<ChangeOfStrokes> changes;
  for (const StrokeAdvice& of : advice)
    for (const Advice& one : of.advice) {
      const auto known =
          std::find_if(changes.begin(), changes.end(), [&](const ChangeOfStrokes& other) {
            return other.outcome == one.outcome && other.change == words(one);
          });
      if (known != changes.end())
        known->strokes.push_back(of.stroke);
      else
        changes.push_back({one.outcome, words(one), {of.stroke}});
    }
  std::stable_sort(
      changes.begin(), changes.end(), [](const ChangeOfStrokes& a, const ChangeOfStrokes& b) {
        return a.outcome != b.outcome ? a.outcome < b.outcome : a.strokes.size() > b.strokes.size();
      });
  std::string lines = "  for strokes by themselves:\n";
  for (const ChangeOfStrokes& one : changes) {
    const char* const says = one.outcome == Advice::Outcome::kSolved    ? "  would help"
                             : one.outcome == Advice::Outcome::kFurther ? "  not enough"
                             : one.outcome == Advice::Outcome::kNoHelp  ? "  no help"
                                                                        : "  not tried in the time";
    lines += std::string(says) +
             (one.strokes.size() == advice.size() ? "" : " for " + stroke_or_strokes(one.strokes)) +
             ": " + one.change + '\n';
  }
  return lines;
}

}  // namespace

const char* to_string(JobAdvice::Change change) {
  switch (change) {
    case JobAdvice::Change::kWithoutStrokes:
      return "without_strokes";
    case JobAdvice::Change::kReversed:
      return "reversed";
    case JobAdvice::Change::kBestOrder:
      return "best_order";
    case JobAdvice::Change::kHome:
      return "home";
    case JobAdvice::Change::kApproach:
      return "approach";
    case JobAdvice::Change::kRetract:
      return "retract";
    case JobAdvice::Change::kLines:
      break;
  }
  return "lines";
}

std::string words(const JobAdvice& advice) {
  const std::string strokes = stroke_or_strokes(advice.strokes);
  switch (advice.change) {
    case JobAdvice::Change::kWithoutStrokes:
      return strokes + " left out";
    case JobAdvice::Change::kReversed:
      return strokes + " run backwards";
    case JobAdvice::Change::kBestOrder:
      return "order: best";
    case JobAdvice::Change::kApproach:
      return formatted("an approach of %.0f mm to ", 1e3 * advice.length.value_or(0)) + strokes;
    case JobAdvice::Change::kRetract:
      return formatted("a retract of %.0f mm behind ", 1e3 * advice.length.value_or(0)) + strokes;
    case JobAdvice::Change::kLines:
      return formatted("approach and retract of %.0f mm at all strokes",
                       1e3 * advice.length.value_or(0));
    case JobAdvice::Change::kHome:
      break;
  }
  if (!advice.home) return "another home";
  std::string text;
  for (const double joint : *advice.home)
    text += (text.empty() ? "" : ", ") + formatted("%.4f", joint);
  return "home: {joints: [" + text + "]}";
}

std::string advice_text(const AdviceOnJob& advice) {
  std::string lines, unknown;
  for (const JobAdvice& one : advice.job) {
    if (one.outcome == Advice::Outcome::kSolved)
      lines += "  would help: " + words(one) + formatted(" (solved, cost %.6g)\n", *one.cost);
    else if (one.outcome == Advice::Outcome::kUnknown)
      unknown += (unknown.empty() ? "" : ", ") + words(one);
    else
      lines += "  no help: " + words(one) + '\n';
  }
  if (!unknown.empty()) lines += "  not tried in the time: " + unknown + '\n';
  if (advice.strokes.size() > 1) return lines + advice_on_strokes(advice.strokes);
  for (const StrokeAdvice& one : advice.strokes)
    if (!one.advice.empty())
      lines += "  for stroke '" + one.stroke + "' by itself:\n" + advice_text(one.advice);
  return lines;
}

}  // namespace swivel
