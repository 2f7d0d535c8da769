// SPDX-License-Identifier: BSD-3-Clause
// Plans and motions of workcells as Python holds them.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "bindings.hpp"
#include "problem.hpp"
#include "results.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/workcells/workcell_csv.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"

namespace swivel::python {

struct WorkcellPlan {
  std::shared_ptr<const Answer> plan;  // shared with trajectories
  std::optional<TimingOptions> timing = {};
  bool refined = false;                              ///< a refinement was asked for
  std::string frame = {};                            ///< name of the base link
  std::shared_ptr<const swivel::Problem> cell = {};  ///< as it was given; null once pickled
};

/// Returns the workcell that a plan is of as it was planned, with what motions and refinements
/// need: `given`, or the one that the plan keeps. Throws ValueError if there is none.
[[nodiscard]] swivel::Problem completed(const WorkcellPlan& plan, const Problem* given);

/// The motion of both arms in time, or why there is none.
struct WorkcellMotion {
  std::shared_ptr<const MotionTiming> timing;          // shared with motions
  std::shared_ptr<const RefinedArms> refinement = {};  ///< null where it was not asked for
  std::array<std::string, 2> names = {};
  std::array<io::JointNames, 2> joint_names = {};
  std::string frame = {};  ///< name of the base link
  /// Returns the motion. Throws ValueError if there is none.
  [[nodiscard]] const swivel::Motion& motion() const;
  /// Returns the motion of each arm by its name; none where there is none.
  [[nodiscard]] Typed<"dict[str, Motion]"> motions() const;
  /// Returns the refinement of each arm by its name; none where it was not asked for.
  [[nodiscard]] Typed<"dict[str, Refined]"> refinements() const;
  /// Writes the motion in the format of the file's ending.
  void save(const std::filesystem::path& file) const;
};

/// Returns a problem of two arms. Throws as to_core() does, and InvalidArgument for another
/// problem.
[[nodiscard]] std::shared_ptr<const swivel::Problem> two_arms_of(const ProblemOrFile& cell);

using TrajectoriesByName = Typed<"dict[str, Trajectory]", py::dict>;
/// The trajectories of both arms: a plan, name -> Trajectory, or the name of a CSV file.
using WorkcellTrajectories = std::variant<WorkcellPlan, TrajectoriesByName, std::filesystem::path>;
/// Returns the rows of `name` -> Trajectory or Motion. Throws KeyError for an arm that is missing,
/// and ValueError if one is a motion and the other is none.
[[nodiscard]] io::WorkcellRows rows_of(const py::dict& rows,
                                       const std::array<std::string, 2>& names);

void bind_workcell_motion(py::module_& m);

}  // namespace swivel::python
