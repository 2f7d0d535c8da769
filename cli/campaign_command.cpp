// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <tuple>

#include "commands.hpp"
#include "progress.hpp"
#include "search_options.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/campaign.hpp"
#include "swivel/report/overview.hpp"

namespace swivel::cli {

namespace {

namespace fs = std::filesystem;

struct CampaignArguments {
  std::string problem, shard, out, trajectories, json, report;
  std::uint64_t episodes = 100, seed = 1;
  SearchOptions search;
};

Shard shard_from_string(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  bool read = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  if (read) {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    read = count.ec == std::errc() && count.ptr == end && shard.index < shard.count;
  }
  if (!read) throw InputError("--shard: '" + text + "': allowed is I/N, I from 0 to N - 1");
  return shard;
}

/// The trajectories of a campaign: DIR/episode_K.csv.
class Trajectories {
 public:
  explicit Trajectories(fs::path folder) : folder_(std::move(folder)) {
    std::error_code ignored;
    if (fs::exists(folder_, ignored) && !fs::is_directory(folder_, ignored))
      throw InputError("--trajectories: " + folder_.string() + " is not a folder: allowed is a folder, or a name for a new one");
  }
  /// Safe to call for several episodes at a time.
  void write(std::uint64_t episode, const PlanResult& result) const {
    std::error_code error;
    if (result.status != PlanStatus::kSolved) {
      fs::remove(file(episode), error);  // of an older campaign
      return;
    }
    fs::create_directories(folder_, error);
    if (error)
      throw InputError("--trajectories: " + folder_.string() + ": " + error.message() +
                       ": allowed is a folder that can be written");
    io::write_trajectory(file(episode), result);
  }
  /// Whether all is there that a row promises.
  [[nodiscard]] bool has(const EpisodeRow& row) const { return row.status != PlanStatus::kSolved || fs::exists(file(row.episode)); }

 private:
  [[nodiscard]] fs::path file(std::uint64_t episode) const { return folder_ / ("episode_" + std::to_string(episode) + ".csv"); }
  fs::path folder_;
};

void print_summary(const CampaignSummary& summary) {
  std::printf("%llu of %llu episodes answered: %llu solved, %llu infeasible\n", static_cast<unsigned long long>(summary.answered()),
              static_cast<unsigned long long>(summary.episodes), static_cast<unsigned long long>(summary.solved),
              static_cast<unsigned long long>(summary.infeasible));
  if (summary.answered() == 0) return;
  std::printf("plan %.1f ms in the median (5 %% below %.1f, 5 %% above %.1f); nodes checked %.0f, FCL calls %.0f in the median\n",
              summary.plan_ms.median, summary.plan_ms.p5, summary.plan_ms.p95, summary.nodes_checked.median,
              summary.fcl_calls.median);
}

/// Rows do not say of which seed and settings they are, so the last one is planned again before others join it.
void require_same_campaign(const PreparedRobot& robot, const Problem& problem, const CampaignOptions& options,
                           const std::vector<EpisodeRow>& rows, const std::string& out) {
  if (rows.empty()) return;
  const EpisodeRow& row = rows.back();
  PlanOptions single = options.plan;
  single.threads = 1;
  const PlanResult result = plan(robot, episode_problem(problem, options.seed, row.episode), single);
  if (result.status != PlanStatus::kSolved && result.status != PlanStatus::kInfeasible) return;  // timed out or cancelled
  const EpisodeRow again(row.episode, result);
  if (std::tie(again.status, again.cost, again.failed_s, again.reason) != std::tie(row.status, row.cost, row.failed_s, row.reason))
    throw InputError(
        out + ".part:" + std::to_string(rows.size() + 1) + ": episode " + std::to_string(row.episode) +
        " comes out differently now: allowed are rows of the same problem, seed and settings; remove the file to start anew");
}

/// As a POSIX shell reads it back.
std::string quoted(const std::string& word) {
  if (!word.empty() &&
      word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-") == std::string::npos)
    return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

CampaignFacts facts_of(const CampaignArguments& arguments, const CampaignOptions& options) {
  const std::string name = fs::path(arguments.problem).filename().string();
  const std::string seed = std::to_string(options.seed);
  return {name,
          options.episodes,
          options.seed,
          options.shard,
          arguments.search.planner,
          "swivel plan " + quoted(arguments.problem) + arguments.search.words() + " --seed " + seed};
}

int run(const CampaignArguments& arguments) {
  CampaignOptions options;
  options.plan = arguments.search.plan_options();
  constexpr std::uint64_t kMostEpisodes = 10'000'000;
  if (arguments.episodes < 1 || arguments.episodes > kMostEpisodes)
    throw InputError("--episodes: " + std::to_string(arguments.episodes) + ": allowed are 1 to " + std::to_string(kMostEpisodes));
  options.episodes = arguments.episodes;
  options.seed = arguments.seed;
  if (!arguments.shard.empty()) options.shard = shard_from_string(arguments.shard);
  if (!arguments.report.empty()) require_pages();
  Problem problem = io::load_problem(arguments.problem);
  arguments.search.apply(problem);
  const PreparedRobot robot(problem);

  std::optional<Trajectories> trajectories;
  if (!arguments.trajectories.empty()) {
    trajectories.emplace(arguments.trajectories);
    options.planned = [&](std::uint64_t episode, const PlanResult& result) { trajectories->write(episode, result); };
  }
  const std::uint64_t size = options.shard.size(options.episodes);
  std::vector<EpisodeRow> rows;
  std::optional<io::CampaignFile> file;
  if (!arguments.out.empty()) {
    file.emplace(arguments.out, options.shard, options.episodes);
    if (trajectories) {  // the campaign that was killed may have been run without
      const auto& found = file->rows();
      const auto lacking =
          std::find_if_not(found.begin(), found.end(), [&](const EpisodeRow& row) { return trajectories->has(row); });
      file->keep(static_cast<std::size_t>(lacking - found.begin()));
    }
    rows = file->rows();
  }
  options.skip = rows.size();
  require_same_campaign(robot, problem, options, rows, arguments.out);

  catch_interrupts();
  ProgressLine progress(isatty(STDERR_FILENO) != 0);
  auto solved = std::count_if(rows.begin(), rows.end(), [](const EpisodeRow& row) { return row.status == PlanStatus::kSolved; });
  const auto show = [&] {
    progress.show(std::to_string(rows.size()) + " of " + std::to_string(size) + " episodes, " + std::to_string(solved) + " solved");
  };
  show();
  run_campaign(robot, problem, options, [&](const EpisodeRow& row) {
    if (file) file->append(row);
    rows.push_back(row);
    solved += row.status == PlanStatus::kSolved;
    show();
  });
  progress.clear();

  const CampaignSummary summary = summarize(rows, size);
  const bool complete = summary.answered() == size;
  if (file && complete) file->finish();
  if (!arguments.report.empty()) io::write_file(arguments.report, to_overview(rows, facts_of(arguments, options)));
  if (arguments.json == "-")
    std::cout << io::to_json(summary);
  else if (!arguments.json.empty())
    io::write_file(arguments.json, io::to_json(summary));
  if (arguments.json != "-") print_summary(summary);
  return complete ? kOk : kStopped;
}

}  // namespace

void add_campaign(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("campaign", "Plan many episodes: the problem with the objects of 'vary' at random poses");
  auto arguments = std::make_shared<CampaignArguments>();  // shared: lives as long as the callback that reads it
  command->add_option("problem", arguments->problem, "problem file")->required();
  command->add_option("--episodes", arguments->episodes, "how many, all shards together")->capture_default_str();
  command->add_option("--seed", arguments->seed, "what the poses are drawn from")->capture_default_str();
  command->add_option("--shard", arguments->shard, "I/N: plan the episodes I, I + N, I + 2 N, ... alone");
  arguments->search.add_to(*command);
  command->add_option("--out", arguments->out,
                      "results file (CSV); an interrupted campaign goes on from FILE.part, which must be of the same settings");
  command->add_option("--trajectories", arguments->trajectories, "folder for the trajectories of solved episodes, episode_K.csv");
  command->add_option("--report", arguments->report,
                      "the campaign as one HTML file: verdicts, times, costs, where and why episodes fail");
  command->add_option("--json", arguments->json, "summary file, - for standard output");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
