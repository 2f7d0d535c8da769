// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "formats.hpp"
#include "watchdog.hpp"

namespace swivel::test {

#if defined(__SANITIZE_ADDRESS__)
constexpr Allowance kAllowance{5, 3072};  // the sanitizer keeps what was freed for a while
#else
constexpr Allowance kAllowance{5, 1024};
#endif

/// Tries `inputs` mutated files, the same number of each format; every finding is a failure of the
/// test. SWIVEL_FUZZ_KEEP: a folder where inputs with findings are kept. `mild`: see Mutator.
void fuzz(const char* name, const std::vector<Reader>& readers, int inputs, bool mild);

}  // namespace swivel::test
