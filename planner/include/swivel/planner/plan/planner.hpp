// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class PreparedRobot;
struct PlanView;

/// An arm that plans again and again. It holds its scene and its task, which may change between
/// plans, and re-uses what did not change: trees of meshes, the kinematics of the path with its
/// bounds and its obstacle-free cost-to-go, and the clearances found before, but of objects that
/// moved. A plan's answer never depends on the plans before, only its counters and its time do.
///
/// Not for several threads at once; each takes a clone(). Changes throw InvalidArgument for what no
/// problem may have, see validate(), and then change nothing.
class Planner {
 public:
  /// Scene and task follow. Throws InputError: unknown links, an arm of fewer than seven joints
  /// (six, where the tool may roll), ...
  explicit Planner(const Robot& robot);
  /// Robot, scene and task of a problem.
  explicit Planner(Problem problem);
  /// The same with a robot that is prepared. Throws InvalidArgument unless it was prepared for this
  /// problem.
  Planner(std::shared_ptr<const PreparedRobot> robot, Problem problem);
  ~Planner();
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;
  /// A planner of the same problem that remembers no plan, for another thread. The two share only
  /// what is never written.
  [[nodiscard]] Planner clone() const;

  [[nodiscard]] const Problem& problem() const;
  /// Trees of the robot's meshes, pairs that touch by design: what the first plan would do
  /// otherwise. Throws Stopped.
  const PreparedRobot& prepare(const Budget& budget = {});

  void set_task(const Task& task);
  void set_scene(std::vector<SceneObject> scene);
  /// An object of the scene, by its name; what is unknown is InvalidArgument.
  void add(SceneObject object);
  void move(const std::string& object, const Pose& pose);
  void remove(const std::string& object);
  /// A tool or part that the arm carries from now on, by its name. The robot is prepared again for
  /// it.
  void attach(AttachedBody body);
  void detach(const std::string& body);
  /// Scene and task at once. Throws InvalidArgument where the robot is another.
  void set_problem(Problem problem);

  /// Deterministic at any thread count, except where it times out. Throws InputError for problems
  /// that make no sense; "no path" is a status, not an exception.
  [[nodiscard]] PlanResult plan(const PlanOptions& options = {});

  /// See plan_view.hpp. Throws InvalidArgument where no plan has come as far as a verdict since the
  /// last change.
  [[nodiscard]] PlanView view() const;

 private:
  friend PlanResult plan(const Problem& problem, const PlanOptions& options);
  friend PlanResult plan(const PreparedRobot& robot, const Problem& problem,
                         const PlanOptions& options);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Plans one problem, once.
[[nodiscard]] PlanResult plan(const Problem& problem, const PlanOptions& options = {});
/// The same on a robot prepared before. Throws InvalidArgument unless it was prepared for this
/// problem (PreparedRobot::require_prepared_for).
[[nodiscard]] PlanResult plan(const PreparedRobot& robot, const Problem& problem,
                              const PlanOptions& options = {});

}  // namespace swivel
