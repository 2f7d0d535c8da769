// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace swivel::cli {

/// Prints every robot pair of a problem and what it must keep. Throws InputError.
void print_pairs(const std::string& problem_file);

}  // namespace swivel::cli
