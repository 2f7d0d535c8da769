// SPDX-License-Identifier: BSD-3-Clause
#include <sys/stat.h>

#include <thread>

#include "io_support.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io::test {
namespace {

std::size_t count_files(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(Files, WritesAndReplacesAndLeavesNothingBeside) {
  const TempFolder folder;
  const fs::path file = folder.path() / "out.json";
  write_file(file, "old and longer");
  write_file(file, "new");
  EXPECT_EQ(TempFolder::read(file), "new");
  EXPECT_EQ(count_files(folder.path()), 1u);
}

TEST(Files, RelativeName) {
  const TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_NO_THROW(write_file("out.txt", "x"));
  fs::current_path(before);
  EXPECT_EQ(TempFolder::read(folder.path() / "out.txt"), "x");
}

TEST(Files, ALinkKeepsPointingAtItsFile) {
  const TempFolder folder;
  const fs::path target = folder.write("real/out.txt", "old");
  fs::create_symlink(target, folder.path() / "link.txt");
  write_file(folder.path() / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.txt"));
  EXPECT_EQ(TempFolder::read(target), "new");
}

TEST(Files, APipeIsWrittenToNotReplaced) {
  const TempFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string seen;
  std::thread reader([&] { seen = TempFolder::read(pipe); });
  write_file(pipe, "through");
  reader.join();
  EXPECT_EQ(seen, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(Files, ManyWritersOneWholeFile) {
  const TempFolder folder;
  const fs::path file = folder.path() / "out.txt";
  std::vector<std::thread> writers;
  for (char letter = 'a'; letter < 'e'; ++letter)
    writers.emplace_back([&file, letter] {
      for (int k = 0; k < 20; ++k) write_file(file, std::string(10000, letter));
    });
  for (std::thread& writer : writers) writer.join();
  const std::string text = TempFolder::read(file);
  EXPECT_EQ(text, std::string(10000, text.at(0)));
  EXPECT_EQ(count_files(folder.path()), 1u);
}

TEST(Files, CannotWrite) {
  const TempFolder folder;
  expect_message(input_error([&] { write_file(folder.path() / "none" / "out.txt", "x"); }),
                 {"none/out.txt"});
  fs::create_directories(folder.path() / "taken" / "inside");
  expect_message(input_error([&] { write_file(folder.path() / "taken", "x"); }), {"taken"});
  EXPECT_EQ(count_files(folder.path()), 1u);
  expect_message(input_error([&] { write_trajectory(folder.path() / "none" / "t.csv", {}); }),
                 {"none/t.csv"});
}

TEST(Files, AllOrNone) {
  const TempFolder folder;
  const fs::path first = folder.write("first", "old"), second = folder.write("second", "old"),
                 third = folder.write("third", "old");
  {
    OutputFiles outputs;
    outputs.add("--first", first);
    outputs.add("--second", second);
    outputs.write("--first", "new");
    outputs.write("--nowhere", "is no error");
    outputs.stage();
    EXPECT_EQ(count_files(folder.path()), 4u);
  }  // not committed
  EXPECT_EQ(count_files(folder.path()), 3u);
  EXPECT_EQ(TempFolder::read(first), "old");
  OutputFiles outputs;
  outputs.add("--first", first);
  outputs.add("--second", second);
  outputs.add("--third", third);
  outputs.write("--first", "new");
  outputs.remove("--second");
  outputs.stage();
  EXPECT_EQ(outputs.commit(), std::vector{second});
  EXPECT_EQ(TempFolder::read(first), "new");
  EXPECT_FALSE(fs::exists(second));
  EXPECT_EQ(TempFolder::read(third), "old");
  EXPECT_EQ(count_files(folder.path()), 2u);
}

TEST(Files, InputsAreNotedWithTheirContents) {
  const TempFolder folder;
  const fs::path file = folder.write(
      "t.csv", "s,phi,branch,1,2,3,4,5,6,7\n0,0,0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0,0,0\n");
  const std::array<std::string, kDof> names{"1", "2", "3", "4", "5", "6", "7"};
  const auto noted = [&] {
    const InputFiles inputs(InputFiles::Contents::kHash);
    (void)load_trajectory_file(file, names);
    (void)load_trajectory_file(file, names);
    return inputs.files();
  };
  const auto before = noted();
  ASSERT_EQ(before.size(), 1u);
  EXPECT_EQ(before[0].name, file);
  fs::create_hard_link(file, folder.path() / "same");
  OutputFiles outputs(before);
  expect_message(input_error([&] { outputs.add("--out", folder.path() / "same"); }),
                 {"--out", "same", "read"});
  folder.write("t.csv", TempFolder::read(file) + "\n");
  const auto after = noted();
  EXPECT_NE(before[0].hash, after[0].hash);
  (void)load_trajectory_file(file, names);  // nobody listens
}

TEST(Files, CampaignsKnowTheirSettings) {
  const TempFolder folder;
  const fs::path csv = folder.path() / "r.csv";
  const RunSettings settings{{{"version", "1"}, {"seed", "2"}},
                             {{"the problem file", 3}, {"a,\"b\".stl", 4}},
                             {"a,\"b\".x", "c.yaw"}};
  const Shard shard;
  std::string written;
  {
    CampaignFile file(csv, settings, shard, 3);
    EpisodeRow row(0, std::string("broken, \"twice\""));
    row.offsets = {0.1, -2.5e-17};
    file.append(row);
    written = file.csv();
  }
  RunSettings other = settings;
  other.values[0].second = "2";
  expect_message(input_error([&] { CampaignFile(csv, other, shard, 3); }),
                 {"r.csv.part:1", "begun with version 1, this is 2"});
  other = settings;
  other.files[1].second = 5;
  expect_message(input_error([&] { CampaignFile(csv, other, shard, 3); }),
                 {"r.csv.part:1", "a,\"b\".stl was another"});
  other = settings;
  other.files.pop_back();
  expect_message(input_error([&] { CampaignFile(csv, other, shard, 3); }),
                 {"r.csv.part:1", "more settings or files"});
  other = settings;
  other.files.emplace_back("more", 1);
  expect_message(input_error([&] { CampaignFile(csv, other, shard, 3); }),
                 {"r.csv.part:1", "begun without more"});
  CampaignFile file(csv, settings, shard, 3);
  ASSERT_EQ(file.rows().size(), 1u);
  EXPECT_EQ(file.rows()[0].status, PlanStatus::kError);
  EXPECT_EQ(file.rows()[0].reason, "broken, \"twice\"");
  EXPECT_EQ(file.rows()[0].offsets, (std::vector<double>{0.1, -2.5e-17}));
  EXPECT_EQ(file.csv(), written);
  const EpisodeTable table = load_rows(folder.write("whole.csv", written));
  EXPECT_EQ(table.coordinates, settings.coordinates);
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0].offsets, file.rows()[0].offsets);
  expect_message(input_error([&] { CampaignFile(csv, settings, shard, 3); }), {"another campaign"});
  file.finish();
  EXPECT_EQ(count_files(folder.path()), 1u);
  for (const char* line :
       {"{}", "{\"settings\": {}}", "[]", "{\"settings\": 1, \"files\": 2}", "no JSON"}) {
    std::ofstream(csv.string() + ".part") << "# swivel campaign " << line << '\n';
    expect_message(input_error([&] { CampaignFile(csv, settings, shard, 3); }),
                   {"r.csv.part:1", "its settings cannot be read"});
  }
}

}  // namespace
TEST(Files, RowsOfACampaignAreWrittenInBlocks) {
  const TempFolder folder;
  const fs::path csv = folder.path() / "r.csv", part = folder.path() / "r.csv.part";
  const auto rows_in_file = [&] {
    std::ifstream file(part);
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n') - 2;  // settings, header
  };
  const auto row = [](std::uint64_t k) { return EpisodeRow(k, std::string("broken")); };
  {
    CampaignFile file(csv, {}, {}, 1000);
    file.append(row(0));
    EXPECT_EQ(rows_in_file(), 1);  // nothing was written for long
    for (std::uint64_t k = 1; k < 400; ++k) file.append(row(k));
    EXPECT_EQ(file.rows().size(), 400u);
    file.flush();
    EXPECT_EQ(rows_in_file(), 400);
    file.append(row(400));
    file.append(row(401));
    file.keep(401);
    EXPECT_EQ(rows_in_file(), 401);
    std::this_thread::sleep_for(CampaignFile::kBetweenWrites);
    file.append(row(401));
    EXPECT_EQ(rows_in_file(), 402);
    file.append(row(402));
  }
  EXPECT_EQ(rows_in_file(), 403);
  EXPECT_EQ(CampaignFile(csv, {}, {}, 1000).rows().size(), 403u);
}

}  // namespace swivel::io::test
