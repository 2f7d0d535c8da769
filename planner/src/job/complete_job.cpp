// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/job/complete_job.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "verify/check_rates.hpp"

namespace swivel {

namespace {

/// Calls `work` on a run and puts the name of its stroke before the message of an InputError.
template <class Work>
auto in_the_name_of(const Problem& job, const StrokeRun& run, const Work& work) {
  try {
    return work(problem_of_run(job, run));
  } catch (const InputError& error) {
    throw InputError("stroke '" + job.arm().strokes[run.stroke].name + "'", error.what());
  }
}

/// The rows of a part in those of a motion: from the one at which it begins to its last one.
struct Range {
  std::size_t begin = 0, end = 0;
};

/// Returns the rows of each part of a motion. A part begins with the last row of the one before.
std::vector<Range> ranges_of(const ArmMotion& motion) {
  std::vector<Range> ranges;
  for (std::size_t k = 0; k < motion.rows.size();) {
    const std::size_t begin = k > 0 ? k - 1 : 0;
    while (k < motion.rows.size() && motion.part[k] == ranges.size()) ++k;
    ranges.push_back({begin, k});
    if (k < motion.rows.size() && motion.part[k] < ranges.size()) break;  // parts do not ascend
  }
  return ranges;
}

/// Returns the run that a part of a motion is; none for a transition.
std::optional<StrokeRun> run_of_part(const Problem& job, const std::vector<StrokeRun>& order,
                                     std::size_t part) {
  const bool is_run = (part % 2 == 1) == job.arm().home.has_value();
  if (!is_run || part / 2 >= order.size()) return std::nullopt;
  return order[part / 2];
}

double roll_at_home(const Problem& job) {
  return job.arm().home ? (*job.arm().home)[kDof - 1] : 0;
}

/// Lets the roll of a six-joint arm turn in a transition as the other joints move: from one value
/// to another, in proportion to their way. `row_at` returns a row by its number.
template <class RowAt>
void turn_along(std::size_t count, double from, double to, const RowAt& row_at) {
  std::vector<double> way{0};
  for (std::size_t k = 1; k < count; ++k)
    way.push_back(way.back() + (row_at(k).q - row_at(k - 1).q).template head<kDof - 1>().norm());
  for (std::size_t k = 0; k < count; ++k)
    row_at(k).q[kDof - 1] = from + (way.back() > 0 ? way[k] / way.back() : 0) * (to - from);
}

/// Returns the distance of joints from the straight move between two others, rad.
double distance_from_move(const Config& q, const Config& from, const Config& to) {
  const Config along = to - from;
  const double length2 = joint_squared_norm(along);
  const double share =
      length2 > 0 ? std::clamp(joint_dot(q - from, along) / length2, 0.0, 1.0) : 0.0;
  return (q - from - share * along).lpNorm<Eigen::Infinity>();
}

/// Returns the rows between which all others lie on straight moves: the first, the last and the
/// corners.
std::vector<TrajectoryRow> corners_of(const std::vector<TrajectoryRow>& rows) {
  constexpr double kStraight = 1e-6;  // rad
  std::vector<bool> kept(rows.size(), false);
  kept.front() = kept.back() = true;
  std::vector<Range> open{{0, rows.size() - 1}};
  while (!open.empty()) {
    const Range range = open.back();
    open.pop_back();
    double most = kStraight;
    std::optional<std::size_t> corner;
    for (std::size_t k = range.begin + 1; k < range.end; ++k) {
      const double off = distance_from_move(rows[k].q, rows[range.begin].q, rows[range.end].q);
      if (off > most) most = off, corner = k;
    }
    if (!corner) continue;
    kept[*corner] = true;
    open.push_back({range.begin, *corner});
    open.push_back({*corner, range.end});
  }
  std::vector<TrajectoryRow> corners;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (kept[k]) corners.push_back(rows[k]);
  return corners;
}

}  // namespace

std::vector<Part> complete_parts(const PreparedRobot& robot, const Problem& job,
                                 std::vector<Part> parts, const Stated& stated,
                                 const Budget& budget) {
  if (stated.rows()) return parts;
  for (Part& part : parts)
    if (part.run)
      part.rows = in_the_name_of(job, *part.run, [&](const PathProblem& problem) {
        return complete_rows(robot, problem, std::move(part.rows), stated, budget);
      });
  if (stated.last_joint) return parts;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].run) continue;
    double from = roll_at_home(job), to = from;
    if (k > 0 && !parts[k - 1].rows.empty()) from = parts[k - 1].rows.back().q[kDof - 1];
    if (k + 1 < parts.size() && !parts[k + 1].rows.empty())
      to = parts[k + 1].rows.front().q[kDof - 1];
    std::vector<TrajectoryRow>& rows = parts[k].rows;
    turn_along(rows.size(), from, to, [&](std::size_t i) -> TrajectoryRow& { return rows[i]; });
  }
  return parts;
}

ArmMotion complete_job_motion(const PreparedRobot& robot, const Problem& job,
                              const std::vector<StrokeRun>& order, ArmMotion motion,
                              const Stated& stated, const Budget& budget) {
  const std::vector<Range> ranges = ranges_of(motion);
  const auto rows_of = [&](const Range& range) {
    return std::vector<TimedRow>(motion.rows.begin() + static_cast<std::ptrdiff_t>(range.begin),
                                 motion.rows.begin() + static_cast<std::ptrdiff_t>(range.end));
  };
  if (!stated.motions()) {
    for (std::size_t part = 0; part < ranges.size(); ++part)
      if (const auto run = run_of_part(job, order, part)) {
        const std::vector<TimedRow> rows =
            in_the_name_of(job, *run, [&](const PathProblem& problem) {
              return complete_motion(robot, problem, rows_of(ranges[part]), stated, budget);
            });
        std::copy(rows.begin(), rows.end(),
                  motion.rows.begin() + static_cast<std::ptrdiff_t>(ranges[part].begin));
      }
    for (std::size_t part = 0; part < ranges.size(); ++part) {
      if (run_of_part(job, order, part)) continue;
      const auto [begin, end] = ranges[part];
      if (!stated.last_joint) {
        double from = roll_at_home(job), to = from;
        if (part > 0) from = motion.rows[begin].row.q[kDof - 1];
        if (part + 1 < ranges.size()) to = motion.rows[end - 1].row.q[kDof - 1];
        turn_along(end - begin, from, to, [&, first = begin](std::size_t k) -> TrajectoryRow& {
          return motion.rows[first + k].row;
        });
      }
      std::vector<TimedRow> rows = rows_of(ranges[part]);
      complete_rates(rows, stated);
      // The rows at both ends belong to runs as well.
      for (std::size_t k = part > 0 ? 1 : 0; k < rows.size(); ++k)
        if (begin + k + 1 < end || part + 1 == ranges.size()) motion.rows[begin + k] = rows[k];
    }
  }
  constexpr double kSamePlace = 1e-6;  // m
  for (ProcessEvent& event : motion.events) {
    const auto row = std::lower_bound(motion.rows.begin(), motion.rows.end(), event.t,
                                      [](const TimedRow& one, double t) { return one.t < t; });
    if (row != motion.rows.end() && !(std::abs(event.s - row->row.s) > kSamePlace))
      event.s = row->row.s;
  }
  return motion;
}

std::vector<Part> parts_of_motion(const PreparedRobot& robot, const Problem& job,
                                  const std::vector<StrokeRun>& order, const ArmMotion& motion,
                                  const Budget& budget) {
  const Problem completed = with_motion_defaults(job);
  std::vector<Part> parts;
  for (const Range& range : ranges_of(motion)) {
    Part& part = parts.emplace_back();
    for (std::size_t k = range.begin; k < range.end; ++k) part.rows.push_back(motion.rows[k].row);
    part.run = run_of_part(job, order, parts.size() - 1);
    if (part.run)
      part.rows = in_the_name_of(completed, *part.run, [&](const PathProblem& problem) {
        return rows_at_layers(robot, problem, part.rows, {}, budget);
      });
    else
      part.rows = corners_of(part.rows);
  }
  return parts;
}

}  // namespace swivel
