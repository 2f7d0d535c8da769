// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/plan.hpp"

#include <algorithm>

#include "swivel/core/base/angle.hpp"

namespace swivel {

bool any_rolls(const std::vector<TrajectoryRow>& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const TrajectoryRow& row) { return row.roll != 0; });
}

std::vector<double> rolls_of(const std::vector<TrajectoryRow>& rows) {
  std::vector<double> rolls;
  for (const TrajectoryRow& row : rows)
    rolls.push_back(rolls.empty() ? row.roll : rolls.back() + wrap_angle(row.roll - rolls.back()));
  return rolls;
}

const char* to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::kSolved:
      return "solved";
    case PlanStatus::kInfeasible:
      return "infeasible";
    case PlanStatus::kTimeout:
      return "timeout";
    case PlanStatus::kCancelled:
      return "cancelled";
    case PlanStatus::kError:
      return "error";
  }
  return "?";
}

const char* to_string(Known known) {
  switch (known) {
    case Known::kMeasured:
      return "measured";
    case Known::kNone:
      return "none";
    case Known::kNotMeasured:
      return "not_measured";
  }
  return "?";
}

std::string words_of_unmeasured(const Measures& measures) {
  const Evidence &asked = measures.asked, &known = measures.evidence;
  std::string words;
  const auto add = [&](bool missing, const char* what) {
    if (missing) words += (words.empty() ? "" : ", ") + std::string(what);
  };
  add(asked.tool_path_error && !known.tool_path_error, "tool path error");
  add(asked.postures && !known.postures, "clearance");
  add(asked.contact && !known.contact, "depth of contact");
  return words;
}

const char* to_string(Diagnosis::Holds holds) {
  switch (holds) {
    case Diagnosis::Holds::kThisResolution:
      return "this_resolution";
    case Diagnosis::Holds::kExactTool:
      return "exact_tool";
    case Diagnosis::Holds::kEveryResolution:
      return "every_resolution";
  }
  return "?";
}

}  // namespace swivel
