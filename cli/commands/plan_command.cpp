// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/motion_output.hpp"
#include "output/self_time_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/page.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

struct PlanArguments {
  std::string problem, out, json, trace, map_svg, report, certificate;
  std::optional<double> timeout;
  std::optional<double> advise;
  bool quiet = false, map = false, full_map = false, refine = false, no_check = false;
  SearchOptions search;
  MotionOptions motion;
  EpisodeChoice episode;
};

double ms(const PlanResult& result, const char* key) {
  const auto found = result.time_ms.find(key);
  return found == result.time_ms.end() ? 0.0 : found->second;
}

/// How long the answer took to prove, after the time that it took to find.
std::string check_words(const PlanResult& result) {
  char text[40] = "";
  if (result.checked) std::snprintf(text, sizeof text, ", checked in %.1f ms", ms(result, "check"));
  return text;
}

void print_summary(const PlanResult& result) {
  say_text(answer_text(result));
  const Counters& c = result.counters;
  say("%s, %d thread%s: load %.1f ms, prepare %.1f ms, plan %.1f ms%s; %lld of %lld nodes and %lld "
      "edges checked, %lld FCL calls\n",
      result.planner.c_str(), result.threads, result.threads == 1 ? "" : "s", ms(result, "load"),
      ms(result, "prepare"), ms(result, "plan"), check_words(result).c_str(),
      static_cast<long long>(c.nodes_checked), static_cast<long long>(result.lattice.nodes),
      static_cast<long long>(c.edges_checked), static_cast<long long>(c.fcl_calls));
  for (const std::string& warning : result.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Lays the files beside their targets, prints, and puts them in place: where printing fails,
/// nothing is written.
void deliver(io::OutputFiles& outputs, const std::string& reason,
             const std::function<void()>& print) {
  outputs.stage();
  print();
  flush_standard_output();
  report_removed(outputs.commit(), reason);
}

/// `outputs` is set as soon as it is known that they may be written.
int plan_problem(const PlanArguments& arguments, std::optional<io::OutputFiles>& outputs) {
  const auto start = std::chrono::steady_clock::now();
  PlanOptions options = arguments.search.plan_options();
  std::optional<Timeline> timeline;
  if (!arguments.trace.empty()) timeline.emplace();
  std::vector<io::InputFiles::File> inputs;
  Problem problem = [&] {
    const TraceSpan span("load");
    const io::InputFiles noted;
    Problem loaded = io::load_problem(arguments.problem);
    inputs = noted.files();
    return arguments.episode.apply(loaded);
  }();
  arguments.search.apply(problem);
  const std::optional<TimingOptions> timing = arguments.motion.asked_timing(problem);
  if (timing) {
    require_motion_format(arguments.out);
    problem = with_motion_defaults(std::move(problem));
  } else {
    require_table_name("--out", arguments.out, "a path without times",
                       "--speed, with which motions are written in other formats");
    if (arguments.refine) keep_clearance_between_layers(problem.limits);
  }
  if (arguments.timeout) options.timeout_s = positive(*arguments.timeout, "--timeout");
  const auto advise_s =
      arguments.advise ? std::optional(positive(*arguments.advise, "--advise")) : std::nullopt;
  const double load = milliseconds_since(start);

  catch_interrupts();
  ProgressLine progress(!arguments.quiet && isatty(STDERR_FILENO));
  options.progress = [&](const Progress& now) { progress.show(now); };
  const bool draws = arguments.map || !arguments.map_svg.empty() || !arguments.report.empty();
  if (!arguments.report.empty()) require_pages();
  if (arguments.full_map && !draws)
    throw InputError("--full-map: nothing is drawn: allowed with --map, --map-svg or --report");
  if (arguments.map && arguments.json == "-")
    throw InputError("--map: standard output is taken by --json -: allowed is one of the two");
  if (!arguments.certificate.empty() && (arguments.refine || timing))
    throw InputError(
        "--certificate: is of the problem as its file has it: allowed without --refine and "
        "--speed, which ask for more");
  outputs.emplace(std::move(inputs));
  outputs->add("--out", arguments.out);
  outputs->add("--report", arguments.report);
  outputs->add("--map-svg", arguments.map_svg);
  outputs->add("--certificate", arguments.certificate);
  outputs->add("--trace", arguments.trace);
  outputs->add("--json", arguments.json);
  options.check = !arguments.no_check;
  if (!arguments.quiet || !arguments.json.empty() || !arguments.report.empty())
    options.evidence = Evidence::all();
  const auto begun = std::chrono::steady_clock::now();
  const Budget budget = options.budget();  // of what is drawn; plan() begins with it
  Planner planner(problem);
  MotionPlan plan = plan_motion(planner, options, arguments.refine, timing);
  PlanResult& result = plan.result;
  result.time_ms["load"] = load;
  std::optional<std::vector<Advice>> advice;
  if (advise_s && result.status == PlanStatus::kInfeasible) {
    PlanOptions trials = options;
    trials.timeout_s = advise_s;
    if (options.timeout_s) {
      const double gone =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
      trials.timeout_s = std::clamp(*options.timeout_s - gone, 1e-6, *advise_s);
    }
    advice = advise(planner, result, trials);
  }
  std::optional<InfeasibilityCertificate> proof;
  std::string certificate;
  if (outputs->wants("--certificate") && result.status == PlanStatus::kInfeasible) {
    const auto start_of_proof = std::chrono::steady_clock::now();
    try {
      proof = prove_infeasible(planner.view(), budget);
      certificate = io::to_json(*proof);
    } catch (const Stopped&) {
      result.warnings.push_back("stopped before the certificate was found: there is none");
    }
    result.time_ms["certificate"] = milliseconds_since(start_of_proof);
  }
  const io::PlanExtras extras{plan.refinement ? &*plan.refinement : nullptr,
                              plan.motion ? &*plan.motion : nullptr,
                              timing.value_or(TimingOptions{}),
                              advice ? &*advice : nullptr,
                              proof ? &*proof : nullptr,
                              certificate.size()};
  std::optional<LatticeMap> map;
  std::string page;
  if (draws && result.status != PlanStatus::kTimeout && result.status != PlanStatus::kCancelled) {
    try {
      const PlanView view = planner.view();
      map = make_map(view, arguments.full_map, budget);
      if (!arguments.report.empty()) {
        PageMotion motion;
        if (plan.refinement && plan.refinement->refined) motion.refined = &result.trajectory;
        if (plan.motion && plan.motion->motion) motion.motion = &*plan.motion->motion;
        page = to_page(view, *map, io::to_json(result, extras), motion, budget,
                       {arguments.episode.words(),
                        answer_text(result) + (advice ? advice_text(*advice) : "")});
      }
    } catch (const Stopped&) {
      map.reset();
      result.warnings.push_back("stopped before the map was drawn: there is none, and no report");
    }
  }
  progress.clear();

  const bool solved = result.status == PlanStatus::kSolved,
             executable = solved && (!timing || plan.motion->motion);
  if (executable && timing) {
    if (outputs->wants("--out"))
      outputs->write("--out", io::motion_text(*plan.motion->motion, result.joint_names,
                                              problem.base_link, arguments.out));
  } else if (executable) {
    outputs->write("--out", io::to_csv(result));
  } else {
    outputs->remove("--out");
  }
  if (proof)
    outputs->write("--certificate", std::move(certificate));
  else
    outputs->remove("--certificate");
  if (map) {
    outputs->write("--report", std::move(page));
    if (outputs->wants("--map-svg")) outputs->write("--map-svg", to_svg(*map));
  } else {
    outputs->remove("--report");
    outputs->remove("--map-svg");
  }
  if (timeline) outputs->write("--trace", io::to_trace_json(*timeline) + "\n");
  if (outputs->wants("--json")) outputs->write("--json", io::to_json(result, extras) + "\n");
  const char* const reason = result.status == PlanStatus::kInfeasible ? "there is no path now"
                             : executable && outputs->wants("--certificate") ? "there is a path now"
                             : solved && !plan.stopped ? "there is no motion now"
                                                       : "the search was stopped";
  deliver(*outputs, reason, [&] {
    if (!arguments.quiet && !outputs->takes_standard_output()) {
      print_summary(result);
      print_plan_extras(extras, result.joint_names);
      if (proof) say_text(certificate_text(*proof, extras.certificate_bytes));
      if (advice) say_text(advice_text(*advice));
    }
    if (!arguments.quiet && timeline) print_self_times(*timeline);
    if (map && arguments.map)
      std::fputs(to_text(*map, terminal_columns(), coloured()).c_str(), stdout);
  });
  switch (result.status) {
    case PlanStatus::kSolved:
      return executable ? kOk : plan.stopped ? kStopped : kNo;
    case PlanStatus::kInfeasible:
      return kNo;
    default:
      return kStopped;
  }
}

int run(const PlanArguments& arguments) {
  std::optional<io::OutputFiles> outputs;
  try {
    return plan_problem(arguments, outputs);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (!outputs) throw;
    for (const char* const option : {"--out", "--report", "--map-svg", "--certificate"})
      outputs->remove(option);
    outputs->write("--json", io::error_json(error.what()));
    deliver(*outputs, "there is no answer now", [] {});
    throw;
  }
}

}  // namespace

void warn_of_held(const std::vector<HeldJoint>& held) {
  for (const std::string& warning : held_warnings(held))
    complain("swivel: warning: %s\n", warning.c_str());
}

void EpisodeChoice::add_to(CLI::App& command) {
  command.add_option("--seed", seed, "campaign seed of --episode");
  command.add_option("--episode", episode, "plan the problem of this campaign episode");
  placement.add_to(command, "");
}

std::string EpisodeChoice::words() const {
  return seed && episode
             ? "episode " + std::to_string(*episode) + " of seed " + std::to_string(*seed)
             : "";
}

Problem EpisodeChoice::apply(const Problem& problem) const {
  if (seed.has_value() != episode.has_value())
    throw InputError("--seed, --episode: one without the other: allowed are both or neither");
  return placement.apply(seed ? episode_problem(problem, *seed, *episode) : problem);
}

void add_plan(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("plan", "Plan a joint trajectory");
  auto arguments =
      std::make_shared<PlanArguments>();  // shared: lives as long as the callback that reads it
  command->add_option("problem", arguments->problem, "problem file")->required();
  arguments->search.add_to(*command);
  arguments->episode.add_to(*command);
  command->add_option("--timeout", arguments->timeout, "seconds");
  command->add_flag("--refine", arguments->refine,
                    "move the path off the lattice's nodes: cheaper and smoother, never dearer");
  arguments->motion.add_to(*command);
  command->add_option(
      "--advise", arguments->advise,
      "where there is no path: what would help, found by planning it for so many seconds");
  command->add_option("--out", arguments->out,
                      "trajectory file (CSV); with --speed the motion: .csv, .json or .yaml "
                      "(JointTrajectory), .mcap (JointState)");
  command->add_option(
      "--certificate", arguments->certificate,
      "where there is no path: a proof of it, which `check --certificate` verifies (JSON)");
  command->add_option("--json", arguments->json, "result file, - for standard output");
  command->add_option("--trace", arguments->trace,
                      "timeline of stages, batches and FCL calls by thread, in Chrome's trace "
                      "event format; prints how long each "
                      "stage took itself");
  command->add_flag("--map", arguments->map,
                    "print the (s, phi) map: what the search looked at, and the path");
  command->add_option("--map-svg", arguments->map_svg, "the same map as an SVG drawing");
  command->add_option("--report", arguments->report,
                      "the plan as one HTML file: playback, map, plots, summary");
  command->add_flag("--full-map", arguments->full_map,
                    "ask about every node before the map is drawn");
  command->add_flag("--no-check", arguments->no_check,
                    "leave out the proof of the answer, which `check` would give as well");
  command->add_flag("--quiet", arguments->quiet, "print nothing but errors");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
