// SPDX-License-Identifier: BSD-3-Clause
#include "options/shard_option.hpp"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

#include "swivel/core/messages/input_error.hpp"

namespace swivel::cli {

namespace {

/// Returns the share of this task of a Slurm job array. Throws InputError outside of one.
Shard shard_from_slurm() {
  const auto value = [](const char* name, std::optional<std::uint64_t> otherwise = {}) {
    const char* const text = std::getenv(name);
    if (text == nullptr && otherwise) return *otherwise;
    std::uint64_t number = 0;
    const std::string_view word(text == nullptr ? "" : text);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (word.empty() || error != std::errc() || end != word.data() + word.size())
      throw InputError(std::string("--shard auto: ") + name + " is " +
                       (text == nullptr ? "not set" : "'" + std::string(word) + "'") +
                       ": allowed within a task of a Slurm job array");
    return number;
  };
  const std::uint64_t task = value("SLURM_ARRAY_TASK_ID"), count = value("SLURM_ARRAY_TASK_COUNT"),
                      first = value("SLURM_ARRAY_TASK_MIN"),
                      step = value("SLURM_ARRAY_TASK_STEP", 1);
  if (task < first || step == 0 || (task - first) % step != 0 || (task - first) / step >= count)
    throw InputError("--shard auto: task " + std::to_string(task) + " is none of " +
                     std::to_string(count) + " from " + std::to_string(first) +
                     " on: allowed are arrays without gaps, as --array=0-31");
  return {(task - first) / step, count};
}

}  // namespace

Shard shard_from_string(const std::string& text) {
  if (text == "auto") return shard_from_slurm();
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  bool read = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  if (read) {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    read = count.ec == std::errc() && count.ptr == end && shard.index < shard.count;
  }
  if (!read)
    throw InputError("--shard: '" + text + "': allowed is I/N, I from 0 to N - 1, or auto");
  return shard;
}

io::RunSettings run_settings(const std::string& problem_file, const PathProblem& problem,
                             const SearchOptions& search,
                             const std::vector<io::InputFiles::File>& inputs) {
  namespace fs = std::filesystem;
  io::RunSettings settings;
  settings.values = {{"version", SWIVEL_VERSION},
                     {"planner", search.planner},
                     {"ds", shortest(problem.resolution.ds)},
                     {"dphi", shortest(problem.resolution.dphi)},
                     {"arcs", problem.resolution.arcs ? "true" : "false"},
                     {"edges", problem.limits.edges == EdgeMode::kNodes ? "nodes" : "continuous"}};
  if (search.knot) settings.values.emplace_back("knot", shortest(*search.knot));
  // The problem file is the first. It is not known by its name, since that may differ or it may
  // come through a pipe; the others are known by their place relative to it.
  const fs::path folder = fs::absolute(problem_file).parent_path();
  for (const io::InputFiles::File& file : inputs)
    settings.files.emplace_back(
        settings.files.empty() ? "the problem file" : fs::relative(file.name, folder).string(),
        file.hash);
  return settings;
}

}  // namespace swivel::cli
