// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>

#include "files/bad_input.hpp"
#include "jobs/job_rows.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel::io {

namespace {

bool has_times(const FileRows& read) {
  return !read.arms.front().timed.empty();
}

/// Finds where the tool lifts off from the rows of a job.
class LiftOffRows {
 public:
  LiftOffRows(const FileRows& read, const Problem& job) : file_(read), job_(job) {}

  std::vector<LiftOff> lift_offs() {
    const std::vector<RowOfJob>& rows = file_.job;
    for (std::size_t first = 0; first < rows.size();) {
      std::size_t end = first + 1;
      while (end < rows.size() && rows[end].stroke == rows[first].stroke) ++end;
      const std::size_t slash = rows[first].stroke.rfind('/');
      if (slash != std::string::npos) add_run(first, end - 1, slash);
      first = end;
    }
    return std::move(lift_offs_);
  }

 private:
  /// Adds the run in rows `first` to `last`, the number of which stands behind the slash of its
  /// name.
  void add_run(std::size_t first, std::size_t last, std::size_t slash) {
    const std::string& name = file_.job[first].stroke;
    const auto stroke = find_stroke(job_, name.substr(0, slash));
    if (!stroke) return;  // refused by who reads the rows
    number_ = stroke == stroke_ ? number_ + 1 : 1;
    stroke_ = stroke;
    if (name.substr(slash + 1) != std::to_string(number_))
      bad_input(file_.where(first) + ": stroke", "is '" + name + "'",
                "'" + name.substr(0, slash + 1) + std::to_string(number_) +
                    "': runs of a stroke in their order");
    // A run of a motion begins with the last row of the transition before it.
    const bool shared = has_times(file_) && first > 0 && file_.job[first - 1].stroke.empty() &&
                        file_.job[first - 1].placed;
    const double s = s_of(shared ? first - 1 : first);
    if (number_ > 1) {
      const Stroke& of = job_.arm().strokes[*stroke];
      const double end = end_ - of.approach.norm() - of.retract.norm(),
                   most = std::max(0.0, end - job_.arm().lift->overlap);
      if (s > most + kSamePlace)
        bad_input(
            file_.where(first) + ": s",
            formatted("is %.9g where the run begins, and the one before it ends at %.9g", s, end),
            formatted("at most %.9g, so that nothing of the stroke is left out and runs "
                      "overlap as lift.overlap says",
                      most));
      lift_offs_.push_back({*stroke, end, s});
    }
    end_ = s_of(last);
  }
  [[nodiscard]] double s_of(std::size_t row) const {
    const TrajectoryFile& of = file_.arms.front();
    if (!file_.lines.empty() && !of.stated.s)
      bad_input(file_.file, "lacks the column s, though strokes are done in several runs",
                "one that says where on the stroke each run is");
    return of.rows[row].s;
  }

  static constexpr double kSamePlace = 1e-9;  // m
  const FileRows& file_;
  const Problem& job_;
  std::size_t number_ = 0;
  std::optional<std::size_t> stroke_;
  double end_ = 0;
  std::vector<LiftOff> lift_offs_;
};

/// Returns the job whose strokes the rows of a file are: with its lift-offs, where it has any.
Problem job_of_rows(const FileRows& read, const Problem& job) {
  if (!job.arm().lift) return job;
  try {
    return with_lift_offs(job, LiftOffRows(read, job).lift_offs());
  } catch (const InvalidArgument& error) {
    throw InputError(read.file, error.what());
  }
}

/// Lets s of rows, and of events, begin at 0 in each run, as it does in the problem of the run.
void begin_at_runs(GivenArm& arm, const Problem& problem) {
  const auto begin_of_stroke = [&](std::size_t stroke) {
    return s_of_piece(problem.arm().strokes[stroke]);
  };
  if (!arm.motion) {
    for (Part& part : arm.parts)
      if (part.run && arm.stated.s)
        for (TrajectoryRow& row : part.rows) row.s -= begin_of_stroke(part.run->stroke);
    return;
  }
  ArmMotion& motion = *arm.motion;
  for (ProcessEvent& event : motion.events) event.s -= begin_of_stroke(event.stroke);
  if (!arm.stated.s) return;
  const auto begin_of = [&](std::size_t part) -> double {
    if ((part % 2 == 1) != problem.arm().home.has_value()) return 0;
    return begin_of_stroke(arm.order.at(part / 2).stroke);
  };
  for (std::size_t k = 0; k < motion.rows.size(); ++k) {
    const bool begins = k + 1 < motion.rows.size() && motion.part[k + 1] != motion.part[k];
    const double own = begin_of(motion.part[k]);
    motion.rows[k].row.s -= own != 0 || !begins ? own : begin_of(motion.part[k + 1]);
  }
}

}  // namespace

GivenAnswer load_strokes(const std::filesystem::path& file, const Problem& problem,
                         const JointNames& joint_names) {
  const FileRows read = read_rows_of_job(file, joint_names);
  GivenAnswer given{job_of_rows(read, problem), {}};
  given.arms.push_back(has_times(read) ? motion_of(read, given.problem, joint_names)
                                       : parts_of(read, given.problem));
  begin_at_runs(given.arms.front(), given.problem);
  return given;
}

}  // namespace swivel::io
