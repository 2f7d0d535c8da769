// SPDX-License-Identifier: BSD-3-Clause
// Motions of two arms in time, of plans and of trajectories that are given.
#include <algorithm>
#include <utility>

#include "interruptible.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"
#include "workcells/workcell_archive.hpp"

namespace swivel::python {

namespace {

/// Returns the timing that keywords ask for; without a speed, that of the arm whose tool may move
/// least fast. Throws ValueError.
TimingOptions timing_of(const swivel::Problem& cell, std::optional<double> speed,
                        std::optional<double> turn_speed, double rate) {
  std::optional<double> least;
  for (const ArmTask& arm : cell.arms)
    if (arm.path().limits.tool_speed)
      least =
          std::min(*arm.path().limits.tool_speed, least.value_or(*arm.path().limits.tool_speed));
  if (!speed && !least)
    throw py::value_error(
        "speed: is not given, nor limits.tool_speed: allowed is the speed of the tool in m/s");
  for (const auto& [value, name] : {std::pair(speed, "speed"), std::pair(turn_speed, "turn_speed")})
    if (value && !(*value > 0))
      throw py::value_error(std::string(name) +
                            ": not a positive number: allowed are values above 0");
  if (!(rate > 0 && rate <= 1e5))
    throw py::value_error("rate: allowed are numbers > 0, at most 100000");
  TimingOptions timing{.speed = speed ? *speed : *least, .turn_speed = turn_speed};
  timing.rate = rate;
  return timing;
}

/// Returns trajectories of both arms, those of a motion in a file at the layers of their paths.
/// `prepared` is that of the workcell with_motion_defaults(). Throws InputError, and ValueError for
/// motions that are no files and for a plan without trajectories.
std::array<std::vector<TrajectoryRow>, 2> untimed_rows(const PreparedWorkcell& prepared,
                                                       const swivel::Problem& cell,
                                                       const std::filesystem::path& file,
                                                       const Budget& budget) {
  io::WorkcellRows read = io::load_workcell_rows(
      file, {prepared.name(0), prepared.name(1)},
      {prepared.robot(0).arm().chain.joint_names, prepared.robot(1).arm().chain.joint_names});
  try {
    if (!read.timed[0].empty()) return rows_at_layers(prepared, read.timed, read.stated, budget);
    if (read.stated[0].rows() && read.stated[1].rows()) return std::move(read.rows);
    return complete_rows(PreparedWorkcell(cell, budget), std::move(read.rows), read.stated, budget);
  } catch (const InputError& error) {
    throw InputError(file.string(), error.what());
  }
}
std::array<std::vector<TrajectoryRow>, 2> untimed_rows(const WorkcellPlan& plan) {
  std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(*plan.plan);
  if (rows[0].empty())
    throw py::value_error(std::string("the plan has no trajectories: ") +
                          to_string(plan.plan->status));
  return rows;
}
std::array<std::vector<TrajectoryRow>, 2> untimed_rows(const py::dict& given,
                                                       const std::array<std::string, 2>& names) {
  io::WorkcellRows rows = rows_of(given, names);
  if (!rows.timed[0].empty()) throw py::value_error("rows: are motions: allowed are Trajectories");
  return std::move(rows.rows);
}

WorkcellMotion time(const ProblemOrFile& of, const WorkcellTrajectories& rows,
                    std::optional<double> speed, std::optional<double> turn_speed, double rate,
                    bool refine, std::optional<double> timeout) {
  if (timeout && !(*timeout > 0))
    throw py::value_error("timeout: not a positive number: allowed are values above 0, or None");
  const auto cell = two_arms_of(of);
  const TimingOptions timing = timing_of(*cell, speed, turn_speed, rate);
  WorkcellMotion made{.names = {cell->arms[0].name, cell->arms[1].name},
                      .frame = cell->arms[0].base_link};
  std::array<std::vector<TrajectoryRow>, 2> given;
  if (const auto* const plan = std::get_if<WorkcellPlan>(&rows))
    given = untimed_rows(*plan);
  else if (const auto* const dict = std::get_if<TrajectoriesByName>(&rows))
    given = untimed_rows(*dict, made.names);
  const auto* const file = std::get_if<std::filesystem::path>(&rows);
  return interruptible([&](const std::stop_token& stop) {
    const Budget budget(timeout, nullptr, stop);
    const PreparedWorkcell prepared(with_motion_defaults(*cell), budget);
    if (file != nullptr) given = untimed_rows(prepared, *cell, *file, budget);
    for (std::size_t k = 0; k < 2; ++k)
      made.joint_names[k] = prepared.robot(k).arm().chain.joint_names;
    if (refine) {
      RefinedWorkcellMotion found = refine_and_time_workcell(prepared, given, timing, budget);
      made.refinement = std::make_shared<const RefinedArms>(std::move(found.refinement));
      made.timing = std::make_shared<const MotionTiming>(std::move(found.timing));
    } else {
      made.timing =
          std::make_shared<const MotionTiming>(time_workcell(prepared, given, timing, budget));
    }
    if (const auto& motion = made.timing->motion)
      require_passed(check_workcell_motion(prepared, {motion->arms[0].rows, motion->arms[1].rows},
                                           {.margins = false, .budget = budget}));
    return made;
  });
}

std::string words_of(const WorkcellMotion& x) {
  if (!x.timing->motion) return "not executable: " + x.timing->failure->reason;
  const swivel::Motion& motion = *x.timing->motion;
  return formatted("%.3f s, %zu samples at %.6g Hz", motion.duration, motion.arms[0].rows.size(),
                   motion.rate);
}

}  // namespace

const swivel::Motion& WorkcellMotion::motion() const {
  if (!timing)
    throw py::value_error("there is no motion: it was not asked for, or there is no plan");
  if (!timing->motion) throw py::value_error("not executable: " + timing->failure->reason);
  return *timing->motion;
}

Typed<"dict[str, Motion]"> WorkcellMotion::motions() const {
  py::dict all;
  if (!timing || !timing->motion) return all;
  for (std::size_t k = 0; k < 2; ++k)
    all[names[k].c_str()] = py::cast(Motion{
        std::make_shared<const TimingResult>(TimingResult{timing->motion->arms[k], std::nullopt}),
        joint_names[k], frame});
  return all;
}

Typed<"dict[str, Refined]"> WorkcellMotion::refinements() const {
  py::dict all;
  if (!refinement) return all;
  for (std::size_t k = 0; k < 2; ++k)
    all[names[k].c_str()] = py::cast(RefinedPath{
        std::shared_ptr<const Refined>(refinement, &refinement->arms[k]), joint_names[k]});
  return all;
}

void WorkcellMotion::save(const std::filesystem::path& file) const {
  io::write_file(file, io::workcell_motion_text(motion(), joint_names, frame, file));
}

void bind_workcell_motion(py::module_& m) {
  py::class_<WorkcellMotion>(m, "WorkcellMotion",
                             "The motion of two arms in time by one clock, or why there is none.")
      .def(pickling<WorkcellMotion>())
      .def_property_readonly("executable",
                             [](const WorkcellMotion& x) { return x.timing->motion.has_value(); })
      .def_property_readonly(
          "not_executable",
          [](const WorkcellMotion& x) -> std::optional<std::string> {
            if (!x.timing->failure) return {};
            return x.timing->failure->reason;
          },
          "Why there is no motion; None: there is one.")
      .def_readonly("names", &WorkcellMotion::names, "Of the arms.")
      .def_property_readonly(
          "duration", [](const WorkcellMotion& x) { return x.motion().duration; },
          "s. Raises ValueError where there is no motion.")
      .def_property_readonly("motions", &WorkcellMotion::motions,
                             "Name of the arm -> Motion; samples of one number are simultaneous. "
                             "Empty: there is none.")
      .def_property_readonly("refinements", &WorkcellMotion::refinements,
                             "Name of the arm -> Refined, with refine=True.")
      .def_property_readonly(
          "warnings",
          [](const WorkcellMotion& x) {
            return x.timing->motion ? x.timing->motion->warnings : std::vector<std::string>();
          },
          "Of both arms together; each Motion has its own besides.")
      .def("save", &WorkcellMotion::save, py::arg("file"),
           "The motion of both arms as .csv, .json or .yaml (JointTrajectory), or .mcap. Raises "
           "ValueError where there is none.")
      .def("__repr__",
           [](const WorkcellMotion& x) { return "<WorkcellMotion " + words_of(x) + ">"; });
  m.def("_time_two_arms", &time, py::arg("workcell"), py::arg("rows").none(false), py::kw_only(),
        py::arg("speed"), py::arg("turn_speed"), py::arg("rate"), py::arg("refine"),
        py::arg("timeout"));
}

}  // namespace swivel::python
