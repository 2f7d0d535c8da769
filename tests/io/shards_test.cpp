// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/io/tables/shards.hpp"

#include <algorithm>
#include <bit>
#include <tuple>

#include "io_support.hpp"
#include "seed.hpp"
#include "swivel/io/tables/placement.hpp"

namespace swivel::io::test {
namespace {

using swivel::test::Random;

std::string some_text(Random& random) {
  std::string text;
  for (int k = random.below(12); k > 0; --k)
    text += "ab \"',-#\xc3\xa9"[static_cast<std::size_t>(random.below(8))];
  return text;
}

/// Draws a number of any size and sign.
double some_number(Random& random) {
  return random.coin(0.2) ? random.below(5)
                          : random.uniform(-1, 1) * std::pow(10, random.uniform(-12, 6));
}

std::optional<double> maybe_number(Random& random) {
  return random.coin() ? std::optional(some_number(random)) : std::nullopt;
}

PlanStatus some_status(Random& random) {
  constexpr std::array kAll{PlanStatus::kSolved, PlanStatus::kInfeasible, PlanStatus::kError};
  return kAll[static_cast<std::size_t>(random.below(3))];
}

void fill(PlacementRow& row, std::uint64_t number, Random& random) {
  row.cell = number;
  for (double& value : row.offset) value = random.coin() ? some_number(random) : 0;
  row.status = some_status(random);
  for (auto* const value : {&row.cost, &row.clearance, &row.clearance_margin, &row.joint_margin,
                            &row.slide_margin, &row.tool_speed, &row.failed_s})
    *value = maybe_number(random);
  row.cause = random.coin() ? "pair" : "";
  row.by = some_text(random);
  row.reason = some_text(random);
}

void fill(EpisodeRow& row, std::uint64_t number, Random& random) {
  row.episode = number;
  row.status = some_status(random);
  for (auto* const value :
       {&row.cost, &row.tool_path_error_mm_mean, &row.tool_path_error_mm_max, &row.failed_s})
    *value = maybe_number(random);
  row.plan_ms = random.below(1'000'000) / 1e3;  // as many digits as are written
  row.nodes_checked = random.below(1 << 30);
  row.fcl_calls = random.below(1 << 30);
  row.reason = some_text(random);
}

/// Rows written as shards, in any order, and joined are the rows; text and bits.
std::string table_of(const std::vector<PlacementRow>& rows, const ShardRecord&) {
  return to_csv(rows);
}
std::string table_of(const std::vector<EpisodeRow>& rows, const ShardRecord& record) {
  return to_csv(rows, record.settings.coordinates);
}

void move_by(PlacementRow& row, std::size_t coordinates, Random& random) {
  for (std::size_t k = 0; k < coordinates % 3; ++k)
    row.hold["joint, \"" + std::to_string(k)] = random.uniform(-1, 1);
}
void move_by(EpisodeRow& row, std::size_t coordinates, Random& random) {
  for (std::size_t k = 0; k < coordinates; ++k) row.offsets.push_back(random.uniform(-1, 1));
}

template <class Row>
void splits_and_joins(const char* command, Random& random, int& rows_joined, int& empty_shards) {
  const TempFolder folder;
  ShardRecord record{command,
                     {{{"seed", "1"}, {"x", some_text(random)}},
                      {{"the problem file", 3}, {some_text(random), 4}}},
                     {},
                     0,
                     some_text(random),
                     some_text(random)};
  for (int k = random.below(3); k > 0; --k)
    record.held.push_back({some_text(random), random.uniform(-3, 3), random.coin(0.5),
                           random.coin(0.5), random.coin(0.5) ? "" : some_text(random)});
  record.total = static_cast<std::uint64_t>(random.below(30));
  record.shard.count = static_cast<std::uint64_t>(1 + random.below(8));
  std::vector<Row> rows(record.total);
  if (std::is_same_v<Row, EpisodeRow>)
    for (int k = random.below(4); k > 0; --k)
      record.settings.coordinates.push_back(some_text(random));
  for (std::uint64_t k = 0; k < record.total; ++k) {
    fill(rows[k], k, random);
    move_by(rows[k], record.settings.coordinates.size(), random);
  }
  std::vector<ShardResults> shards;
  for (std::uint64_t index = 0; index < record.shard.count; ++index) {
    record.shard.index = index;
    std::vector<Row> own;
    for (std::uint64_t k = 0; k < record.shard.size(record.total); ++k)
      own.push_back(rows[record.shard.episode(k)]);
    empty_shards += own.empty();
    shards.push_back(
        load_shard(folder.write(std::to_string(index), to_line(record) + table_of(own, record))));
  }
  for (std::size_t k = shards.size(); k > 1; --k)
    std::swap(shards[k - 1], shards[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  const ShardResults whole = join_shards(std::move(shards));
  EXPECT_EQ(whole.record.command, command);
  EXPECT_EQ(whole.record.settings.values, record.settings.values);
  EXPECT_EQ(whole.record.settings.files, record.settings.files);
  EXPECT_EQ(whole.record.total, record.total);
  EXPECT_EQ(whole.record.shard.count, 1u);
  EXPECT_EQ(whole.record.problem, record.problem);
  EXPECT_EQ(whole.record.plan_command, record.plan_command);
  ASSERT_EQ(whole.record.held.size(), record.held.size());
  for (std::size_t k = 0; k < record.held.size(); ++k) {
    const HeldJoint &a = whole.record.held[k], &b = record.held[k];
    EXPECT_EQ(std::tie(a.name, a.position, a.slides, a.given, a.leader),
              std::tie(b.name, b.position, b.slides, b.given, b.leader));
  }
  EXPECT_EQ(whole.record.settings.coordinates, record.settings.coordinates);
  EXPECT_EQ(table_of(std::get<std::vector<Row>>(whole.rows), record), table_of(rows, record));
  rows_joined += static_cast<int>(rows.size());
}

TEST(Shards, JoinedTheyAreWhatWasSplit) {
  Random random(swivel::test::seed("Shards.JoinedTheyAreWhatWasSplit"));
  int placements = 0, episodes = 0, empty = 0;
  for (int trial = 0; trial < swivel::test::trials(100); ++trial) {
    splits_and_joins<PlacementRow>("place", random, placements, empty);
    splits_and_joins<EpisodeRow>("campaign", random, episodes, empty);
  }
  std::printf("%d placements, %d episodes, %d empty shards\n", placements, episodes, empty);
  EXPECT_GE(std::min(placements, episodes), swivel::test::at_least(1000));
  EXPECT_GE(empty, swivel::test::at_least(20));
}

TEST(Shards, NumbersKeepTheirBits) {
  Random random(swivel::test::seed("Shards.NumbersKeepTheirBits"));
  const TempFolder folder;
  const ShardRecord record{"place", {}, {}, 500, "", ""};
  std::vector<PlacementRow> rows(record.total);
  for (std::uint64_t k = 0; k < rows.size(); ++k) fill(rows[k], k, random);
  const ShardResults read = load_shard(folder.write("r.csv", to_line(record) + to_csv(rows)));
  const auto& same = std::get<PlacementRows>(read.rows);
  ASSERT_EQ(same.size(), rows.size());
  const auto bits = [](const std::optional<double>& value) {
    return std::bit_cast<std::uint64_t>(value.value_or(0.125));
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t c = 0; c < rows[k].offset.size(); ++c)
      EXPECT_EQ(bits(same[k].offset[c]), bits(rows[k].offset[c]));
    EXPECT_EQ(bits(same[k].cost), bits(rows[k].cost));
    EXPECT_EQ(bits(same[k].clearance_margin), bits(rows[k].clearance_margin));
    EXPECT_EQ(same[k].status, rows[k].status);
    EXPECT_EQ(same[k].by, rows[k].by);
    EXPECT_EQ(same[k].reason, rows[k].reason);
  }
}

}  // namespace
}  // namespace swivel::io::test
