// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/measure/state_clearance.hpp"

#include "swivel/collision/world/world.hpp"

namespace swivel {

StateClearances state_clearances(const PreparedRobot& robot, const PathProblem& problem,
                                 std::span<const Config> states, const Budget& budget) {
  robot.require_prepared_for(problem);
  const World world(robot.world(), problem, budget);
  World::Query query(world, DistanceProofs::kOn);
  StateClearances result;
  result.bodies = world.body_names();
  result.states.reserve(states.size());
  for (const Config& q : states) {
    if (result.states.size() % 64 == 0) budget.poll();
    StateClearances::State& state = result.states.emplace_back();
    const auto nearest = query.clearance(q);
    if (nearest)
      state = {
          nearest->distance, nearest->required, nearest->least, {nearest->pair.a, nearest->pair.b}};
  }
  return result;
}

}  // namespace swivel
