// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/campaign_output.hpp"
#include "output/placement_output.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/io/tables/shards.hpp"

namespace swivel::cli {

namespace {

struct MergeArguments {
  std::string out, report, json, svg;
  std::vector<std::string> shards;
  std::size_t top = 10;
};

int run(const MergeArguments& arguments) {
  if (!arguments.report.empty()) require_pages();
  require_table_name("OUT", arguments.out, "the table of rows",
                     "--json, --svg and --report for other formats");
  std::vector<io::InputFiles::File> inputs;
  io::ShardResults whole = [&] {
    const io::InputFiles noted;
    std::vector<io::ShardResults> shards;
    for (const std::string& file : arguments.shards) shards.push_back(io::load_shard(file));
    inputs = noted.files();
    return io::join_shards(std::move(shards));
  }();
  const io::ShardRecord& record = whole.record;
  const bool places = record.command == "place";
  if (places && !arguments.json.empty())
    throw InputError("--json: these are placements: allowed are shards of a campaign");
  if (!places && !arguments.svg.empty())
    throw InputError("--svg: this is a campaign: allowed are shards of placements");
  const PlacementRequest request = places ? PlacementRequest::from(record) : PlacementRequest();
  if (places && request.total() != record.total)
    throw InputError(whole.file + ":1: of " + std::to_string(record.total) +
                     " cells, where its grid has " + std::to_string(request.total()) +
                     ": allowed are shards as they were written");
  require_drawable(request, arguments.svg);

  io::OutputFiles outputs(inputs);
  outputs.add("OUT", arguments.out);
  outputs.add("--report", arguments.report);
  outputs.add("--json", arguments.json);
  outputs.add("--svg", arguments.svg);
  if (const auto* const rows = std::get_if<io::EpisodeRows>(&whole.rows)) {
    outputs.write("OUT", io::to_csv(*rows, record.settings.coordinates));
    show_campaign(outputs, *rows, record);
    return campaign_exit_code(*rows, record);
  }
  const auto& rows = std::get<io::PlacementRows>(whole.rows);
  outputs.write("OUT", io::to_csv(rows));
  show_placements(outputs, rows, request, record, arguments.top, "");
  return placement_exit_code(rows);
}

}  // namespace

void add_merge(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("merge",
                                         "Join the shards of a campaign, or of placements, into "
                                         "the results of one that was not split");
  // shared, so that it lives as long as the callback that reads it
  auto arguments = std::make_shared<MergeArguments>();
  command->add_option("out", arguments->out, "results file (CSV), - for standard output")
      ->required();
  command
      ->add_option("shards", arguments->shards,
                   "what campaign or place wrote with --shard, all of them, in any order")
      ->required();
  command->add_option("--report", arguments->report, "the page that campaign or place makes");
  command->add_option("--json", arguments->json,
                      "of campaigns: summary file, - for standard output");
  command->add_option("--svg", arguments->svg,
                      "of placements: the map over the first two varied coordinates as a drawing");
  command->add_option("--top", arguments->top, "of placements: how many of the best are listed")
      ->capture_default_str();
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
