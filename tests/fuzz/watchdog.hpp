// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace swivel::test {

/// How an input was answered: it may be read, or refused by an InputError of one printable line
/// that says what is allowed.
struct Verdict {
  bool accepted = false, refused = false;
  std::string wrong;  ///< empty where it is as it should be
};
[[nodiscard]] Verdict judge(const std::function<void()>& read);

/// How much time and memory one input may take.
struct Allowance {
  int seconds = 5;               ///< of the processor
  std::size_t megabytes = 1024;  ///< resident, of the whole process
};

struct Finding {
  int input = 0;
  std::string what;
};
struct Tally {
  int accepted = 0, refused = 0;
  std::vector<Finding> findings;
};

/// Calls read(k) for k in [0, count) in a child process, and judges it. Wrong answers, crashes,
/// hangs and too much memory are findings; after a child that ended, the next one goes on.
[[nodiscard]] Tally watch(int count, const Allowance& allowance,
                          const std::function<void(int)>& read);

}  // namespace swivel::test
