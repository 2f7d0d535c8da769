// SPDX-License-Identifier: BSD-3-Clause
// Jobs and their answers, and workcells, as bytes, for pickle, as archive.hpp has those of
// problems.
#pragma once
#include "archive.hpp"
#include "job_results.hpp"

namespace swivel {

template <class A>
void serialize(A& archive, StrokePiece& x) {
  auto& [stroke, begin, before] = x;
  archive(stroke, begin, before);
}
template <class A>
void serialize(A& archive, LiftOffs& x) {
  auto& [cost, overlap] = x;
  archive(cost, overlap);
}
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
template <class A>
void serialize(A& archive, Problem& x) {
  auto& [source, arms, scene, vary, may_touch] = x;
  archive(source, arms, scene, vary, may_touch);
}
template <class A>
void serialize(A& archive, StrokeRun& x) {
  auto& [stroke, reversed] = x;
  archive(stroke, reversed);
}
template <class A>
void serialize(A& archive, JobPart& x) {
  auto& [run, cost, rows, barred_by] = x;
  archive(run, cost, rows, barred_by);
}
template <class A>
void serialize(A& archive, RunResult& x) {
  auto& [run, status, least_cost, lattice, measures, diagnosis] = x;
  archive(run, status, least_cost, lattice, measures, diagnosis);
}
template <class A>
void serialize(A& archive, TransitionCounters& x) {
  auto& [pairs, searches, rounds] = x;
  archive(pairs, searches, rounds);
}
template <class A>
void serialize(A& archive, NoTransition& x) {
  auto& [to, where, bodies] = x;
  archive(to, where, bodies);
}
/// Lists the members of a LiftOffResult and of its base, which no structured binding takes apart
/// together.
template <class A>
void serialize(A& archive, LiftOffResult& x) {
  struct Listed : LiftOff {
    double reached;
    Cause cause;
  };
  static_assert(sizeof(Listed) == sizeof(LiftOffResult));
  archive(x.stroke, x.end, x.resumed, x.reached, x.cause);
}
template <class A>
void serialize(A& archive, JobResult& x) {
  auto& [status, cost, lattice_cost, bound, bound_any, lift_offs, parts, partial, runs,
         no_transition, planner, threads, counters, transitions, time_ms, checked, joint_names,
         held, dropped_pairs, reduced_pairs, warnings] = x;
  archive(status, cost, lattice_cost, bound, bound_any, lift_offs, parts, partial, runs,
          no_transition, planner, threads, counters, transitions, time_ms, checked, joint_names,
          held, dropped_pairs, reduced_pairs, warnings);
}
template <class A>
void serialize(A& archive, ProcessEvent& x) {
  auto& [t, stroke, s, on] = x;
  archive(t, stroke, s, on);
}
template <class A>
void serialize(A& archive, JobMotion& x) {
  auto& [rows, part, rate, duration, events, runs, roll, warnings] = x;
  archive(rows, part, rate, duration, events, runs, roll, warnings);
}
template <class A>
void serialize(A& archive, JobTimingResult& x) {
  auto& [motion, failure, failed_part] = x;
  archive(motion, failure, failed_part);
}
template <class A>
void serialize(A& archive, JobTimingOptions& x) {
  auto& [speed, turn_speed, rate] = x;
  archive(speed, turn_speed, rate);
}
template <class A>
void serialize(A& archive, JobMotionPlan& x) {
  auto& [result, timing, stopped] = x;
  archive(result, timing, stopped);
}
template <class A>
void serialize(A& archive, JobCheckResult& x) {
  auto& [passed, failures, failure_count, cost, runs] = x;
  archive(passed, failures, failure_count, cost, runs);
}

namespace python {

template <class A>
void serialize(A& archive, Stroke& x) {
  auto& [name, waypoints, frame, smooth, reversible, approach, retract, process_speed,
         approach_speed, feed, limits, resolution, end, closed] = x;
  archive(name, waypoints, frame, smooth, reversible, approach, retract, process_speed,
          approach_speed, feed, limits, resolution, end, closed);
}
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
template <class A>
void serialize(A& archive, JobPart& x) {
  auto& [rows, joint_names, stroke, reversed, cost, barred_by, process, begin] = x;
  archive(rows, joint_names, stroke, reversed, cost, barred_by, process, begin);
}
template <class A>
void serialize(A& archive, LiftOffPlace& x) {
  auto& [stroke, result] = x;
  archive(stroke, result);
}
template <class A>
void serialize(A& archive, Workcell& x) {
  auto& [cell] = x;
  archive(cell);
}
template <class A>
void serialize(A& archive, JobRun& x) {
  auto& [result, stroke, cost] = x;
  archive(result, stroke, cost);
}
/// Leaves out the job as it was given, which would be most of a plan.
template <class A>
void serialize(A& archive, JobPlan& x) {
  auto& [plan, job, timing, given] = x;
  archive(plan, job, timing);
}
template <class A>
void serialize(A& archive, JobMotion& x) {
  auto& [timing, job, order, joint_names, fault] = x;
  archive(timing, job, order, joint_names, fault);
}
template <class A>
void serialize(A& archive, JobCheck& x) {
  auto& [result, joint_names] = x;
  archive(result, joint_names);
}

}  // namespace python

}  // namespace swivel
