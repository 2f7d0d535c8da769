// SPDX-License-Identifier: BSD-3-Clause
#include "trial.hpp"

#include <algorithm>
#include <cstdlib>

#include "mutator.hpp"
#include "seed.hpp"

namespace swivel::test {

void fuzz(const char* name, const std::vector<Reader>& readers, int inputs, bool mild) {
  const std::uint64_t first = seed(name);
  const char* const keep = std::getenv("SWIVEL_FUZZ_KEEP");
  for (const Reader& reader : readers) {
    for (const std::string& good : reader.seeds)
      EXPECT_NO_THROW(reader.read(good)) << reader.name << ": " << good;
    const Mutator mutator(reader.seeds, reader.words, mild);
    const auto input = [&](int k) {
      return mutator.input(first * 1'000'003 + static_cast<std::uint64_t>(k));
    };
    const int count = inputs / static_cast<int>(readers.size());
    const Tally tally = watch(count, kAllowance, [&](int k) { reader.read(input(k)); });
    std::printf("%s: %d inputs, %d read, %d refused, %zu findings\n", reader.name, count,
                tally.accepted, tally.refused, tally.findings.size());
    EXPECT_GE(tally.accepted, std::max(1, count / 20));
    EXPECT_GE(tally.refused, std::max(1, count / 20));
    for (const Finding& finding : tally.findings) {
      ADD_FAILURE() << reader.name << ", input " << finding.input << ": " << finding.what;
      if (keep != nullptr)
        std::ofstream(std::filesystem::path(keep) / (reader.name + std::to_string(finding.input)),
                      std::ios::binary)
            << input(finding.input);
    }
  }
}

}  // namespace swivel::test
