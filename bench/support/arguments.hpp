// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <optional>

namespace swivel::bench {

/// Reads the command line of a benchmark. Returns the exit code with which the program must end
/// now: 0 after --help, 2 after an unknown word or a value that is not allowed, which CLI11 has
/// reported on stderr.
inline std::optional<int> read_arguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
}

}  // namespace swivel::bench
