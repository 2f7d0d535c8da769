// SPDX-License-Identifier: BSD-3-Clause
// The format that the environment's SWIVEL_FUZZ_FORMAT names under libFuzzer:
// https://llvm.org/docs/LibFuzzer.html. What counts as wrong is what it is for the tests beside
// this file; libFuzzer watches over memory, and over time by the clock, which on a busy machine
// says nothing: the time of the processor is looked at here.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <optional>

#include "formats.hpp"
#include "mutator.hpp"
#include "watchdog.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace swivel::test {
namespace {

/// The reader of the format, and a folder that lives as long.
class Target {
 public:
  Target() {
    prepare(folder_);
    const char* const wanted = std::getenv("SWIVEL_FUZZ_FORMAT");
    std::string names;
    for (const Reader& reader : readers(folder_)) {
      names += std::string(names.empty() ? "" : ", ") + reader.name;
      if (wanted != nullptr && std::strcmp(reader.name, wanted) == 0) reader_ = reader;
    }
    if (!reader_.read) {
      std::fprintf(stderr, "SWIVEL_FUZZ_FORMAT: '%s': allowed is one of %s\n",
                   wanted == nullptr ? "" : wanted, names.c_str());
      std::exit(2);
    }
    mutator_.emplace(reader_.seeds, reader_.words, false);
  }
  [[nodiscard]] const Reader& reader() const { return reader_; }
  [[nodiscard]] const Mutator& mutator() const { return *mutator_; }

 private:
  TempFolder folder_;
  Reader reader_;
  std::optional<Mutator> mutator_;
};

const Target& target() {
  static const Target one;
  return one;
}

std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace
}  // namespace swivel::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swivel::test;
  const std::string text = text_of(data, size);
  const std::clock_t start = std::clock();
  Verdict verdict = judge([&] { target().reader().read(text); });
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (seconds > Allowance{}.seconds)
    verdict.wrong += " " + std::to_string(seconds) + " s of the processor";
  if (verdict.wrong.empty()) return 0;
  std::fprintf(stderr, "%s\n", verdict.wrong.c_str());
  std::abort();
}

/// Half of the changes are libFuzzer's, which know what comparisons the code makes; the others know
/// the format's words and numbers. Some inputs begin anew from a good file, so that a corpus need
/// not hold any.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  using namespace swivel::test;
  if (seed % 2 == 0 && size > 0) return LLVMFuzzerMutate(data, size, most);
  const Mutator& mutator = target().mutator();
  const std::string text = seed % 16 == 1 || size == 0 ? mutator.input(seed)
                                                       : mutator.changed(text_of(data, size), seed);
  const std::size_t kept = std::min(text.size(), most);
  std::memcpy(data, text.data(), kept);
  return kept;
}
