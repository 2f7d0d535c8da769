// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_text.hpp"

#include <algorithm>
#include <cstdio>

#include "swivel/core/types.hpp"

namespace swivel::cli {

namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// "joint a4 (0.3 deg beyond 120.00 deg)".
std::string cause_text(const Cause& cause, std::optional<double> most = {}) {
  const std::string by = figures(cause, most);
  return words(cause) + (by.empty() ? "" : " (" + by + ")");
}

std::string line_of(const EmptyLayers& run) {
  std::string line = run.first == run.last ? text("  layer %d", run.first) : text("  layers %d to %d", run.first, run.last);
  if (run.first_waypoint >= 0)
    line += run.first_waypoint == run.last_waypoint ? text(" (waypoint %d)", run.first_waypoint)
                                                    : text(" (waypoints %d to %d)", run.first_waypoint, run.last_waypoint);
  line += run.first == run.last ? text(", s = %.4f m", run.first_s) : text(", s = %.4f to %.4f m", run.first_s, run.last_s);
  return line + ": no valid node: " + cause_text(run.cause, run.most) + '\n';
}

/// What else would have to go, or what going without the cause is worth.
std::string without_text(const PlanResult& result) {
  const Diagnosis& d = result.diagnosis;
  if (!d.together.empty()) {
    std::string line = "  no single thing stands in the way: besides it";
    for (std::size_t k = 0; k < d.together.size(); ++k) line += (k == 0 ? " " : ", ") + cause_text(d.together[k]);
    return line + '\n';
  }
  if (!d.without_it) return "";
  const std::string removed = d.cause.object.empty() ? "it" : d.cause.object;
  return text("  without ") + removed +
         text(" there are paths to layer %d (s = %.4f m) at least\n", *d.without_it, *d.without_it_s);
}

std::string diagnosis_text(const PlanResult& result) {
  const Diagnosis& d = result.diagnosis;
  const std::string none =
      result.lattice.complete ? "no path at this resolution" : "no path found, among the solutions that were found";
  if (d.cause.kind == Cause::Kind::kNone) return none + "; stopped before it was known what ends every one\n";
  const std::string why = cause_text(d.cause);
  std::string answer = d.reached_layer ? none +
                                             text(": every one ends by layer %d of %d (s = %.4f m), where ", *d.reached_layer,
                                                  result.lattice.layers - 1, *d.reached_s) +
                                             why + " stops it\n"
                                       : none + ": the first layer has no valid node: " + why + '\n';
  answer += without_text(result);
  constexpr std::size_t kMostLines = 40;
  for (std::size_t k = 0; k < d.empty_layers.size() && k < kMostLines; ++k) answer += line_of(d.empty_layers[k]);
  if (d.empty_layers.size() > kMostLines)
    answer += text("  ... and %zu more, listed in --json\n", d.empty_layers.size() - kMostLines);
  if (!d.complete && d.layers_known < result.lattice.layers)
    answer += text("  layers from %d on were not looked at\n", d.layers_known);
  return answer;
}

std::string solved_text(const PlanResult& result) {
  const auto s_of = [&](int row) { return result.trajectory[static_cast<std::size_t>(row)].s; };
  std::string line = text("solved: %d layers, cost %.6g", result.lattice.layers, result.cost);
  if (const auto& least = result.min_margin)
    line += text(" | least clearance %.1f mm (asked %.3g) at s %.3f: ", 1e3 * least->clearance, 1e3 * least->required,
                 s_of(least->row)) +
            least->bodies[0] + " - " + least->bodies[1];
  if (const auto& limit = result.nearest_limit)
    line += " | " + limit->joint + text(" %.1f deg from its limit at s %.3f", limit->margin * 180 / kPi, s_of(limit->row));
  if (const auto& error = result.tool_path_error_mm; result.evidence.tool_path_error)
    line += text(" | tool %.3f mm off", error.max) + (error.allowed ? text(" (allowed %.3g)", 1e3 * *error.allowed) : "");
  if (const auto& top = result.top_tool_speed) line += text(" | tool speed up to %.3g m/s (", top->speed) + top->joint + ")";
  return line + '\n';
}

}  // namespace

std::string answer_text(const PlanResult& result) {
  switch (result.status) {
    case PlanStatus::kSolved:
      return solved_text(result);
    case PlanStatus::kInfeasible:
      return diagnosis_text(result);
    default:
      return std::string("stopped: ") + to_string(result.status) + '\n';
  }
}

std::string advice_text(const std::vector<Advice>& advice) {
  std::string lines, unknown;
  for (const Advice& one : advice) switch (one.outcome) {
      case Advice::Outcome::kSolved:
        lines += "  would help: " + words(one) + text(" (solved, cost %.6g)\n", *one.cost);
        break;
      case Advice::Outcome::kFurther:
        lines += "  not enough: " + words(one) + text(" (paths to s = %.4f m)\n", *one.reached_s);
        break;
      case Advice::Outcome::kNoHelp:
        lines += "  no help: " + words(one) + '\n';
        break;
      case Advice::Outcome::kUnknown:
        unknown += (unknown.empty() ? "" : ", ") + words(one);
    }
  return lines + (unknown.empty() ? "" : "  not tried in the time: " + unknown + '\n');
}

}  // namespace swivel::cli
