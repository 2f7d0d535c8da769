// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/plan.hpp"

namespace swivel::test {

/// Returns why a run has no path; a diagnosis that says nothing where it has one. So answers of
/// both kinds compare alike.
inline const Diagnosis& diagnosis_of(const RunAnswer& run) {
  static const Diagnosis none;
  return run.diagnosis ? *run.diagnosis : none;
}

}  // namespace swivel::test
