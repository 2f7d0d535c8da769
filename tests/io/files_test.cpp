// SPDX-License-Identifier: BSD-3-Clause
#include <sys/stat.h>

#include <thread>

#include "io_support.hpp"

namespace swivel::io::test {
namespace {

std::size_t count_files(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
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
  expect_message(input_error([&] { write_file(folder.path() / "none" / "out.txt", "x"); }), {"none/out.txt"});
  fs::create_directories(folder.path() / "taken" / "inside");
  expect_message(input_error([&] { write_file(folder.path() / "taken", "x"); }), {"taken"});
  EXPECT_EQ(count_files(folder.path()), 1u);
  expect_message(input_error([&] { write_trajectory(folder.path() / "none" / "t.csv", {}); }), {"none/t.csv"});
}

}  // namespace
}  // namespace swivel::io::test
