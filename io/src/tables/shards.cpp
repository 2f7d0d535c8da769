// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/tables/shards.hpp"

#include <algorithm>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "tables/run_settings.hpp"
#include "tables/table_rows.hpp"

namespace swivel::io {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAllowed = "the results that campaign or place wrote with --shard";

std::string to_string(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

std::uint64_t number_of(const EpisodeRow& row) {
  return row.episode;
}
std::uint64_t number_of(const PlacementRow& row) {
  return row.cell;
}

std::optional<Shard> shard_from(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto index = to_number<std::uint64_t>(text.substr(0, slash)),
             count = to_number<std::uint64_t>(text.substr(slash + 1));
  if (!index || !count || *index >= *count) return std::nullopt;
  return Shard{*index, *count};
}

/// Of the first line, without its end; none where it does not say one.
std::optional<ShardRecord> record_from(std::string_view line) {
  line.remove_prefix(std::string_view(kRunMark).size());
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return std::nullopt;
  ShardRecord record;
  record.command = line.substr(0, space);
  const Json json = Json::parse(line.substr(space + 1), nullptr, false);
  auto settings = settings_from(json);
  const auto text = [&](const char* key) { return json.contains(key) && json[key].is_string(); };
  if (!settings || !text("shard") || !text("problem") || !text("plan_command") ||
      !json.contains("total") || !json["total"].is_number_unsigned())
    return std::nullopt;
  const auto shard = shard_from(json["shard"].get<std::string>());
  if (!shard) return std::nullopt;
  record.settings = std::move(*settings);
  record.shard = *shard;
  record.total = json["total"].get<std::uint64_t>();
  record.problem = json["problem"].get<std::string>();
  record.plan_command = json["plan_command"].get<std::string>();
  if (json.contains("held")) {  // those of earlier builds do not say
    auto held = held_from(json["held"]);
    if (!held) return std::nullopt;
    record.held = std::move(*held);
  }
  if (record.command == "campaign" && !to_number<std::uint64_t>(record.setting("seed")))
    return std::nullopt;
  return record;
}

template <class Row, class RowOf>
std::vector<Row> rows_of(std::string_view text, const std::string& file, const ShardRecord& record,
                         const std::string& header, const RowOf& row_of) {
  const std::size_t first = text.find('\n') + 1, begin = first + header.size();
  if (!text.substr(first).starts_with(header))
    bad_input(at_line(file, 2), "another header", kAllowed);
  const std::uint64_t size = record.shard.size(record.total);
  const std::string noun = record.command == "place" ? "cell " : "episode ";
  std::vector<Row> rows;
  read_lines(text, begin, file, 3, kAllowed, row_of,
             [&](const Row& row, const std::string& where, std::size_t) {
               const std::uint64_t wanted = record.shard.episode(rows.size());
               if (rows.size() == size)
                 bad_input(where, "more rows than shard " + to_string(record.shard) + " has",
                           kAllowed);
               if (number_of(row) != wanted)
                 bad_input(where,
                           noun + std::to_string(number_of(row)) + " where the shard has " +
                               std::to_string(wanted),
                           kAllowed);
               rows.push_back(row);
             });
  if (rows.size() < size)
    bad_input(file,
              "has " + std::to_string(rows.size()) + " of the " + std::to_string(size) +
                  " rows of shard " + to_string(record.shard),
              "finished shards");
  return rows;
}

/// Throws unless the second shard is of the run that the first is of.
void require_same_run(const ShardResults& first, const ShardResults& second) {
  const auto refuse = [&](const std::string& what) {
    bad_input(second.file, what, "shards of one run");
  };
  const ShardRecord &a = first.record, &b = second.record;
  if (a.command != b.command)
    refuse("of swivel " + b.command + ", where " + first.file + " is of swivel " + a.command);
  if (const auto other = difference(a.settings, b.settings)) {
    if (other->file && !other->first && !other->second)
      refuse(other->name + " was another than for " + first.file);
    if (!other->first)
      refuse("with " + other->name + " " + *other->second + ", and " + first.file + " without");
    if (!other->second) refuse("without " + other->name + ", and " + first.file + " with");
    refuse(other->name + " " + *other->second + ", where " + first.file + " has " + *other->first);
  }
  if (a.total != b.total)
    refuse("of " + std::to_string(b.total) + (b.command == "place" ? " cells" : " episodes") +
           ", where " + first.file + " is of " + std::to_string(a.total));
  if (a.shard.count != b.shard.count)
    refuse("one of " + std::to_string(b.shard.count) + " shards, where " + first.file +
           " is one of " + std::to_string(a.shard.count));
}

}  // namespace

std::string ShardRecord::setting(const std::string& name) const {
  for (const auto& [known, value] : settings.values)
    if (known == name) return value;
  return {};
}

std::string to_line(const ShardRecord& record) {
  Json json = to_json(record.settings);
  json["shard"] = to_string(record.shard);
  json["total"] = record.total;
  json["problem"] = record.problem;
  json["plan_command"] = record.plan_command;
  json["held"] = held_json(record.held);
  return kRunMark + record.command + ' ' +
         json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

ShardResults load_shard(const std::filesystem::path& csv) {
  const std::string text = read_file(csv, "CSV file", kMostTableBytes), file = csv.string();
  if (!text.starts_with(kRunMark))
    bad_input(at_line(file, 1), "does not say which shard it is", kAllowed);
  if (!text.ends_with('\n')) bad_input(file, "ends within a row", "finished shards");
  auto record = record_from(std::string_view(text).substr(0, text.find('\n')));
  if (!record || (record->command != "campaign" && record->command != "place"))
    bad_input(at_line(file, 1), "does not say which shard it is", kAllowed);
  ShardResults results{file, std::move(*record), {}};
  const std::string_view table = std::string_view(text).substr(text.find('\n') + 1),
                         header = table.substr(0, table.find('\n'));
  if (results.record.command == "campaign") {
    const auto coordinates = coordinates_of(header);
    if (!coordinates) bad_input(at_line(file, 2), "another header", kAllowed);
    results.record.settings.coordinates = *coordinates;
    results.rows = rows_of<EpisodeRow>(
        text, file, results.record, episode_header(*coordinates),
        [&](std::string_view line) { return episode_row(line, coordinates->size()); });
  } else {
    const auto joints = joints_of(header);
    if (!joints) bad_input(at_line(file, 2), "another header", kAllowed);
    results.rows =
        rows_of<PlacementRow>(text, file, results.record, placement_header(*joints),
                              [&](std::string_view line) { return placement_row(line, *joints); });
  }
  return results;
}

ShardResults join_shards(std::vector<ShardResults> shards) {
  for (std::size_t k = 1; k < shards.size(); ++k) require_same_run(shards.front(), shards[k]);
  std::stable_sort(shards.begin(), shards.end(), [](const auto& a, const auto& b) {
    return a.record.shard.index < b.record.shard.index;
  });
  for (std::size_t k = 1; k < shards.size(); ++k)
    if (shards[k].record.shard.index == shards[k - 1].record.shard.index)
      bad_input(shards[k].file,
                "shard " + to_string(shards[k].record.shard) + " again, as " + shards[k - 1].file,
                "each shard once");
  const Shard all = shards.front().record.shard;
  for (std::uint64_t k = 0; k < all.count; ++k)
    if (k >= shards.size() || shards[k].record.shard.index != k)
      bad_input("shard " + to_string(Shard{k, all.count}),
                "missing: " + std::to_string(shards.size()) + " of " + std::to_string(all.count) +
                    " are given",
                "all shards of a run");
  ShardResults whole = std::move(shards.front());
  whole.record.shard = {};
  std::visit(
      [&](auto& rows) {
        using Rows = std::decay_t<decltype(rows)>;
        for (std::size_t k = 1; k < shards.size(); ++k) {
          const Rows& more = std::get<Rows>(shards[k].rows);
          rows.insert(rows.end(), more.begin(), more.end());
        }
        std::sort(rows.begin(), rows.end(),
                  [](const auto& a, const auto& b) { return number_of(a) < number_of(b); });
      },
      whole.rows);
  return whole;
}

}  // namespace swivel::io
