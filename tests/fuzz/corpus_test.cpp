// SPDX-License-Identifier: BSD-3-Clause
// The corpus: inputs that fuzzing found to reach code that no other one does, and edges made by
// hand. All of them, every time.
#include <gtest/gtest.h>

#include <algorithm>

#include "trial.hpp"

namespace swivel::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(Corpus, EveryFileIsReadOrRefused) {
  const TempFolder folder;
  prepare(folder);
  std::vector<std::string> folders;
  for (const fs::path& path : entries(SWIVEL_CORPUS_DIR)) folders.push_back(path.filename());
  std::vector<std::string> names;
  int accepted = 0, refused = 0;
  for (const Reader& reader : readers(folder)) {
    names.emplace_back(reader.name);
    const std::vector<fs::path> files = entries(fs::path(SWIVEL_CORPUS_DIR) / reader.name);
    const auto count = static_cast<int>(files.size());
    const Tally tally = watch(count, kAllowance, [&](int k) {
      reader.read(TempFolder::read(files[static_cast<std::size_t>(k)]));
    });
    std::printf("%s: %d files, %d read, %d refused\n", reader.name, count, tally.accepted,
                tally.refused);
    EXPECT_GT(count, 3) << reader.name;
    EXPECT_EQ(tally.accepted + tally.refused, count) << reader.name;
    for (const Finding& finding : tally.findings)
      ADD_FAILURE() << files[static_cast<std::size_t>(finding.input)] << ": " << finding.what;
    accepted += tally.accepted;
    refused += tally.refused;
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(folders, names) << "a folder for each format, and no other";
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace swivel::test
