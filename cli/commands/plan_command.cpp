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
#include <vector>

#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/advice_or_warning.hpp"
#include "output/answer_output.hpp"
#include "output/motion_output.hpp"
#include "output/self_time_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/report/lattice_map.hpp"
#include "swivel/report/page.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// The command line of `swivel plan`.
struct PlanArguments {
  std::string problem, json, trace, map_svg, report, certificate;
  std::vector<std::string> out;
  std::optional<double> timeout;
  std::optional<double> advise;
  bool quiet = false, map = false, full_map = false, refine = false;
  SearchOptions search;
  MotionOptions motion;
  EpisodeChoice episode;

  /// Returns true if the lattice map is drawn, in whatever form.
  [[nodiscard]] bool draws() const { return map || !map_svg.empty() || !report.empty(); }
};

/// Returns what the answer of a problem is called: a path, a job of strokes, or a plan of two arms.
const char* noun_of(const Problem& problem) {
  return problem.arms.size() == 2 ? "plan" : is_path(problem) ? "path" : "job";
}

/// What is to be planned, as problem file and command line say it.
struct PlanRequest {
  const PlanArguments& arguments;
  Problem problem{};  ///< as the file and the choice of an episode or a placement have it
  /// The files that were read, which no output may replace.
  std::vector<io::InputFiles::File> inputs{};
  MotionRequest asked{};
  PlanOptions options{};
  std::optional<double> advise_s{};  ///< s, time for all trials of --advise
  double load_ms = 0;                ///< time that loading took
};

/// What was found.
struct PlanFindings {
  Answer answer{};
  std::optional<AdviceList> advice{};     ///< with --advise, where there is no answer
  std::optional<AnyCertificate> proof{};  ///< with --certificate, where there is no answer
  std::string certificate{};              ///< `proof` as JSON
  std::vector<RunMap> maps{};             ///< of all runs; none if nothing is drawn
  std::optional<std::string> page{};      ///< HTML of --report

  [[nodiscard]] bool infeasible() const { return answer.status == PlanStatus::kInfeasible; }
};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Reads the problem file of the command line. Throws InputError.
PlanRequest load_file(const PlanArguments& arguments) {
  const TraceSpan span("load");
  const auto start = std::chrono::steady_clock::now();
  const io::InputFiles noted;
  PlanRequest request{.arguments = arguments, .problem = io::load_problem(arguments.problem)};
  request.inputs = noted.files();
  request.options = arguments.search.plan_options();
  request.load_ms = milliseconds_since(start);
  return request;
}

/// Reads from the command line whether the answer is refined and timed. Throws InputError if --out
/// names a format that does not fit, or if a stroke has no speed.
void read_motion(PlanRequest& request) {
  const PlanArguments& arguments = request.arguments;
  const Problem& problem = request.problem;
  const bool strokes = problem.arms.size() == 1 && !is_path(problem);
  request.asked.refine = arguments.refine;
  if (!strokes)
    request.asked.timing =
        arguments.motion.asked_timing(is_path(problem) ? problem.arm().path().limits : Limits());
  if (request.asked.timing || (strokes && arguments.motion.ask_for_job_motion())) {
    require_motion_formats(arguments.out);
  } else {
    require_table_names(arguments.out,
                        strokes            ? "a job without times"
                        : is_path(problem) ? "a path without times"
                                           : "the trajectory of a workcell without times",
                        std::string("--speed") + (strokes ? " or --rate" : "") +
                            ", with which motions are written in other formats");
    return;
  }
  if (!strokes) return;
  request.asked.timing = arguments.motion.timing_of_strokes();
  require_speeds(problem, *request.asked.timing);
}

/// Throws InputError if options contradict each other, or need what this build lacks.
void require_options_agree(const PlanRequest& request) {
  const PlanArguments& arguments = request.arguments;
  const Problem& problem = request.problem;
  if (!arguments.report.empty()) require_pages();
  if (arguments.full_map && !arguments.draws())
    throw InputError("--full-map: nothing is drawn: allowed with --map, --map-svg or --report");
  if (arguments.map && arguments.json == "-")
    throw InputError("--map: standard output is taken by --json -: allowed is one of the two");
  if (arguments.certificate.empty()) return;
  if (problem.arms.size() == 1 && problem.arm().lift)
    throw InputError(
        "--certificate: proves that one run of a stroke has no path, and the job allows several "
        "by `lift`: allowed without lift-offs");
  const bool two_arms = problem.arms.size() == 2, path = is_path(problem);
  if (request.asked.refine || request.asked.timing)
    throw InputError(std::string("--certificate: is of the ") +
                     (two_arms ? "workcell"
                      : path   ? "problem"
                               : "job") +
                     " as its file has it: allowed without " +
                     (two_arms || path ? "--refine and --speed" : "--refine, --speed and --rate") +
                     ", which ask for more");
}

/// Gives a request the times that the command line allows, and what is to be found out besides the
/// answer. Throws InputError.
void take_limits(PlanRequest& request) {
  const PlanArguments& arguments = request.arguments;
  if (arguments.timeout) request.options.timeout_s = positive(*arguments.timeout, "--timeout");
  if (arguments.advise) request.advise_s = positive(*arguments.advise, "--advise");
  if (!arguments.quiet || !arguments.json.empty() || !arguments.report.empty())
    request.options.evidence = Evidence::all();
}

/// Returns the outputs of the command line. Throws InputError if one cannot be written.
void add_outputs(const PlanArguments& arguments, io::OutputFiles& outputs) {
  for (const std::string& file : arguments.out) outputs.add("--out", file);
  outputs.add("--report", arguments.report);
  outputs.add("--map-svg", arguments.map_svg);
  outputs.add("--certificate", arguments.certificate);
  outputs.add("--trace", arguments.trace);
  outputs.add("--json", arguments.json);
}

/// Where there is no answer, seeks changes that would help, within --advise and what is left of
/// --timeout, that of `budget`.
void find_advice(const ProblemPlanner& planner, const PlanRequest& request, const Budget& budget,
                 PlanFindings& found) {
  if (!request.advise_s || !found.infeasible()) return;
  PlanOptions trials = request.options;
  trials.timeout_s = std::min(budget.seconds_left().value_or(*request.advise_s), *request.advise_s);
  found.advice = advice_or_warning(found.answer.warnings,
                                   [&] { return planner.advise(found.answer, trials); });
}

/// Where there is no answer, proves it with a certificate. Adds a warning if there is none, or if
/// the budget ends first.
void find_certificate(const ProblemPlanner& planner, const Budget& budget, PlanFindings& found) {
  if (!found.infeasible()) return;
  const auto start = std::chrono::steady_clock::now();
  try {
    found.proof = planner.prove_infeasible(found.answer, budget);
    if (found.proof)
      found.certificate =
          std::visit([](const auto& proof) { return io::to_json(proof); }, *found.proof);
  } catch (const Stopped&) {
    found.answer.warnings.push_back("stopped before the certificate was found: there is none");
  }
  found.answer.time_ms["certificate"] = milliseconds_since(start);
}

/// Returns what followed the search, for the result file. It points into `found`.
io::AnswerExtras extras_of(const PlanFindings& found) {
  io::AnswerExtras extras{.advice = found.advice ? &*found.advice : nullptr};
  if (found.proof) {
    extras.certificate = std::get_if<InfeasibilityCertificate>(&*found.proof);
    extras.certificate_bytes = found.certificate.size();
  }
  return extras;
}

/// Returns the page of --report.
std::string page_of(const ProblemPlanner& planner, const PlanRequest& request,
                    const PlanFindings& found, const Budget& budget) {
  const Answer& answer = found.answer;
  const Problem problem = executed_problem(planner.problem(), answer);
  const io::VisualRobot visual = io::load_visuals(*problem.arm().model);
  const PageWords words{request.arguments.episode.words(),
                        whole_text(answer, problem, found.advice ? &*found.advice : nullptr),
                        visual.model.get(), visual.left_out};
  return to_page(planner, answer, io::to_json(answer, problem, extras_of(found)), found.maps,
                 budget, words);
}

/// Makes the lattice maps and the page, if they are asked for and the plan has a verdict. Adds a
/// warning if the budget ends first; there are then neither maps nor page.
void draw(const ProblemPlanner& planner, const PlanRequest& request, const Budget& budget,
          PlanFindings& found) {
  const PlanArguments& arguments = request.arguments;
  const Problem& problem = request.problem;
  const bool decided = found.answer.has_rows() || found.infeasible();
  if (!arguments.draws() || !decided) return;
  if (problem.arms.size() == 2 && planner.view().runs.empty()) return;
  try {
    found.maps = make_maps(planner.view(), found.answer, executed_problem(problem, found.answer),
                           arguments.full_map, budget);
    if (!arguments.report.empty()) found.page = page_of(planner, request, found, budget);
  } catch (const Stopped&) {
    found.maps.clear();
    found.answer.warnings.push_back(
        is_path(problem) ? "stopped before the map was drawn: there is none, and no report"
                         : "stopped before the maps were drawn: there are none, and no report");
  }
}

/// Gives --out its text: the motion where one is asked for, else the rows. Marks an earlier file
/// for removal if there is none.
void write_rows(const Answer& answer, const Problem& executed, io::OutputFiles& outputs) {
  if (!answer.is_whole())
    outputs.remove("--out");
  else
    outputs.write_each("--out", [&](const std::filesystem::path& file) {
      return answer.timing ? io::motion_text(answer, executed, file) : io::to_csv(answer, executed);
    });
}

/// Gives all outputs their texts, or marks earlier files for removal. Moves certificate and page
/// out of `found`.
void write_answer(const Problem& executed, const std::optional<Timeline>& timeline,
                  PlanFindings& found, io::OutputFiles& outputs) {
  write_rows(found.answer, executed, outputs);
  if (outputs.wants("--json"))
    outputs.write("--json", io::to_json(found.answer, executed, extras_of(found)) + "\n");
  const auto write_or_remove = [&](const char* option, bool made, auto&& text) {
    if (made && outputs.wants(option))
      outputs.write(option, text());
    else
      outputs.remove(option);
  };
  write_or_remove("--certificate", found.proof.has_value(),
                  [&] { return std::move(found.certificate); });
  write_or_remove("--report", found.page.has_value(), [&] { return *std::move(found.page); });
  write_or_remove("--map-svg", !found.maps.empty(), [&] { return to_svg(found.maps); });
  if (timeline) outputs.write("--trace", io::to_trace_json(*timeline) + "\n");
}

/// Returns the reason for which earlier files are removed.
std::string reason_of_removal(const Problem& problem, const Answer& answer,
                              const io::OutputFiles& outputs) {
  const std::string noun = noun_of(problem);
  if (answer.status == PlanStatus::kInfeasible) return "there is no " + noun + " now";
  if (answer.is_whole() && outputs.wants("--certificate")) return "there is a " + noun + " now";
  if (answer.has_rows() && !answer.is_whole() && !answer.stopped) return "there is no motion now";
  return "the search was stopped";
}

ExitCode exit_code_of(const Answer& answer) {
  if (answer.status == PlanStatus::kInfeasible) return kNo;
  if (answer.is_whole()) return kOk;
  return answer.has_rows() && !answer.stopped ? kNo : kStopped;
}

/// Plans the problem of the command line and writes and prints the answer. Returns the exit code.
/// Sets `outputs` as soon as it is known that they may be written. Throws InputError.
int plan_problem(const PlanArguments& arguments, std::optional<io::OutputFiles>& outputs) {
  std::optional<Timeline> timeline;
  if (!arguments.trace.empty()) timeline.emplace();
  PlanRequest request = load_file(arguments);
  request.problem = chosen_problem(request.problem, arguments.search, arguments.episode);
  read_motion(request);
  require_options_agree(request);
  take_limits(request);
  outputs.emplace(std::move(request.inputs));
  add_outputs(arguments, *outputs);

  catch_interrupts();
  ProgressLine progress(!arguments.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  const Budget budget = request.options.budget();  // of what follows the plan, which has its own
  ProblemPlanner planner(request.problem, request.asked);
  const bool proves = outputs->wants("--certificate");
  PlanFindings found{.answer = planner.plan(request.options, proves || arguments.draws())};
  found.answer.time_ms["load"] = request.load_ms;
  find_advice(planner, request, budget, found);
  if (proves) find_certificate(planner, budget, found);
  draw(planner, request, budget, found);
  progress.clear();

  const Answer& answer = found.answer;
  const Problem executed = executed_problem(request.problem, answer);
  const std::size_t bytes = found.certificate.size();
  write_answer(executed, timeline, found, *outputs);
  deliver(*outputs, reason_of_removal(executed, answer, *outputs), [&] {
    if (!arguments.quiet && !outputs->takes_standard_output())
      print_answer(answer, executed, found.advice, found.proof, bytes);
    if (!arguments.quiet && timeline) print_self_times(*timeline);
    if (arguments.map)
      std::fputs(to_text(found.maps, terminal_columns(), coloured()).c_str(), stdout);
  });
  return exit_code_of(answer);
}

/// Calls plan_problem(). If it fails after the outputs are known, and not through bad input or lack
/// of memory, removes earlier answers and writes the error to --json. Passes every error on.
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

void deliver(io::OutputFiles& outputs, const std::string& reason,
             const std::function<void()>& print) {
  outputs.stage();
  print();
  flush_standard_output();
  report_removed(outputs.commit(), reason);
}

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

void EpisodeChoice::require_episodes(const std::vector<Variation>& vary) const {
  if (seed.has_value() != episode.has_value())
    throw InputError("--seed, --episode: one without the other: allowed are both or neither");
  if (seed && vary.empty())
    throw InputError(
        "--seed, --episode: the file has no `vary`, so that all episodes are alike: allowed is a "
        "file with it, or neither option");
}

Problem EpisodeChoice::apply(const Problem& problem) const {
  require_episodes(problem.vary);
  return placement.apply(seed ? episode_problem(problem, *seed, *episode) : problem);
}

void add_plan(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("plan", "Plan a joint trajectory");
  // The callback shares the arguments, which must live as long as it does.
  auto arguments = std::make_shared<PlanArguments>();
  command->add_option("problem", arguments->problem, "problem file, job or workcell")->required();
  arguments->search.add_to(*command);
  arguments->episode.add_to(*command);
  command->add_option("--timeout", arguments->timeout, "seconds");
  command->add_flag("--refine", arguments->refine,
                    "move the path off the lattice's nodes: cheaper and smoother, never dearer");
  arguments->motion.add_to(*command);
  command->add_option(
      "--advise", arguments->advise,
      "where there is no path: what would help, found by planning it for so many seconds");
  add_out_option(*command, arguments->out,
                 "trajectory file (CSV); with --speed, of jobs also with --rate, the motion: .csv, "
                 ".json or .yaml (JointTrajectory), .mcap (JointState)");
  command->add_option(
      "--certificate", arguments->certificate,
      "where there is no path: a proof of it, which `check --certificate` verifies (JSON)");
  command->add_option("--json", arguments->json, "result file, - for standard output");
  command->add_option("--trace", arguments->trace,
                      "timeline of stages, batches and FCL calls by thread, in Chrome's trace "
                      "event format; prints how long each "
                      "stage took itself");
  command->add_flag("--map", arguments->map,
                    "print the (s, phi) map, of each stroke or arm: what the search looked at, and "
                    "the path");
  command->add_option("--map-svg", arguments->map_svg, "the same maps as an SVG drawing");
  command->add_option("--report", arguments->report,
                      "the plan as one HTML file: playback, maps, plots, summary");
  command->add_flag("--full-map", arguments->full_map,
                    "ask about every node before the map is drawn");
  command->add_flag("--quiet", arguments->quiet, "print nothing but errors");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
