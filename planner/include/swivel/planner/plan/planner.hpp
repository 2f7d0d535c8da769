// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class LatticeCache;
class PreparedRobot;
struct PlanView;

/// A planner that plans many times for one arm. It holds a robot, a scene and a task; scene and
/// task may change between plans. It reuses what did not change: trees of meshes, the kinematics of
/// the path with its bounds and its obstacle-free cost-to-go, and clearances found before, except
/// those of objects that moved. The answer of a plan never depends on earlier plans; only its
/// counters and its time do.
///
/// A planner serves one thread at a time; use clone() to give each thread its own. A change that
/// would make a problem invalid (see validate()) throws InvalidArgument and changes nothing.
class Planner {
 public:
  /// Builds a planner for a robot, with an empty scene and task to be set later. Throws InputError
  /// for unknown links, an arm of fewer than seven joints (six, if the tool may roll) and the like;
  /// InvalidArgument for what validate() refuses.
  explicit Planner(const Robot& robot);
  /// Builds a planner with the robot, scene and task of a problem. Throws as the constructor for a
  /// robot does.
  explicit Planner(PathProblem problem);
  /// Builds a planner for a problem and a robot that was prepared before. Throws InvalidArgument
  /// for what validate() refuses, and if the robot was not prepared for this problem
  /// (PreparedRobot::require_prepared_for).
  Planner(std::shared_ptr<const PreparedRobot> robot, PathProblem problem);
  ~Planner();
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;
  /// Returns a planner of the same problem that remembers no earlier plan, for use in another
  /// thread. The two share only data that are never written.
  [[nodiscard]] Planner clone() const;

  [[nodiscard]] const PathProblem& problem() const;
  /// Computes what depends on the robot alone, which the first plan would do otherwise: trees of
  /// its meshes and pairs of its bodies that touch by design. Does nothing if that is done. Throws
  /// InputError and Stopped.
  const PreparedRobot& prepare(const Budget& budget = {});

  void set_task(const Task& task);
  void set_scene(std::vector<SceneObject> scene);
  /// Adds an object to the scene. move() puts the object with a name at another pose in the world
  /// frame, and remove() takes it out; both throw InvalidArgument for an unknown name.
  void add(SceneObject object);
  void move(const std::string& object, const Pose& pose);
  void remove(const std::string& object);
  /// Attaches a tool or part that the arm carries from now on; detach() removes it by its name and
  /// throws InvalidArgument for an unknown one. The robot is prepared again at the next plan.
  void attach(AttachedBody body);
  void detach(const std::string& body);
  /// Replaces scene and task at once. Throws InvalidArgument if the robot of `problem` needs to be
  /// prepared otherwise (PreparedRobot::require_prepared_for).
  void set_problem(PathProblem problem);

  /// Plans with the current scene and task. The result is the same at any thread count, unless it
  /// times out. Throws InputError for a problem that makes no sense, and std::logic_error if
  /// options.check finds an answer invalid. "No path" and "no answer in time" are values of
  /// PlanResult::status, not exceptions.
  [[nodiscard]] PlanResult plan(const PlanOptions& options = {});

  /// Returns what the last plan found out. Throws InvalidArgument if no plan has finished or
  /// stopped in its search since the last change.
  [[nodiscard]] PlanView view() const;

 private:
  friend class StudyPlanner;
  /// Takes lattices of tasks from a cache from now on, and keeps nothing of what plans find out of
  /// obstacles. Call it before the first plan.
  void share_lattices(std::shared_ptr<LatticeCache> cache);
  friend PlanResult plan(const PathProblem& problem, const PlanOptions& options);
  friend PlanResult plan(const PreparedRobot& robot, const PathProblem& problem,
                         const PlanOptions& options);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Plans one problem, once. Throws as the constructors of Planner and Planner::plan() do.
[[nodiscard]] PlanResult plan(const PathProblem& problem, const PlanOptions& options = {});
/// Plans one problem, once, with a robot that was prepared before. Throws InvalidArgument if it was
/// not prepared for this problem (PreparedRobot::require_prepared_for).
[[nodiscard]] PlanResult plan(const PreparedRobot& robot, const PathProblem& problem,
                              const PlanOptions& options = {});

}  // namespace swivel
