// SPDX-License-Identifier: BSD-3-Clause
// Plans and motions of workcells as bytes, for pickle, as archive.hpp has those of problems.
#pragma once
#include "job_archive.hpp"
#include "workcells/workcell_plan.hpp"

namespace swivel {

template <class A>
void serialize(A& archive, ArmConflict& x) {
  auto& [layer, of_motion, s, bodies] = x;
  archive(layer, of_motion, s, bodies);
}
template <class A>
void serialize(A& archive, WorkcellCounters& x) {
  auto& [rounds, pops, node_pairs, move_pairs] = x;
  archive(rounds, pops, node_pairs, move_pairs);
}
template <class A>
void serialize(A& archive, WorkcellResult& x) {
  auto& [status, cost, bound, least_costs, names, given_arm, arms, decided_by, conflict,
         between_arms, between_arms_measured, counters, planner, threads, time_ms, checked, refined,
         warnings] = x;
  archive(status, cost, bound, least_costs, names, given_arm, arms, decided_by, conflict,
          between_arms, between_arms_measured, counters, planner, threads, time_ms, checked,
          refined, warnings);
}
template <class A>
void serialize(A& archive, RefinedWorkcell& x) {
  auto& [arms, turns, cost_before, cost] = x;
  archive(arms, turns, cost_before, cost);
}
template <class A>
void serialize(A& archive, WorkcellMotion& x) {
  auto& [names, arms, rate, duration, ideal, blended, follower, follower_position, follower_angle,
         warnings] = x;
  archive(names, arms, rate, duration, ideal, blended, follower, follower_position, follower_angle,
          warnings);
}
template <class A>
void serialize(A& archive, WorkcellTiming& x) {
  auto& [motion, failure, failed_arm, time_ms, check_ms] = x;
  archive(motion, failure, failed_arm, time_ms, check_ms);
}
template <class A>
void serialize(A& archive, WorkcellMotionPlan& x) {
  auto& [result, refinement, timing, stopped] = x;
  archive(result, refinement, timing, stopped);
}

namespace python {

/// Leaves out the workcell, which would be most of a plan.
template <class A>
void serialize(A& archive, WorkcellPlan& x) {
  auto& [plan, timing, refined, frame, cell] = x;
  archive(plan, timing, refined, frame);
}
template <class A>
void serialize(A& archive, WorkcellMotion& x) {
  auto& [timing, refinement, names, joint_names, frame] = x;
  archive(timing, refinement, names, joint_names, frame);
}

}  // namespace python

}  // namespace swivel
