// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/schema/schema_text.hpp"

#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "options/commands.hpp"

namespace swivel::cli {

void add_schema(CLI::App& app, int& exit_code) {
  static const std::map<std::string, std::function<std::string()>> kTexts{
      {"problem", io::problem_json_schema},
      {"result", io::result_json_schema},
      {"campaign", io::campaign_json_schema},
      {"tables", io::schema_tables}};
  CLI::App* command = app.add_subcommand(
      "schema",
      "Print what a problem file, a result or the summary of a campaign may hold, as JSON Schema");
  // shared, so that it lives as long as the callback that reads it
  auto file = std::make_shared<std::string>();
  command
      ->add_option("file", *file,
                   "problem, result, campaign; or tables: all keys as tables in Markdown")
      ->required()
      ->check(CLI::IsMember({"problem", "result", "campaign", "tables"}));
  command->callback([file, &exit_code] {
    std::fputs(kTexts.at(*file)().c_str(), stdout);
    exit_code = kOk;
  });
}

}  // namespace swivel::cli
