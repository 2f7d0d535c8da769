// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "job/order/stroke_order.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// Estimates what it costs to run the strokes of a job one after the other, from their lattices
/// without obstacles: the least joint distance from where one run ends to where the next begins,
/// plus what each of the two costs more than at its best if it ends or begins there. Throws
/// InputError and Stopped.
[[nodiscard]] OrderCosts estimate_order_costs(const PreparedRobot& robot, const Problem& job,
                                              const ParallelFor& work, const Budget& budget);

}  // namespace swivel
