// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/planner/verify/check.hpp"

namespace swivel::cli {

/// What is said of rows without times where the problem asks for speeds of the tool.
inline constexpr const char* kSpeedsNotChecked =
    "speeds of the tool were not checked: rows have no times\n";

/// Prints one line for each kind of failure, with the number of further failures of that kind, and
/// how many of the `count` failures are not listed.
void print_failures(const std::vector<std::string>& failures, std::int64_t count);

/// Prints how deep bodies that may touch are in each other, or that it was not measured. Prints
/// nothing where none touch.
void print_contact(const CheckResult& result);

}  // namespace swivel::cli
