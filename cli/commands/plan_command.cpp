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

#include "commands/plan_job_command.hpp"
#include "commands/workcell_command.hpp"
#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/advice_or_warning.hpp"
#include "output/motion_output.hpp"
#include "output/self_time_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
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

/// What is to be planned, as problem file and command line say it.
struct PlanRequest {
  const PlanArguments& arguments;
  PathProblem problem{};
  /// The files that were read, which no output may replace.
  std::vector<io::InputFiles::File> inputs{};
  std::optional<TimingOptions> timing{};  ///< set with --speed: the path is timed
  PlanOptions options{};
  std::optional<double> advise_s{};  ///< s, time for all trials of --advise
  double load_ms = 0;                ///< time that loading took
};

/// What was found. Steps after plan_motion() add to it.
struct PlanAnswer {
  MotionPlan plan;
  std::optional<std::vector<Advice>> advice{};      ///< with --advise, where there is no path
  std::optional<InfeasibilityCertificate> proof{};  ///< with --certificate, where there is no path
  std::string certificate{};                        ///< `proof` as JSON
  std::optional<LatticeMap> map{};                  ///< unset if nothing is drawn
  std::string page{};                               ///< HTML of --report

  [[nodiscard]] bool solved() const { return plan.result.status == PlanStatus::kSolved; }
  [[nodiscard]] bool infeasible() const { return plan.result.status == PlanStatus::kInfeasible; }
  /// Returns true if there is a path, and with --speed its timed motion too.
  [[nodiscard]] bool executable(const PlanRequest& request) const {
    return solved() && (!request.timing || plan.motion->motion);
  }
};

/// Returns the time in ms that the plan noted for a stage; 0 if it noted none.
double ms(const PlanResult& result, const char* key) {
  const auto found = result.time_ms.find(key);
  return found == result.time_ms.end() ? 0.0 : found->second;
}

/// Returns the words that say how long the proof of the answer took; "" if it was not proved.
std::string check_words(const PlanResult& result) {
  char text[40] = "";
  if (result.checked) std::snprintf(text, sizeof text, ", checked in %.1f ms", ms(result, "check"));
  return text;
}

/// Prints the answer, times and work counts of a plan; warnings go to standard error.
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

/// A problem file as it was read.
struct LoadedFile {
  Problem problem{};
  std::vector<io::InputFiles::File> inputs{};  ///< the files that were read
  double load_ms = 0;                          ///< time that loading took
};

LoadedFile load_file(const PlanArguments& arguments) {
  const TraceSpan span("load");
  const auto start = std::chrono::steady_clock::now();
  const io::InputFiles noted;
  LoadedFile file{.problem = io::load_problem(arguments.problem)};
  file.inputs = noted.files();
  file.load_ms = milliseconds_since(start);
  return file;
}

/// Reads from the command line whether the path is timed, and completes the problem for what
/// follows the search: with_motion_defaults() for a motion, clearance between layers for a
/// refinement. Throws InputError if --out names a format that does not fit.
void read_motion(PlanRequest& request) {
  const PlanArguments& arguments = request.arguments;
  request.timing = arguments.motion.asked_timing(request.problem.limits);
  if (request.timing) {
    require_motion_formats(arguments.out);
    request.problem = with_motion_defaults(std::move(request.problem));
  } else {
    require_table_names(arguments.out, "a path without times",
                        "--speed, with which motions are written in other formats");
    if (arguments.refine) keep_clearance_between_layers(request.problem.limits);
  }
}

/// Gives a request the times that the command line allows, and what is to be found out besides the
/// answer. Throws InputError.
template <class Request>
void take_limits(const PlanArguments& arguments, Request& request) {
  if (arguments.timeout) request.options.timeout_s = positive(*arguments.timeout, "--timeout");
  if (arguments.advise) request.advise_s = positive(*arguments.advise, "--advise");
  if (!arguments.quiet || !arguments.json.empty() || !arguments.report.empty())
    request.options.evidence = Evidence::all();
}

/// Returns the request that a problem of one path and the command line make. Throws InputError.
PlanRequest request_of(const PlanArguments& arguments, LoadedFile file) {
  PlanRequest request{.arguments = arguments,
                      .problem = problem_of_run(file.problem, {0, false}),
                      .inputs = std::move(file.inputs),
                      .options = arguments.search.plan_options(),
                      .load_ms = file.load_ms};
  read_motion(request);
  take_limits(arguments, request);
  return request;
}

/// Throws InputError if options contradict each other, or need what this build lacks.
void require_options_agree(const PlanRequest& request) {
  const PlanArguments& arguments = request.arguments;
  if (!arguments.report.empty()) require_pages();
  if (arguments.full_map && !arguments.draws())
    throw InputError("--full-map: nothing is drawn: allowed with --map, --map-svg or --report");
  if (arguments.map && arguments.json == "-")
    throw InputError("--map: standard output is taken by --json -: allowed is one of the two");
  if (!arguments.certificate.empty() && (arguments.refine || request.timing))
    throw InputError(
        "--certificate: is of the problem as its file has it: allowed without --refine and "
        "--speed, which ask for more");
}

/// Adds the files of the command line to `outputs`. Throws InputError if one cannot be written.
void add_outputs(const PlanArguments& arguments, io::OutputFiles& outputs) {
  for (const std::string& file : arguments.out) outputs.add("--out", file);
  outputs.add("--report", arguments.report);
  outputs.add("--map-svg", arguments.map_svg);
  outputs.add("--certificate", arguments.certificate);
  outputs.add("--trace", arguments.trace);
  outputs.add("--json", arguments.json);
}

/// Where there is no path, seeks changes that would help, within --advise and what is left of
/// --timeout, that of `budget`.
void find_advice(const Planner& planner, const PlanRequest& request, const Budget& budget,
                 PlanAnswer& answer) {
  if (!request.advise_s || !answer.infeasible()) return;
  PlanOptions trials = request.options;
  trials.timeout_s = std::min(budget.seconds_left().value_or(*request.advise_s), *request.advise_s);
  answer.advice = advice_or_warning(answer.plan.result.warnings,
                                    [&] { return advise(planner, answer.plan.result, trials); });
}

/// Where there is no path, proves it with a certificate. Adds a warning to the result if the budget
/// ends first.
void find_certificate(const Planner& planner, const Budget& budget, PlanAnswer& answer) {
  if (!answer.infeasible()) return;
  PlanResult& result = answer.plan.result;
  const auto start = std::chrono::steady_clock::now();
  try {
    answer.proof = prove_infeasible(planner.view(), budget);
    answer.certificate = io::to_json(*answer.proof);
  } catch (const Stopped&) {
    result.warnings.push_back("stopped before the certificate was found: there is none");
  }
  result.time_ms["certificate"] = milliseconds_since(start);
}

/// Returns what followed the search, for the result file. It points into `answer`.
io::PlanExtras extras_of(const PlanRequest& request, const PlanAnswer& answer) {
  const MotionPlan& plan = answer.plan;
  return {plan.refinement ? &*plan.refinement : nullptr, plan.motion ? &*plan.motion : nullptr,
          request.timing.value_or(TimingOptions{}),      answer.advice ? &*answer.advice : nullptr,
          answer.proof ? &*answer.proof : nullptr,       answer.certificate.size()};
}

/// Returns the page of --report.
std::string page_of(const PlanRequest& request, const PlanAnswer& answer, const PlanView& view,
                    const io::PlanExtras& extras, const Budget& budget) {
  const MotionPlan& plan = answer.plan;
  PageMotion motion;
  if (plan.refinement && plan.refinement->refined) motion.refined = &plan.result.trajectory;
  if (plan.motion && plan.motion->motion) motion.motion = &*plan.motion->motion;
  const io::VisualRobot visual = io::load_visuals(*view.problem.model);
  return to_page(view, *answer.map, io::to_json(plan.result, extras), motion, budget,
                 {request.arguments.episode.words(),
                  answer_text(plan.result) + (answer.advice ? advice_text(*answer.advice) : ""),
                  visual.model.get(), visual.left_out});
}

/// Makes the lattice map and the page, if they are asked for and the plan has a verdict. Adds a
/// warning to the result if the budget ends first; there is then neither map nor page.
void draw(const Planner& planner, const PlanRequest& request, const io::PlanExtras& extras,
          const Budget& budget, PlanAnswer& answer) {
  const PlanArguments& arguments = request.arguments;
  PlanResult& result = answer.plan.result;
  if (!arguments.draws() || result.status == PlanStatus::kTimeout ||
      result.status == PlanStatus::kCancelled)
    return;
  try {
    const PlanView view = planner.view();
    answer.map = make_map(view, arguments.full_map, budget);
    if (!arguments.report.empty()) answer.page = page_of(request, answer, view, extras, budget);
  } catch (const Stopped&) {
    answer.map.reset();
    result.warnings.push_back("stopped before the map was drawn: there is none, and no report");
  }
}

/// Gives --out its text: with --speed the timed motion, else the path. Marks an earlier file for
/// removal if there is none.
void write_path(const PlanRequest& request, const PlanAnswer& answer, io::OutputFiles& outputs) {
  const MotionPlan& plan = answer.plan;
  if (!answer.executable(request))
    outputs.remove("--out");
  else if (!request.timing)
    outputs.write("--out", io::to_csv(plan.result));
  else
    outputs.write_each("--out", [&](const std::filesystem::path& file) {
      return io::motion_text(*plan.motion->motion, plan.result.joint_names,
                             request.problem.base_link, file);
    });
}

/// Gives all outputs their texts, or marks earlier files for removal. Moves certificate and page
/// out of `answer`.
void write_answer(const PlanRequest& request, const io::PlanExtras& extras,
                  const std::optional<Timeline>& timeline, PlanAnswer& answer,
                  io::OutputFiles& outputs) {
  write_path(request, answer, outputs);
  if (answer.proof)
    outputs.write("--certificate", std::move(answer.certificate));
  else
    outputs.remove("--certificate");
  if (answer.map) {
    outputs.write("--report", std::move(answer.page));
    if (outputs.wants("--map-svg")) outputs.write("--map-svg", to_svg(*answer.map));
  } else {
    outputs.remove("--report");
    outputs.remove("--map-svg");
  }
  if (timeline) outputs.write("--trace", io::to_trace_json(*timeline) + "\n");
  if (outputs.wants("--json"))
    outputs.write("--json", io::to_json(answer.plan.result, extras) + "\n");
}

/// Returns the reason for which earlier files are removed.
const char* reason_of_removal(const PlanRequest& request, const PlanAnswer& answer,
                              const io::OutputFiles& outputs) {
  if (answer.infeasible()) return "there is no path now";
  if (answer.executable(request) && outputs.wants("--certificate")) return "there is a path now";
  if (answer.solved() && !answer.plan.stopped) return "there is no motion now";
  return "the search was stopped";
}

/// Prints summary, times of the stages and map, as far as they are asked for.
void print_answer(const PlanRequest& request, const PlanAnswer& answer,
                  const io::PlanExtras& extras, const std::optional<Timeline>& timeline,
                  const io::OutputFiles& outputs) {
  const PlanArguments& arguments = request.arguments;
  const PlanResult& result = answer.plan.result;
  if (!arguments.quiet && !outputs.takes_standard_output()) {
    print_summary(result);
    print_plan_extras(extras, result.joint_names);
    if (answer.proof) say_text(certificate_text(*answer.proof, extras.certificate_bytes));
    if (answer.advice) say_text(advice_text(*answer.advice));
  }
  if (!arguments.quiet && timeline) print_self_times(*timeline);
  if (answer.map && arguments.map)
    std::fputs(to_text(*answer.map, terminal_columns(), coloured()).c_str(), stdout);
}

ExitCode exit_code_of(const PlanRequest& request, const PlanAnswer& answer) {
  if (answer.infeasible()) return kNo;
  if (!answer.solved()) return kStopped;
  if (answer.executable(request)) return kOk;
  return answer.plan.stopped ? kStopped : kNo;
}

/// Throws InputError for options that are of problems with one path alone.
void require_options_of(const PlanArguments& arguments, const Problem& problem) {
  if (is_path(problem)) return;
  const bool two_arms = problem.arms.size() == 2;
  refuse_options(problem, arguments.problem,
                 {{!two_arms && arguments.refine, "--refine"},
                  {!two_arms && arguments.motion.chord.has_value(), "--chord"},
                  {!arguments.trace.empty(), "--trace"},
                  {arguments.map, "--map"},
                  {!arguments.map_svg.empty(), "--map-svg"},
                  {arguments.full_map, "--full-map"}});
  require_planner_of(problem, arguments.search);
}

/// Plans a job and writes and prints the answer, as plan_problem() does for one path.
int plan_job_of(const PlanArguments& arguments, LoadedFile file,
                std::optional<io::OutputFiles>& outputs) {
  if (!arguments.report.empty()) require_pages();
  JobRequest request{.job = std::move(file.problem),
                     .options = arguments.search.plan_options(),
                     .which = arguments.episode.words(),
                     .report = !arguments.report.empty(),
                     .quiet = arguments.quiet,
                     .load_ms = file.load_ms};
  if (arguments.motion.ask_for_job_motion()) {
    require_motion_formats(arguments.out);
    request.timing = arguments.motion.job_timing();
    require_speeds(request.job, *request.timing);
  } else {
    require_table_names(arguments.out, "a job without times",
                        "--speed or --rate, with which motions are written in other formats");
  }
  if (!arguments.certificate.empty() && request.job.arm().lift)
    throw InputError(
        "--certificate: proves that one run of a stroke has no path, and the job allows several "
        "by `lift`: allowed without lift-offs");
  if (!arguments.certificate.empty() && request.timing)
    throw InputError(
        "--certificate: is of the job as its file has it: allowed without --speed and --rate, "
        "which ask for more");
  take_limits(arguments, request);
  outputs.emplace(std::move(file.inputs));
  add_outputs(arguments, *outputs);
  return plan_job_file(std::move(request), *outputs);
}

/// Plans a workcell and writes and prints the answer.
int plan_workcell_of(const PlanArguments& arguments, LoadedFile file,
                     std::optional<io::OutputFiles>& outputs) {
  if (!arguments.report.empty()) require_pages();
  if (!arguments.certificate.empty() && (arguments.refine || arguments.motion.speed))
    throw InputError(
        "--certificate: is of the workcell as its file has it: allowed without --refine and "
        "--speed, which ask for more");
  WorkcellRequest request{.cell = std::move(file.problem),
                          .options = arguments.search.plan_options(),
                          .refine = arguments.refine,
                          .which = arguments.episode.words(),
                          .report = !arguments.report.empty(),
                          .quiet = arguments.quiet,
                          .load_ms = file.load_ms};
  request.timing = arguments.motion.asked_timing({});
  if (request.timing) {
    require_motion_formats(arguments.out);
    request.cell = with_motion_defaults(std::move(request.cell));
  } else {
    require_table_names(arguments.out, "the trajectory of a workcell without times",
                        "--speed, with which motions are written in other formats");
    for (ArmTask& arm : request.cell.arms)
      if (arguments.refine) keep_clearance_between_layers(arm.path().limits);
  }
  take_limits(arguments, request);
  outputs.emplace(std::move(file.inputs));
  add_outputs(arguments, *outputs);
  return plan_workcell_file(std::move(request), *outputs);
}

/// Plans the problem, job or workcell of the command line and writes and prints the answer. Returns
/// the exit code. Sets `outputs` as soon as it is known that they may be written. Throws
/// InputError.
int plan_problem(const PlanArguments& arguments, std::optional<io::OutputFiles>& outputs) {
  std::optional<Timeline> timeline;
  if (!arguments.trace.empty()) timeline.emplace();
  LoadedFile file = load_file(arguments);
  require_options_of(arguments, file.problem);
  file.problem = chosen_problem(file.problem, arguments.search, arguments.episode);
  if (file.problem.arms.size() == 2) return plan_workcell_of(arguments, std::move(file), outputs);
  if (!is_path(file.problem)) return plan_job_of(arguments, std::move(file), outputs);
  PlanRequest request = request_of(arguments, std::move(file));

  catch_interrupts();
  ProgressLine progress(!arguments.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  require_options_agree(request);
  outputs.emplace(std::move(request.inputs));
  add_outputs(arguments, *outputs);

  const Budget budget = request.options.budget();  // of proof and map; plan_motion() has its own
  Planner planner(request.problem);
  PlanAnswer answer{plan_motion(planner, request.options, arguments.refine, request.timing)};
  answer.plan.result.time_ms["load"] = request.load_ms;
  find_advice(planner, request, budget, answer);
  if (outputs->wants("--certificate")) find_certificate(planner, budget, answer);
  const io::PlanExtras extras = extras_of(request, answer);
  draw(planner, request, extras, budget, answer);
  progress.clear();

  write_answer(request, extras, timeline, answer, *outputs);
  deliver(*outputs, reason_of_removal(request, answer, *outputs),
          [&] { print_answer(request, answer, extras, timeline, *outputs); });
  return exit_code_of(request, answer);
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
                    "print the (s, phi) map: what the search looked at, and the path");
  command->add_option("--map-svg", arguments->map_svg, "the same map as an SVG drawing");
  command->add_option("--report", arguments->report,
                      "the plan as one HTML file: playback, maps, plots, summary");
  command->add_flag("--full-map", arguments->full_map,
                    "ask about every node before the map is drawn");
  command->add_flag("--quiet", arguments->quiet, "print nothing but errors");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
