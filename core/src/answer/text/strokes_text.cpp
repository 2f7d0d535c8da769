// SPDX-License-Identifier: BSD-3-Clause
#include "answer/text/answer_words.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// Returns the number of a text's characters, which is less than that of its bytes beyond ASCII.
std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

/// Returns a table whose columns are as wide as they need: the first to the left, the others to the
/// right.
std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (widths.size() <= k) widths.push_back(0);
      widths[k] = std::max(widths[k], columns_of(line[k]));
    }
  std::string text;
  for (const std::vector<std::string>& line : lines) {
    text += ' ';
    for (std::size_t k = 0; k < line.size(); ++k) {
      const std::string space(widths[k] - columns_of(line[k]), ' ');
      text += ' ';
      text += k == 0 ? line[k] + space : ' ' + space + line[k];
    }
    text += '\n';
  }
  return text;
}

/// Returns by how much less than `cost` another job may cost, in words.
std::string less_than(double cost, double bound) {
  if (bound <= 0) return "not bounded from below";
  return formatted("at most %.3g %% less", 100 * (1 - bound / cost));
}

/// Returns how near a job's cost is to the least.
std::string bounds_text(const Answer& result, const Problem& job) {
  const bool other_orders = job.arm().order == StrokeOrder::kBest && job.arm().strokes.size() > 1;
  const std::string in_order = other_orders ? " in this order" : "";
  const std::string of_orders =
      !other_orders                                ? ""
      : result.lattice_cost <= result.bound_orders ? "; no order is cheaper"
      : result.bound_orders <= 0                   ? "; other orders may be cheaper"
                                 : formatted("; at most %.3g %% can be gained by another order",
                                             100 * (1 - result.bound_orders / result.lattice_cost));
  const std::string none = "none costs less at this resolution" + in_order;
  if (result.lattice_cost <= result.bound_any)
    return none + ", whatever the transitions" + of_orders;
  const std::string any =
      "whatever the transitions, " + less_than(result.lattice_cost, result.bound_any) + of_orders;
  if (result.lattice_cost <= result.bound) return none + " with the transitions found; " + any;
  return "with the transitions found" + in_order + ", " +
         less_than(result.lattice_cost, result.bound) + "; " + any;
}

/// Returns a line for each run: what it costs in the job and by itself, and what it comes near to.
std::string table_of_runs(const Answer& result, const Problem& job) {
  std::vector<std::vector<std::string>> lines{
      {"stroke", "layers", "cost", "least", "clearance mm", "tool off mm"}};
  for (const RunAnswer& one : result.arm().runs) {
    const auto part = std::find_if(result.arm().parts.begin(), result.arm().parts.end(),
                                   [&](const Part& any) { return any.run == one.run; });
    if (part == result.arm().parts.end()) continue;
    const Measures& measures = one;
    lines.push_back(
        {job.arm().strokes[one.run.stroke].name + (one.run.reversed ? " (backwards)" : ""),
         std::to_string(one.lattice.layers), formatted("%.5g", part->cost),
         formatted("%.5g", one.least_cost),
         measures.min_clearance ? formatted("%.1f", 1e3 * *measures.min_clearance) : "-",
         measures.evidence.tool_path_error ? formatted("%.3f", measures.tool_path_error_mm.max)
                                           : "-"});
  }
  std::string text = aligned(lines);
  for (const RunAnswer& one : result.arm().runs)
    if (const std::string missing = words_of_unmeasured(one); !missing.empty())
      text += "  not measured, for time ran out: " + missing + " of " + words(one.run, job) + '\n';
  return text;
}

std::string transitions_text(const Answer& result, const Problem& job) {
  int all = 0, straight = 0;
  double cost = 0;
  for (const Part& part : result.arm().parts) {
    if (part.run) continue;
    ++all;
    if (part.rows.size() <= 2) ++straight;
    cost += part.cost;
  }
  if (all == 0) return "";
  const TransitionCounters& counters = result.arm().transitions;
  std::string text = formatted(
      "  %d transition%s, %d of them straight, cost %.5g; %lld asked for, %lld searched, %lld "
      "round%s\n",
      all, all == 1 ? "" : "s", straight, cost, static_cast<long long>(counters.pairs),
      static_cast<long long>(counters.searches), static_cast<long long>(counters.rounds),
      counters.rounds == 1 ? "" : "s");
  for (std::size_t k = 0; k < result.arm().parts.size(); ++k) {
    const Part& part = result.arm().parts[k];
    if (!part.barred_by) continue;
    const std::string to = k + 1 < result.arm().parts.size()
                               ? words(*result.arm().parts[k + 1].run, job)
                               : std::string("home");
    text +=
        "  to " + to + ": around " + (*part.barred_by)[0] + " - " + (*part.barred_by)[1] +
        formatted(", by %zu corner%s\n", part.rows.size() - 2, part.rows.size() == 3 ? "" : "s");
  }
  return text;
}

/// Returns a line for each stroke in several runs: where the tool lifts off, and why no run goes
/// on.
std::string lift_offs_text(const Answer& result, const Problem& job) {
  std::string text;
  for (std::size_t k = 0, run = 0; k < result.arm().lift_offs.size();) {
    const std::size_t stroke = result.arm().lift_offs[k].stroke;
    std::size_t end = k;
    while (end < result.arm().lift_offs.size() && result.arm().lift_offs[end].stroke == stroke)
      ++end;
    while (!job.arm().strokes[run].piece) ++run;
    const std::string& name = job.arm().strokes[run].piece->stroke;
    const double approach = job.arm().strokes[run].approach.norm();  // s of rows counts it as well
    text += "  stroke '" + name + "': " + std::to_string(end - k) + " lift-off" +
            (end - k == 1 ? "" : "s") + ", at s";
    for (std::size_t i = k; i < end; ++i)
      text += (i == k        ? " "
               : i + 1 < end ? ", "
                             : " and ") +
              formatted("%.3f", approach + result.arm().lift_offs[i].end);
    text += " m\n";
    for (std::size_t i = k; i < end; ++i) {
      const LiftOffAnswer& lift = result.arm().lift_offs[i];
      if (lift.cause.kind == Cause::Kind::kNone) continue;
      const std::string by = figures(lift.cause);
      text += formatted("    no run from s %.3f gets beyond s %.3f m: ",
                        approach + (i == k ? 0.0 : result.arm().lift_offs[i - 1].resumed),
                        approach + lift.reached) +
              words(lift.cause) + (by.empty() ? "" : " (" + by + ")") + '\n';
    }
    run += end - k + 1;
    k = end;
  }
  return text;
}

/// Returns the answer where there is a motion.
std::string motion_text(const Answer& result, const Problem& job) {
  const std::size_t strokes = job.arm().strokes.size() - result.arm().lift_offs.size();
  std::string text = formatted("solved: %zu stroke%s, cost %.6g: ", strokes,
                               strokes == 1 ? "" : "s", result.cost) +
                     (result.refined ? "before refining " : "") + bounds_text(result, job) +
                     (result.arm().lift_offs.empty() ? "" : ", with the lift-offs at these places");
  if (!result.arm().held.empty()) text += " | held: " + words(result.arm().held);
  text += '\n';
  if (job.arm().order == StrokeOrder::kBest) {
    text += "  order:";
    for (std::size_t k = 0; k < result.arm().runs.size(); ++k)
      text += (k == 0 ? " " : ", ") + job.arm().strokes[result.arm().runs[k].run.stroke].name +
              (result.arm().runs[k].run.reversed ? " (backwards)" : "");
    text += '\n';
  }
  text += lift_offs_text(result, job);
  return text + table_of_runs(result, job) + transitions_text(result, job);
}

/// Returns why a run has no path by itself, with the lines of a problem's answer.
std::string words_without_path(const Answer& result, const RunAnswer& run, const Problem& job) {
  const bool either = job.arm().strokes[run.run.stroke].reversible;
  return "  stroke " + words(run.run, job) +
         (either ? ", which has no path backwards either: " : ": ") +
         run_text(run, result.arm().held);
}

/// Returns what ends the paths of a run that has none, whatever the place and the figures: of two
/// bodies the object of the scene alone.
std::string ending_of(const Diagnosis& diagnosis, const Problem& job) {
  std::string text;
  const auto add = [&](const Cause& cause) {
    std::string what = words(cause);
    for (const SceneObject& object : job.scene)
      if (object.name == cause.object || object.name == cause.bodies[0] ||
          object.name == cause.bodies[1])
        what = "'" + object.name + "'";
    text += what + '\n';
  };
  add(diagnosis.cause);
  for (const Cause& cause : diagnosis.together) add(cause);
  return text;
}

/// Returns the verdicts on runs that have no path by themselves: one in full of those that one
/// cause ends, and where the others end.
std::string verdicts_by_cause(const Answer& result, const Problem& job) {
  std::vector<std::string> endings, texts, likewise;
  for (const RunAnswer& run : result.arm().runs) {
    if (run.status != PlanStatus::kInfeasible || !run.diagnosis) continue;
    const std::string ending = ending_of(*run.diagnosis, job);
    const auto known = std::find(endings.begin(), endings.end(), ending);
    if (known == endings.end()) {
      endings.push_back(ending);
      texts.push_back(words_without_path(result, run, job));
      likewise.emplace_back();
      continue;
    }
    const auto& reached = run.diagnosis->reached_s;
    std::string& others = likewise[static_cast<std::size_t>(known - endings.begin())];
    others += (others.empty() ? "  likewise " : ", ") + words(run.run, job) +
              (reached ? formatted(" (paths to s = %.4f m)", *reached)
                       : std::string(" (no valid node at its begin)"));
  }
  std::string text;
  for (std::size_t k = 0; k < texts.size(); ++k)
    text += texts[k] + (likewise[k].empty() ? "" : likewise[k] + '\n');
  return text;
}

std::string infeasible_text(const Answer& result, const Problem& job) {
  const std::string text = verdicts_by_cause(result, job);
  const auto without =
      std::count_if(result.arm().runs.begin(), result.arm().runs.end(),
                    [](const RunAnswer& run) { return run.status == PlanStatus::kInfeasible; });
  if (without > 0)
    return formatted("no job: %td of %zu strokes ha%s no path by %s\n", without,
                     job.arm().strokes.size(), without == 1 ? "s" : "ve",
                     without == 1 ? "itself" : "themselves") +
           text;
  if (!result.arm().no_transition) return "no job found\n";
  std::vector<std::string> runs;
  for (const RunAnswer& run : result.arm().runs) runs.push_back("stroke " + words(run.run, job));
  const bool searched = result.arm().no_transition->where == NoTransition::Where::kBetween;
  return (searched ? "no job found: " : "no job: ") + words(*result.arm().no_transition, runs) +
         '\n';
}

}  // namespace

std::string text_of_strokes(const Answer& result, const Problem& job) {
  if (!result.arm().parts.empty()) return motion_text(result, job);
  if (result.status == PlanStatus::kInfeasible) return infeasible_text(result, job);
  return std::string("stopped: ") + to_string(result.status) +
         (result.arm().partial.empty()
              ? ""
              : formatted(", with a job of cost %.6g that is not proved", result.cost)) +
         '\n';
}

}  // namespace swivel
