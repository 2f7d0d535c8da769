// SPDX-License-Identifier: BSD-3-Clause
#include "output/answer_output.hpp"

#include <cstdio>
#include <set>
#include <vector>

#include "options/search_options.hpp"
#include "output/motion_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/answer/timed_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns the time in ms that the plan noted for a stage; 0 if it noted none.
double ms(const Answer& answer, const char* stage) {
  const auto found = answer.time_ms.find(stage);
  return found == answer.time_ms.end() ? 0.0 : found->second;
}

/// Returns how long each of these stages took, in words, of those that the plan noted.
std::string stages_text(const Answer& answer, const std::vector<const char*>& stages) {
  std::string text;
  for (const char* const stage : stages)
    if (answer.time_ms.contains(stage))
      text += formatted("%s%s %.1f ms", text.empty() ? "" : ", ", stage, ms(answer, stage));
  return text;
}

/// Returns the planner and its threads in words.
std::string planner_text(const Answer& answer) {
  return answer.planner +
         formatted(", %d thread%s: ", answer.threads, answer.threads == 1 ? "" : "s");
}

std::string work_of_path(const Answer& answer) {
  const Counters& c = answer.arm().counters;
  return planner_text(answer) +
         formatted("load %.1f ms, prepare %.1f ms, plan %.1f ms", ms(answer, "load"),
                   ms(answer, "prepare"), ms(answer, "plan")) +
         (answer.checked ? formatted(", checked in %.1f ms", ms(answer, "check")) : "") +
         formatted("; %lld of %lld nodes and %lld edges checked, %lld FCL calls\n",
                   static_cast<long long>(c.nodes_checked),
                   static_cast<long long>(answer.arm().run().lattice.nodes),
                   static_cast<long long>(c.edges_checked), static_cast<long long>(c.fcl_calls));
}

std::string work_of_strokes(const Answer& answer) {
  const Counters& c = answer.arm().counters;
  return planner_text(answer) +
         stages_text(answer, {"load", "lattice", "find", "order", "lift", "refine", "report",
                              "check", "time", "check motion"}) +
         formatted("; %lld nodes and %lld edges checked, %lld FCL calls\n",
                   static_cast<long long>(c.nodes_checked), static_cast<long long>(c.edges_checked),
                   static_cast<long long>(c.fcl_calls));
}

std::string work_of_two_arms(const Answer& answer) {
  long long nodes = 0, edges = 0, calls = 0;
  for (const ArmAnswer& arm : answer.arms) {
    nodes += arm.counters.nodes_checked;
    edges += arm.counters.edges_checked;
    calls += arm.counters.fcl_calls;
  }
  return planner_text(answer) +
         stages_text(answer, {"load", "prepare", "lattice", "search", "refine", "time", "check",
                              "report", "certificate"}) +
         formatted(
             "; %lld nodes and %lld edges of the arms checked, %lld pairs of nodes and %lld of "
             "motions, %lld FCL calls\n",
             nodes, edges, static_cast<long long>(answer.pair.counters.node_pairs),
             static_cast<long long>(answer.pair.counters.move_pairs), calls);
}

/// Prints the warnings of an answer, each once, and those of its motion.
void warn(const Answer& answer) {
  std::set<std::string> said;
  const auto print = [&](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
      if (said.insert(warning).second) complain("swivel: warning: %s\n", warning.c_str());
  };
  print(answer.warnings);
  for (const ArmAnswer& arm : answer.arms) print(arm.warnings);
  if (answer.timed() != nullptr) warn_of(*answer.timed());
}

std::string words_of_certificate(const AnyCertificate& certificate, std::size_t bytes) {
  const auto* const of_run = std::get_if<InfeasibilityCertificate>(&certificate);
  if (of_run == nullptr) return formatted("certificate: %zu bytes\n", bytes);
  const std::string stroke =
      of_run->stroke.empty()
          ? ""
          : "  stroke '" + of_run->stroke + (of_run->reversed ? "' backwards: " : "': ");
  return stroke + certificate_text(*of_run, bytes);
}

}  // namespace

void print_answer(const Answer& answer, const Problem& problem,
                  const std::optional<AdviceList>& advice,
                  const std::optional<AnyCertificate>& certificate, std::size_t bytes) {
  if (answer.arms.size() == 2) {
    say_text(whole_text(answer, problem, advice ? &*advice : nullptr) + work_of_two_arms(answer));
  } else if (!is_path(problem)) {
    say_text(whole_text(answer, problem) + work_of_strokes(answer));
  } else {
    say_text(answer_text(answer, problem) + work_of_path(answer) + refined_text(answer, problem) +
             timed_text(answer, problem));
  }
  warn(answer);
  if (certificate) say_text(words_of_certificate(*certificate, bytes));
  if (advice && answer.arms.size() == 1) say_text(advice_text(*advice));
}

void print_timed(const Answer& answer, const Problem& problem, bool quiet) {
  if (!quiet) say_text(refined_text(answer, problem));
  say_text(timed_text(answer, problem, true));
  if (answer.timed() != nullptr) warn_of(*answer.timed());
}

}  // namespace swivel::cli
