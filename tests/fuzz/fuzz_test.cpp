// SPDX-License-Identifier: BSD-3-Clause
// Broken files of every format that is read: an InputError of one line, soon, and nothing else.
// SWIVEL_TEST_TRIALS is the number of inputs over all readers (2,000 unless given).
#include <gtest/gtest.h>

#include "seed.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "trial.hpp"

namespace swivel::test {
namespace {

TEST(Fuzz, EveryReaderRefusesWhatItCannotRead) {
  const TempFolder folder;
  prepare(folder);
  fuzz("Fuzz", readers(folder), trials(2000), false);
}

/// 20,000 files, since the format has no library that others have tried.
TEST(Fuzz, AptFiles) {
  const TempFolder folder;
  prepare(folder);
  std::vector<Reader> apt = readers(folder);
  std::erase_if(apt, [](const Reader& reader) { return reader.name != std::string("apt"); });
  ASSERT_EQ(apt.size(), 1u);
  fuzz("Apt", apt, trials(20'000), false);
}

/// The watchdog finds each kind of fault that it is there for.
TEST(Fuzz, TheWatchdogBites) {
  const Tally tally = watch(9, {3, 250}, [](int k) {
    switch (k) {
      case 1:
        throw InputError("a.yaml:1: key: allowed is more");
      case 2:
        throw InputError("a.yaml: two\nlines: allowed is one");
      case 3:
        throw std::runtime_error("something else: allowed");
      case 4:
        std::abort();
      case 5:
        while (true) {
          volatile int busy = k;
          (void)busy;
        }
      case 6: {
        std::vector<char> large(std::size_t{300} << 20, 'x');
        volatile char used = large[large.size() / 2];
        (void)used;
        return;
      }
      case 7:
        throw InputError("a.yaml: wrong");
      default:
        return;
    }
  });
  EXPECT_EQ(tally.accepted, 3);
  EXPECT_EQ(tally.refused, 3);
  ASSERT_EQ(tally.findings.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(tally.findings[k].input, static_cast<int>(k) + 2) << tally.findings[k].what;
}

}  // namespace
}  // namespace swivel::test
