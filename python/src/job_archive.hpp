// SPDX-License-Identifier: BSD-3-Clause
// Jobs and their answers, and workcells, as bytes, for pickle, as archive.hpp has those of
// problems.
#pragma once
#include "archive.hpp"
#include "job_results.hpp"

namespace swivel {

/// Lists the members of a Stroke and of its base, which no structured binding takes apart together.
template <class A>
void serialize(A& archive, Stroke& x) {
  struct Listed : Task {
    std::string name;
    bool reversible;
    Vector3d approach, retract;
    std::optional<double> process_speed, approach_speed;
    std::vector<double> feed;
    std::optional<StrokePiece> piece;
  };
  static_assert(sizeof(Listed) == sizeof(Stroke));
  archive(static_cast<Task&>(x), x.name, x.reversible, x.approach, x.retract, x.process_speed,
          x.approach_speed, x.feed, x.piece);
}
/// Lists the members of an ArmTask and of its base.
template <class A>
void serialize(A& archive, ArmTask& x) {
  struct Listed : Robot {
    std::string name;
    std::vector<Stroke> strokes;
    std::vector<Config> given;
    Limits transition_limits;
    std::optional<Config> home;
    StrokeOrder order;
    std::optional<double> process_speed, approach_speed;
    double rapid;
    std::optional<LiftOffs> lift;
  };
  static_assert(sizeof(Listed) == sizeof(ArmTask));
  archive(static_cast<Robot&>(x), x.name, x.strokes, x.given, x.transition_limits, x.home, x.order,
          x.process_speed, x.approach_speed, x.rapid, x.lift);
}
/// Lists the members of a LiftOffAnswer and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, LiftOffAnswer& x) {
  struct Listed : LiftOff {
    double reached;
    Cause cause;
  };
  static_assert(sizeof(Listed) == sizeof(LiftOffAnswer));
  archive(x.stroke, x.end, x.resumed, x.reached, x.cause);
}

namespace python {

/// Lists the members of a Job and of its base, which no structured binding takes apart together.
template <class A>
void serialize(A& archive, Job& x) {
  struct Listed : Robot {
    std::string source;
    std::vector<SceneObject> scene;
    std::vector<Variation> vary;
    py::list strokes;
    Limits limits;
    Resolution resolution;
    Cost cost;
    Refinement refinement;
    std::optional<Config> home;
    StrokeOrder order;
    Vector3d approach, retract;
    std::optional<double> process_speed, approach_speed;
    double rapid;
    std::optional<LiftOffs> lift;
  };
  static_assert(sizeof(Listed) == sizeof(Job));
  std::vector<Stroke> strokes;
  if constexpr (A::is_saving::value) strokes = x.all_strokes();
  archive(static_cast<Robot&>(x), x.source, x.scene, x.vary, strokes, x.limits, x.resolution,
          x.cost, x.refinement, x.home, x.order, x.approach, x.retract, x.process_speed,
          x.approach_speed, x.rapid, x.lift);
  if constexpr (A::is_loading::value) x.set_strokes(strokes);
}
/// Leaves out the job as it was given, which would be most of a plan.
template <class A>
void serialize(A& archive, JobPlan& x) {
  auto& [plan, job, timing, given] = x;
  archive(plan, job, timing);
}

}  // namespace python

}  // namespace swivel
