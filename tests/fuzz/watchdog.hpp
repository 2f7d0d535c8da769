// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace swivel::test {

/// What one input may take.
struct Allowance {
  int seconds = 5;
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

/// Calls read(k) for k in [0, count) in a child process. It may return (accepted) or throw an InputError of one printable line
/// (refused). A crash, a hang, too much memory and everything else that is thrown is a finding; the next child goes on after it.
[[nodiscard]] Tally watch(int count, const Allowance& allowance, const std::function<void(int)>& read);

}  // namespace swivel::test
