// SPDX-License-Identifier: BSD-3-Clause
#include "context.hpp"

#include <fstream>
#include <thread>

#include "commit.hpp"
#include "swivel/core/base/isa.hpp"

namespace swivel::bench {

namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> context() {
  return {{"commit", SWIVEL_COMMIT},
          {"compiler", SWIVEL_COMPILER},
          {"flags", SWIVEL_FLAGS},
          {"build_type", SWIVEL_BUILD_TYPE},
          {"vector_unit", to_string(active_isa())},
          {"processor", processor()},
          {"hardware_threads", std::to_string(std::thread::hardware_concurrency())}};
}

}  // namespace swivel::bench
