// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/answer_text.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "answer/text/answer_words.hpp"
#include "swivel/core/answer/timed_text.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// Returns the cause in words and figures: "joint a4 (0.3 deg beyond 120.00 deg)".
std::string cause_text(const Cause& cause, std::optional<double> most = {}) {
  const std::string by = figures(cause, most);
  return words(cause) + (by.empty() ? "" : " (" + by + ")");
}

std::string line_of(const EmptyLayers& run) {
  std::string line = run.first == run.last ? formatted("  layer %d", run.first)
                                           : formatted("  layers %d to %d", run.first, run.last);
  if (run.first_waypoint >= 0)
    line += run.first_waypoint == run.last_waypoint
                ? formatted(" (waypoint %d)", run.first_waypoint)
                : formatted(" (waypoints %d to %d)", run.first_waypoint, run.last_waypoint);
  line += run.first == run.last ? formatted(", s = %.4f m", run.first_s)
                                : formatted(", s = %.4f to %.4f m", run.first_s, run.last_s);
  return line + ": no valid node: " + cause_text(run.cause, run.most) + '\n';
}

/// Returns a line that says what else must be removed besides the cause, or how far paths go
/// without the cause.
std::string without_text(const Diagnosis& d) {
  if (!d.together.empty()) {
    std::string line = "  no single thing stands in the way: besides it";
    for (std::size_t k = 0; k < d.together.size(); ++k)
      line += (k == 0 ? " " : ", ") + cause_text(d.together[k]);
    return line + '\n';
  }
  if (!d.without_it) return "";
  const std::string removed = d.cause.object.empty() ? "it" : d.cause.object;
  return formatted("  without ") + removed +
         formatted(" there are paths to layer %d (s = %.4f m) at least\n", *d.without_it,
                   *d.without_it_s);
}

std::string diagnosis_text(const RunAnswer& run, const std::vector<HeldJoint>& held) {
  const Diagnosis& d = *run.diagnosis;
  const std::string claim =
      d.holds() == Diagnosis::Holds::kEveryResolution ? "no path at any resolution"
      : d.holds() == Diagnosis::Holds::kExactTool     ? "no path for a tool that follows exactly"
      : run.lattice.complete                          ? "no path at this resolution"
                             : "no path found, among the solutions that were found";
  const std::string none = claim + with_held(held);
  if (d.cause.kind == Cause::Kind::kNotClosed)
    return none +
           ": paths reach the end, but none in the joints in which it begins "
           "(path.closed)\n";
  if (d.cause.kind == Cause::Kind::kNotAsked) return none + "\n";
  if (d.cause.kind == Cause::Kind::kNone)
    return none + "; stopped before it was known what ends every one\n";
  const std::string why = cause_text(d.cause);
  std::string answer =
      d.reached_layer ? none +
                            formatted(": every one ends by layer %d of %d (s = %.4f m), where ",
                                      *d.reached_layer, run.lattice.layers - 1, *d.reached_s) +
                            why + " stops it\n"
                      : none + ": the first layer has no valid node: " + why + '\n';
  answer += without_text(d);
  if (d.unreachable) {
    answer += formatted("  layer %d", d.unreachable->layer);
    if (d.unreachable->waypoint >= 0)
      answer += formatted(" (waypoint %d)", d.unreachable->waypoint);
    answer += formatted(", s = %.4f m: no joints within their limits reach it, at any arm angle\n",
                        d.unreachable->s);
  }
  constexpr std::size_t kMostLines = 40;
  for (std::size_t k = 0; k < d.empty_layers.size() && k < kMostLines; ++k)
    answer += line_of(d.empty_layers[k]);
  if (d.empty_layers.size() > kMostLines)
    answer +=
        formatted("  ... and %zu more, listed in --json\n", d.empty_layers.size() - kMostLines);
  if (!d.complete && d.layers_known < run.lattice.layers)
    answer += formatted("  layers from %d on were not looked at\n", d.layers_known);
  return answer;
}

std::string held_text(const std::vector<HeldJoint>& held) {
  return held.empty() ? "" : " | held: " + words(held);
}

std::string solved_text(const RunAnswer& result, const std::vector<TrajectoryRow>& rows,
                        double cost, const std::vector<HeldJoint>& held) {
  const auto s_of = [&](int row) { return rows[static_cast<std::size_t>(row)].s; };
  std::string line = formatted("solved: %d layers, cost %.6g", result.lattice.layers, cost);
  if (const auto& least = result.min_margin)
    line += formatted(" | least clearance %.1f mm (asked %.3g) at s %.3f: ", 1e3 * least->clearance,
                      1e3 * least->required, s_of(least->row)) +
            least->bodies[0] + " - " + least->bodies[1];
  if (const auto& contact = result.deepest_contact)
    line += formatted(" | contact %s%.2f mm deep", contact->at_most ? "" : "at least ",
                      1e3 * contact->depth) +
            (contact->allowed ? formatted(" (allowed %.3g)", 1e3 * *contact->allowed) : "") +
            formatted(" at s %.3f: ", s_of(contact->row)) + contact->bodies[0] + " - " +
            contact->bodies[1];
  if (const auto& limit = result.nearest_limit)
    line += " | " + limit->joint +
            formatted(" %.1f deg from its limit at s %.3f", limit->margin * 180 / kPi,
                      s_of(limit->row));
  if (const auto& limit = result.nearest_slide_limit)
    line += " | " + limit->joint +
            formatted(" %.1f mm from its limit at s %.3f", 1e3 * limit->margin, s_of(limit->row));
  if (const auto& error = result.tool_path_error_mm; result.evidence.tool_path_error)
    line += formatted(" | tool %.3f mm off", error.max) +
            (error.allowed ? formatted(" (allowed %.3g)", 1e3 * *error.allowed) : "");
  if (const auto& top = result.top_tool_speed)
    line += formatted(" | tool speed up to %.3g m/s (", top->speed) + top->joint + ")";
  if (const std::string missing = words_of_unmeasured(result); !missing.empty())
    line += " | not measured, for time ran out: " + missing;
  return line + held_text(held) + '\n';
}

}  // namespace

std::string run_text(const RunAnswer& run, const std::vector<HeldJoint>& held, const Part* part) {
  if (part != nullptr) return solved_text(run, part->rows, part->cost, held);
  if (run.diagnosis) return diagnosis_text(run, held);
  return std::string("stopped: ") + to_string(run.status) + held_text(held) + '\n';
}

std::string answer_text(const Answer& answer, const Problem& problem) {
  if (answer.arms.size() == 2) return text_of_two_arms(answer);
  if (!is_path(problem)) return text_of_strokes(answer, problem);
  const ArmAnswer& arm = answer.arm();
  return run_text(arm.run(), arm.held, answer.has_rows() ? &arm.parts.front() : nullptr);
}

std::string whole_text(const Answer& answer, const Problem& problem, const AdviceList* advice) {
  const std::string text =
      answer_text(answer, problem) + (advice != nullptr ? advice_text(*advice) : "");
  return is_path(problem) ? text
                          : text + refined_text(answer, problem) + timed_text(answer, problem);
}

std::string answer_text(const PlanResult& result) {
  if (result.status == PlanStatus::kSolved)
    return solved_text(result, result.trajectory, result.cost, result.held);
  return run_text(result, result.held);
}

std::string removed_text(const InfeasibilityCertificate& certificate) {
  const CertificateCounts counts = count(certificate);
  std::map<std::string, CertificateCounts::Removed> by_words;
  for (std::size_t k = 0; k < certificate.witnesses.size(); ++k) {
    CertificateCounts::Removed& sum = by_words[words(certificate.witnesses[k])];
    sum.nodes += counts.by_witness[k].nodes;
    sum.edges += counts.by_witness[k].edges;
  }
  std::vector<std::pair<std::string, CertificateCounts::Removed>> most(by_words.begin(),
                                                                       by_words.end());
  std::stable_sort(most.begin(), most.end(), [](const auto& x, const auto& y) {
    return x.second.nodes + x.second.edges > y.second.nodes + y.second.edges;
  });
  constexpr std::size_t kShown = 5;
  std::string list;
  for (std::size_t k = 0; k < std::min(kShown, most.size()); ++k) {
    const auto& [reason, sum] = most[k];
    list += (k == 0 ? "" : ", ") + reason +
            (sum.nodes > 0 ? formatted(" %lld nodes", static_cast<long long>(sum.nodes)) : "") +
            (sum.nodes > 0 && sum.edges > 0 ? " and" : "") +
            (sum.edges > 0 ? formatted(" %lld edges", static_cast<long long>(sum.edges)) : "");
  }
  if (most.size() > kShown) list += formatted(" and %zu more", most.size() - kShown);
  const int last = certificate.first_layer + static_cast<int>(certificate.band.size()) - 1;
  return (certificate.first_layer == last
              ? formatted("layer %d", last)
              : formatted("layers %d to %d", certificate.first_layer, last)) +
         formatted(", %lld nodes reached; removed by ", static_cast<long long>(counts.reached)) +
         (list.empty() ? "nothing else" : list);
}

std::string certificate_text(const InfeasibilityCertificate& certificate, std::size_t bytes) {
  return "certificate: " + removed_text(certificate) + formatted("; %zu bytes\n", bytes);
}

}  // namespace swivel
