// SPDX-License-Identifier: BSD-3-Clause
#include "output/answer_output.hpp"

#include <cstdio>
#include <set>
#include <vector>

#include "options/search_options.hpp"
#include "output/motion_output.hpp"
#include "output/workcell_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/motion/job_text.hpp"
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
         stages_text(answer, {"load", "lattice", "find", "order", "lift", "report", "check", "time",
                              "check motion"}) +
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

/// Prints the main figures of the motion of one path.
void print_motion(const TimedPath& motion, const io::JointNames& joint_names) {
  const auto name = [&](int joint) { return joint_names[static_cast<std::size_t>(joint)].c_str(); };
  say("motion: %.3f s at %g mm/s (%.3f s at that speed throughout), %zu samples at %g Hz\n",
      motion.rows.back().t, 1e3 * motion.speed, motion.ideal, motion.rows.size(), motion.rate);
  for (const JointRate rate : {JointRate::kSpeed, JointRate::kAcceleration, JointRate::kJerk}) {
    const auto& peaks = motion.peaks[static_cast<std::size_t>(rate)];
    const TimedPath::Peak* most = &peaks[0];
    for (const TimedPath::Peak& peak : peaks)
      if (peak.ratio > most->ratio) most = &peak;
    say("  %s at most %s of the limit: '%s' at s = %.4f m, t = %.3f s\n", to_string(rate),
        percent(most->ratio).c_str(), name(most->joint), most->s, most->t);
  }
  for (const TimedPath::Slow& slow : motion.slow) {
    say("  slower from s = %.4f to %.4f m (t = %.3f to %.3f s): %s of the speed at least, for the "
        "%s of '%s'",
        slow.from_s, slow.to_s, slow.from_t, slow.to_t, percent(slow.share).c_str(),
        to_string(slow.reason), name(slow.joint));
    if (!slow.singular.empty())
      say("; the %s is %.1f deg from singular", slow.singular.c_str(),
          slow.singular_angle * 180 / kPi);
    say("\n");
  }
  if (motion.rounded > 0)
    say("  %d corner%s rounded, within %.3g mm and %.3g mrad\n", motion.rounded,
        motion.rounded == 1 ? "" : "s", 1e3 * motion.rounded_position, 1e3 * motion.rounded_angle);
  for (const TimedPath::Stop& stop : motion.stops)
    say("  stops at waypoint %d, s = %.4f m, t = %.3f s: the corner may not be rounded\n",
        stop.waypoint, stop.s, stop.t);
  say("  between samples the tool is within %.3g um and %.3g urad of its path\n",
      1e6 * motion.between_position, 1e6 * motion.between_angle);
}

}  // namespace

std::string whole_text(const Answer& answer, const Problem& problem,
                       const std::optional<AnyAdvice>& advice) {
  std::string text = answer_text(answer, problem);
  if (advice) text += advice_text(*advice);
  if (is_path(problem)) return text;
  if (answer.refinement) text += refined_workcell_text(*answer.refinement, names_of_arms(answer));
  if (!answer.motion) return text;
  return text + (answer.arms.size() == 2
                     ? workcell_motion_text(*answer.motion, joint_names_of_arms(answer),
                                            names_of_arms(answer))
                     : job_motion_text(*answer.motion, answer.arm().parts, problem));
}

void print_answer(const Answer& answer, const Problem& problem,
                  const std::optional<AnyAdvice>& advice,
                  const std::optional<AnyCertificate>& certificate, std::size_t bytes) {
  if (answer.arms.size() == 2) {
    say_text(whole_text(answer, problem, advice) + work_of_two_arms(answer));
  } else if (!is_path(problem)) {
    say_text(whole_text(answer, problem, std::nullopt) + work_of_strokes(answer));
  } else {
    say_text(answer_text(answer, problem) + work_of_path(answer));
    print_refined_and_timed(answer);
  }
  warn(answer);
  if (certificate) say_text(words_of_certificate(*certificate, bytes));
  if (advice && answer.arms.size() == 1) say_text(advice_text(*advice));
}

void print_timed(const Answer& answer, const Problem& problem, bool quiet) {
  const bool one_path = is_path(problem);
  if (answer.refinement && !quiet) {
    if (one_path)
      print_refined(answer.refinement->arms.front());
    else
      say_text(refined_workcell_text(*answer.refinement, names_of_arms(answer)));
  }
  const MotionTiming& timing = *answer.motion;
  if (answer.arms.size() == 2)
    say_text(workcell_motion_text(timing, joint_names_of_arms(answer), names_of_arms(answer)));
  else if (!one_path)
    say_text(job_motion_text(timing, answer.arm().parts, problem));
  else if (const auto& failure = timing.failure)
    say("not executable: s = %.4f m: %s\n", failure->s, failure->reason.c_str());
  else
    print_motion(timing.motion->arms.front(), answer.arm().joint_names);
  if (answer.timed() != nullptr) warn_of(*answer.timed());
}

}  // namespace swivel::cli
