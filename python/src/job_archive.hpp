// SPDX-License-Identifier: BSD-3-Clause
// Jobs and their answers, and workcells, as bytes, for pickle, as archive.hpp has those of
// problems.
#pragma once
#include "archive.hpp"
#include "job_results.hpp"

namespace swivel {

namespace python {

/// Leaves out the job as it was given, which would be most of a plan.
template <class A>
void serialize(A& archive, JobPlan& x) {
  auto& [plan, job, timing, given] = x;
  archive(plan, job, timing);
}

}  // namespace python

}  // namespace swivel
