// SPDX-License-Identifier: BSD-3-Clause
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
  for (const StrokeAdvice& one : advice.strokes)
    if (!one.advice.empty())
      lines += "  for stroke '" + one.stroke + "' by itself:\n" + advice_text(one.advice);
  return lines;
}

}  // namespace swivel
