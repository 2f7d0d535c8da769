// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/cut.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/motion/timed_path.hpp"

namespace swivel::io {

/// RESULT.json as text, docs/formats.md. Cost, tool-path error and manipulability are null unless solved.
[[nodiscard]] std::string to_json(const PlanResult& result);
/// CERTIFICATE.json, docs/formats.md: a line for each layer.
[[nodiscard]] std::string to_json(const Cut& cut);
[[nodiscard]] Cut load_cut(const std::filesystem::path& json);
/// RESULT.json after an internal error: its status is "error".
[[nodiscard]] std::string error_json(const std::string& message);
/// The timeline in Chrome's trace event format, which Perfetto and speedscope open.
[[nodiscard]] std::string to_trace_json(const Timeline& timeline);

/// What became of a plan's path: null where it was not asked for, or where there is no path.
struct Aftermath {
  const Refined* refinement = nullptr;
  const TimingResult* motion = nullptr;
  TimingOptions timing;                         ///< what the motion was asked to keep
  const std::vector<Advice>* advice = nullptr;  ///< of a problem that has no path
  const Cut* cut = nullptr;                     ///< that there is no path
  std::size_t cut_bytes = 0;                    ///< of its file
};
/// to_json(result) with the keys `refinement`, `motion`, `advice` and `certificate` filled in. docs/formats.md "Result".
[[nodiscard]] std::string to_json(const PlanResult& result, const Aftermath& aftermath);

}  // namespace swivel::io
