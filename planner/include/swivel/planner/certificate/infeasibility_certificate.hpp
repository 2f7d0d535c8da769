// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>

#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

class PreparedRobot;
struct PathProblem;
struct PlanView;

/// Returns a certificate that the last plan's problem has no path, which verify_certificate()
/// verifies: a band of layers that no path crosses, as near to the path's end as possible. `check`
/// must be the StateCheck that the plan used, or null. Throws InvalidArgument if the last plan
/// found a path, and Stopped.
[[nodiscard]] InfeasibilityCertificate prove_infeasible(
    const PlanView& view, const Budget& budget = {},
    const std::shared_ptr<StateCheck>& check = nullptr);

/// The verdict on a certificate of infeasibility: what it proves, or what is wrong with it.
struct CertificateCheck {
  bool passed = false;
  /// one line: the first fault, with layer and slot; empty if passed
  std::string failure;
  std::array<double, 2> s{0, 0};  ///< m along the path: first and last layer of the band
  /// true: all IK solutions of the arm are known; else the proof covers only those that were found
  bool complete = true;
  std::int64_t nodes = 0, edges = 0;  ///< tests of witnesses
};

/// Verifies a certificate of infeasibility from the problem alone. Builds the nodes of its layers
/// anew, tests for every node and edge that the certificate calls removed whether its witness
/// removes it, by FCL without the planners' distance proofs, and tests that no other edge leads on.
/// Uses no planner. `check` must be the StateCheck that was planned with, or null. Throws
/// InputError if the problem's lattice differs from the certificate's (resolution, edges, layers),
/// InvalidArgument as check_trajectory() does, and Stopped.
[[nodiscard]] CertificateCheck verify_certificate(
    const PreparedRobot& robot, const PathProblem& problem,
    const InfeasibilityCertificate& certificate, const Budget& budget = {},
    const std::shared_ptr<StateCheck>& check = nullptr);

}  // namespace swivel
