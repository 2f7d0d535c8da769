// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "options/shard_option.hpp"
#include "output/campaign_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/tables/shards.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "terminal/large_pages.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

namespace fs = std::filesystem;

/// The command line of `swivel campaign`.
struct CampaignArguments {
  std::string problem, shard, out, trajectories, json, report;
  std::vector<std::string> rows;
  std::uint64_t episodes = 100, seed = 1;
  SearchOptions search;
};

/// Writes the trajectories of a campaign: DIR/episode_K.csv.
class Trajectories {
 public:
  explicit Trajectories(fs::path folder) : folder_(std::move(folder)) {}
  /// Returns true for the name of a file that a campaign may write.
  [[nodiscard]] static bool is_name(const std::string& name) {
    return name.starts_with("episode_") && name.ends_with(".csv");
  }
  /// Writes the trajectory of an episode, or removes that of an older campaign if there is none.
  /// Several threads may call it at a time. Throws InputError if the folder cannot be written.
  void write(std::uint64_t episode, const Answer& result, const Problem& problem) {
    std::error_code error;
    if (result.status != PlanStatus::kSolved) {
      removed_ += fs::remove(file(episode), error);
      return;
    }
    fs::create_directories(folder_, error);
    if (error)
      throw InputError("--trajectories: " + folder_.string() + ": " + error.message() +
                       ": allowed is a folder that can be written");
    io::write_file(file(episode), io::to_csv(result, problem));
  }
  /// Returns how many files of an older campaign were removed.
  [[nodiscard]] std::uint64_t removed() const { return removed_; }
  /// Returns true if the row has no path, or the file of its trajectory exists.
  [[nodiscard]] bool has(const EpisodeRow& row) const {
    return row.status != PlanStatus::kSolved || fs::exists(file(row.episode));
  }

 private:
  [[nodiscard]] fs::path file(std::uint64_t episode) const {
    return folder_ / ("episode_" + std::to_string(episode) + ".csv");
  }
  fs::path folder_;
  std::atomic<std::uint64_t> removed_{0};
};

/// Returns the settings that an unfinished results file must have to be continued: those of the
/// record and the shard. The number of episodes is none of them, so that a campaign may be made
/// longer.
io::RunSettings settings_of(const io::ShardRecord& record) {
  io::RunSettings settings = record.settings;
  settings.values.emplace_back(
      "shard", std::to_string(record.shard.index) + "/" + std::to_string(record.shard.count));
  return settings;
}

/// Returns the rows of --rows in the order of the campaign. Throws InputError unless they are its
/// first rows.
std::vector<EpisodeRow> given_rows(const std::vector<std::string>& files,
                                   const CampaignOptions& options,
                                   const std::vector<std::string>& coordinates) {
  std::vector<EpisodeRow> rows;
  for (const std::string& file : files) {
    const io::EpisodeTable found = io::load_rows(file);
    if (found.coordinates != coordinates)
      throw InputError(
          "--rows: " + file +
          ": other objects or coordinates vary there: allowed are results of this problem");
    rows.insert(rows.end(), found.rows.begin(), found.rows.end());
  }
  std::sort(rows.begin(), rows.end(),
            [](const EpisodeRow& a, const EpisodeRow& b) { return a.episode < b.episode; });
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (k >= options.shard.size(options.episodes) || rows[k].episode != options.shard.episode(k))
      throw InputError(
          "--rows: the rows from episode " + std::to_string(rows[k].episode) +
          " on are not the next of this campaign: allowed are its first rows, each once");
  return rows;
}

/// Returns the options of the campaign, which plan from its first episode. Throws InputError.
CampaignOptions campaign_options(const CampaignArguments& arguments) {
  CampaignOptions options;
  options.plan = arguments.search.plan_options();
  constexpr std::uint64_t kMostEpisodes = 10'000'000;
  if (arguments.episodes < 1 || arguments.episodes > kMostEpisodes)
    throw InputError("--episodes: " + std::to_string(arguments.episodes) + ": allowed are 1 to " +
                     std::to_string(kMostEpisodes));
  options.episodes = arguments.episodes;
  options.seed = arguments.seed;
  if (!arguments.shard.empty()) options.shard = shard_from_string(arguments.shard);
  return options;
}

/// Adds the files of the command line to `outputs`. Throws InputError if one cannot be written.
void add_outputs(const CampaignArguments& arguments, io::OutputFiles& outputs) {
  outputs.add("--out", arguments.out);
  if (!arguments.out.empty()) outputs.add("the rows of --out", arguments.out + ".part");
  outputs.add("--report", arguments.report);
  outputs.add("--json", arguments.json);
  if (!arguments.trajectories.empty())
    outputs.add_folder("--trajectories", arguments.trajectories, Trajectories::is_name);
}

/// Returns the record of this run, which a shard's results begin with.
io::ShardRecord record_of(const CampaignArguments& arguments, const CampaignOptions& options,
                          const PathProblem& problem, const std::vector<HeldJoint>& held,
                          const std::vector<io::InputFiles::File>& inputs) {
  io::ShardRecord record{"campaign",
                         run_settings(arguments.problem, problem, arguments.search, inputs),
                         options.shard,
                         options.episodes,
                         fs::path(arguments.problem).filename().string(),
                         "swivel plan " + quoted(arguments.problem) + arguments.search.words() +
                             " --seed " + std::to_string(options.seed)};
  record.settings.values.emplace_back("seed", std::to_string(options.seed));
  record.held = held;
  record.settings.coordinates = varied_coordinates(problem.vary);
  return record;
}

/// Brings the results file and the rows of --rows together: appends to the file those `given` rows
/// that it lacks. With --trajectories, cuts the file before the first row whose trajectory is
/// missing, since the campaign that was interrupted may have run without that option. Returns the
/// rows that the file then has.
std::vector<EpisodeRow> resume(io::CampaignFile& file, const std::vector<EpisodeRow>& given,
                               const std::optional<Trajectories>& trajectories) {
  for (std::size_t k = file.rows().size(); k < given.size(); ++k) file.append(given[k]);
  if (trajectories) {
    const auto& found = file.rows();
    const auto lacking = std::find_if_not(
        found.begin(), found.end(), [&](const EpisodeRow& row) { return trajectories->has(row); });
    file.keep(lacking - found.begin());
  }
  return file.rows();
}

/// Plans the episodes that `rows` lacks, and appends them to `rows` and to the results file. Shows
/// on standard error how many are done.
/// `robot`: the prepared one, unless the problem is of two arms.
void plan_episodes(const std::optional<PreparedRobot>& robot, const ChosenProblem& drawn,
                   const CampaignOptions& options, std::vector<EpisodeRow>& rows,
                   std::optional<io::CampaignFile>& file) {
  ProgressLine progress(isatty(STDERR_FILENO) != 0);
  const std::uint64_t size = options.shard.size(options.episodes);
  auto solved = std::count_if(rows.begin(), rows.end(), [](const EpisodeRow& row) {
    return row.status == PlanStatus::kSolved;
  });
  const std::uint64_t before = rows.size();
  const auto show = [&] {
    progress.show(std::to_string(rows.size()) + " of " + std::to_string(size) + " episodes, " +
                  std::to_string(solved) + " solved" +
                  time_to_go(rows.size() - before, size - before, progress.seconds()));
  };
  show();
  const auto row_done = [&](const EpisodeRow& row) {
    if (file) file->append(row);
    rows.push_back(row);
    solved += row.status == PlanStatus::kSolved;
    show();
  };
  if (robot)
    run_campaign(*robot, drawn.problem, options, row_done);
  else
    run_campaign(drawn.problem, options, row_done);
  if (file) file->flush();
}

/// Writes results, summary and page, prints the summary, and finishes the results file if all rows
/// are there.
void write_results(const CampaignArguments& arguments, const std::vector<EpisodeRow>& rows,
                   bool complete, const io::ShardRecord& record,
                   std::optional<io::CampaignFile>& file, io::OutputFiles& outputs) {
  if (file && complete)
    outputs.write("--out", (arguments.shard.empty() ? "" : io::to_line(record)) + file->csv());
  show_campaign(outputs, rows, record);
  if (file && complete) file->finish();
}

/// Plans the campaign of the command line, from where an earlier run of it ended, writes and prints
/// its results. Returns the exit code. Throws InputError.
int run(const CampaignArguments& arguments) {
  use_heaps_of_threads();
  CampaignOptions options = campaign_options(arguments);
  if (!arguments.report.empty()) require_pages();
  require_table_name("--out", arguments.out, "the table of episodes", "--json for a summary");
  const ChosenProblem drawn = load_chosen(
      arguments.problem, arguments.search,
      arguments.out.empty() ? io::InputFiles::Contents::kIgnore : io::InputFiles::Contents::kHash);
  const Problem& problem = drawn.problem;
  std::optional<PreparedRobot> robot;
  if (problem.arms.size() == 1) robot.emplace(drawn.first);
  const std::vector<HeldJoint> held = held_joints(problem);
  warn_of_held(held);

  std::vector<io::InputFiles::File> read = drawn.inputs;
  std::vector<EpisodeRow> rows = [&] {
    const io::InputFiles noted;
    std::vector<EpisodeRow> found =
        given_rows(arguments.rows, options, varied_coordinates(problem.vary));
    read.insert(read.end(), noted.files().begin(), noted.files().end());
    return found;
  }();
  io::OutputFiles outputs(read);
  add_outputs(arguments, outputs);
  std::optional<Trajectories> trajectories;
  if (!arguments.trajectories.empty()) {
    trajectories.emplace(arguments.trajectories);
    options.planned = [&](std::uint64_t episode, const Answer& answer) {
      trajectories->write(episode, answer, problem);
    };
  }
  const io::ShardRecord record = record_of(arguments, options, drawn.first, held, drawn.inputs);
  std::optional<io::CampaignFile> file;
  if (!arguments.out.empty()) {
    file.emplace(arguments.out, settings_of(record), options.shard, options.episodes);
    rows = resume(*file, rows, trajectories);
  }
  options.skip = rows.size();

  catch_interrupts();
  plan_episodes(robot, drawn, options, rows, file);
  const bool complete = rows.size() == options.shard.size(options.episodes);
  write_results(arguments, rows, complete, record, file, outputs);
  if (trajectories && trajectories->removed() > 0)
    complain("swivel: removed %llu earlier trajectories in %s: there is no %s now\n",
             static_cast<unsigned long long>(trajectories->removed()),
             arguments.trajectories.c_str(),
             is_path(problem)           ? "path"
             : problem.arms.size() == 1 ? "job"
                                        : "plan");
  return campaign_exit_code(rows, record);
}

}  // namespace

void add_campaign(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("campaign",
                                         "Plan many episodes: the problem, job or workcell with "
                                         "the objects of 'vary' at random poses");
  // The callback shares the arguments, which must live as long as it does.
  auto arguments = std::make_shared<CampaignArguments>();
  command->add_option("problem", arguments->problem, "problem file, job or workcell")->required();
  command->add_option("--episodes", arguments->episodes, "how many, all shards together")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "what the poses are drawn from")
      ->capture_default_str();
  command->add_option("--shard", arguments->shard,
                      "I/N: plan the episodes I, I + N, I + 2 N, ... alone; auto: the share of "
                      "this task of a Slurm job array");
  arguments->search.add_to(*command);
  command->add_option("--out", arguments->out,
                      "results file (CSV); an interrupted campaign goes on from FILE.part, which "
                      "must be of the same settings");
  command->add_option("--rows", arguments->rows,
                      "results of a shorter campaign, to go on from; that they are of the same "
                      "settings is not checked (shards: swivel merge)");
  command->add_option("--trajectories", arguments->trajectories,
                      "folder for the trajectories of solved episodes, episode_K.csv");
  command->add_option(
      "--report", arguments->report,
      "the campaign as one HTML file: verdicts, times, costs, where and why episodes fail");
  command->add_option("--json", arguments->json, "summary file, - for standard output");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
