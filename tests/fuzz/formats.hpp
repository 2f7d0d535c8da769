// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "io_support.hpp"
#include "watchdog.hpp"

namespace swivel::test {

using io::test::TempFolder;

#if defined(__SANITIZE_ADDRESS__)
constexpr Allowance kAllowance{5, 3072};  // the sanitizer keeps what was freed for a while
#else
constexpr Allowance kAllowance{5, 1024};
#endif

/// A format: good files, pieces of its syntax, and what reads it.
struct Reader {
  const char* name;
  std::vector<std::string> seeds, words;
  std::function<void(const std::string&)> read;
};

/// A problem about the iiwa with everything in it, for the folder "problems" of prepared().
extern const char* const kProblem;
extern const std::vector<std::string> kXmlWords, kYamlWords;

/// A file of the data folder.
std::string data(const std::string& name);

/// Puts into an empty folder what problems/*.yaml name: links to the data, problems/box.stl, problems/good.yaml.
void prepare(const TempFolder& folder);

/// Tries `inputs` mutated files, the same number of each format; every finding is a failure of the test. SWIVEL_FUZZ_KEEP: a folder
/// where inputs with findings are kept. `mild`: see Mutator.
void fuzz(const char* name, const std::vector<Reader>& readers, int inputs, bool mild);

}  // namespace swivel::test
