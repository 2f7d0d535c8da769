// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel::io {

/// What followed a plan. A pointer is null if it was not asked for or does not exist.
struct AnswerExtras {
  const AdviceList* advice = nullptr;  ///< for a problem that has no answer
  /// The certificate that there is no path, of a problem of one path.
  const InfeasibilityCertificate* certificate = nullptr;
  std::size_t certificate_bytes = 0;  ///< size of the certificate's file
};
/// Returns RESULT.json as text, docs/formats.md "Result", "Result of a job" and "Result of a
/// workcell". What describes rows is null unless there are some; `refinement`, `motion`, `advice`
/// and `certificate` unless they were asked for. `problem` is executed_problem() of the answer.
[[nodiscard]] std::string to_json(const Answer& answer, const Problem& problem,
                                  const AnswerExtras& extras = {});
/// Returns RESULT.json of the plan of one path as text.
[[nodiscard]] std::string to_json(const PlanResult& result);
/// Returns the motion of an answer in the format of the file name's ending: .csv, .json, .yaml or
/// .mcap, docs/formats.md "Motion"; of strokes with the events that switch the process, of two arms
/// with the joints of both. The answer must have one; `problem` is executed_problem() of it. Throws
/// InputError for any other ending, and in CSV for a stroke that begins and ends between two
/// samples.
[[nodiscard]] std::string motion_text(const Answer& answer, const Problem& problem,
                                      const std::filesystem::path& file);
/// Returns CERTIFICATE.json as text, docs/formats.md, with a line for each layer.
[[nodiscard]] std::string to_json(const InfeasibilityCertificate& certificate);
/// Loads CERTIFICATE.json. Throws InputError for a file that is none. verify_certificate() verifies
/// what it says.
[[nodiscard]] InfeasibilityCertificate load_certificate(const std::filesystem::path& json);
/// Returns the certificate of a workcell as text, docs/formats.md, with a line for each set.
[[nodiscard]] std::string to_json(const WorkcellCertificate& certificate);
/// Loads the certificate of a workcell. Throws InputError for a file that is none.
/// verify_certificate() verifies what it says.
[[nodiscard]] WorkcellCertificate load_workcell_certificate(const std::filesystem::path& json);
/// Returns RESULT.json for an internal error: its status is "error".
[[nodiscard]] std::string error_json(const std::string& message);
/// Returns the timeline in Chrome's trace event format, which Perfetto and speedscope open.
[[nodiscard]] std::string to_trace_json(const Timeline& timeline);

}  // namespace swivel::io
