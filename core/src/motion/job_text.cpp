// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/job_text.hpp"

#include <algorithm>

#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// Returns the speed that a job's motion was asked for along its strokes, in words.
std::string speed_words(const ArmMotion& motion, const Problem& job) {
  if (motion.runs.empty()) return "";
  double least = motion.runs.front().speed, most = least;
  for (const TimedPath& run : motion.runs)
    least = std::min(least, run.speed), most = std::max(most, run.speed);
  const bool feeds = std::any_of(job.arm().strokes.begin(), job.arm().strokes.end(),
                                 [](const Stroke& stroke) { return !stroke.feed.empty(); });
  return formatted(least < most || feeds ? " at up to %g mm/s" : " at %g mm/s", 1e3 * most);
}

}  // namespace

std::string job_motion_text(const MotionTiming& timing, const std::vector<Part>& parts,
                            const Problem& job) {
  if (const auto& failure = timing.failure) {
    const std::size_t k = timing.failed_part;
    std::string part = "transition home";
    if (parts.at(k).run)
      part = "stroke " + words(*parts[k].run, job);
    else if (k + 1 < parts.size())
      part = "transition to " + words(*parts[k + 1].run, job);
    return "not executable: " + part + formatted(": s = %.4f m: ", failure->s) + failure->reason +
           '\n';
  }
  const ArmMotion& motion = timing.motion->arms.front();
  double on_strokes = 0;
  for (std::size_t k = 1; k < motion.rows.size(); ++k)
    if (parts.at(motion.part[k]).run) on_strokes += motion.rows[k].t - motion.rows[k - 1].t;
  return formatted(
      "motion: %.3f s, %.3f s of it on strokes%s and %.3f s in transitions, %zu samples at %g Hz, "
      "%zu events\n",
      motion.duration, on_strokes, speed_words(motion, job).c_str(), motion.duration - on_strokes,
      motion.rows.size(), motion.rate, motion.events.size());
}

}  // namespace swivel
