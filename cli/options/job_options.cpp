// SPDX-License-Identifier: BSD-3-Clause
#include "options/job_options.hpp"

#include <algorithm>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::cli {

void refuse_options(const std::string& kind, const std::string& file,
                    const std::vector<std::pair<bool, const char*>>& options) {
  for (const auto& [given, name] : options)
    if (given)
      throw InputError(std::string(name) + ": is not supported yet for " + kind + ", as " + file +
                       " is one: allowed are problems with one path");
}

void require_planner_of(const std::string& kind, const SearchOptions& search) {
  const PlannerKind planner = search.plan_options().planner;
  if (planner == PlannerKind::kEager || planner == PlannerKind::kEagerDp)
    throw InputError("--planner: " + search.planner + " is not supported for " + kind +
                     ": allowed are lazy, parallel");
}

Job chosen_job(Job job, const LatticeOptions& lattice, const EpisodeChoice& episode) {
  job = episode.apply(job);
  for (Stroke& stroke : job.strokes) lattice.apply(stroke);
  if (lattice.dphi || lattice.arcs) lattice.require_used(unused_keys_of(job, job.source));
  return job;
}

Workcell chosen_workcell(Workcell cell, const LatticeOptions& lattice,
                         const EpisodeChoice& episode) {
  cell = episode.apply(cell);
  for (WorkcellArm& arm : cell.arms) lattice.apply(arm);
  if (lattice.dphi || lattice.arcs)
    lattice.require_used(unused_by_both(unused_keys_of(cell.arms[0], cell.source),
                                        unused_keys_of(cell.arms[1], cell.source)));
  return cell;
}

PathProblem problem_of_arm(const Workcell& cell, std::size_t arm) {
  PathProblem problem;
  static_cast<Robot&>(problem) = cell.arms[arm];
  static_cast<Task&>(problem) = cell.arms[arm];
  problem.scene = cell.scene;
  problem.vary = cell.vary;
  problem.source = cell.source;
  return problem;
}

std::vector<HeldJoint> held_joints(const Workcell& cell) {
  std::vector<HeldJoint> held;
  for (const WorkcellArm& arm : cell.arms)
    for (const HeldJoint& joint :
         build_arm(*arm.model, arm.base_link, arm.tip_link, arm.hold, arm.tool, arm.roll).held)
      if (std::none_of(held.begin(), held.end(),
                       [&](const HeldJoint& known) { return known.name == joint.name; }))
        held.push_back(joint);
  return held;
}

}  // namespace swivel::cli
