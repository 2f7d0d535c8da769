// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "answer/stroke_words.hpp"
#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// One change of several strokes, each planned by itself.
struct ChangeOfStrokes {
  Advice::Outcome outcome;
  std::string change;
  std::vector<std::string> strokes;
};

/// Returns what helps strokes by themselves, a line for each change with the strokes that it is
/// about, what helps most of them first.
std::string advice_on_strokes(const std::vector<AdviceAlone>& advice) {
  std::vector<ChangeOfStrokes> changes;
  for (const AdviceAlone& of : advice)
    for (const Advice& one : of.advice) {
      const auto known =
          std::find_if(changes.begin(), changes.end(), [&](const ChangeOfStrokes& other) {
            return other.outcome == one.outcome && other.change == words(one);
          });
      if (known != changes.end())
        known->strokes.push_back(of.name);
      else
        changes.push_back({one.outcome, words(one), {of.name}});
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

std::string advice_text(const std::vector<Advice>& advice) {
  std::string lines, unknown;
  for (const Advice& one : advice) switch (one.outcome) {
      case Advice::Outcome::kSolved:
        lines += "  would help: " + words(one) + formatted(" (solved, cost %.6g)\n", *one.cost);
        break;
      case Advice::Outcome::kFurther:
        lines +=
            "  not enough: " + words(one) + formatted(" (paths to s = %.4f m)\n", *one.reached_s);
        break;
      case Advice::Outcome::kNoHelp:
        lines += "  no help: " + words(one) + '\n';
        break;
      case Advice::Outcome::kUnknown:
        unknown += (unknown.empty() ? "" : ", ") + words(one);
    }
  return lines + (unknown.empty() ? "" : "  not tried in the time: " + unknown + '\n');
}

std::string advice_text(const AdviceList& advice) {
  std::string lines = advice_text(advice.changes);
  if (advice.alone.size() > 1 && !advice.alone.front().is_arm)
    return lines + advice_on_strokes(advice.alone);
  for (const AdviceAlone& one : advice.alone)
    if (!one.advice.empty())
      lines += std::string("  for ") + (one.is_arm ? "arm" : "stroke") + " '" + one.name +
               "' by itself:\n" + advice_text(one.advice);
  return lines;
}

}  // namespace swivel
