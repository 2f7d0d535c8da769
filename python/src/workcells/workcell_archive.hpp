// SPDX-License-Identifier: BSD-3-Clause
// Plans and motions of workcells as bytes, for pickle, as archive.hpp has those of problems.
#pragma once
#include "job_archive.hpp"
#include "workcells/workcell_plan.hpp"

namespace swivel {

namespace python {

/// Leaves out the workcell, which would be most of a plan.
template <class A>
void serialize(A& archive, WorkcellPlan& x) {
  auto& [plan, timing, refined, frame, cell] = x;
  archive(plan, timing, refined, frame);
}

}  // namespace python

}  // namespace swivel
