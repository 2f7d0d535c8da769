// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/motion/job_motion.hpp"
#include "swivel/core/motion/timed_path.hpp"
#include "swivel/core/motion/workcell_motion.hpp"

namespace swivel::io {

/// Returns RESULT.json as text, docs/formats.md. Cost, tool-path error and manipulability are null
/// unless the problem is solved.
[[nodiscard]] std::string to_json(const PlanResult& result);
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
/// What followed the plan of a job.
struct JobExtras {
  const JobTimingResult* motion = nullptr;  ///< null if it was not asked for or does not exist
  bool stopped = false;                     ///< time ran out before the motion that was asked for
  const AdviceOnJob* advice = nullptr;      ///< for a job that cannot be planned
};
/// Returns RESULT.json of a job as text, docs/formats.md "Result of a job". What describes the
/// rows is null unless there are some, `motion` unless one was asked for.
[[nodiscard]] std::string to_job_json(const Answer& result, const Problem& job,
                                      const JobExtras& extras = {});
/// What followed the plan of a workcell.
struct WorkcellExtras {
  const RefinedWorkcell* refinement = nullptr;
  const WorkcellTiming* motion = nullptr;    ///< null if it was not asked for or does not exist
  TimingOptions timing{};                    ///< the options that the motion was timed with
  const AdviceOnWorkcell* advice = nullptr;  ///< for a workcell that has no plan
  bool stopped = false;                      ///< time ran out before the motion that was asked for
};
/// Returns RESULT.json of a workcell as text, docs/formats.md "Result of a workcell".
[[nodiscard]] std::string to_workcell_json(const Answer& result, const WorkcellExtras& extras = {});
/// Returns RESULT.json for an internal error: its status is "error".
[[nodiscard]] std::string error_json(const std::string& message);
/// Returns the timeline in Chrome's trace event format, which Perfetto and speedscope open.
[[nodiscard]] std::string to_trace_json(const Timeline& timeline);

/// What followed a plan. A pointer is null if it was not asked for or does not exist.
struct PlanExtras {
  const Refined* refinement = nullptr;
  const TimingResult* motion = nullptr;
  TimingOptions timing;                         ///< the options that the motion was timed with
  const std::vector<Advice>* advice = nullptr;  ///< for a problem that has no path
  const InfeasibilityCertificate* certificate = nullptr;  ///< the certificate that there is no path
  std::size_t certificate_bytes = 0;                      ///< size of the certificate's file
};
/// Returns RESULT.json as text, as to_json(result) does, with the keys `refinement`, `motion`,
/// `advice` and `certificate` filled in. docs/formats.md "Result".
[[nodiscard]] std::string to_json(const PlanResult& result, const PlanExtras& extras);

}  // namespace swivel::io
