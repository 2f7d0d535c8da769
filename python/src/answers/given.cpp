// SPDX-License-Identifier: BSD-3-Clause
#include "answers/given.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "problems/problem.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::python {

namespace {

[[noreturn]] void refuse(const swivel::Problem& problem, const std::string& what) {
  throw InvalidArgument("rows: are " + what + ": allowed are " +
                        (problem.arms.size() == 2 ? "those of two arms"
                         : has_strokes(problem)   ? "those of strokes"
                                                  : "those of one path"));
}

/// Returns the index of the stroke with this name. Throws InvalidArgument if there is none.
std::size_t stroke_of(const swivel::Problem& problem, const std::string& name) {
  if (const auto found = find_stroke(problem, name)) return *found;
  std::vector<std::string> known;
  for (const swivel::Stroke& stroke : problem.arm().strokes) known.push_back(stroke.name);
  throw InvalidArgument("'" + name + "' is no stroke of the problem, nearest is '" +
                        nearest_name(name, known) + "'");
}

/// A run as rows have it: its name, "ring/2" of the second run of a stroke with lift-offs, the arc
/// length of the stroke at which it begins, and that of the run itself, lines included, m.
struct RunInRows {
  std::string name;
  double begin = 0, length = 0;
};

/// Returns the problem whose strokes the runs are: where lift-offs are allowed and a stroke is done
/// in several runs, with its lift-offs. Throws InvalidArgument for runs that are not in their
/// order, that leave some of the stroke out, or that overlap by less than LiftOffs::overlap.
swivel::Problem executed_by(const swivel::Problem& problem, const std::vector<RunInRows>& runs) {
  if (!problem.arm().lift) return problem;
  constexpr double kSamePlace = 1e-9;  // m
  std::vector<LiftOff> places;
  std::optional<std::size_t> stroke;
  std::size_t number = 0;
  double end = 0;
  for (const RunInRows& run : runs) {
    const std::size_t slash = run.name.rfind('/');
    const auto whole = slash == std::string::npos || find_stroke(problem, run.name)
                           ? std::nullopt
                           : find_stroke(problem, run.name.substr(0, slash));
    number = whole && whole == stroke ? number + 1 : 1;
    stroke = whole;
    if (!whole) continue;  // a stroke in one run; one that is not known is refused later
    if (run.name.substr(slash + 1) != std::to_string(number))
      throw InvalidArgument("'" + run.name + "': allowed is '" + run.name.substr(0, slash + 1) +
                            std::to_string(number) + "': runs of a stroke in their order");
    const double most = std::max(0.0, end - problem.arm().lift->overlap);
    if (number > 1 && run.begin > most + kSamePlace)
      throw InvalidArgument("'" + run.name +
                            formatted("': begins at s = %.9g: allowed is at most %.9g, so that "
                                      "nothing of the stroke is left out and runs overlap as "
                                      "LiftOffs.overlap says",
                                      run.begin, most));
    if (number > 1) places.push_back({*whole, end, run.begin});
    const swivel::Stroke& of = problem.arm().strokes[*whole];
    end = run.begin + run.length - of.approach.norm() - of.retract.norm();
  }
  return with_lift_offs(problem, places);
}

/// Throws InvalidArgument for rows with another number of joints than the arm of a problem has.
void require_joints_of(const swivel::Problem& problem, const Trajectory& rows) {
  const std::size_t given = named_joints(rows.joint_names), own = coordinates_of(problem);
  if (given != own)
    throw InvalidArgument("rows: of " + std::to_string(given) + " joints: allowed are the arm's " +
                          std::to_string(own));
}

GivenAnswer of_parts(const swivel::Problem& problem, const std::vector<Part>& parts) {
  if (!has_strokes(problem)) refuse(problem, "parts of strokes");
  for (const Part& part : parts) require_joints_of(problem, part.trajectory);
  std::vector<RunInRows> runs;
  for (const Part& part : parts) {
    const std::vector<TrajectoryRow>& rows = *part.trajectory.rows;
    if (part.stroke) runs.push_back({*part.stroke, part.begin, rows.empty() ? 0 : rows.back().s});
  }
  GivenAnswer given{executed_by(problem, runs), std::vector<GivenArm>(1)};
  GivenArm& arm = given.arms.front();
  arm.states_directions = true;
  for (const Part& part : parts) {
    swivel::Part& made = arm.parts.emplace_back();
    if (part.stroke) made.run = StrokeRun{stroke_of(given.problem, *part.stroke), part.reversed};
    made.cost = part.cost.value_or(0);
    made.rows = *part.trajectory.rows;
    made.barred_by = part.barred_by;
    arm.process.push_back(part.process);
  }
  return given;
}

/// Returns the motion of strokes, which are numbered as in the problem that it was made for.
GivenAnswer of_motion_of_strokes(const swivel::Problem& problem, const Motion& motion) {
  if (!has_strokes(problem)) refuse(problem, "a motion of strokes");
  const std::vector<swivel::Stroke>& strokes = motion.of.executed->arm().strokes;
  const std::vector<StrokeRun> order = order_of(motion.of.found->arm());
  const ArmMotion& timed = motion.motion().arms.front();
  std::vector<RunInRows> runs;
  for (const StrokeRun& run : order)
    runs.push_back({strokes[run.stroke].name, s_of_piece(strokes[run.stroke]), 0});
  for (std::size_t k = 0; k < timed.rows.size(); ++k) {
    const std::size_t part = timed.part[k];
    if ((part % 2 == 1) == problem.arm().home.has_value() && part / 2 < runs.size())
      runs[part / 2].length = timed.rows[k].row.s;
  }
  GivenAnswer given{executed_by(problem, runs), std::vector<GivenArm>(1)};
  GivenArm& arm = given.arms.front();
  arm.states_directions = true;
  arm.motion = timed;
  const auto number = [&](std::size_t k) { return stroke_of(given.problem, strokes[k].name); };
  for (const StrokeRun& run : order) arm.order.push_back({number(run.stroke), run.reversed});
  for (ProcessEvent& event : arm.motion->events) event.stroke = number(event.stroke);
  return given;
}

/// Adds an arm that runs its only path with these rows.
void add(GivenAnswer& given, const std::vector<TrajectoryRow>& rows) {
  given.arms.emplace_back().parts.push_back({.run = StrokeRun(), .rows = rows});
}
/// Adds an arm that runs its only path with the samples of one arm of a motion.
void add(GivenAnswer& given, const Motion& motion, std::size_t arm) {
  GivenArm& made = given.arms.emplace_back();
  made.motion = motion.motion().arms[arm];
  made.order.push_back(StrokeRun());
}

GivenAnswer of_motion(const swivel::Problem& problem, const Motion& motion) {
  if (!motion.of.has_paths()) return of_motion_of_strokes(problem, motion);
  const std::size_t arms = motion.arm ? 1 : motion.of.found->arms.size();
  if (has_strokes(problem) || arms != problem.arms.size())
    refuse(problem, arms == 2 ? "a motion of two arms" : "a motion of one path");
  GivenAnswer given{problem, {}};
  for (std::size_t k = 0; k < arms; ++k) add(given, motion, motion.arm.value_or(k));
  return given;
}

GivenAnswer of_answer(const swivel::Problem& problem, const Answer& answer) {
  if (!answer.found->has_rows())
    throw py::value_error(std::string("rows: there are none: the answer is '") +
                          to_string(answer.found->status) + "'");
  if (!answer.has_paths())
    return of_parts(problem, parts_of({answer, 0}, answer.found->arm().parts));
  if (has_strokes(problem) || answer.found->arms.size() != problem.arms.size())
    refuse(problem, answer.has_two_arms() ? "an answer of two arms" : "an answer of one path");
  GivenAnswer given{problem, {}};
  for (const ArmAnswer& arm : answer.found->arms) add(given, arm.rows());
  return given;
}

GivenAnswer by_name(const swivel::Problem& problem, const py::dict& rows) {
  if (problem.arms.size() != 2) refuse(problem, "rows by the names of arms");
  GivenAnswer given{problem, {}};
  for (const ArmTask& arm : problem.arms) {
    if (!rows.contains(arm.name)) throw py::key_error("'" + arm.name + "': is missing");
    const py::object one = rows[arm.name.c_str()];
    if (py::isinstance<Motion>(one)) {
      const auto& motion = one.cast<const Motion&>();
      if (!motion.arm && motion.of.has_two_arms()) refuse(problem, "motions of two arms by name");
      add(given, motion, motion.arm.value_or(0));
    } else {
      add(given, *one.cast<const Trajectory&>().rows);
    }
  }
  if (given.arms[0].motion.has_value() != given.arms[1].motion.has_value())
    throw py::value_error("rows: one is a motion, the other one is none: allowed are two alike");
  return given;
}

}  // namespace

bool has_strokes(const swivel::Problem& problem) {
  return problem.arms.size() == 1 && !is_path(problem);
}

GivenAnswer given_answer(const swivel::Problem& problem, const GivenRows& rows) {
  if (const auto* const answer = std::get_if<Answer>(&rows)) return of_answer(problem, *answer);
  if (const auto* const motion = std::get_if<Motion>(&rows)) return of_motion(problem, *motion);
  if (const auto* const dict = std::get_if<RowsByName>(&rows)) return by_name(problem, *dict);
  if (const auto* const parts = std::get_if<std::vector<Part>>(&rows))
    return of_parts(problem, *parts);
  if (has_strokes(problem) || problem.arms.size() != 1) refuse(problem, "a trajectory of one path");
  require_joints_of(problem, std::get<Trajectory>(rows));
  GivenAnswer given{problem, {}};
  add(given, *std::get<Trajectory>(rows).rows);
  return given;
}

}  // namespace swivel::python
