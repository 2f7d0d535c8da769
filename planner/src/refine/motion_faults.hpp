// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// What is wrong with a motion, and the sample at which it is.
struct Fault {
  NoMotion what;
  std::size_t row = 0;
};

/// Returns the first fault of a motion: a sample that leaves its limits or whose bodies come too
/// near, or do so on the way to it; none if it has none. `of_samples` is problem_of_samples().
/// Throws Stopped.
std::optional<Fault> first_fault(const PreparedRobot& robot, const PathProblem& of_samples,
                                 const std::vector<TimedRow>& rows, const Budget& budget);

/// Finds postures for the stretches between layers on which a motion is at fault.
class Bisection {
 public:
  /// References must outlive it.
  Bisection(const PreparedRobot& robot, const PathProblem& of_samples, const ToolPath& path,
            const Budget& budget)
      : chain_(&robot.arm().chain),
        problem_(&of_samples),
        path_(&path),
        world_(robot.world(), of_samples, budget),
        query_(world_) {}

  /// Takes the samples at fault that follow each other from `first` on, and returns the posture
  /// nearest to their middle one that keeps limits and clearance, and a little more. None if there
  /// is none, or if one was returned for that place before.
  std::optional<BetweenRow> posture(const std::vector<TimedRow>& rows, std::size_t first);

 private:
  [[nodiscard]] bool allowed(const Config& q);

  const Chain* chain_;
  const PathProblem* problem_;
  const ToolPath* path_;
  World world_;
  World::Query query_;
  std::vector<double> found_;  // m of travel
};

/// Returns true if the tool leaves the tolerances of its path between the samples of a motion, as
/// check_motion() finds.
bool strays_between(const PreparedRobot& robot, const PathProblem& problem, const TimedPath& motion,
                    const Budget& budget);
/// Returns the timing options with the tool no faster than limits.tool_speed and
/// limits.tool_turn_speed allow. Adds a warning for each speed that is lowered.
TimingOptions within_limits(TimingOptions options, const Limits& limits,
                            std::vector<std::string>& warnings);
/// Throws InvalidArgument unless the numbers of the options are finite and positive.
void require_positive(const TimingOptions& options);

}  // namespace swivel
