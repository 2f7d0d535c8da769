// SPDX-License-Identifier: BSD-3-Clause
// Problems as Python holds them.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/bindings.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel::python {

/// A stroke of a problem. What is unset is as the problem says, as in a problem file.
struct Stroke {
  std::string name;
  std::vector<Waypoint> waypoints;
  std::string frame;
  std::optional<PathSmoothing> smooth;
  bool reversible = false;
  std::optional<Vector3d> approach, retract;
  std::optional<double> process_speed, approach_speed;
  std::vector<double> feed;
  std::optional<Limits> limits;
  std::optional<Resolution> resolution;
  std::optional<Config> end;
  bool closed = false;
  bool operator==(const Stroke&) const = default;
};

/// The strokes of a problem: a list of Python's, which a user changes in place. Copies have strokes
/// of their own. The interpreter's lock must be held when it is made, copied and destroyed.
struct StrokeList {
  std::optional<py::list> list;  ///< none where the problem has no strokes but one path

  StrokeList() = default;
  StrokeList(const StrokeList& other) {
    if (other.list) set(other.all());
  }
  StrokeList(StrokeList&&) = default;
  StrokeList& operator=(const StrokeList&) = delete;
  StrokeList& operator=(StrokeList&&) = default;
  ~StrokeList() = default;
  /// Returns copies of the strokes. Throws TypeError for a thing in the list that is none.
  [[nodiscard]] std::vector<Stroke> all() const;
  void set(const std::vector<Stroke>& all);
};

/// A problem of any kind. The robot, scene, limits, resolution, cost and refinement of a problem
/// with strokes are those of the base; of its task it has no more.
struct Problem : PathProblem {
  StrokeList strokes;
  std::optional<Config> home;
  StrokeOrder order = StrokeOrder::kGiven;
  Vector3d approach = Vector3d::Zero(), retract = Vector3d::Zero();
  std::optional<double> process_speed, approach_speed;
  double rapid = 1;
  std::optional<LiftOffs> lift;
  /// The problem of two arms, which does not change; null where there is one. Of the base,
  /// robot is that of the first arm then, and the rest is empty.
  std::shared_ptr<const swivel::Problem> two;

  Problem() = default;
  explicit Problem(PathProblem path) : PathProblem(std::move(path)) {}
};

/// Lists the members of a Problem and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, Problem& x) {
  struct Listed : PathProblem {
    StrokeList strokes;
    std::optional<Config> home;
    StrokeOrder order;
    Vector3d approach, retract;
    std::optional<double> process_speed, approach_speed;
    double rapid;
    std::optional<LiftOffs> lift;
    std::shared_ptr<const swivel::Problem> two;
  };
  static_assert(sizeof(Listed) == sizeof(Problem));
  std::optional<std::vector<Stroke>> strokes;
  if (x.strokes.list) strokes = x.strokes.all();
  archive(static_cast<PathProblem&>(x), strokes, x.home, x.order, x.approach, x.retract,
          x.process_speed, x.approach_speed, x.rapid, x.lift, x.two);
  if (A::is_loading::value && strokes) x.strokes.set(*strokes);
}

/// Returns where the tool stands before a stroke or after it, m in the tool frame, from a distance
/// against the tool's z axis or a vector. Throws ValueError, with `what` as the argument's name.
[[nodiscard]] Vector3d to_offset(py::handle source, const char* what);

/// Returns a problem for the planner, and the other way round. Strokes that say what all strokes
/// say get it from the problem. Throws as StrokeList::all() and, of strokes, swivel::validate() do.
[[nodiscard]] swivel::Problem to_core(const Problem& problem);
/// Returns a task with its postures as the planner has them, seven numbers each. Throws
/// InvalidArgument for a posture of six numbers, unless the robot's arm has six joints and its tool
/// may not turn, and then for one of seven.
[[nodiscard]] Task task_to_core(Task task, const Robot& robot);
/// Returns a task with its postures as Python has them: of six numbers where the arm has six joints
/// and its tool may not turn.
[[nodiscard]] Task task_from_core(Task task, const Robot& robot);
/// Returns the number of joints of a state of the problem's arm, the first of two.
[[nodiscard]] std::size_t coordinates_of(const swivel::Problem& problem);
[[nodiscard]] Problem from_core(swivel::Problem core);
/// Returns the problem of one path. Throws InvalidArgument, with `what` as what was asked for, for
/// another problem.
[[nodiscard]] const PathProblem& path_of(const Problem& problem, const char* what);

/// A problem, or the name of its file.
using ProblemOrFile = std::variant<const Problem*, std::filesystem::path>;
/// Returns a problem for the planner. Throws as to_core() and io::load_problem() do.
[[nodiscard]] swivel::Problem to_core(const ProblemOrFile& problem);

/// Makes a problem of two arms, whose scene is that of the first that has a problem.
using ArmsByName = Typed<"dict[str, Problem | tuple[Robot, Trajectory]]", py::dict>;
[[nodiscard]] Problem problem_of_arms(const ArmsByName& arms,
                                      const std::vector<std::array<std::string, 2>>& touch,
                                      const std::vector<int>& at_rows);

/// Returns what place() and `Problem.placed` move: exactly one of the three, or where joints alone
/// are held elsewhere (`only_held`) none. Throws InvalidArgument otherwise, and for an arm whose
/// path is not moved.
[[nodiscard]] Movable to_movable(const std::optional<std::string>& object, bool path, bool base,
                                 bool only_held = false,
                                 const std::optional<std::string>& arm = {});

/// Returns a problem, a job or a workcell with joints held elsewhere. Throws InvalidArgument.
template <class Planned>
Planned held_as(Planned planned, const HeldPositions& positions) {
  hold_joints(planned, positions);
  return planned;
}

void bind_strokes(py::module_& m);
void bind_whole_problem(py::module_& m);

}  // namespace swivel::python
