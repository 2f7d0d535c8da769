// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <stdexcept>
#include <string>

namespace swivel {

/// Bad input from outside: one line that names the file, key or row, what is wrong, and what is
/// allowed. The command line prints it and exits with 2; a library user catches it. It is never
/// thrown because no path exists.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// Makes the message "<source>: <what>", or `what` alone where `source` is empty, as for problems
  /// made in memory.
  InputError(const std::string& source, const std::string& what)
      : std::runtime_error(source.empty() ? what : source + ": " + what) {}
};

}  // namespace swivel
