// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <stdexcept>

namespace swivel {

/// Misuse of the library by the program that calls it: a value that no problem may have, or a
/// prepared robot that does not belong to the problem. Its message is one line that names the
/// member, its value, and what is allowed. Bad input from a user's files throws InputError instead.
class InvalidArgument : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace swivel
